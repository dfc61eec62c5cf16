// One solve, lit and painted otherwise afterwards: light groups with other weights, and other materials over the transport that was stored.
#include "box.h"
#include <math.h>

static void radiosities(patchlight_solution *solution, double radiosity[6]) {
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, radiosity, 6, NULL));
}

// Walls and ceiling are a light group each: any weights of theirs are a sum.
static void weigh(patchlight_context *context, const char *backend) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {1, 5}, weights[3][2] = {{1, 0}, {0, 1}, {0.5, 2}};
    patchlight_scene *scene = open_box(context, 1, reflectance, exitance);
    CHECK(patchlight_scene_group_lights(scene, PATCHLIGHT_LIGHTS_BY_MATERIAL));
    CHECK(patchlight_scene_commit(scene));
    patchlight_options *options = make_options(0.05, backend);
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution;
    CHECK(patchlight_solve(context, scene, &info, &solution));

    size_t groups;
    CHECK(patchlight_solution_light_group_count(solution, &groups));
    EXPECT(groups == 2);
    double radiosity[3][6], error;
    for (int k = 0; k < 3; k++) {
        patchlight_array array = array_of(PATCHLIGHT_DOUBLE, weights[k], groups);
        patchlight_solution *relit;
        CHECK(patchlight_solution_relight(solution, &array, &relit));
        CHECK(patchlight_solution_get_figure(relit, PATCHLIGHT_ERROR_ESTIMATE, &error));
        printf("weights %g and %g: an error of %.2f%% is claimed\n", weights[k][0], weights[k][1], 100 * error);
        radiosities(relit, radiosity[k]);
        CHECK(patchlight_solution_release(relit));
    }
    for (int wall = 0; wall < 6; wall++) {
        double sum = 0.5 * radiosity[0][wall] + 2 * radiosity[1][wall];
        EXPECT(fabs(radiosity[2][wall] - sum) < 1e-6 * sum);
    }
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
}

// Where all faces emit 1 W/m^2 and reflect one half, radiosity is 1 / (1 - 0.5).
static void paint(patchlight_context *context, const char *backend) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5}, half[2] = {0.5, 0.5}, one[2] = {1, 1};
    patchlight_scene *scene = make_box(context, 1, reflectance, exitance);
    patchlight_options *options = make_options(0.05, backend);
    CHECK(patchlight_options_set_bool(options, "keep_transport", 1));
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution, *painted;
    CHECK(patchlight_solve(context, scene, &info, &solution));

    patchlight_array reflectances = array_of(PATCHLIGHT_DOUBLE, half, 2), exitances = array_of(PATCHLIGHT_DOUBLE, one, 2);
    double radiosity[6], error;
    CHECK(patchlight_solution_with_materials(solution, &reflectances, &exitances, 0, &painted));
    CHECK(patchlight_solution_get_figure(painted, PATCHLIGHT_ERROR_ESTIMATE, &error));
    radiosities(painted, radiosity);
    for (int wall = 0; wall < 6; wall++) {
        printf("wall %d, painted: %.4f W/m^2 of 2\n", wall, radiosity[wall]);
        EXPECT(fabs(radiosity[wall] - 2) < 0.1);
    }
    printf("an error of %.2f%% is claimed for values\n", 100 * error);
    CHECK(patchlight_solution_release(painted));
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
}

int main(int argc, char **argv) {
    patchlight_context *context;
    CHECK(patchlight_context_create(0, &context));
    weigh(context, argc > 1 ? argv[1] : NULL);
    paint(context, argc > 1 ? argv[1] : NULL);
    CHECK(patchlight_context_release(context));
    return 0;
}
