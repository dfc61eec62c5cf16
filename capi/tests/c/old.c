// A program of version 0.1.0 as it is after compilation: it has no patchlight.h, but what that said of functions, structs and numbers.
// Later libraries must run it, whatever options, fields and values were added. Nothing here changes before the SONAME does.
#include <stdint.h>
#include <stdio.h>
#include <string.h>

struct array { size_t size; uint32_t format; const void *data; size_t count; size_t stride; };
struct solve_info { size_t size; void *options; int32_t (*progress)(void *, const void *); void *progress_user; const void *visibility; };

#ifdef __cplusplus
extern "C" {
#endif
int patchlight_context_create(uint32_t, void **);
int patchlight_context_release(void *);
int patchlight_option_count(size_t *);
int patchlight_option_get_type(size_t, uint32_t *);
int patchlight_option_get_text(size_t, uint32_t, char *, size_t, size_t *);
int patchlight_options_create(void **);
int patchlight_options_release(void *);
int patchlight_options_set_double(void *, const char *, double);
int patchlight_options_set_text(void *, const char *, const char *);
int patchlight_options_reset(void *, const char *);
int patchlight_scene_create(void *, uint32_t, uint32_t, void **);
int patchlight_scene_release(void *);
int patchlight_scene_add_materials(void *, const struct array *, const struct array *);
int patchlight_scene_add_vertices(void *, const struct array *);
int patchlight_scene_add_faces(void *, const struct array *, const struct array *, const struct array *);
int patchlight_scene_commit(void *);
int patchlight_solve(void *, void *, const struct solve_info *, void **);
int patchlight_solution_get_double(void *, uint32_t, uint32_t, double *, size_t, size_t *);
int patchlight_solution_release(void *);
#ifdef __cplusplus
}
#endif

enum { OK = 0, INVALID_ARGUMENT = 100, UNKNOWN_OPTION = 102, DOUBLE = 2, UINT32 = 3, OPTION_KEY = 1, SURFACES = 1, RADIOSITY = 1 };

#define CHECK(what) \
    do { if (!(what)) return fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #what), 1; } while (0)

static const double VERTICES[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
static const uint32_t CORNERS[24] = {0, 4, 5, 1, 3, 2, 6, 7, 4, 7, 6, 5, 0, 1, 2, 3, 0, 3, 7, 4, 1, 5, 6, 2};
static const uint32_t COUNTS[6] = {4, 4, 4, 4, 4, 4}, MATERIALS[6] = {0};

// The options that it knows are there, by name, whatever others are listed; what it does not know it can set back.
static int sets_options(void *options) {
    static const char *const known[] = {"error", "seed", "solver", "norm", "max_links", "backend", "time", "memory"};
    size_t count, length, found = 0;
    CHECK(patchlight_option_count(&count) == OK);
    for (size_t option = 0; option < count; option++) {
        char key[200];
        uint32_t type;
        CHECK(patchlight_option_get_text(option, OPTION_KEY, key, sizeof key, &length) == OK);
        CHECK(patchlight_option_get_type(option, &type) == OK && type >= 1);
        CHECK(patchlight_options_reset(options, key) == OK);
        for (size_t name = 0; name < sizeof known / sizeof *known; name++) found += strcmp(key, known[name]) == 0;
    }
    CHECK(found == sizeof known / sizeof *known);
    CHECK(patchlight_options_set_double(options, "error", 0.2) == OK);
    CHECK(patchlight_options_set_text(options, "backend", "obvhs") == OK);
    CHECK(patchlight_options_set_text(options, "no_such_option", "1") == UNKNOWN_OPTION);
    return 0;
}

int main(void) {
    void *context, *options, *scene, *solution;
    CHECK(patchlight_context_create(1, &context) == OK);
    CHECK(patchlight_options_create(&options) == OK);
    if (sets_options(options)) return 1;

    // A closed box of which each wall sends out 3 W/m^2 and reflects 0.4: everywhere there are 3 / (1 - 0.4) = 5.
    const double reflectance = 0.4, exitance = 3;
    struct array rho = {sizeof rho, DOUBLE, &reflectance, 1, 0}, e = {sizeof e, DOUBLE, &exitance, 1, 0};
    struct array positions = {sizeof positions, DOUBLE, VERTICES, 8, 0}, corners = {sizeof corners, UINT32, CORNERS, 24, 0};
    struct array counts = {sizeof counts, UINT32, COUNTS, 6, 0}, materials = {sizeof materials, UINT32, MATERIALS, 6, 0};
    CHECK(patchlight_scene_create(context, 1, 0, &scene) == OK);
    CHECK(patchlight_scene_add_materials(scene, &rho, &e) == OK);
    CHECK(patchlight_scene_add_vertices(scene, &positions) == OK);
    CHECK(patchlight_scene_add_faces(scene, &corners, &counts, &materials) == OK);
    CHECK(patchlight_scene_commit(scene) == OK);

    // What lies behind the struct is no part of it: fields that were added since are not read from there.
    struct { struct solve_info info; unsigned char behind[64]; } room;
    memset(&room, 0xff, sizeof room);
    struct solve_info info = {sizeof info, options, NULL, NULL, NULL};
    room.info = info;
    CHECK(patchlight_solve(context, scene, &room.info, &solution) < INVALID_ARGUMENT);
    double walls[6];
    CHECK(patchlight_solution_get_double(solution, SURFACES, RADIOSITY, walls, 6, NULL) == OK);
    for (int wall = 0; wall < 6; wall++) CHECK(walls[wall] > 4 && walls[wall] < 6);

    CHECK(patchlight_solution_release(solution) == OK && patchlight_scene_release(scene) == OK);
    CHECK(patchlight_options_release(options) == OK && patchlight_context_release(context) == OK);
    return 0;
}
