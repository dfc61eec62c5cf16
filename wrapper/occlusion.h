/* Occlusion of segments by triangles, answered by Embree 3 or 4. No Embree type crosses this header.
 *
 * Everything here is in the frame of the caller's choice (coordinates of some thousands, centred on the origin). A triangle
 * blocks a segment if the segment passes through it, its plane number is none of the two numbers of the segment, and the two
 * ends of the segment lie on different sides of its plane, each farther than `tolerance` from it. The sides are decided in
 * double precision, the passing through in single precision by Embree's robust mode.
 */
#ifndef PATCHLIGHT_OCCLUSION_H
#define PATCHLIGHT_OCCLUSION_H

#include <stddef.h>
#include <stdint.h>

#define OCCLUSION_NOTHING UINT32_MAX

/* What occludes. `vertices` and `triangles` are copied. `planes` and `equations` are not: they must stay where they are,
 * unchanged, until occlusion_destroy. */
typedef struct occlusion_mesh {
    const float (*vertices)[3];      /* finite */
    size_t vertex_count;
    const uint32_t (*triangles)[3];  /* indices below vertex_count */
    size_t triangle_count;           /* below 2^32 - 1; may be 0 */
    const uint32_t *planes;          /* per triangle */
    const double (*equations)[4];    /* per triangle n and d: dot(n, x) = d, n of length 1, or all 0 for a triangle without area */
    double tolerance;
} occlusion_mesh;

/* One segment, finite and of some length: Embree checks nothing, and builds with assertions abort on anything else. */
typedef struct occlusion_segment {
    double from[3], to[3];           /* its ends, for the sides */
    float origin[3], direction[3];   /* what Embree traces: origin + t direction, near <= t <= 1 */
    float near;                      /* at least 0 */
    uint32_t planes[2];              /* of the surfaces at its ends */
} occlusion_segment;

typedef struct occlusion_scene occlusion_scene;

/* Builds a scene on the calling thread. NULL only if there is no memory for the scene itself; otherwise ask occlusion_error. */
occlusion_scene *occlusion_create(const occlusion_mesh *mesh);

/* The first error of this scene in words, or NULL. A scene with an error may only be destroyed. */
const char *occlusion_error(const occlusion_scene *scene);

/* Embree's version at run time: major * 10000 + minor * 100 + patch. */
uint32_t occlusion_embree_version(const occlusion_scene *scene);

/* Sets occluded[i] to 1 if something blocks segments[i], else to 0. Any number of threads may ask at once. */
void occlusion_occluded(const occlusion_scene *scene, const occlusion_segment *segments, size_t count, uint8_t *occluded);

/* Sets triangles[i] to the blocking triangle of segments[i] next to its origin, or to OCCLUSION_NOTHING. Thread-safe too. */
void occlusion_first(const occlusion_scene *scene, const occlusion_segment *segments, size_t count, uint32_t *triangles);

/* The same, faster for segments from one point of which each goes almost the same way as the next. */
void occlusion_first_coherent(const occlusion_scene *scene, const occlusion_segment *segments, size_t count,
                              uint32_t *triangles);

/* Frees the scene, then the device. NULL is allowed. */
void occlusion_destroy(occlusion_scene *scene);

#endif
