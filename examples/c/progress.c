// A bar of progress, and a user who loses patience: the solve is cancelled, and what there is can be read.
#include "box.h"

struct user {
    int reports;
    int patience;
};

// Called on worker threads, by one at a time.
static int32_t tell(void *data, const patchlight_progress *progress) {
    static const char *const stages[] = {"", "build", "refine", "gather", "error", "sample", "render"};
    struct user *user = (struct user *)data;
    user->reports++;
    const char *stage = progress->stage <= PATCHLIGHT_STAGE_RENDER ? stages[progress->stage] : "?";
    fprintf(stderr, "\r%-6s %6llu links  ", stage, (unsigned long long)progress->links);
    return user->reports >= user->patience;
}

int main(int argc, char **argv) {
    const double reflectance[6] = {0.7, 0.6, 0.5, 0.5, 0.5, 0.5}, exitance[6] = {0, 0, 0, 10, 10, 10};
    patchlight_context *context;
    CHECK(patchlight_context_create(2, &context));
    patchlight_scene *scene = make_box(context, 3, reflectance, exitance);
    patchlight_options *options = make_options(0.05, argc > 1 ? argv[1] : NULL);

    // All of it, and then one that is cancelled at once.
    for (int patience = 1000000; patience > 0; patience = patience > 1 ? 1 : 0) {
        struct user user = {0, patience};
        patchlight_solve_info info = {sizeof info, options, tell, &user, NULL, NULL, NULL};
        patchlight_solution *solution;
        patchlight_status status = CHECK(patchlight_solve(context, scene, &info, &solution));
        fprintf(stderr, "\n");
        EXPECT(user.reports > 0);
        EXPECT(status == (patience == 1 ? PATCHLIGHT_CANCELLED : PATCHLIGHT_OK));

        size_t elements;
        CHECK(patchlight_solution_count(solution, PATCHLIGHT_ELEMENTS, &elements));
        EXPECT(elements >= 6);
        printf("%s: %llu elements\n", status == PATCHLIGHT_OK ? "done" : "cancelled", (unsigned long long)elements);
        CHECK(patchlight_solution_release(solution));
    }
    CHECK(patchlight_options_release(options));
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
