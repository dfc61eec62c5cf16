// What the examples share: an ending, and a box of six walls that face inwards.
#ifndef BOX_H
#define BOX_H

#include <patchlight.h>
#include <stdio.h>
#include <stdlib.h>

// Ends the program if a call fails. A solve that a limit ended has a solution, and goes on.
static inline patchlight_status check_at(patchlight_status status, const char *file, int line) {
    if (status >= PATCHLIGHT_INVALID_ARGUMENT) {
        const char *message = "";
        patchlight_get_message(&message);
        fprintf(stderr, "%s:%d: status %d: %s\n", file, line, (int)status, message);
        exit(1);
    }
    return status;
}
#define CHECK(call) check_at((call), __FILE__, __LINE__)

// Ends the program if something is not as it should be.
#define EXPECT(what) \
    do { if (!(what)) { fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #what); exit(1); } } while (0)

static inline patchlight_array array_of(uint32_t format, const void *data, size_t count) {
    patchlight_array array = {sizeof(patchlight_array), format, data, count, 0};
    return array;
}

// A unit cube, its walls facing inwards: floor, ceiling, front, back, left, right.
static const float BOX_VERTICES[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const uint32_t BOX_CORNERS[24] = {0, 4, 5, 1, 3, 2, 6, 7, 4, 7, 6, 5, 0, 1, 2, 3, 0, 3, 7, 4, 1, 5, 6, 2};
static const uint32_t BOX_COUNTS[6] = {4, 4, 4, 4, 4, 4};

// A box of so many channels: walls are of material 0, the ceiling of material 1, which have as many numbers.
static inline patchlight_scene *open_box(patchlight_context *context, uint32_t channels, const double *reflectance,
                                         const double *exitance) {
    static const uint32_t materials[6] = {0, 1, 0, 0, 0, 0};
    patchlight_array reflectances = array_of(PATCHLIGHT_DOUBLE, reflectance, 2), exitances = array_of(PATCHLIGHT_DOUBLE, exitance, 2);
    patchlight_array positions = array_of(PATCHLIGHT_FLOAT, BOX_VERTICES, 8), corners = array_of(PATCHLIGHT_UINT32, BOX_CORNERS, 24);
    patchlight_array counts = array_of(PATCHLIGHT_UINT32, BOX_COUNTS, 6), of_faces = array_of(PATCHLIGHT_UINT32, materials, 6);
    patchlight_scene *scene;
    CHECK(patchlight_scene_create(context, channels, PATCHLIGHT_SIDES_FRONT, &scene));
    CHECK(patchlight_scene_add_materials(scene, &reflectances, &exitances));
    CHECK(patchlight_scene_add_vertices(scene, &positions));
    CHECK(patchlight_scene_add_faces(scene, &corners, &counts, &of_faces));
    return scene;
}

// The same, committed.
static inline patchlight_scene *make_box(patchlight_context *context, uint32_t channels, const double *reflectance,
                                         const double *exitance) {
    patchlight_scene *scene = open_box(context, channels, reflectance, exitance);
    CHECK(patchlight_scene_commit(scene));
    return scene;
}

// Options with an error, and with a backend if one is named.
static inline patchlight_options *make_options(double error, const char *backend) {
    patchlight_options *options;
    CHECK(patchlight_options_create(&options));
    CHECK(patchlight_options_set_double(options, "error", error));
    if (backend != NULL) CHECK(patchlight_options_set_text(options, "backend", backend));
    return options;
}

#endif
