// A host that traces rays in an Embree scene of its own, with its own error function and floating-point state, while Patchlight solves
// beside it: neither disturbs the other. EMBREE_HEADER names the installed header.
#include "box.h"
#include <pthread.h>
#include <string.h>
#include <pmmintrin.h>
#include <xmmintrin.h>
#include EMBREE_HEADER

static int embree_errors;
static int stop;

static void note_error(void *user, enum RTCError code, const char *message) {
    (void)user, (void)code, (void)message;
    __atomic_fetch_add(&embree_errors, 1, __ATOMIC_SEQ_CST);
}

// How many of a grid of rays hit the triangle below them.
static int trace(RTCScene scene) {
    int hits = 0;
    for (int k = 0; k < 10000; k++) {
        struct RTCRayHit ray;
        memset(&ray, 0, sizeof ray);
        ray.ray.org_x = (float)(k % 100) / 100.0f, ray.ray.org_y = (float)(k / 100) / 100.0f, ray.ray.org_z = 1;
        ray.ray.dir_z = -1, ray.ray.tfar = 100, ray.ray.mask = 0xffffffffu;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(scene, &ray, NULL);
#else
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene, &context, &ray);
#endif
        hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

static int expected;

static void *host(void *scene) {
    int rounds = 0;
    while (!__atomic_load_n(&stop, __ATOMIC_SEQ_CST) || rounds == 0) {
        EXPECT(trace((RTCScene)scene) == expected);
        rounds++;
    }
    return NULL;
}

int main(void) {
    RTCDevice device = rtcNewDevice(NULL);
    rtcSetDeviceErrorFunction(device, note_error, NULL);
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertices = (float *)rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3);
    unsigned *indices = (unsigned *)rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 1);
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    memcpy(vertices, corners, sizeof corners);
    for (unsigned k = 0; k < 3; k++) indices[k] = k;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    expected = trace(scene);
    EXPECT(expected > 4000);

    // As the manual of Embree advises its users; and a rounding that nobody expects.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    double found[2][6];
    const double reflectance[2] = {0.6, 0.3}, exitance[2] = {0, 5};
    pthread_t thread;
    EXPECT(pthread_create(&thread, NULL, host, scene) == 0);
    for (int upwards = 0; upwards < 2; upwards++) {
        _MM_SET_ROUNDING_MODE(upwards ? _MM_ROUND_UP : _MM_ROUND_NEAREST);
        const unsigned before = _mm_getcsr();
        patchlight_context *context;
        patchlight_solution *solution;
        CHECK(patchlight_context_create(2, &context));
        patchlight_scene *box = make_box(context, 1, reflectance, exitance);
        patchlight_options *options = make_options(0.02, "embree");
        patchlight_solve_info info = {sizeof info, options, NULL, NULL, NULL, NULL, NULL};
        CHECK(patchlight_solve(context, box, &info, &solution));
        CHECK(patchlight_solution_get_double(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY, found[upwards], 6, NULL));
        CHECK(patchlight_solution_release(solution));
        CHECK(patchlight_options_release(options));
        CHECK(patchlight_scene_release(box));
        CHECK(patchlight_context_release(context));
        EXPECT(_mm_getcsr() == before);
    }
    EXPECT(memcmp(found[0], found[1], sizeof found[0]) == 0);
    _MM_SET_ROUNDING_MODE(_MM_ROUND_NEAREST);
    __atomic_store_n(&stop, 1, __ATOMIC_SEQ_CST);
    EXPECT(pthread_join(thread, NULL) == 0);
    EXPECT(trace(scene) == expected);
    EXPECT(rtcGetDeviceError(device) == RTC_ERROR_NONE);
    EXPECT(__atomic_load_n(&embree_errors, __ATOMIC_SEQ_CST) == 0);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return 0;
}
