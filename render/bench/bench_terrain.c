#include "render/bench/bench_terrain.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/leafcast_dynamic.h"

/* Columns, in the order of add_row():
 *   tiles      along each axis; the ground is as large as they are
 *   triangles  of all plants, and of the ground
 *   make s     places and the trees over them, with the first picture
 *   ms         of a picture, by job->threads, median over runs
 *   x first    of the first row's
 *   asked/ray  objects that a ray, or its shadow rays, are held against
 *   differ     pixels whose depth is not the t that leafcast_trace_rays() finds for their ray */
const char bench_terrain_headings[] =
    "tiles|objects|triangles|make s|ms|+-|x first|fps|rays|asked/ray|hits|differ";

enum { PLANTS = 4, VARIANTS = 18, CELLS = 512 };

/* A tile is a square of 160 m^2. So many of each kind stand on it, on a grid that is shaken. */
static const double SIDE = 12.65;
static const struct {
    const char *name; /* in the store */
    int across;       /* so many squared */
    double size;      /* of its own */
} plants[PLANTS] = {
    {"conifer", 3, 1.0}, {"broadleaf", 2, 1.0}, {"bush", 5, 1.0}, {"grass", 48, 0.6}};

typedef struct landscape {
    bench_job *job;
    leafcast_device *device;
    leafcast *plant[PLANTS], *ground;
    uint64_t triangles[PLANTS], ground_triangles;
    leafcast_shown shown[VARIANTS][PLANTS], floor;
    leafcast_places *standing[VARIANTS][PLANTS], *tiles;
    leafcast_group inside[VARIANTS][PLANTS], variant[VARIANTS], wood;
    uint64_t of_variant[VARIANTS][2]; /* objects, triangles */
    uint64_t state;
} landscape;

static const leafcast_surface green = {.rgb = {0.4f, 0.5f, 0.3f}, .opacity = 1.0f};

static double chance(landscape *l) {
    uint64_t h = l->state += UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ h >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((h ^ h >> 31) >> 11) * 0x1p-53;
}

/* ---- Surfaces ---- */

static status open_plants(landscape *l) {
    const leafcast_options o = {.size = sizeof o, .device = l->device};
    status st = ST_OK;
    for (int i = 0; i < PLANTS && st == ST_OK; i++) {
        bench_stored of;
        st = bench_store_get(l->job->store, plants[i].name, &of);
        if (st == ST_OK)
            st = (status)leafcast_open(of.path, &o, &l->plant[i]);
        if (st == ST_OK)
            l->triangles[i] = leafcast_describe(l->plant[i]).cells;
    }
    return st;
}

/* Hills of a few waves, for a ground of the size 1. */
static double hill(double x, double y) {
    static const double waves[6][4] = {{1.0, 0.3, 0.1, 0.030},   {-0.6, 1.4, 0.7, 0.022},
                                       {2.3, 1.9, 0.4, 0.010},   {3.1, -4.2, 0.9, 0.006},
                                       {-7.7, 6.1, 0.2, 0.0028}, {11.0, 13.0, 0.5, 0.0014}};
    double z = 0.0;
    for (int i = 0; i < 6; i++)
        z += waves[i][3] *
             sin(6.283185307179586 * (waves[i][0] * x + waves[i][1] * y + waves[i][2]));
    return z;
}

