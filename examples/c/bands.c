// Own arrays, with strides, and two bands: a leaf's worth of photosynthetically active and of near-infrared radiation.
#include "box.h"
#include <math.h>

// Vertices as a program may have them: with something else in between.
struct vertex {
    float position[3];
    float temperature;
};

int main(int argc, char **argv) {
    // Both bands in closed surroundings that all emit and reflect alike: the exact radiosity is E / (1 - rho).
    const double reflectance[4] = {0.1, 0.45, 0.1, 0.45}, exitance[4] = {2, 3, 2, 3};
    struct vertex vertices[8];
    for (int k = 0; k < 8; k++) {
        for (int axis = 0; axis < 3; axis++) vertices[k].position[axis] = BOX_VERTICES[k][axis];
        vertices[k].temperature = 293.0f;
    }
    uint64_t corners[24];
    for (int k = 0; k < 24; k++) corners[k] = BOX_CORNERS[k];

    patchlight_array positions = {sizeof positions, PATCHLIGHT_FLOAT, vertices, 8, sizeof vertices[0]};
    patchlight_array of_corners = array_of(PATCHLIGHT_UINT64, corners, 24), counts = array_of(PATCHLIGHT_UINT32, BOX_COUNTS, 6);
    patchlight_array reflectances = array_of(PATCHLIGHT_DOUBLE, reflectance, 2), exitances = array_of(PATCHLIGHT_DOUBLE, exitance, 2);
    patchlight_context *context;
    patchlight_scene *scene;
    CHECK(patchlight_context_create(1, &context));
    CHECK(patchlight_scene_create(context, 2, PATCHLIGHT_SIDES_FRONT, &scene));
    CHECK(patchlight_scene_add_materials(scene, &reflectances, &exitances));
    CHECK(patchlight_scene_add_vertices(scene, &positions));
    CHECK(patchlight_scene_add_faces(scene, &of_corners, &counts, NULL));
    CHECK(patchlight_scene_commit(scene));

    patchlight_options *options = make_options(0.05, argc > 1 ? argv[1] : NULL);
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution;
    CHECK(patchlight_solve(context, scene, &info, &solution));
    double radiosity[12];
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, radiosity, 12, NULL));
    for (int surface = 0; surface < 6; surface++) {
        printf("surface %d: %.4f and %.4f W/m^2\n", surface, radiosity[2 * surface], radiosity[2 * surface + 1]);
        EXPECT(fabs(radiosity[2 * surface] - 2 / 0.9) < 0.05 * 2 / 0.9);
        EXPECT(fabs(radiosity[2 * surface + 1] - 3 / 0.55) < 0.05 * 3 / 0.55);
    }
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
