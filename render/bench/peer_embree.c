#include "render/bench/peer_embree.h"

#include "formats/base/status.h"

#ifndef PEER_WITH_EMBREE

bool peer_embree_present(void) {
    return false;
}

status peer_embree_create(mem *m, const peer_mesh *mesh, int threads, bool high,
                          peer_embree **out) {
    (void)m, (void)mesh, (void)threads, (void)high;
    *out = NULL;
    return status_describe(ST_UNSUPPORTED,
                           "built without Embree 3: install libembree-dev, and make again");
}

void peer_embree_destroy(peer_embree *e) {
    (void)e;
}

const char *peer_embree_version(const peer_embree *e) {
    (void)e;
    return "none";
}

size_t peer_embree_bytes(const peer_embree *e) {
    (void)e;
    return 0;
}

status peer_embree_frame(const peer_embree *e, pool *threads, peer_packet packet,
                         const leafcast_camera *from, const leafcast_surface *surface,
                         const leafcast_scene *scene, const leafcast_image *image, uint64_t *hits) {
    (void)e, (void)threads, (void)packet, (void)from, (void)surface, (void)scene, (void)image;
    *hits = 0;
    return ST_UNSUPPORTED;
}

#else

#include <embree3/rtcore.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#if defined __x86_64__ || defined __i386__
#include <immintrin.h>
#endif

#include "render/camera.h"

enum { TILE = 16, SIDE = 4, LANES = SIDE * SIDE };

struct peer_embree {
    RTCDevice device;
    RTCScene scene;
    const peer_mesh *mesh;
    char version[32];
    atomic_size_t bytes; /* that Embree has allocated */
    mem *m;
};

bool peer_embree_present(void) {
    return true;
}

/* ---- the BVH ---- */

static status device_status(RTCDevice device, const char *what) {
    const enum RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE)
        return ST_OK;
    return status_describe(error == RTC_ERROR_OUT_OF_MEMORY ? ST_NOMEM : ST_FAILED,
                           "Embree: error %d while %s", (int)error, what);
}

static bool count_bytes(void *ctx, ssize_t bytes, bool post) {
    peer_embree *e = ctx;
    (void)post;
    atomic_fetch_add(&e->bytes, (size_t)bytes);
    return true;
}

static void attach_mesh(peer_embree *e, bool high) {
    const enum RTCBuildQuality quality = high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
    const peer_mesh *mesh = e->mesh;
    RTCGeometry g = rtcNewGeometry(e->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0,
                               3 * sizeof(float), mesh->vertices);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->corners, 0,
                               3 * sizeof(uint32_t), mesh->triangles);
    rtcSetGeometryBuildQuality(g, quality);
    rtcCommitGeometry(g);
    rtcAttachGeometry(e->scene, g);
    rtcReleaseGeometry(g);
    rtcSetSceneBuildQuality(e->scene, quality);
}

static void name_version(peer_embree *e) {
    const int v = (int)rtcGetDeviceProperty(e->device, RTC_DEVICE_PROPERTY_VERSION);
    snprintf(e->version, sizeof e->version, "%d.%d.%d", v / 10000, v / 100 % 100, v % 100);
}

status peer_embree_create(mem *m, const peer_mesh *mesh, int threads, bool high,
                          peer_embree **out) {
    char config[64];
    peer_embree *e = *out = mem_zalloc(m, sizeof *e);
    if (!e)
        return ST_NOMEM;
    e->mesh = mesh;
    e->m = m;
    snprintf(config, sizeof config, "threads=%d,user_threads=0,set_affinity=0", threads);
    e->device = rtcNewDevice(config);
    status st = device_status(e->device, "opening a device");
    if (st == ST_OK) {
        name_version(e);
        rtcSetDeviceMemoryMonitorFunction(e->device, count_bytes, e);
        e->scene = rtcNewScene(e->device);
        attach_mesh(e, high);
        rtcCommitScene(e->scene);
        st = device_status(e->device, "building the BVH");
    }
    if (st) {
        peer_embree_destroy(e);
        *out = NULL;
    }
    return st;
}