static status open_ground(landscape *l, int cells) {
    const uint32_t row = (uint32_t)cells + 1;
    mem *m = &l->job->m;
    float(*vertices)[3] = mem_array(m, (size_t)row * row, sizeof *vertices);
    uint32_t(*triangles)[3] = mem_array(m, 2 * (size_t)cells * (size_t)cells, sizeof *triangles);
    status st = vertices && triangles ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; i < row * row && st == ST_OK; i++) {
        const double x = (double)(i % row) / cells, y = (double)(i / row) / cells;
        const double at[3] = {x, y, hill(x, y)};
        for (int a = 0; a < 3; a++)
            vertices[i][a] = (float)at[a];
    }
    for (uint32_t i = 0; i < (row - 1) * (row - 1) && st == ST_OK; i++) {
        const uint32_t v = i / (row - 1) * row + i % (row - 1);
        memcpy(triangles[2 * i], (uint32_t[3]){v, v + 1, v + row}, sizeof triangles[0]);
        memcpy(triangles[2 * i + 1], (uint32_t[3]){v + 1, v + row + 1, v + row},
               sizeof triangles[0]);
    }
    if (st == ST_OK) {
        const leafcast_triangles of = {.size = sizeof of,
                                       .vertex_count = row * row,
                                       .triangle_count = 2 * (row - 1) * (row - 1),
                                       .vertices = (const float(*)[3])vertices,
                                       .triangles = (const uint32_t(*)[3])triangles};
        const leafcast_options o = {.size = sizeof o, .device = l->device};
        l->ground_triangles = of.triangle_count;
        st = (status)leafcast_open_triangles(&of, &o, &l->ground);
    }
    mem_free(m, triangles);
    mem_free(m, vertices);
    return st;
}

/* ---- Places ---- */

/* Let plants of a sort stand on a tile: turned, and of different sizes. */
static status plant_tile(landscape *l, int variant, int sort) {
    const int across = plants[sort].across, count = across * across;
    const double step = SIDE / across;
    double(*at)[12] = mem_array(&l->job->m, (size_t)count, sizeof *at);
    if (!at)
        return ST_NOMEM;
    for (int i = 0; i < count; i++) {
        const double turn = 6.283185307179586 * chance(l),
                     size = plants[sort].size * (0.6 + 0.7 * chance(l)), c = size * cos(turn),
                     s = size * sin(turn);
        const double place[12] = {c,   -s,  0.0,  (i % across + chance(l)) * step,
                                  s,   c,   0.0,  (i / across + chance(l)) * step,
                                  0.0, 0.0, size, 0.0};
        memcpy(at[i], place, sizeof place);
    }
    const status st = (status)leafcast_make_places(l->ground, at[0], NULL, (uint32_t)count,
                                                   &l->standing[variant][sort]);
    mem_free(&l->job->m, at);
    l->shown[variant][sort] =
        (leafcast_shown){.volume = l->plant[sort], .surfaces = &green, .count = 1};
    l->inside[variant][sort] = (leafcast_group){.places = l->standing[variant][sort],
                                                .volumes = &l->shown[variant][sort],
                                                .volume_count = 1};
    l->of_variant[variant][0] += (uint64_t)count;
    l->of_variant[variant][1] += (uint64_t)count * l->triangles[sort];
    return st;
}

static status plant_tiles(landscape *l) {
    status st = ST_OK;
    for (int v = 0; v < VARIANTS && st == ST_OK; v++) {
        for (int k = 0; k < PLANTS && st == ST_OK; k++)
            st = plant_tile(l, v, k);
        l->variant[v] = (leafcast_group){.groups = l->inside[v], .group_count = PLANTS};
    }
    return st;
}

/* Lay so many tiles along each axis, sheared to the ground, which grows with them. totals: objects,
 * triangles. */
