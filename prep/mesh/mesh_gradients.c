/* All threads compute shares of tets, some thousands at a time, and then add them. Each thread adds
 * the shares of its own vertices, in the order of the tets. */
#include "prep/mesh/mesh_gradients.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum {
    SLICE = 8192, /* tets whose shares are held at a time */
    CHUNK = 256,  /* tets that a thread takes at a time */
    BAND_MIN = 1024,
    OWN_LOG2 = 3, /* log2 of neighbouring vertices that belong to one thread */
    SOME = 512    /* gradients written at a time */
};

/* A tet's |determinant| is rounding error if it is below this part of the sum of its terms'
 * moduli. */
#define GRADIENT_SURE 0x1p-36

#define NOBODY UINT16_MAX

/* Sums of a vertex, or a tet's contribution: gradient times volume, and volume; both times 6. */
typedef struct weighted {
    double gradient[3], volume;
} weighted;

typedef struct share {
    weighted sum;
    uint16_t owner[4]; /* threads that own the tet's vertices; NOBODY: nothing to add */
} share;

typedef struct window {
    mesh_pages points, values;
} window;

struct mesh_gradients {
    mem *m;
    pool *workers;
    uint64_t vertices, band;
    uint64_t first, count; /* vertices of the current band */
    uint64_t point, value; /* index of vertex 0 in points, and in values */
    weighted *sums;        /* of the band's vertices */
    share *shares;
    window *windows; /* one per thread */
    const mesh_record *records;
    size_t records_count;
};

/* ---- memory ---- */

uint64_t mesh_gradients_memory(const mesh_gradients_plan *plan, int threads) {
    return sizeof(mesh_gradients) + plan->band * sizeof(weighted) + SLICE * sizeof(share) +
           (uint64_t)threads * (sizeof(window) + plan->points_window + plan->values_window) + 1024;
}

mesh_gradients_plan mesh_gradients_plan_make(const mesh_spool *points, const mesh_spool *values,
                                             uint64_t vertices, bool paged, int threads,
                                             uint64_t room) {
    mesh_gradients_plan plan = {.band = vertices < BAND_MIN ? vertices : BAND_MIN};
    if (paged) {
        plan.points_window = mesh_pages_least(points);
        plan.values_window = mesh_pages_least(values);
    }
    const uint64_t least = mesh_gradients_memory(&plan, threads);
    uint64_t left = room > least ? room - least : 0;
    /* Prefer fewer bands: another band costs more than narrower windows do. */
    const uint64_t wider = (paged ? left / 4 * 3 : left) / sizeof(weighted);
    const uint64_t more = wider < vertices - plan.band ? wider : vertices - plan.band;
    plan.band += more;
    left -= more * sizeof(weighted);
    if (paged) {
        const uint64_t each = left / (uint64_t)threads / 4;
        plan.points_window = mesh_pages_memory(points, plan.points_window + 3 * each);
        plan.values_window = mesh_pages_memory(values, plan.values_window + each);
    }
    return plan;
}

status mesh_gradients_create(mem *m, pool *workers, mesh_spool *points, mesh_spool *values,
                             uint64_t vertices, const mesh_gradients_plan *plan,
                             mesh_gradients **out) {
    mesh_gradients *g = mem_zalloc(m, sizeof *g);
    if (!g)
        return ST_NOMEM;
    const size_t threads = (size_t)pool_threads(workers);
    g->m = m;
    g->workers = workers;
    g->vertices = vertices;
    g->band = plan->band;
    g->sums = mem_array(m, (size_t)plan->band, sizeof *g->sums);
    g->shares = mem_alloc(m, SLICE * sizeof *g->shares);
    g->windows = mem_array(m, threads, sizeof *g->windows);
    status st = g->sums && g->shares && g->windows ? ST_OK : ST_NOMEM;
    for (size_t i = 0; st == ST_OK && i < threads; i++) {
        st = mesh_pages_init(&g->windows[i].points, points, plan->points_window);
        if (st == ST_OK)
            st = mesh_pages_init(&g->windows[i].values, values, plan->values_window);
    }
    if (st != ST_OK) {
        mesh_gradients_destroy(g);
        return st;
    }
    *out = g;
    return ST_OK;
}

void mesh_gradients_destroy(mesh_gradients *g) {
    if (!g)
        return;
    for (int i = 0; g->windows && i < pool_threads(g->workers); i++) {
        mesh_pages_release(&g->windows[i].points);
        mesh_pages_release(&g->windows[i].values);
    }
    mem_free(g->m, g->windows);
    mem_free(g->m, g->shares);
    mem_free(g->m, g->sums);
    mem_free(g->m, g);
}

uint64_t mesh_gradients_bands(const mesh_gradients *g) {
    return (g->vertices + g->band - 1) / g->band;
}

void mesh_gradients_begin(mesh_gradients *g, uint64_t band, uint64_t point, uint64_t value) {
    const uint64_t left = g->vertices - band * g->band;
    g->first = band * g->band;
    g->count = left < g->band ? left : g->band;
    g->point = point;
    g->value = value;
    memset(g->sums, 0, (size_t)g->count * sizeof *g->sums);
}

/* ---- shares ---- */

