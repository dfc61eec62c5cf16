// Makes, solves and lets go, so many times: what the process holds in memory must not grow.
#include "box.h"

static long resident_kib(void) {
    long kib = -1;
    char line[256];
    FILE *file = fopen("/proc/self/status", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) sscanf(line, "VmRSS: %ld", &kib);
    if (file != NULL) fclose(file);
    return kib;
}

int main(int argc, char **argv) {
    const int times = argc > 1 ? atoi(argv[1]) : 1000;
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    long early = 0;
    for (int k = 0; k < times; k++) {
        patchlight_context *context;
        patchlight_solution *solution;
        CHECK(patchlight_context_create(1, &context));
        patchlight_scene *scene = make_box(context, 1, reflectance, exitance);
        patchlight_options *options = make_options(0.9, argc > 2 ? argv[2] : NULL);
        patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
        CHECK(patchlight_solve(context, scene, &info, &solution));
        CHECK(patchlight_solution_release(solution));
        CHECK(patchlight_options_release(options));
        CHECK(patchlight_scene_release(scene));
        CHECK(patchlight_context_release(context));
        if (k == times / 4) early = resident_kib();
    }
    long late = resident_kib();
    printf("%d times: %ld KiB after a quarter, %ld KiB at the end\n", times, early, late);
    // What the allocator keeps varies; a leak of one solution or thread a round would be tens of MiB.
    EXPECT(late <= early + 4096);
    return 0;
}