static status lay_tiles(landscape *l, int across, double ground[12], uint64_t totals[2]) {
    const size_t count = (size_t)across * (size_t)across;
    const double size = across * SIDE;
    mem *m = &l->job->m;
    double(*at)[12] = mem_array(m, count, sizeof *at);
    uint16_t *which = mem_array(m, count, sizeof *which);
    status st = at && which ? ST_OK : ST_NOMEM;
    totals[0] = 1;
    totals[1] = l->ground_triangles;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const double x = (double)(i % (size_t)across), y = (double)(i / (size_t)across);
        double z[4];
        for (int k = 0; k < 4; k++)
            z[k] = size * hill((x + k % 2) / across, (y + k / 2) / across);
        const double rise[2] = {0.5 * (z[1] - z[0] + z[3] - z[2]),
                                0.5 * (z[2] - z[0] + z[3] - z[1])};
        const double place[12] = {1.0,
                                  0.0,
                                  0.0,
                                  x * SIDE,
                                  0.0,
                                  1.0,
                                  0.0,
                                  y * SIDE,
                                  rise[0] / SIDE,
                                  rise[1] / SIDE,
                                  1.0,
                                  0.25 * (z[0] + z[1] + z[2] + z[3]) - 0.5 * (rise[0] + rise[1])};
        memcpy(at[i], place, sizeof place);
        which[i] = (uint16_t)(chance(l) * VARIANTS);
        totals[0] += l->of_variant[which[i]][0];
        totals[1] += l->of_variant[which[i]][1];
    }
    leafcast_free_places(l->tiles);
    l->tiles = NULL;
    if (st == ST_OK)
        st = (status)leafcast_make_places(l->ground, at[0], which, (uint32_t)count, &l->tiles);
    const double floor[12] = {size, 0.0, 0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, 0.0, size, 0.0};
    memcpy(ground, floor, sizeof floor);
    mem_free(m, which);
    mem_free(m, at);
    return st;
}

/* ---- Pictures ---- */

typedef struct measured {
    double make, ms, spread, asked;
    uint64_t rays, hits, differ;
} measured;

/* A walker's view over the wood, from the same height above the same point of the ground. */
static leafcast_camera camera_of(const landscape *l, double size) {
    const leafcast_camera *asked = &l->job->view.camera;
    const double eye[2] = {0.5, 0.32}, to[2] = {0.56, 0.62};
    leafcast_camera c = {.size = sizeof c,
                         .up = {0, 0, 1},
                         .fov = 50,
                         .width = asked->width,
                         .height = asked->height};
    for (int a = 0; a < 2; a++) {
        c.eye[a] = size * eye[a];
        c.look_at[a] = size * eye[a] + 60.0 * (to[a] - eye[a]);
    }
    c.eye[2] = size * hill(eye[0], eye[1]) + 30.0;
    c.look_at[2] = c.eye[2] - 5.0;
    return c;
}

/* Count pixels whose depth differs from that of their ray, traced by single rays. */
static status count_differing(landscape *l, const leafcast_scene *scene, const leafcast_camera *c,
                              const double *z, measured *e) {
    const size_t pixels = (size_t)c->width * c->height;
    mem *m = &l->job->m;
    leafcast_ray *rays = mem_array(m, pixels, sizeof *rays);
    leafcast_ray_hit *hits = mem_array(m, pixels, sizeof *hits);
    status st = rays && hits ? ST_OK : ST_NOMEM;
    for (size_t i = 0; i < pixels && st == ST_OK; i++) {
        rays[i].t1 = INFINITY;
        leafcast_pixel_ray(c, (double)(i % c->width) + 0.5, (double)(i / c->width) + 0.5,
                           rays[i].origin, rays[i].direction);
    }
    if (st == ST_OK)
        st = (status)leafcast_trace_rays(l->ground, scene, rays, pixels, hits);
    for (size_t i = 0; i < pixels && st == ST_OK; i++) {
        e->hits += !isinf(z[i]);
        e->differ += hits[i].t != z[i];
    }
    mem_free(m, hits);
    mem_free(m, rays);
    return st;
}

static status draw(landscape *l, const leafcast_scene *scene, double size, measured *e) {
    const leafcast_camera c = camera_of(l, size);
    const size_t pixels = (size_t)c.width * c.height;
    mem *m = &l->job->m;
    float *red = mem_array(m, pixels, sizeof *red);
    double *z = mem_array(m, pixels, sizeof *z),
           *times = mem_array(m, (size_t)l->job->runs, sizeof *times);
    status st = red && z && times ? ST_OK : ST_NOMEM;
    const leafcast_image image = {.size = sizeof image, .r = red, .z = z};
    leafcast_stats stats = {.size = sizeof stats};
    const double from = clock_seconds();
    if (st == ST_OK)
        st = (status)leafcast_trace(l->ground, scene, &c, &image, &stats, NULL, NULL);
    e->make += clock_seconds() - from;
    for (int i = 0; i < l->job->runs && st == ST_OK; i++) {
        const double start = clock_seconds();
        st = (status)leafcast_trace(l->ground, scene, &c, &image, &stats, NULL, NULL);
        times[i] = clock_seconds() - start;
    }
    if (st == ST_OK) {
        e->ms = 1e3 * bench_median(times, l->job->runs, &e->spread);
        e->rays = stats.primary_rays + stats.shadow_rays;
        e->asked = (double)stats.objects / (double)e->rays;
        st = count_differing(l, scene, &c, z, e);
    }
    mem_free(m, times);
    mem_free(m, z);
    mem_free(m, red);
    return st;
}