void peer_embree_destroy(peer_embree *e) {
    if (!e)
        return;
    if (e->scene)
        rtcReleaseScene(e->scene);
    if (e->device)
        rtcReleaseDevice(e->device);
    mem_free(e->m, e);
}

const char *peer_embree_version(const peer_embree *e) {
    return e->version;
}

size_t peer_embree_bytes(const peer_embree *e) {
    return atomic_load(&e->bytes);
}

/* ---- a frame ---- */

typedef struct view {
    float eye[3], forward[3], right[3], up[3]; /* eye: relative to the mesh's origin */
    float u0, du, v0, dv;                      /* of pixel centres */
    uint32_t width, height;
} view;

typedef struct lanes {
    float x[LANES], y[LANES], z[LANES];
} lanes;

typedef struct frame {
    const peer_embree *e;
    const leafcast_image *image;
    view view;
    peer_packet packet;
    float ambient, rgb[3], background[3];
    lanes empty; /* the background */
    uint32_t tiles_x;
    uint64_t hits;
} frame;

static status view_init(view *v, const peer_mesh *mesh, const leafcast_camera *from) {
    camera c;
    status st = camera_init(&c, from);
    if (st)
        return st;
    for (int a = 0; a < 3; a++) {
        v->eye[a] = (float)(c.eye[a] - mesh->origin[a]);
        v->forward[a] = (float)c.forward[a];
        v->right[a] = (float)c.right[a];
        v->up[a] = (float)c.up[a];
    }
    v->width = from->width;
    v->height = from->height;
    v->du = (float)(2.0 / c.height);
    v->dv = -v->du;
    v->u0 = (float)((1.0 - c.width) / c.height);
    v->v0 = (float)((c.height - 1.0) / c.height);
    return ST_OK;
}

