// Many lights in one solve: a channel for each, so that any of them can be dimmed afterwards without another solve.
#include "box.h"
#include <math.h>

#define LIGHTS 6

// A box of which every wall is a light, in a channel of its own.
static patchlight_scene *lights(patchlight_context *context) {
    double reflectance[LIGHTS * LIGHTS], exitance[LIGHTS * LIGHTS] = {0};
    uint32_t materials[6];
    for (int k = 0; k < LIGHTS * LIGHTS; k++) reflectance[k] = 0.5;
    for (uint32_t wall = 0; wall < 6; wall++) {
        materials[wall] = wall;
        exitance[wall * LIGHTS + wall] = 1.0 + wall;
    }
    patchlight_array reflectances = array_of(PATCHLIGHT_DOUBLE, reflectance, 6), exitances = array_of(PATCHLIGHT_DOUBLE, exitance, 6);
    patchlight_array positions = array_of(PATCHLIGHT_FLOAT, BOX_VERTICES, 8), corners = array_of(PATCHLIGHT_UINT32, BOX_CORNERS, 24);
    patchlight_array counts = array_of(PATCHLIGHT_UINT32, BOX_COUNTS, 6), of_faces = array_of(PATCHLIGHT_UINT32, materials, 6);
    patchlight_scene *scene;
    CHECK(patchlight_scene_create(context, LIGHTS, PATCHLIGHT_SIDES_FRONT, &scene));
    CHECK(patchlight_scene_add_materials(scene, &reflectances, &exitances));
    CHECK(patchlight_scene_add_vertices(scene, &positions));
    CHECK(patchlight_scene_add_faces(scene, &corners, &counts, &of_faces));
    CHECK(patchlight_scene_commit(scene));
    return scene;
}

int main(int argc, char **argv) {
    patchlight_context *context;
    CHECK(patchlight_context_create(0, &context));
    patchlight_scene *scene = lights(context);
    patchlight_options *options = make_options(0.05, argc > 1 ? argv[1] : NULL);
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution;
    CHECK(patchlight_solve(context, scene, &info, &solution));

    // Dimmed so that all walls emit 1 W/m^2, radiosity is 1 / (1 - 0.5) on all of them.
    double radiosity[6 * LIGHTS];
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, radiosity, 6 * LIGHTS, NULL));
    for (int wall = 0; wall < 6; wall++) {
        double sum = 0;
        for (int light = 0; light < LIGHTS; light++) sum += radiosity[wall * LIGHTS + light] / (1.0 + light);
        printf("wall %d: %.4f W/m^2 by all lights, %.4f by its own\n", wall, sum, radiosity[wall * LIGHTS + wall] / (1.0 + wall));
        EXPECT(fabs(sum - 2) < 0.1);
    }
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