static status measure(landscape *l, int across, double *first) {
    double place[12];
    uint64_t totals[2];
    measured e = {0};
    bench_table *t = &l->job->table;
    const double from = clock_seconds();
    status st = lay_tiles(l, across, place, totals);
    e.make = clock_seconds() - from;
    if (st != ST_OK)
        return st;
    l->floor =
        (leafcast_shown){.volume = l->ground, .surfaces = &green, .count = 1, .place = place};
    l->wood = (leafcast_group){.places = l->tiles, .groups = l->variant, .group_count = VARIANTS};
    leafcast_scene scene = leafcast_scene_default();
    scene.volumes = &l->floor;
    scene.volume_count = 1;
    scene.groups = &l->wood;
    scene.group_count = 1;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.vector = {0.6, -0.5, 0.8}, .rgb = {1, 1, 1}};
    scene.shadows = true;
    st = draw(l, &scene, across * SIDE, &e);
    if (st != ST_OK)
        return st;
    *first = *first > 0.0 ? *first : e.ms;
    bench_table_add(t, "%d x %d", across, across);
    bench_table_add(t, "%llu", (unsigned long long)totals[0]);
    bench_table_add(t, "%.3g", (double)totals[1]);
    bench_table_add(t, "%.2f", e.make);
    bench_table_add(t, "%.1f", e.ms);
    bench_table_add(t, "%.2f", e.spread);
    bench_table_add(t, "%.2f", e.ms / *first);
    bench_table_add(t, "%.2f", 1e3 / e.ms);
    bench_table_add(t, "%llu", (unsigned long long)e.rays);
    bench_table_add(t, "%.2f", e.asked);
    bench_table_add(t, "%llu", (unsigned long long)e.hits);
    bench_table_add(t, "%llu", (unsigned long long)e.differ);
    return ST_OK;
}

static void close_all(landscape *l) {
    for (int v = 0; v < VARIANTS; v++)
        for (int k = 0; k < PLANTS; k++)
            leafcast_free_places(l->standing[v][k]);
    leafcast_free_places(l->tiles);
    for (int i = 0; i < PLANTS; i++)
        leafcast_close(l->plant[i]);
    leafcast_close(l->ground);
    leafcast_device_destroy(l->device);
}

status bench_terrain(bench_job *job) {
    static landscape l;
    static const int sides[] = {64, 128, 256, 512};
    const leafcast_options o = {.size = sizeof o, .threads = job->threads, .memory = job->memory};
    double first = 0.0;
    bench_table_init(&job->table,
                     "A wood of tiles on hills (M08 5.2.3, table 5.7): growth with the number of "
                     "tiles",
                     bench_terrain_headings);
    if (job->target)
        return status_describe(ST_USAGE, "bench terrain takes no file: it grows its own wood");
    l = (landscape){.job = job, .state = 1};
    status st = (status)leafcast_device_create(&o, &l.device);
    if (st == ST_OK)
        st = open_ground(&l, job->brief ? 16 : CELLS);
    if (st == ST_OK)
        st = open_plants(&l);
    if (st == ST_OK)
        st = plant_tiles(&l);
    for (size_t i = 0; i < sizeof sides / sizeof *sides && st == ST_OK; i++)
        st = measure(&l, job->brief ? sides[i] / 16 : sides[i], &first);
    close_all(&l);
    return st;
}
