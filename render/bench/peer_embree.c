#include "render/bench/peer_embree.h"

#include <limits.h>
#include <math.h>

#include "formats/base/status.h"

/* As in surface_integrator.c: what is behind this much alpha no longer counts. */
#define OPAQUE_ENOUGH (1.0f - 1.0f / 4096.0f)

int peer_embree_layers(int layers_max, float opacity) {
    const double most = ceil(log(1.0 - (double)OPAQUE_ENOUGH) / log1p(-(double)opacity));
    return layers_max > 0 && layers_max < most ? layers_max : (int)fmin(most, INT_MAX);
}

#ifndef PEER_WITH_EMBREE

bool peer_embree_present(void) {
    return false;
}

status peer_embree_create(mem *m, const peer_mesh *mesh, const peer_build *how, peer_embree **out) {
    (void)m, (void)mesh, (void)how;
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

status peer_embree_frame(const peer_embree *e, pool *threads, const peer_way *way,
                         const peer_view *view, const leafcast_image *image, peer_counts *counts) {
    (void)e, (void)threads, (void)way, (void)view, (void)image;
    *counts = (peer_counts){0};
    return ST_UNSUPPORTED;
}

#else

#include <embree3/rtcore.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#if defined __x86_64__ || defined __i386__
#include <immintrin.h>
#endif

#include "render/bench/peer_rays.h"
#include "render/look/camera.h"

enum { TILE = 16, SIDE = 4, LANES = SIDE * SIDE, CONFIG_MAX = 80 };

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

/* As Embree names instructions. */
static void configure(const peer_build *how, char config[CONFIG_MAX]) {
    static const char *const names[CPU_ISAS] = {
        [CPU_SSE42] = "sse4.2", [CPU_AVX2] = "avx2", [CPU_AVX512] = "avx512"};
    const int length =
        snprintf(config, CONFIG_MAX, "threads=%d,user_threads=0,set_affinity=0", how->threads);
    if (names[how->isa])
        snprintf(config + length, CONFIG_MAX - (size_t)length, ",isa=%s", names[how->isa]);
}

status peer_embree_create(mem *m, const peer_mesh *mesh, const peer_build *how, peer_embree **out) {
    char config[CONFIG_MAX];
    peer_embree *e = *out = mem_zalloc(m, sizeof *e);
    if (!e)
        return ST_NOMEM;
    e->mesh = mesh;
    e->m = m;
    configure(how, config);
    e->device = rtcNewDevice(config);
    status st = device_status(e->device, "opening a device");
    if (st == ST_OK) {
        name_version(e);
        rtcSetDeviceMemoryMonitorFunction(e->device, count_bytes, e);
        e->scene = rtcNewScene(e->device);
        attach_mesh(e, how->high);
        if (how->one_pass)
            rtcSetSceneFlags(e->scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
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

/* A light in the mesh's space. */
typedef struct lamp {
    bool point;
    float vector[3], rgb[3];
} lamp;

typedef struct frame {
    const peer_embree *e;
    const leafcast_image *image;
    view view;
    peer_way way;
    float ambient, opacity, rgb[3], background[3];
    lamp lamps[LEAFCAST_LIGHTS_MAX];
    int lamp_count, layers_max; /* layers_max 0: no limit */
    bool shadows;
    float cell;
    lanes empty; /* the background */
    uint32_t tiles_x;
    peer_counts counts;
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

/* ---- a packet ---- */

typedef struct packet {
    struct RTCRayHit16 rays;
    int valid[LANES] __attribute__((aligned(64))); /* -1: the ray still looks */
    lanes colour;                                  /* composited so far */
    float alpha[LANES];
    peer_collection *all; /* of one pass */
} packet;

static inline bool lane_hits(const struct RTCRayHit16 *rays, int i) {
    return rays->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
}

static uint64_t count_hits(const packet *p) {
    uint64_t hits = 0;
    for (int i = 0; i < LANES; i++)
        hits += p->valid[i] && lane_hits(&p->rays, i);
    return hits;
}

/* How far behind a surface another one may begin: within this, floats do not tell them apart. */
static inline float step_at(const frame *f, float t) {
    return 1e-3f * f->cell + 1e-6f * t;
}

/* The first surfaces, or those behind the ones there are. */
static void find_surfaces(const frame *f, bool behind, packet *p) {
    const RTCScene scene = f->e->scene;
    for (int i = 0; behind && i < LANES; i++) {
        p->rays.ray.tnear[i] = p->rays.ray.tfar[i] + step_at(f, p->rays.ray.tfar[i]);
        p->rays.ray.tfar[i] = INFINITY;
        p->rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    if (!f->way.one_pass) {
        peer_rays_intersect(scene, &f->way, behind, p->valid, &p->rays);
        return;
    }
    if (!behind)
        peer_rays_collect(scene, peer_embree_layers(f->layers_max, f->opacity), p->valid, &p->rays,
                          p->all);
    peer_rays_take(p->all, p->valid, &p->rays);
}

/* ---- shading ---- */

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
static inline void shade_headlight(const frame *f, const struct RTCRayHit16 *rays, const lanes *n,
                                   lanes *colour) {
    for (int i = 0; i < LANES; i++) {
        const float square = n->x[i] * n->x[i] + n->y[i] * n->y[i] + n->z[i] * n->z[i];
        const float along = n->x[i] * rays->ray.dir_x[i] + n->y[i] * rays->ray.dir_y[i] +
                            n->z[i] * rays->ray.dir_z[i];
        const float facing = square > 0.0f ? fabsf(along) / sqrtf(square) : 1.0f;
        const float light = f->ambient + (1.0f - f->ambient) * facing;
        colour->x[i] = light * f->rgb[0];
        colour->y[i] = light * f->rgb[1];
        colour->z[i] = light * f->rgb[2];
    }
}

/* Rays from the surfaces to a lamp. */
static inline void aim(const frame *f, const lamp *at, const struct RTCRay16 *from,
                       struct RTCRay16 *to) {
    for (int i = 0; i < LANES; i++) {
        const float t = from->tfar[i];
        const float px = from->org_x[i] + t * from->dir_x[i];
        const float py = from->org_y[i] + t * from->dir_y[i];
        const float pz = from->org_z[i] + t * from->dir_z[i];
        const float x = at->vector[0] - (at->point ? px : 0.0f);
        const float y = at->vector[1] - (at->point ? py : 0.0f);
        const float z = at->vector[2] - (at->point ? pz : 0.0f);
        const float length = sqrtf(x * x + y * y + z * z);
        to->org_x[i] = px;
        to->org_y[i] = py;
        to->org_z[i] = pz;
        to->dir_x[i] = x / length;
        to->dir_y[i] = y / length;
        to->dir_z[i] = z / length;
        to->tnear[i] = step_at(f, t);
        to->tfar[i] = at->point ? length : INFINITY;
        to->time[i] = 0.0f;
        to->mask[i] = ~0u;
        to->id[i] = (unsigned)i;
        to->flags[i] = 0;
    }
}

/* N . L with N on the eye's side; 0 where a light does not reach. With shadows it reaches no
 * triangle that the eye sees from its other side. */
static inline void face_lamp(const frame *f, const packet *p, const lanes *n,
                             const struct RTCRay16 *to, float facing[LANES]) {
    const struct RTCRay16 *from = &p->rays.ray;
    const struct RTCHit16 *hit = &p->rays.hit;
    for (int i = 0; i < LANES; i++) {
        const float x = n->x[i], y = n->y[i], z = n->z[i];
        const float length = sqrtf(x * x + y * y + z * z);
        const float n_d = x * from->dir_x[i] + y * from->dir_y[i] + z * from->dir_z[i];
        const float n_l = x * to->dir_x[i] + y * to->dir_y[i] + z * to->dir_z[i];
        const float d_l = from->dir_x[i] * to->dir_x[i] + from->dir_y[i] * to->dir_y[i] +
                          from->dir_z[i] * to->dir_z[i];
        const float g_d = hit->Ng_x[i] * from->dir_x[i] + hit->Ng_y[i] * from->dir_y[i] +
                          hit->Ng_z[i] * from->dir_z[i];
        const float g_l =
            hit->Ng_x[i] * to->dir_x[i] + hit->Ng_y[i] * to->dir_y[i] + hit->Ng_z[i] * to->dir_z[i];
        const float turned = length > 0.0f ? (n_d > 0.0f ? -n_l : n_l) / length : -d_l;
        const bool reaches = p->valid[i] && lane_hits(&p->rays, i) && turned > 0.0f &&
                             !(f->shadows && g_d * g_l > 0.0f);
        facing[i] = reaches ? turned : 0.0f;
    }
}

/* Adds a lamp's light; returns how many rays went to it. */
static uint64_t add_lamp(const frame *f, const lamp *at, const packet *p, const lanes *n,
                         lanes *colour) {
    struct RTCRay16 to;
    float facing[LANES];
    uint64_t rays = 0;
    aim(f, at, &p->rays.ray, &to);
    face_lamp(f, p, n, &to, facing);
    if (f->shadows) {
        int valid[LANES] __attribute__((aligned(64)));
        for (int i = 0; i < LANES; i++) {
            valid[i] = facing[i] > 0.0f ? -1 : 0;
            rays += facing[i] > 0.0f;
            /* Where packets of 16 are split, Embree looks at all that is not empty. */
            if (!valid[i])
                to.tfar[i] = -INFINITY;
        }
        if (rays)
            peer_rays_occluded(f->e->scene, &f->way, valid, &to);
    }
    for (int i = 0; i < LANES; i++) {
        const float light = to.tfar[i] < 0.0f ? 0.0f : (1.0f - f->ambient) * facing[i];
        colour->x[i] += light * at->rgb[0] * f->rgb[0];
        colour->y[i] += light * at->rgb[1] * f->rgb[1];
        colour->z[i] += light * at->rgb[2] * f->rgb[2];
    }
    return rays;
}

static uint64_t shade_lamps(const frame *f, const packet *p, const lanes *n, lanes *colour) {
    uint64_t rays = 0;
    for (int i = 0; i < LANES; i++) {
        colour->x[i] = f->ambient * f->rgb[0];
        colour->y[i] = f->ambient * f->rgb[1];
        colour->z[i] = f->ambient * f->rgb[2];
    }
    for (int l = 0; l < f->lamp_count; l++)
        rays += add_lamp(f, &f->lamps[l], p, n, colour);
    return rays;
}

static void triangle_normals(const struct RTCHit16 *hit, lanes *n) {
    memcpy(n->x, hit->Ng_x, sizeof n->x);
    memcpy(n->y, hit->Ng_y, sizeof n->y);
    memcpy(n->z, hit->Ng_z, sizeof n->z);
}

/* The colours of the surfaces there are; returns how many rays went to lamps. Rays alone, and a
 * mesh without normals: by the triangles' own. */
static uint64_t shade(const frame *f, const packet *p, lanes *colour) {
    lanes normal;
    if (!f->image->r && !f->shadows)
        return 0;
    if (f->image->r && f->e->mesh->normals)
        interpolate_normals(f->e->mesh, &p->rays, &normal);
    else
        triangle_normals(&p->rays.hit, &normal);
    if (f->lamp_count > 0)
        return shade_lamps(f, p, &normal, colour);
    shade_headlight(f, &p->rays, &normal, colour);
    return 0;
}

/* Opaque surfaces before the background. */
static uint64_t shade_opaque(const frame *f, packet *p) {
    const uint64_t rays = shade(f, p, &p->colour);
    for (int i = 0; f->image->r && i < LANES; i++) {
        const bool hit = lane_hits(&p->rays, i);
        p->colour.x[i] = hit ? p->colour.x[i] : f->background[0];
        p->colour.y[i] = hit ? p->colour.y[i] : f->background[1];
        p->colour.z[i] = hit ? p->colour.z[i] : f->background[2];
    }
    return rays;
}

static void composite(packet *p, const lanes *colour, int i, float opacity) {
    const float weight = (1.0f - p->alpha[i]) * opacity;
    p->colour.x[i] += weight * colour->x[i];
    p->colour.y[i] += weight * colour->y[i];
    p->colour.z[i] += weight * colour->z[i];
    p->alpha[i] += weight;
}

/* Surface behind surface, as far as a ray lets light through. */
static void shade_layers(const frame *f, packet *p, peer_counts *counts) {
    lanes colour = {{0}, {0}, {0}};
    for (int layer = 1;; layer++) {
        const uint64_t surfaces = count_hits(p);
        if (surfaces == 0)
            break;
        counts->surfaces += surfaces;
        counts->shadow_rays += shade(f, p, &colour);
        for (int i = 0; i < LANES; i++) {
            if (p->valid[i] && lane_hits(&p->rays, i))
                composite(p, &colour, i, f->opacity);
            p->valid[i] = lane_hits(&p->rays, i) && p->alpha[i] < OPAQUE_ENOUGH ? p->valid[i] : 0;
        }
        if (layer == f->layers_max)
            break;
        find_surfaces(f, true, p);
    }
    for (int i = 0; i < LANES; i++) {
        const float left = 1.0f - p->alpha[i];
        p->colour.x[i] += left * f->background[0];
        p->colour.y[i] += left * f->background[1];
        p->colour.z[i] += left * f->background[2];
    }
}

/* ---- pictures ---- */

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

static void store_depth(const frame *f, uint32_t px, uint32_t py, const packet *p) {
    for (int i = 0; f->image->z && i < LANES; i++)
        if (p->valid[i])
            f->image
                ->z[px + (uint32_t)i % SIDE + (size_t)f->view.width * (py + (uint32_t)i / SIDE)] =
                lane_hits(&p->rays, i) ? (double)p->rays.ray.tfar[i] : INFINITY;
}

static void draw_packet(const frame *f, peer_collection *all, uint32_t px, uint32_t py,
                        peer_counts *counts) {
    packet p;
    p.all = all;
    for (uint32_t i = 0; i < LANES; i++)
        p.valid[i] = px + i % SIDE < f->view.width && py + i / SIDE < f->view.height ? -1 : 0;
    make_rays(&f->view, px, py, &p.rays);
    find_surfaces(f, false, &p);
    const uint64_t hits = count_hits(&p);
    counts->hits += hits;
    store_depth(f, px, py, &p);
    if (hits && f->opacity < 1.0f) {
        memset(&p.colour, 0, sizeof p.colour);
        memset(p.alpha, 0, sizeof p.alpha);
        shade_layers(f, &p, counts);
    } else if (hits) {
        counts->surfaces += hits;
        counts->shadow_rays += shade_opaque(f, &p);
    }
    if (f->image->r) {
        const lanes *colour = hits ? &p.colour : &f->empty;
        store_lanes(f, px, py, colour->x, f->image->r);
        store_lanes(f, px, py, colour->y, f->image->g);
        store_lanes(f, px, py, colour->z, f->image->b);
    }
}

static void add_counts(peer_counts *to, const peer_counts *n) {
    __atomic_fetch_add(&to->hits, n->hits, __ATOMIC_RELAXED);
    __atomic_fetch_add(&to->surfaces, n->surfaces, __ATOMIC_RELAXED);
    __atomic_fetch_add(&to->shadow_rays, n->shadow_rays, __ATOMIC_RELAXED);
}

static status draw_tile(void *ctx, size_t index, int worker) {
    frame *f = ctx;
    const uint32_t x0 = TILE * (uint32_t)(index % f->tiles_x);
    const uint32_t y0 = TILE * (uint32_t)(index / f->tiles_x);
    peer_counts counts = {0};
    peer_collection all; /* filled only in one pass */
    (void)worker;
#if defined __x86_64__ || defined __i386__
    /* As Embree's manual asks for: denormals are 0. For this tile: the threads are not ours. */
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040);
#endif
    for (uint32_t y = y0; y < y0 + TILE && y < f->view.height; y += SIDE)
        for (uint32_t x = x0; x < x0 + TILE && x < f->view.width; x += SIDE)
            draw_packet(f, &all, x, y, &counts);
#if defined __x86_64__ || defined __i386__
    _mm_setcsr(before);
#endif
    add_counts(&f->counts, &counts);
    return ST_OK;
}

static void set_up_lamps(frame *f, const leafcast_scene *scene) {
    f->lamp_count = scene->light_count;
    f->shadows = scene->shadows;
    for (int l = 0; l < scene->light_count; l++) {
        const leafcast_light *from = &scene->lights[l];
        lamp *to = &f->lamps[l];
        to->point = from->point;
        for (int a = 0; a < 3; a++) {
            to->vector[a] = (float)(from->vector[a] - (from->point ? f->e->mesh->origin[a] : 0.0));
            to->rgb[a] = from->rgb[a];
        }
    }
}

static void set_up_colours(frame *f, const leafcast_surface *surface, const leafcast_scene *scene) {
    for (int i = 0; i < 3; i++) {
        f->rgb[i] = surface->rgb[i];
        f->background[i] = scene->background[i] * scene->background[3];
    }
    for (int i = 0; i < LANES; i++) {
        f->empty.x[i] = f->background[0];
        f->empty.y[i] = f->background[1];
        f->empty.z[i] = f->background[2];
    }
}

status peer_embree_frame(const peer_embree *e, pool *threads, const peer_way *way,
                         const peer_view *from, const leafcast_image *image, peer_counts *counts) {
    const leafcast_camera *c = from->camera;
    frame f = {.e = e,
               .image = image,
               .way = *way,
               .ambient = from->scene->ambient,
               .opacity = from->surface->opacity,
               .layers_max = from->scene->layers_max,
               .cell = (float)from->cell,
               .tiles_x = (c->width + TILE - 1) / TILE};
    set_up_colours(&f, from->surface, from->scene);
    set_up_lamps(&f, from->scene);
    status st = view_init(&f.view, e->mesh, c);
    if (st == ST_OK)
        st = pool_run(threads, (size_t)f.tiles_x * ((c->height + TILE - 1) / TILE), draw_tile, &f);
    *counts = f.counts;
    return st;
}

#endif
