// Structs of other sizes, handles that are not alive, buffers that are too small: a status and a message, and nothing else happens.
#include "box.h"
#include <math.h>
#include <string.h>

#define REFUSED(call, expected) EXPECT((call) == (expected) && has_message())

static int has_message(void) {
    const char *message = "";
    return patchlight_get_message(&message) == PATCHLIGHT_OK && strlen(message) > 0;
}

// What an older program knows of patchlight_solve_info: the options alone.
struct older_info {
    size_t size;
    patchlight_options *options;
};

// What a newer program knows.
struct newer_info {
    patchlight_solve_info known;
    void *unknown;
};

static void sizes(patchlight_context *context, patchlight_scene *scene, patchlight_options *options) {
    patchlight_solution *solution;
    struct older_info older = {sizeof older, options};
    CHECK(patchlight_solve(context, scene, (const patchlight_solve_info *)&older, &solution));
    CHECK(patchlight_solution_release(solution));
    struct newer_info newer = {{sizeof newer, options, NULL, NULL, NULL, NULL, NULL}, NULL};
    CHECK(patchlight_solve(context, scene, &newer.known, &solution));
    CHECK(patchlight_solution_release(solution));
    newer.unknown = &newer;
    REFUSED(patchlight_solve(context, scene, &newer.known, &solution), PATCHLIGHT_INVALID_ARGUMENT);
    newer.known.size = 0;
    REFUSED(patchlight_solve(context, scene, &newer.known, &solution), PATCHLIGHT_INVALID_ARGUMENT);
    newer.known.size = (size_t)-1;
    REFUSED(patchlight_solve(context, scene, &newer.known, &solution), PATCHLIGHT_INVALID_ARGUMENT);
}

static void handles(patchlight_context *context, patchlight_scene *scene, patchlight_options *options) {
    patchlight_solution *solution, *same;
    int mine;
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    CHECK(patchlight_solve(context, scene, &info, &solution));
    same = solution;
    CHECK(patchlight_solution_retain(solution));
    CHECK(patchlight_solution_release(solution));
    size_t count;
    CHECK(patchlight_solution_count(same, PATCHLIGHT_SURFACES, &count));
    EXPECT(count == 6);
    CHECK(patchlight_solution_release(same));

    // Released, of another kind, of nobody's.
    REFUSED(patchlight_solution_retain(solution), PATCHLIGHT_INVALID_HANDLE);
    REFUSED(patchlight_solution_release(solution), PATCHLIGHT_INVALID_HANDLE);
    REFUSED(patchlight_solution_count(solution, PATCHLIGHT_SURFACES, &count), PATCHLIGHT_INVALID_HANDLE);
    REFUSED(patchlight_solution_count((patchlight_solution *)scene, PATCHLIGHT_SURFACES, &count), PATCHLIGHT_INVALID_HANDLE);
    REFUSED(patchlight_scene_commit((patchlight_scene *)&mine), PATCHLIGHT_INVALID_HANDLE);
    CHECK(patchlight_solution_release(NULL));
}

