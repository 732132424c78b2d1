#include "prep/generate/attractor.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

const field_info attractor_info = {
    "attractor",
    "how densely orbits of the Lorenz attractor pass by; u8 maps [0, 255] to itself; try 10",
    0,
    255,
    true,
    false};

enum {
    LANES = 8,            /* orbits integrated side by side */
    GROUPS = 32,          /* groups of LANES orbits, the unit of work for threads */
    WARM_UP = 2000,       /* steps until an orbit is on the attractor */
    POINTS_PER_NODE = 64, /* points = this times the square of the longest edge: the attractor is
                             nearly a surface */
    LEAST_EDGE = 128,     /* ... but never fewer than for this edge */
    ONE = 16              /* weight of a whole point along an axis */
};

#define STEP   0.004
#define EXTENT 28.0 /* from the centre to the ends of the longest edge */
#define CENTRE 25.0 /* in z */

struct attractor {
    mem *m;
    uint32_t dims[3];
    uint64_t seed;
    uint32_t steps;  /* per orbit */
    double scale;    /* nodes per unit of the attractor's space */
    double per_unit; /* density per whole part counted */
    size_t room;
    _Atomic uint32_t *counts;
    field_block block;
};

typedef struct orbits {
    double x[LANES], y[LANES], z[LANES];
} orbits;

status attractor_create(mem *m, const uint32_t dims[3], uint64_t seed, size_t samples,
                        attractor **out) {
    attractor *a = mem_zalloc(m, sizeof *a);
    if (!a)
        return ST_NOMEM;
    a->m = m;
    memcpy(a->dims, dims, sizeof a->dims);
    a->seed = seed;
    a->room = samples;
    a->counts = mem_array(m, samples, sizeof *a->counts);
    if (!a->counts) {
        attractor_destroy(a);
        return ST_NOMEM;
    }
    uint32_t edge = dims[0] > dims[1] ? dims[0] : dims[1];
    edge = edge > dims[2] ? edge : dims[2];
    a->scale = (edge - 1.0) / (2 * EXTENT);
    double wanted = (double)POINTS_PER_NODE * edge * edge;
    double least = (double)POINTS_PER_NODE * LEAST_EDGE * LEAST_EDGE;
    a->steps = (uint32_t)((wanted > least ? wanted : least) / (2 * LANES * GROUPS));
    a->per_unit = wanted / (2.0 * LANES * GROUPS * a->steps) / (ONE * ONE * ONE);
    *out = a;
    return ST_OK;
}

void attractor_destroy(attractor *a) {
    if (!a)
        return;
    mem_free(a->m, a->counts);
    mem_free(a->m, a);
}

/* ---- orbits ---- */

/* Lorenz 1963: x' = 10 (y - x), y' = x (28 - z) - y, z' = x y - 8/3 z; at p + h d. */
static void slope(const orbits *p, const orbits *d, double h, orbits *out) {
    for (int l = 0; l < LANES; l++) {
        double x = p->x[l] + h * d->x[l], y = p->y[l] + h * d->y[l], z = p->z[l] + h * d->z[l];
        out->x[l] = 10 * (y - x);
        out->y[l] = x * (28 - z) - y;
        out->z[l] = x * y - z * (8.0 / 3);
    }
}

static void step(orbits *p) {
    orbits k1, k2, k3, k4;
    slope(p, p, 0, &k1);
    slope(p, &k1, STEP / 2, &k2);
    slope(p, &k2, STEP / 2, &k3);
    slope(p, &k3, STEP, &k4);
    for (int l = 0; l < LANES; l++) {
        p->x[l] += STEP / 6 * (k1.x[l] + 2 * (k2.x[l] + k3.x[l]) + k4.x[l]);
        p->y[l] += STEP / 6 * (k1.y[l] + 2 * (k2.y[l] + k3.y[l]) + k4.y[l]);
        p->z[l] += STEP / 6 * (k1.z[l] + 2 * (k2.z[l] + k3.z[l]) + k4.z[l]);
    }
}

static void start(const attractor *a, size_t group, orbits *p) {
    uint64_t state = a->seed * 0x9e3779b97f4a7c15u + group;
    for (int l = 0; l < LANES; l++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        p->x[l] = 1 + (double)(state >> 40) * 0x1p-24;
        p->y[l] = 1 + l;
        p->z[l] = CENTRE;
    }
    for (int n = 0; n < WARM_UP; n++)
        step(p);
}

/* ---- counting ---- */

/* Find the node below a coordinate, and the weight of the node above in parts of ONE. Returns false
 * outside the grid. */
static bool locate(double at, uint32_t nodes, uint32_t *node, uint32_t *above) {
    if (!(at >= 0 && at < nodes - 1.0))
        return false;
    *node = (uint32_t)at;
    *above = (uint32_t)((at - *node) * ONE + 0.5);
    return true;
}

static void deposit(attractor *a, const uint32_t node[3], const uint32_t above[3]) {
    const field_block *b = &a->block;
    for (int corner = 0; corner < 8; corner++) {
        uint32_t at[3], weight = 1;
        for (int c = 0; c < 3; c++) {
            int up = corner >> c & 1;
            at[c] = node[c] + (uint32_t)up;
            weight *= up ? above[c] : ONE - above[c];
        }
        if (at[2] - b->slice >= b->slices || at[1] - b->row >= b->rows)
            continue;
        size_t index =
            ((size_t)(at[2] - b->slice) * b->rows + (at[1] - b->row)) * a->dims[0] + at[0];
        atomic_fetch_add_explicit(&a->counts[index], weight, memory_order_relaxed);
    }
}

/* Count a point and its mirror image: the attractor is symmetric about its z axis. */
static void count_point(attractor *a, double x, double y, double z) {
    uint32_t node[3], above[3];
    double at_z = (z - CENTRE) * a->scale + 0.5 * (a->dims[2] - 1.0);
    if (!locate(at_z, a->dims[2], &node[2], &above[2]) || node[2] + 1 < a->block.slice ||
        node[2] >= a->block.slice + a->block.slices)
        return;
    for (int side = 0; side < 2; side++) {
        double sign = side ? -a->scale : a->scale;
        if (locate(x * sign + 0.5 * (a->dims[0] - 1.0), a->dims[0], &node[0], &above[0]) &&
            locate(y * sign + 0.5 * (a->dims[1] - 1.0), a->dims[1], &node[1], &above[1]))
            deposit(a, node, above);
    }
}

static status count_group(void *ctx, size_t group, int worker) {
    (void)worker;
    attractor *a = ctx;
    orbits p;
    start(a, group, &p);
    for (uint32_t n = 0; n < a->steps; n++) {
        step(&p);
        for (int l = 0; l < LANES; l++)
            count_point(a, p.x[l], p.y[l], p.z[l]);
    }
    return ST_OK;
}

status attractor_count(attractor *a, pool *p, const field_block *block) {
    size_t samples = (size_t)block->slices * block->rows * a->dims[0];
    assert(samples <= a->room);
    a->block = *block;
    memset((void *)a->counts, 0, samples * sizeof *a->counts);
    return pool_run(p, GROUPS, count_group, a);
}

void attractor_values(const attractor *a, size_t first, size_t count, double *out) {
    for (size_t n = 0; n < count; n++)
        out[n] = a->per_unit * atomic_load_explicit(&a->counts[first + n], memory_order_relaxed);
}
