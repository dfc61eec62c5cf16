/* One source for Embree 3.13 and Embree 4: EMBREE_HEADER names the installed <embree3/rtcore.h> or <embree4/rtcore.h>. */
#include "occlusion.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include EMBREE_HEADER

/* Segments per call of Embree. Packets of 8 answered groups of segments 1.3 to 1.8 times as fast as single rays on 1.6k to 2M
 * triangles, and unrelated segments as fast: benches/visibility.rs. First hits of paths over a hemisphere were 5 to 20% slower in
 * packets, even with neighbours together, so they are asked one by one; those of a camera are asked in packets. */
#define PACKET 8

struct occlusion_scene {
    RTCDevice device;
    RTCScene scene;
    const uint32_t *planes;
    const double (*equations)[4];
    double tolerance;
    int failed;
    char error[200];
};

/* Embree passes its context through to the filter; ours ends in the segments, which the ray's id indexes. */
#if RTC_VERSION_MAJOR >= 4
typedef struct RTCRayQueryContext embree_context;
#define FILTER_BY_QUERY RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS
#else
typedef struct RTCIntersectContext embree_context;
#define FILTER_BY_QUERY RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
#endif

typedef struct query {
    embree_context context;
    const occlusion_scene *scene;
    const occlusion_segment *segments;
} query;

static void query_init(query *q, const occlusion_scene *scene, const occlusion_segment *segments) {
#if RTC_VERSION_MAJOR >= 4
    rtcInitRayQueryContext(&q->context);
#else
    rtcInitIntersectContext(&q->context);
#endif
    q->scene = scene;
    q->segments = segments;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Whether a triangle that a segment passes through blocks it. */
static int blocks(const occlusion_scene *scene, uint32_t triangle, const occlusion_segment *segment) {
    uint32_t plane = scene->planes[triangle];
    if (plane == segment->planes[0] || plane == segment->planes[1]) return 0;

    const double *equation = scene->equations[triangle];
    double from = dot(equation, segment->from) - equation[3];
    double to = dot(equation, segment->to) - equation[3];
    double tolerance = scene->tolerance;
    return (from > tolerance && to < -tolerance) || (from < -tolerance && to > tolerance);
}

/* Rejects the hits that do not block. Embree calls this for every hit, with rays in any width N. */
static void filter(const struct RTCFilterFunctionNArguments *args) {
    const query *q = (const query *)args->context;
    const uint32_t *triangles = (const uint32_t *)args->hit + 5 * (size_t)args->N; /* RTCHitN: Ng_x, Ng_y, Ng_z, u, v, primID */
    const uint32_t *ids = (const uint32_t *)args->ray + 10 * (size_t)args->N;  /* RTCRayN: org, tnear, dir, time, tfar, mask, id */
    for (unsigned int i = 0; i < args->N; i++)
        if (args->valid[i] && !blocks(q->scene, triangles[i], &q->segments[ids[i]])) args->valid[i] = 0;
}

/* Keeps the first error. The device has one thread, and building is the only call that reports here. */
static void keep_first_error(void *user, enum RTCError code, const char *message) {
    occlusion_scene *scene = user;
    if (scene->failed) return;
    scene->failed = 1;
    snprintf(scene->error, sizeof scene->error, "error %d: %s", (int)code, message ? message : "no message");
}

static const char *why_no_device(enum RTCError error) {
    switch (error) {
    case RTC_ERROR_OUT_OF_MEMORY: return "out of memory";
    case RTC_ERROR_UNSUPPORTED_CPU: return "this processor is too old for Embree";
    default: return "no Embree device: the system may lack memory or threads for it";
    }
}

static void build(occlusion_scene *scene, const occlusion_mesh *mesh) {
    /* Triangles, copied into buffers of Embree's own, which have the padding that it reads past the end. */
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) return;
    void *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                             mesh->vertex_count);
    void *triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                              mesh->triangle_count);
    if (vertices && triangles) {
        memcpy(vertices, mesh->vertices, mesh->vertex_count * sizeof *mesh->vertices);
        memcpy(triangles, mesh->triangles, mesh->triangle_count * sizeof *mesh->triangles);
        rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
        rtcSetGeometryOccludedFilterFunction(geometry, filter);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene->scene, geometry, 0);
    }
    rtcReleaseGeometry(geometry); /* the scene holds it from here on */
}

