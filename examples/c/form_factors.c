// Form factors as sparse rows (receiver, source, form factor). In a closed box those from any wall add up to 1.
#include "box.h"
#include <math.h>

int main(int argc, char **argv) {
    const double reflectance[2] = {0.5, 0.5}, exitance[2] = {1, 1};
    patchlight_context *context;
    CHECK(patchlight_context_create(0, &context));
    patchlight_scene *scene = make_box(context, 1, reflectance, exitance);

    // Every pair of walls is linked as it is, exactly, without rays to guess at what is in between.
    patchlight_options *options = make_options(0.1, argc > 1 ? argv[1] : NULL);
    CHECK(patchlight_options_set_text(options, "strategy", "uniform"));
    CHECK(patchlight_options_set_text(options, "solver", "links"));
    CHECK(patchlight_options_set_double(options, "form_factor_accuracy", 0));
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    patchlight_solution *solution;
    CHECK(patchlight_solve(context, scene, &info, &solution));

    size_t links, nodes;
    CHECK(patchlight_solution_count(solution, PATCHLIGHT_LINKS, &links));
    CHECK(patchlight_solution_count(solution, PATCHLIGHT_NODES, &nodes));
    uint32_t *receiver = (uint32_t *)malloc(links * sizeof(uint32_t)), *source = (uint32_t *)malloc(links * sizeof(uint32_t));
    double *form_factor = (double *)malloc(links * sizeof(double)), *row = (double *)calloc(nodes, sizeof(double));
    CHECK(patchlight_solution_get_uint32(solution, PATCHLIGHT_LINKS, PATCHLIGHT_RECEIVER, receiver, links, NULL));
    CHECK(patchlight_solution_get_uint32(solution, PATCHLIGHT_LINKS, PATCHLIGHT_SOURCE, source, links, NULL));
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_LINKS, PATCHLIGHT_FORM_FACTOR, form_factor, links, NULL));
    for (size_t k = 0; k < links; k++) {
        EXPECT(receiver[k] < nodes && source[k] < nodes && (k == 0 || receiver[k] >= receiver[k - 1]));
        printf("%u %u %.6f\n", (unsigned)receiver[k], (unsigned)source[k], form_factor[k]);
        row[receiver[k]] += form_factor[k];
    }

    uint32_t of_surface[6];
    CHECK(patchlight_solution_get_uint32(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_NODE, of_surface, 6, NULL));
    for (int surface = 0; surface < 6; surface++) EXPECT(fabs(row[of_surface[surface]] - 1) < 1e-6);
    EXPECT(links == 30);
    free(receiver);
    free(source);
    free(form_factor);
    free(row);
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
