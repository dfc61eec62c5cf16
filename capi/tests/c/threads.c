// Eight threads share a context, and solve and read at once; each hears its own progress.
#include "box.h"
#include <pthread.h>
#include <string.h>

#define THREADS 8

static patchlight_context *context;
static patchlight_scene *scene;

struct outcome {
    double radiosity[6];
    int reports;
};

// By one thread at a time for each solve, but not always the same.
static int32_t count(void *user, const patchlight_progress *progress) {
    (void)progress;
    __atomic_fetch_add((int *)user, 1, __ATOMIC_SEQ_CST);
    return 0;
}

static void *solve(void *data) {
    struct outcome *outcome = (struct outcome *)data;
    patchlight_options *options = make_options(0.1, "obvhs");
    patchlight_solve_info info = {sizeof info, options, count, &outcome->reports, NULL, NULL, NULL};
    patchlight_solution *solution;
    CHECK(patchlight_solve(context, scene, &info, &solution));
    CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, outcome->radiosity, 6, NULL));

    // A message is of its own thread.
    const char *message = "";
    EXPECT(patchlight_solution_count(solution, 77, NULL) == PATCHLIGHT_INVALID_ARGUMENT);
    CHECK(patchlight_get_message(&message));
    EXPECT(strlen(message) > 0);
    CHECK(patchlight_solution_release(solution));
    CHECK(patchlight_options_release(options));
    return NULL;
}

int main(void) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    CHECK(patchlight_context_create(2, &context));
    scene = make_box(context, 1, reflectance, exitance);
    pthread_t threads[THREADS];
    static struct outcome outcomes[THREADS];
    for (int k = 0; k < THREADS; k++) EXPECT(pthread_create(&threads[k], NULL, solve, &outcomes[k]) == 0);
    for (int k = 0; k < THREADS; k++) EXPECT(pthread_join(threads[k], NULL) == 0);
    for (int k = 0; k < THREADS; k++) {
        EXPECT(memcmp(outcomes[k].radiosity, outcomes[0].radiosity, sizeof outcomes[0].radiosity) == 0);
        EXPECT(__atomic_load_n(&outcomes[k].reports, __ATOMIC_SEQ_CST) > 0);
    }
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
