// Lights the furnished room, whose arrays are in room.h, and tells the radiosity on the table. With an argument, a picture goes there.
#include <patchlight.h>
#include <stdio.h>
#include "room.h"

static const char *message = "";
#define CHECK(call) \
    if ((call) >= PATCHLIGHT_INVALID_ARGUMENT) return patchlight_get_message(&message), fprintf(stderr, "%s: %s\n", #call, message)

int main(int argc, char **argv) {
    patchlight_array positions = {sizeof positions, PATCHLIGHT_DOUBLE, room_vertices, ROOM_VERTICES, 0};
    patchlight_array corners = {sizeof corners, PATCHLIGHT_UINT32, room_corners, ROOM_CORNERS, 0};
    patchlight_array counts = {sizeof counts, PATCHLIGHT_UINT32, room_counts, ROOM_FACES, 0};
    patchlight_array materials = {sizeof materials, PATCHLIGHT_UINT32, room_materials, ROOM_FACES, 0};
    patchlight_array reflectance = {sizeof reflectance, PATCHLIGHT_DOUBLE, room_reflectance, ROOM_MATERIALS, 0};
    patchlight_array exitance = {sizeof exitance, PATCHLIGHT_DOUBLE, room_exitance, ROOM_MATERIALS, 0};
    patchlight_context *context; patchlight_scene *scene; patchlight_options *options; patchlight_solution *solution;
    CHECK(patchlight_context_create(0, &context));
    CHECK(patchlight_scene_create(context, 3, PATCHLIGHT_SIDES_FRONT, &scene));
    CHECK(patchlight_scene_add_materials(scene, &reflectance, &exitance));
    CHECK(patchlight_scene_add_vertices(scene, &positions));
    CHECK(patchlight_scene_add_faces(scene, &corners, &counts, &materials));
    CHECK(patchlight_scene_commit(scene));
    CHECK(patchlight_options_create(&options));
    CHECK(patchlight_options_set_double(options, "error", 0.1));
    patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
    CHECK(patchlight_solve(context, scene, &info, &solution));
    double on_the_table[6] = {2.05, 0.41, 2.05, 0, 1, 0};
    patchlight_array point = {sizeof point, PATCHLIGHT_DOUBLE, on_the_table, 1, 0}, normal = point;
    normal.data = on_the_table + 3;
    float radiosity[3];
    patchlight_values values = {sizeof values, 3, radiosity, NULL, NULL, NULL};
    CHECK(patchlight_solution_get_values(solution, &point, &normal, &values, NULL));
    printf("%.9g,%.9g,%.9g\n", (double)radiosity[0], (double)radiosity[1], (double)radiosity[2]);
    patchlight_camera camera = {sizeof camera, 160, 120, {0}, {0}, {0}, 0};
    CHECK(patchlight_solution_get_camera(solution, &camera));
    if (argc > 1) CHECK(patchlight_solution_write_picture(solution, &camera, argv[1]));
    return 0 != (patchlight_solution_release(solution) | patchlight_options_release(options) | patchlight_scene_release(scene)
        | patchlight_context_release(context));
}