static void buffers(patchlight_context *context, patchlight_scene *scene, patchlight_options *options) {
    patchlight_solution *solution;
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    CHECK(patchlight_solve(context, scene, &info, &solution));
    double numbers[6] = {-1, -1, -1, -1, -1, -1};
    size_t count = 0;
    REFUSED(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, numbers, 5, &count),
            PATCHLIGHT_BUFFER_TOO_SMALL);
    EXPECT(count == 6 && numbers[0] == -1);
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, numbers, 6, NULL));
    EXPECT(numbers[0] > 0);

    // Text ends in a zero, which counts.
    CHECK(patchlight_solution_get_report(solution, NULL, 0, &count));
    char *report = (char *)malloc(count);
    REFUSED(patchlight_solution_get_report(solution, report, count - 1, NULL), PATCHLIGHT_BUFFER_TOO_SMALL);
    CHECK(patchlight_solution_get_report(solution, report, count, NULL));
    EXPECT(strlen(report) == count - 1 && report[0] == '{');
    free(report);

    // Points that are none.
    double point[6] = {0.5, 0, 0.5, 0, 1, 0};
    float radiosity = -1;
    size_t missed = 9;
    patchlight_array positions = array_of(PATCHLIGHT_DOUBLE, point, 1), normals = array_of(PATCHLIGHT_DOUBLE, point + 3, 1);
    patchlight_values values = {sizeof values, 1, &radiosity, NULL, NULL, NULL};
    CHECK(patchlight_solution_get_values(solution, &positions, &normals, &values, &missed));
    EXPECT(missed == 0 && radiosity > 0);
    values.lower = &radiosity;
    REFUSED(patchlight_solution_get_values(solution, &positions, &normals, &values, NULL), PATCHLIGHT_NOT_AVAILABLE);
    values.lower = NULL;
    values.capacity = 0;
    REFUSED(patchlight_solution_get_values(solution, &positions, &normals, &values, NULL), PATCHLIGHT_BUFFER_TOO_SMALL);
    values.capacity = 1;
    normals.count = 0;
    REFUSED(patchlight_solution_get_values(solution, &positions, &normals, &values, NULL), PATCHLIGHT_INVALID_ARGUMENT);
    normals.count = 1;
    point[0] = NAN;
    REFUSED(patchlight_solution_get_values(solution, &positions, &normals, &values, NULL), PATCHLIGHT_INVALID_ARGUMENT);
    positions.format = PATCHLIGHT_UINT32;
    REFUSED(patchlight_solution_get_values(solution, &positions, &normals, &values, NULL), PATCHLIGHT_INVALID_ARGUMENT);
    CHECK(patchlight_solution_release(solution));
}

static void meshes(patchlight_context *context, patchlight_scene *scene, patchlight_options *options) {
    patchlight_solution *solution;
    patchlight_mesh *mesh;
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    CHECK(patchlight_solve(context, scene, &info, &solution));
    REFUSED(patchlight_solution_get_mesh(solution, &mesh), PATCHLIGHT_NOT_AVAILABLE);
    REFUSED(patchlight_solution_make_mesh(solution, NAN, &mesh), PATCHLIGHT_OUT_OF_RANGE);
    CHECK(patchlight_solution_make_mesh(solution, 0.9, &mesh));
    CHECK(patchlight_solution_release(solution));

    // A byte beyond the last item would not be there.
    size_t count = 0;
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, NULL, &count));
    const size_t stride = 49, size = (count - 1) * stride + 6 * sizeof(uint64_t);
    unsigned char *nodes = (unsigned char *)malloc(size);
    patchlight_buffer buffer = {sizeof buffer, PATCHLIGHT_UINT64, nodes, count, stride};
    CHECK(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, &buffer, NULL));
    buffer.capacity--;
    REFUSED(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, &buffer, NULL), PATCHLIGHT_BUFFER_TOO_SMALL);
    buffer.stride = 47;
    REFUSED(patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, &buffer, NULL), PATCHLIGHT_INVALID_ARGUMENT);
    free(nodes);

    patchlight_mesh *same = mesh;
    CHECK(patchlight_mesh_release(mesh));
    REFUSED(patchlight_mesh_get_array(same, PATCHLIGHT_MESH_POSITIONS, NULL, &count), PATCHLIGHT_INVALID_HANDLE);
}

int main(void) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    patchlight_context *context;
    CHECK(patchlight_context_create(1, &context));
    patchlight_scene *scene = make_box(context, 1, reflectance, exitance);
    patchlight_options *options = make_options(0.9, "obvhs");
    sizes(context, scene, options);
    handles(context, scene, options);
    buffers(context, scene, options);
    meshes(context, scene, options);
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    REFUSED(patchlight_context_retain(context), PATCHLIGHT_INVALID_HANDLE);
    return 0;
}
