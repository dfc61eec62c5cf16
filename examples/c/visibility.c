// A visibility backend of one's own: every triangle, in double precision. The library's reference does the same, so the answers agree.
#include "box.h"
#include <math.h>
#include <string.h>

struct triangles {
    size_t count;
    double *positions; // nine numbers each
    uint32_t *ids;     // surface and plane
    double tolerance;
    int released;
};

static void minus(const double a[3], const double b[3], double d[3]) { for (int k = 0; k < 3; k++) d[k] = a[k] - b[k]; }
static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void cross(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

// Where the line from `from` by `along` meets a triangle whose plane it crosses: the part of `along`, or less than 0.
static double meets(const struct triangles *all, size_t triangle, const double from[3], const double along[3], int has_end) {
    const double *a = all->positions + 9 * triangle;
    double ab[3], ac[3], normal[3], to_from[3], to_end[3], end[3], p[3], q[3];
    minus(a + 3, a, ab), minus(a + 6, a, ac), cross(ab, ac, normal);
    double length = sqrt(dot(normal, normal));
    for (int k = 0; k < 3; k++) normal[k] /= length, end[k] = from[k] + along[k];
    minus(from, a, to_from), minus(end, a, to_end);

    // The ends lie on different sides of the plane, clear of it.
    double height = dot(to_from, normal), slope = dot(along, normal);
    if (fabs(height) <= all->tolerance || height * slope >= 0) return -1;
    if (has_end && (fabs(dot(to_end, normal)) <= all->tolerance || height * dot(to_end, normal) > 0)) return -1;

    // The crossing lies inside (Moeller, Trumbore 1997).
    cross(along, ac, p), cross(to_from, ab, q);
    double u = dot(to_from, p) / dot(ab, p), v = dot(along, q) / dot(ab, p);
    return u >= 0 && v >= 0 && u + v <= 1 ? -height / slope : -1;
}

static int32_t occluded(void *user, const patchlight_segment *segments, size_t count, uint8_t *answers) {
    const struct triangles *all = (const struct triangles *)user;
    for (size_t k = 0; k < count; k++) {
        double along[3];
        minus(segments[k].to, segments[k].from, along);
        for (size_t t = 0; t < all->count && !answers[k]; t++) {
            uint32_t plane = all->ids[2 * t + 1];
            if (plane != segments[k].from_plane && plane != segments[k].to_plane)
                answers[k] = meets(all, t, segments[k].from, along, 1) > 0;
        }
    }
    return 0;
}

static int32_t first_hits(void *user, const patchlight_ray *rays, size_t count, patchlight_hit *hits) {
    const struct triangles *all = (const struct triangles *)user;
    for (size_t k = 0; k < count; k++)
        for (size_t t = 0; t < all->count; t++) {
            if (all->ids[2 * t + 1] == rays[k].origin_plane) continue;
            double distance = meets(all, t, rays[k].origin, rays[k].direction, 0);
            if (distance > 0 && (hits[k].surface == PATCHLIGHT_NO_SURFACE || distance < hits[k].distance))
                hits[k].distance = distance, hits[k].surface = all->ids[2 * t];
        }
    return 0;
}

static void release(void *user) { ((struct triangles *)user)->released++; }

int main(void) {
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    patchlight_context *context;
    CHECK(patchlight_context_create(2, &context));
    patchlight_scene *scene = make_box(context, 1, reflectance, exitance);

    struct triangles all;
    memset(&all, 0, sizeof all);
    CHECK(patchlight_scene_triangles(scene, NULL, 0, &all.count));
    all.positions = (double *)malloc(all.count * sizeof(double));
    CHECK(patchlight_scene_triangles(scene, all.positions, all.count, NULL));
    all.count /= 9;
    all.ids = (uint32_t *)malloc(2 * all.count * sizeof(uint32_t));
    CHECK(patchlight_scene_triangle_planes(scene, all.ids, 2 * all.count, NULL));
    CHECK(patchlight_scene_get_figure(scene, PATCHLIGHT_SCENE_CONTACT_TOLERANCE, &all.tolerance));

    // By one's own, and by the library's reference.
    patchlight_visibility own = {sizeof own, &all, occluded, first_hits, release};
    double found[2][6];
    for (int by_own = 0; by_own < 2; by_own++) {
        patchlight_options *options = make_options(0.1, "brute-force");
        patchlight_solve_info info = {sizeof info, options, NULL, NULL, by_own ? &own : NULL, NULL, NULL};
        patchlight_solution *solution;
        CHECK(patchlight_solve(context, scene, &info, &solution));
        CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, found[by_own], 6, NULL));
        EXPECT(all.released == 0);
        CHECK(patchlight_solution_release(solution));
        CHECK(patchlight_options_release(options));
    }
    EXPECT(all.released == 1);
    for (int k = 0; k < 6; k++) {
        printf("surface %d: %.6f, and by the library %.6f W/m^2\n", k, found[1][k], found[0][k]);
        EXPECT(fabs(found[1][k] - found[0][k]) < 1e-9);
    }
    free(all.positions);
    free(all.ids);
    CHECK(patchlight_scene_release(scene));
    CHECK(patchlight_context_release(context));
    return 0;
}
