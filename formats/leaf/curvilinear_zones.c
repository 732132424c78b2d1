#include "formats/leaf/curvilinear_zones.h"

static uint32_t treelets_along(uint32_t nodes) {
    return (nodes - 2) / CURVILINEAR_SIDE + 1;
}

uint64_t curvilinear_zones_treelets(const uint32_t nodes[3], uint64_t most) {
    uint64_t all = 1;
    for (int a = 0; a < 3; a++) {
        const uint64_t along = treelets_along(nodes[a]);
        if (all > most / along)
            return most + 1;
        all *= along;
    }
    return all;
}

typedef struct zone_walk {
    const uint32_t *nodes;
    uint32_t along[3];
    curvilinear_each *each;
    void *ctx;
} zone_walk;

static void visit_treelet(const zone_walk *w, const uint32_t at[3]) {
    uint32_t first[3], cells[3];
    for (int a = 0; a < 3; a++) {
        first[a] = at[a] * CURVILINEAR_SIDE;
        const uint32_t left = w->nodes[a] - 1 - first[a];
        cells[a] = left < CURVILINEAR_SIDE ? left : CURVILINEAR_SIDE;
    }
    w->each(w->ctx, first, cells);
}

/* Visit a cube of `side` treelets along each axis, a power of two, as far as it exists. */
static void visit(const zone_walk *w, const uint32_t at[3], uint32_t side) {
    for (int a = 0; a < 3; a++)
        if (at[a] >= w->along[a])
            return;
    if (side == 1) {
        visit_treelet(w, at);
        return;
    }
    const uint32_t half = side / 2;
    for (uint32_t octant = 0; octant < 8; octant++) {
        const uint32_t to[3] = {at[0] + (octant & 1) * half, at[1] + (octant >> 1 & 1) * half,
                                at[2] + (octant >> 2) * half};
        visit(w, to, half);
    }
}

void curvilinear_zones_walk(const uint32_t nodes[3], curvilinear_each *each, void *ctx) {
    zone_walk w = {.nodes = nodes, .each = each, .ctx = ctx};
    uint32_t side = 1;
    for (int a = 0; a < 3; a++) {
        w.along[a] = treelets_along(nodes[a]);
        while (side < w.along[a])
            side *= 2;
    }
    visit(&w, (const uint32_t[3]){0, 0, 0}, side);
}