/* The rays of 4x4 pixels, row by row. */
static inline void make_rays(const view *v, uint32_t px, uint32_t py, struct RTCRayHit16 *rays) {
    for (int i = 0; i < LANES; i++) {
        const float s = v->u0 + v->du * (float)(int)(px + (uint32_t)(i % SIDE));
        const float t = v->v0 + v->dv * (float)(int)(py + (uint32_t)(i / SIDE));
        const float x = v->forward[0] + s * v->right[0] + t * v->up[0];
        const float y = v->forward[1] + s * v->right[1] + t * v->up[1];
        const float z = v->forward[2] + s * v->right[2] + t * v->up[2];
        const float inverse = 1.0f / sqrtf(x * x + y * y + z * z);
        rays->ray.org_x[i] = v->eye[0];
        rays->ray.org_y[i] = v->eye[1];
        rays->ray.org_z[i] = v->eye[2];
        rays->ray.dir_x[i] = x * inverse;
        rays->ray.dir_y[i] = y * inverse;
        rays->ray.dir_z[i] = z * inverse;
        rays->ray.tnear[i] = 0.0f;
        rays->ray.tfar[i] = INFINITY;
        rays->ray.time[i] = 0.0f;
        rays->ray.mask[i] = ~0u;
        rays->ray.id[i] = (unsigned)i;
        rays->ray.flags[i] = 0;
        rays->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
}

/* Half a packet there and back, for rtcIntersect8. */
#define HALF(to, to_at, from, from_at, part) \
    memcpy((to)->part + (to_at), (from)->part + (from_at), 8 * sizeof *(to)->part)

static void intersect_8(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                        struct RTCRayHit16 *rays) {
    for (int half = 0; half < LANES; half += 8) {
        struct RTCRayHit8 r;
        HALF(&r, 0, rays, half, ray.org_x);
        HALF(&r, 0, rays, half, ray.org_y);
        HALF(&r, 0, rays, half, ray.org_z);
        HALF(&r, 0, rays, half, ray.dir_x);
        HALF(&r, 0, rays, half, ray.dir_y);
        HALF(&r, 0, rays, half, ray.dir_z);
        HALF(&r, 0, rays, half, ray.tnear);
        HALF(&r, 0, rays, half, ray.tfar);
        HALF(&r, 0, rays, half, ray.time);
        HALF(&r, 0, rays, half, ray.mask);
        HALF(&r, 0, rays, half, ray.id);
        HALF(&r, 0, rays, half, ray.flags);
        HALF(&r, 0, rays, half, hit.geomID);
        HALF(&r, 0, rays, half, hit.instID[0]);
        rtcIntersect8(valid + half, scene, context, &r);
        HALF(rays, half, &r, 0, ray.tfar);
        HALF(rays, half, &r, 0, hit.u);
        HALF(rays, half, &r, 0, hit.v);
        HALF(rays, half, &r, 0, hit.primID);
        HALF(rays, half, &r, 0, hit.geomID);
    }
}

static void intersect_1(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                        struct RTCRayHit16 *rays) {
    for (int i = 0; i < LANES; i++) {
        if (!valid[i])
            continue;
        struct RTCRayHit r = {
            .ray = {.org_x = rays->ray.org_x[i],
                    .org_y = rays->ray.org_y[i],
                    .org_z = rays->ray.org_z[i],
                    .dir_x = rays->ray.dir_x[i],
                    .dir_y = rays->ray.dir_y[i],
                    .dir_z = rays->ray.dir_z[i],
                    .tfar = INFINITY,
                    .mask = ~0u},
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
        rtcIntersect1(scene, context, &r);
        rays->ray.tfar[i] = r.ray.tfar;
        rays->hit.u[i] = r.hit.u;
        rays->hit.v[i] = r.hit.v;
        rays->hit.primID[i] = r.hit.primID;
        rays->hit.geomID[i] = r.hit.geomID;
    }
}

/* The normals of the three corners, interpolated; not of unit length; 0 on a miss. */
static void interpolate_normals(const peer_mesh *mesh, const struct RTCRayHit16 *rays, lanes *n) {
    for (int i = 0; i < LANES; i++) {
        if (rays->hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
            n->x[i] = n->y[i] = n->z[i] = 0.0f;
            continue;
        }
        const uint32_t *corner = mesh->corners + 3 * (size_t)rays->hit.primID[i];
        const float *a = mesh->normals + 3 * (size_t)corner[0];
        const float *b = mesh->normals + 3 * (size_t)corner[1];
        const float *c = mesh->normals + 3 * (size_t)corner[2];
        const float u = rays->hit.u[i], v = rays->hit.v[i], w = 1.0f - u - v;
        n->x[i] = w * a[0] + u * b[0] + v * c[0];
        n->y[i] = w * a[1] + u * b[1] + v * c[1];
        n->z[i] = w * a[2] + u * b[2] + v * c[2];
    }
}

/* k_a + (1 - k_a) |N . L| with the light at the eye; what has no normal faces the eye. */
static inline void shade_lanes(const frame *f, const struct RTCRayHit16 *rays, const lanes *n,
                               lanes *colour) {
    for (int i = 0; i < LANES; i++) {
        const float square = n->x[i] * n->x[i] + n->y[i] * n->y[i] + n->z[i] * n->z[i];
        const float along = n->x[i] * rays->ray.dir_x[i] + n->y[i] * rays->ray.dir_y[i] +
                            n->z[i] * rays->ray.dir_z[i];
        const float facing = square > 0.0f ? fabsf(along) / sqrtf(square) : 1.0f;
        const float light = f->ambient + (1.0f - f->ambient) * facing;
        const bool hit = rays->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        colour->x[i] = hit ? light * f->rgb[0] : f->background[0];
        colour->y[i] = hit ? light * f->rgb[1] : f->background[1];
        colour->z[i] = hit ? light * f->rgb[2] : f->background[2];
    }
}

static inline void store_lanes(const frame *f, uint32_t px, uint32_t py, const float *from,
                               float *plane) {
    const uint32_t columns = f->view.width - px < SIDE ? f->view.width - px : SIDE;
    const uint32_t rows = f->view.height - py < SIDE ? f->view.height - py : SIDE;
    for (uint32_t y = 0; y < rows; y++) {
        float *to = plane + px + (size_t)f->view.width * (py + y);
        if (columns == SIDE)
            memcpy(to, from + SIDE * y, SIDE * sizeof *to);
        else
            memcpy(to, from + SIDE * y, columns * sizeof *to);
    }
}

static void store_depth(const frame *f, uint32_t px, uint32_t py, const int *valid,
                        const struct RTCRayHit16 *rays) {
    for (uint32_t i = 0; f->image->z && i < LANES; i++)
        if (valid[i])
            f->image->z[px + i % SIDE + (size_t)f->view.width * (py + i / SIDE)] =
                rays->hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? INFINITY
                                                               : (double)rays->ray.tfar[i];
}

static uint64_t draw_packet(const frame *f, struct RTCIntersectContext *context, uint32_t px,
                            uint32_t py) {
    struct RTCRayHit16 rays;
    int valid[LANES] __attribute__((aligned(64)));
    for (uint32_t i = 0; i < LANES; i++)
        valid[i] = px + i % SIDE < f->view.width && py + i / SIDE < f->view.height ? -1 : 0;
    make_rays(&f->view, px, py, &rays);
    if (f->packet == PEER_PACKET_16)
        rtcIntersect16(valid, f->e->scene, context, &rays);
    else if (f->packet == PEER_PACKET_8)
        intersect_8(f->e->scene, context, valid, &rays);
    else
        intersect_1(f->e->scene, context, valid, &rays);
    uint64_t hits = 0;
    for (int i = 0; i < LANES; i++)
        hits += valid[i] && rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    if (f->image->r) {
        lanes normal, colour = f->empty;
        if (hits) {
            interpolate_normals(f->e->mesh, &rays, &normal);
            shade_lanes(f, &rays, &normal, &colour);
        }
        store_lanes(f, px, py, colour.x, f->image->r);
        store_lanes(f, px, py, colour.y, f->image->g);
        store_lanes(f, px, py, colour.z, f->image->b);
    }
    store_depth(f, px, py, valid, &rays);
    return hits;
}

static status draw_tile(void *ctx, size_t index, int worker) {
    frame *f = ctx;
    const uint32_t x0 = TILE * (uint32_t)(index % f->tiles_x);
    const uint32_t y0 = TILE * (uint32_t)(index / f->tiles_x);
    struct RTCIntersectContext context;
    uint64_t hits = 0;
    (void)worker;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#if defined __x86_64__ || defined __i386__
    /* As Embree's manual asks for: denormals are 0. For this tile: the threads are not ours. */
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040);
#endif
    for (uint32_t y = y0; y < y0 + TILE && y < f->view.height; y += SIDE)
        for (uint32_t x = x0; x < x0 + TILE && x < f->view.width; x += SIDE)
            hits += draw_packet(f, &context, x, y);
#if defined __x86_64__ || defined __i386__
    _mm_setcsr(before);
#endif
    __atomic_fetch_add(&f->hits, hits, __ATOMIC_RELAXED);
    return ST_OK;
}

status peer_embree_frame(const peer_embree *e, pool *threads, peer_packet packet,
                         const leafcast_camera *from, const leafcast_surface *surface,
                         const leafcast_scene *scene, const leafcast_image *image, uint64_t *hits) {
    frame f = {.e = e, .image = image, .packet = packet, .ambient = scene->ambient};
    for (int i = 0; i < 3; i++) {
        f.rgb[i] = surface->rgb[i];
        f.background[i] = scene->background[i] * scene->background[3];
    }
    for (int i = 0; i < LANES; i++) {
        f.empty.x[i] = f.background[0];
        f.empty.y[i] = f.background[1];
        f.empty.z[i] = f.background[2];
    }
    status st = view_init(&f.view, e->mesh, from);
    if (st == ST_OK) {
        f.tiles_x = (from->width + TILE - 1) / TILE;
        st = pool_run(threads, (size_t)f.tiles_x * ((from->height + TILE - 1) / TILE), draw_tile,
                      &f);
    }
    *hits = f.hits;
    return st;
}

#endif
