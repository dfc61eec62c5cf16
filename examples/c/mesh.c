// The answer as a function on the surfaces: its nodes in vertices of one's own, the light that it says is absorbed, a value. With a second argument, a
// picture of it goes there.
#include "box.h"
#include <math.h>

// A vertex as a renderer may have it.
struct vertex {
    float position[3];
    float radiosity;
    unsigned char others[4];
};

static double area_of(const struct vertex *vertices, const uint32_t *nodes) {
    double u[3], v[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = vertices[nodes[1]].position[k] - vertices[nodes[0]].position[k];
        v[k] = vertices[nodes[2]].position[k] - vertices[nodes[0]].position[k];
    }
    for (int k = 0; k < 3; k++) sum += pow(u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3], 2);
    return sqrt(sum) / 2;
}

int main(int argc, char **argv) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    patchlight_context *context;
    CHECK(patchlight_context_create(2, &context));
    patchlight_scene *scene = make_box(context, 1, reflectance, exitance);
    patchlight_options *options = make_options(0.05, argc > 1 ? argv[1] : NULL);
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution;
    patchlight_mesh *mesh;
    double of_values, of_mesh;
    CHECK(patchlight_solve(context, scene, &info, &solution));
    CHECK(patchlight_solution_make_mesh(solution, 0.05, &mesh));
    CHECK(patchlight_solution_get_figure(solution, PATCHLIGHT_ERROR_ESTIMATE, &of_values));
    CHECK(patchlight_mesh_get_figure(mesh, PATCHLIGHT_MESH_CLAIMED, &of_mesh));

    // Nodes go where they are wanted, positions beside radiosities.
    size_t nodes, elements;
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_POSITIONS, NULL, &nodes));
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, NULL, &elements));
    struct vertex *vertices = (struct vertex *)calloc(nodes, sizeof *vertices);
    uint32_t *corners = (uint32_t *)malloc(6 * elements * sizeof *corners), *surfaces = (uint32_t *)malloc(elements * sizeof *surfaces);
    patchlight_buffer positions = {sizeof positions, PATCHLIGHT_FLOAT, vertices[0].position, nodes, sizeof *vertices};
    patchlight_buffer radiosities = {sizeof radiosities, PATCHLIGHT_FLOAT, &vertices[0].radiosity, nodes, sizeof *vertices};
    patchlight_buffer of_elements = {sizeof of_elements, PATCHLIGHT_UINT32, corners, elements, 0};
    patchlight_buffer of_surfaces = {sizeof of_surfaces, PATCHLIGHT_UINT32, surfaces, elements, 0};
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_POSITIONS, &positions, NULL));
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_RADIOSITY, &radiosities, NULL));
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, &of_elements, NULL));
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_SURFACE, &of_surfaces, NULL));

    // What the ceiling of 1 m^2 emits is absorbed: of what leaves a place, B - E is the part rho of what arrives, and the rest of that stays. The mean of
    // a quadratic function over a triangle is that of the middles of its edges.
    uint32_t materials[6];
    CHECK(patchlight_solution_get_uint32(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_MATERIAL, materials, 6, NULL));
    double absorbed = 0;
    for (size_t k = 0; k < elements; k++) {
        const uint32_t *of = corners + 6 * k, material = materials[surfaces[k]];
        double mean = (vertices[of[3]].radiosity + vertices[of[4]].radiosity + vertices[of[5]].radiosity) / 3.0;
        double arrives = (mean - exitance[material]) / reflectance[material];
        absorbed += area_of(vertices, of) * (1 - reflectance[material]) * arrives;
    }
    printf("%llu elements, %llu nodes: %.4f of %.4f W are absorbed; errors of %.1f%% and %.1f%% are claimed\n",
           (unsigned long long)elements, (unsigned long long)nodes, absorbed, exitance[1], 100 * of_values, 100 * of_mesh);
    EXPECT(fabs(absorbed / exitance[1] - 1) < of_values + of_mesh);

    // A value, also when all else is gone.
    CHECK(patchlight_solution_release(solution));
    double point[6] = {0.5, 0, 0.5, 0, 1, 0}, value[1];
    patchlight_array at = array_of(PATCHLIGHT_DOUBLE, point, 1), normal = array_of(PATCHLIGHT_DOUBLE, point + 3, 1);
    patchlight_buffer into = {sizeof into, PATCHLIGHT_DOUBLE, value, 1, 0};
    CHECK(patchlight_mesh_get_values(mesh, &at, &normal, &into, NULL));
    printf("%.4f W/m^2 in the middle of the floor\n", value[0]);
    EXPECT(value[0] > 0 && value[0] < exitance[1]);
    patchlight_camera camera = {sizeof camera, 320, 240, {0.5, 0.5, 0.95}, {0.5, 0.5, 0}, {0, 1, 0}, 80};
    if (argc > 2) CHECK(patchlight_mesh_write_picture(mesh, &camera, argv[2]));

    free(vertices), free(corners), free(surfaces);
    CHECK(patchlight_mesh_release(mesh));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