/* Sum of the moduli of the terms of e[0] . (e[1] x e[2]). */
static double moduli_of_terms(const double e[3][3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += fabs(e[0][i]) * (fabs(e[1][j] * e[2][k]) + fabs(e[1][k] * e[2][j]));
    }
    return sum;
}

/* Compute a tet's contribution. Returns false if it has none. Products of floats are far from the
 * limits of doubles. */
static bool weigh(const float p[4][3], const float f[4], weighted *out) {
    double e[3][3], df[3], normal[3][3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++)
            e[i][a] = (double)p[i + 1][a] - (double)p[0][a];
        df[i] = (double)f[i + 1] - (double)f[0];
    }
    for (int i = 0; i < 3; i++)
        vec3_cross(e[(i + 1) % 3], e[(i + 2) % 3], normal[i]);
    const double volume = vec3_dot(e[0], normal[0]);
    if (!(fabs(volume) > GRADIENT_SURE * moduli_of_terms((const double(*)[3])e)) ||
        !isfinite(df[0] + df[1] + df[2]))
        return false;
    for (int a = 0; a < 3; a++) {
        const double g = df[0] * normal[0][a] + df[1] * normal[1][a] + df[2] * normal[2][a];
        out->gradient[a] = volume < 0 ? -g : g;
    }
    out->volume = fabs(volume);
    return true;
}

/* Find the owners of the tet's vertices in the band. Returns false if there is none. */
static bool find_owners(const mesh_gradients *g, const uint32_t id[4], uint16_t owner[4]) {
    const uint32_t threads = (uint32_t)pool_threads(g->workers);
    bool any = false;
    for (int c = 0; c < 4; c++) {
        const bool here = id[c] >= g->first && id[c] - g->first < g->count;
        owner[c] = (uint16_t)(here ? (id[c] >> OWN_LOG2) % threads : NOBODY);
        any = any || here;
    }
    return any;
}

static status share_tet(const mesh_gradients *g, window *w, const uint32_t id[4], share *out) {
    static const uint16_t nobody[4] = {NOBODY, NOBODY, NOBODY, NOBODY};
    float p[4][3], f[4];
    if (!find_owners(g, id, out->owner))
        return ST_OK;
    for (int c = 0; c < 4; c++) {
        const void *at = mesh_pages_at(&w->points, g->point + id[c]);
        if (!at)
            return w->points.st;
        memcpy(p[c], at, sizeof p[c]);
        const void *value = mesh_pages_at(&w->values, g->value + id[c]);
        if (!value)
            return w->values.st;
        memcpy(&f[c], value, sizeof f[c]);
    }
    if (!weigh((const float(*)[3])p, f, &out->sum))
        memcpy(out->owner, nobody, sizeof nobody);
    return ST_OK;
}

static status share_chunk(void *ctx, size_t index, int worker) {
    mesh_gradients *g = ctx;
    const size_t end = (index + 1) * CHUNK;
    status st = ST_OK;
    for (size_t i = index * CHUNK; st == ST_OK && i < end && i < g->records_count; i++)
        st = share_tet(g, &g->windows[worker], g->records[i].id, &g->shares[i]);
    return st;
}

/* ---- sums ---- */

static status add_own(void *ctx, size_t index, int worker) {
    mesh_gradients *g = ctx;
    (void)worker;
    for (size_t i = 0; i < g->records_count; i++) {
        const share *s = &g->shares[i];
        for (int c = 0; c < 4; c++) {
            if (s->owner[c] != index)
                continue;
            weighted *to = &g->sums[g->records[i].id[c] - g->first];
            for (int a = 0; a < 3; a++)
                to->gradient[a] += s->sum.gradient[a];
            to->volume += s->sum.volume;
        }
    }
    return ST_OK;
}

status mesh_gradients_add(mesh_gradients *g, const mesh_record *records, size_t count) {
    status st = ST_OK;
    while (st == ST_OK && count > 0) {
        g->records = records;
        g->records_count = count < SLICE ? count : SLICE;
        st = pool_run(g->workers, (g->records_count + CHUNK - 1) / CHUNK, share_chunk, g);
        if (st == ST_OK)
            st = pool_run(g->workers, (size_t)pool_threads(g->workers), add_own, g);
        records += g->records_count;
        count -= g->records_count;
    }
    return st;
}

static void mean_of(const weighted *sum, float gradient[3]) {
    double mean[3], most = 0;
    for (int a = 0; a < 3; a++) {
        mean[a] = sum->volume > 0 ? sum->gradient[a] / sum->volume : 0;
        most = fabs(mean[a]) > most ? fabs(mean[a]) : most;
    }
    double scale = 1;
    while (most * scale > 0.5 * (double)FLT_MAX)
        scale *= 0.5;
    for (int a = 0; a < 3; a++)
        gradient[a] = (float)(mean[a] * scale) + 0.0F; /* -0 becomes +0 */
}

status mesh_gradients_end(mesh_gradients *g, mesh_spool *to) {
    float some[SOME][3];
    status st = ST_OK;
    for (uint64_t at = 0; st == ST_OK && at < g->count; at += SOME) {
        const size_t count = g->count - at < SOME ? (size_t)(g->count - at) : SOME;
        for (size_t i = 0; i < count; i++)
            mean_of(&g->sums[at + i], some[i]);
        st = mesh_spool_append(to, some, count);
    }
    return st;
}