occlusion_scene *occlusion_create(const occlusion_mesh *mesh) {
    occlusion_scene *scene = calloc(1, sizeof *scene);
    if (!scene) return NULL;
    scene->planes = mesh->planes;
    scene->equations = mesh->equations;
    scene->tolerance = mesh->tolerance;

    /* One thread: the caller's threads do the work, and the tree does not depend on their number. */
    scene->device = rtcNewDevice("threads=1,set_affinity=0");
    if (!scene->device) {
        enum RTCError error = rtcGetDeviceError(NULL);
        keep_first_error(scene, error, why_no_device(error));
        return scene;
    }
    rtcSetDeviceErrorFunction(scene->device, keep_first_error, scene);

    scene->scene = rtcNewScene(scene->device);
    if (!scene->scene) {
        keep_first_error(scene, rtcGetDeviceError(scene->device), "no scene");
        return scene;
    }
    rtcSetSceneBuildQuality(scene->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(scene->scene, RTC_SCENE_FLAG_ROBUST | FILTER_BY_QUERY);
    if (mesh->triangle_count > 0) build(scene, mesh);
    rtcCommitScene(scene->scene);

    /* What the callback did not see. */
    enum RTCError error = rtcGetDeviceError(scene->device);
    if (error != RTC_ERROR_NONE) keep_first_error(scene, error, "the scene could not be built");
    return scene;
}

const char *occlusion_error(const occlusion_scene *scene) { return scene->failed ? scene->error : NULL; }

uint32_t occlusion_embree_version(const occlusion_scene *scene) {
    return (uint32_t)rtcGetDeviceProperty(scene->device, RTC_DEVICE_PROPERTY_VERSION);
}

/* Fills a packet with segments from `first` on; how many there are. */
static size_t fill(const occlusion_segment *segments, size_t first, size_t count, struct RTCRay8 *rays, int valid[PACKET]) {
    size_t filled = count - first < PACKET ? count - first : PACKET;
    memset(rays, 0, sizeof *rays);
    for (size_t k = 0; k < PACKET; k++) valid[k] = k < filled ? -1 : 0;
    for (size_t k = 0; k < filled; k++) {
        const occlusion_segment *s = &segments[first + k];
        rays->org_x[k] = s->origin[0], rays->org_y[k] = s->origin[1], rays->org_z[k] = s->origin[2];
        rays->dir_x[k] = s->direction[0], rays->dir_y[k] = s->direction[1], rays->dir_z[k] = s->direction[2];
        rays->tnear[k] = s->near;
        rays->tfar[k] = 1.0f;
        rays->mask[k] = UINT32_MAX;
        rays->id[k] = (unsigned int)(first + k);
    }
    return filled;
}

void occlusion_occluded(const occlusion_scene *scene, const occlusion_segment *segments, size_t count, uint8_t *occluded) {
    query q;
    query_init(&q, scene, segments);
#if RTC_VERSION_MAJOR >= 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &q.context;
#endif

    for (size_t first = 0; first < count; first += PACKET) {
        RTC_ALIGN(32) int valid[PACKET];
        struct RTCRay8 rays;
        size_t filled = fill(segments, first, count, &rays, valid);
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded8(valid, scene->scene, &rays, &arguments);
#else
        rtcOccluded8(valid, scene->scene, &q.context, &rays);
#endif
        for (size_t k = 0; k < filled; k++) occluded[first + k] = rays.tfar[k] < 0.0f; /* Embree sets -inf on a hit */
    }
}

/* The nearest triangle on a segment from `near` on that `filter` lets pass, or any if that is NULL. */
static uint32_t nearest(query *q, unsigned int index, float near, RTCFilterFunctionN filter) {
    const occlusion_segment *s = &q->segments[index];
    struct RTCRayHit hit;
    memset(&hit, 0, sizeof hit);
    hit.ray.org_x = s->origin[0], hit.ray.org_y = s->origin[1], hit.ray.org_z = s->origin[2];
    hit.ray.dir_x = s->direction[0], hit.ray.dir_y = s->direction[1], hit.ray.dir_z = s->direction[2];
    hit.ray.tnear = near;
    hit.ray.tfar = 1.0f;
    hit.ray.mask = UINT32_MAX;
    hit.ray.id = index;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &q->context;
    arguments.filter = filter;
    if (filter) arguments.flags |= RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    rtcIntersect1(q->scene->scene, &hit, &arguments);
#else
    q->context.filter = filter;
    rtcIntersect1(q->scene->scene, &q->context, &hit);
#endif
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? OCCLUSION_NOTHING : hit.hit.primID;
}

/* The blocking triangle next to a segment's origin, by what was met at some distance without the filter. Nearly always that
 * blocks; where it does not, what lies nearer may, such as the wall beside a point in a corner. */
static uint32_t first_blocking(query *q, unsigned int index, uint32_t met) {
    if (met != OCCLUSION_NOTHING && blocks(q->scene, met, &q->segments[index])) return met;
    return nearest(q, index, 0.0f, filter);
}

void occlusion_first(const occlusion_scene *scene, const occlusion_segment *segments, size_t count, uint32_t *triangles) {
    query q;
    query_init(&q, scene, segments);
    for (size_t i = 0; i < count; i++) {
        triangles[i] = first_blocking(&q, (unsigned int)i, nearest(&q, (unsigned int)i, segments[i].near, NULL));
    }
}

void occlusion_first_coherent(const occlusion_scene *scene, const occlusion_segment *segments, size_t count,
                              uint32_t *triangles) {
    query q, coherent;
    query_init(&q, scene, segments);
    query_init(&coherent, scene, segments);
#if RTC_VERSION_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &coherent.context;
    arguments.flags |= RTC_RAY_QUERY_FLAG_COHERENT;
#else
    coherent.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif

    for (size_t first = 0; first < count; first += PACKET) {
        RTC_ALIGN(32) int valid[PACKET];
        struct RTCRayHit8 hits;
        memset(&hits, 0, sizeof hits);
        size_t filled = fill(segments, first, count, &hits.ray, valid);
        for (size_t k = 0; k < PACKET; k++) hits.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect8(valid, scene->scene, &hits, &arguments);
#else
        rtcIntersect8(valid, scene->scene, &coherent.context, &hits);
#endif
        for (size_t k = 0; k < filled; k++) {
            int is_met = hits.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
            uint32_t met = is_met ? hits.hit.primID[k] : OCCLUSION_NOTHING;
            triangles[first + k] = first_blocking(&q, (unsigned int)(first + k), met);
        }
    }
}

void occlusion_destroy(occlusion_scene *scene) {
    if (!scene) return;
    if (scene->scene) rtcReleaseScene(scene->scene);
    if (scene->device) rtcReleaseDevice(scene->device);
    free(scene);
}
