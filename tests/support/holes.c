#include "tests/support/holes.h"
#include "formats/leaf/leaf_unpacker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "stream/active.h"
#include "tests/support/fixture.h"

enum { VOLUMES = 16, SIDE = 16, CELLS = SIDE * SIDE * SIDE, NODES = SIDE + 1, CELLS_LOG2 = 4 };

/* One treelet of 16^3 cells. */
typedef struct volume_masks {
    float samples[NODES * NODES * NODES];
    double iso;
    bool active[CELLS]; /* x fastest */
} volume_masks;

struct holes {
    uint64_t seed;
    volume_masks of[VOLUMES];
};

static float sample(field_random *r, int volume) {
    const long rare = 4 + 12 * (long)(volume % 4);
    if (field_random_below(r, rare) == 0) {
        const long what = field_random_below(r, 3);
        return what == 0 ? NAN : what == 1 ? INFINITY : -INFINITY;
    }
    /* Whole numbers, so that some lie at the isovalue; or any. */
    return volume % 2 ? (float)(field_random_below(r, 9) - 4) : (float)field_random_in(r, -1, 1);
}

/* Bit 0 x, bit 1 y, bit 2 z per level, the finest last. */
static unsigned morton(unsigned x, unsigned y, unsigned z) {
    unsigned code = 0;
    for (unsigned b = 0; b < 8; b++)
        code |=
            (x >> b & 1u) << (3 * b) | (y >> b & 1u) << (3 * b + 1) | (z >> b & 1u) << (3 * b + 2);
    return code;
}

static void read_masks(const char *path, volume_masks *v) {
    mem m;
    leaf_file *f = NULL;
    const interest in = interest_of_isovalues(&v->iso, 1);
    mem_init(&m, 0);
    if (leaf_file_open(&m, path, &f) != ST_OK)
        goto fail;
    uint32_t t = 0;
    while (t + 1 < f->layout.treelets && f->layout.level_of[t] != 0)
        t++;
    const leaf_payload shape = leaf_layout_payload(&f->layout, t);
    void *payload = mem_alloc(&m, shape.bytes),
         *block = mem_alloc(&m, active_bytes(shape.node_levels));
    if (!payload || !block || leaf_file_load(f, t, NULL, payload) != ST_OK)
        goto fail;
    active_masks *masks = active_init(block, shape.node_levels);
    active_for(cpu_best())(masks, f, t, payload, &in);
    for (unsigned i = 0; i < CELLS; i++) {
        const unsigned x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const unsigned code = morton(x, y, z);
        v->active[i] = masks->cells[code >> 6] >> (code & 63u) & 1u;
    }
    mem_free(&m, block);
    mem_free(&m, payload);
    leaf_file_close(f);
    return;
fail:
    fprintf(stderr, "holes: %s\n", status_text());
    exit(1);
}

holes *holes_make(uint64_t seed) {
    holes *h = calloc(1, sizeof *h);
    if (!h)
        abort(); /* a test without memory has nothing to say */
    h->seed = seed;
    for (int n = 0; n < VOLUMES; n++) {
        volume_masks *v = &h->of[n];
        field_random r = {seed * 100 + (uint64_t)n};
        for (int i = 0; i < NODES * NODES * NODES; i++)
            v->samples[i] = sample(&r, n);
        v->iso = n % 2 ? (double)(field_random_below(&r, 5) - 2) : field_random_in(&r, -0.5, 0.5);
        const field f = {.name = "holes",
                         .type = "f32",
                         .dims = {NODES, NODES, NODES},
                         .samples = v->samples,
                         .spacing = {1, 1, 1},
                         .iso = v->iso};
        const char *path = fixture_leaf(&f, CELLS_LOG2, 1, false);
        read_masks(path, v);
        (void)unlink(path);
    }
    return h;
}

void holes_free(holes *h) {
    free(h);
}

bool holes_cell(const holes *h, uint64_t index, ray_cell *out) {
    field_random mix = {h->seed * 0x9e3779b97f4a7c15u + index};
    field_random r = {field_random_bits(&mix)};
    const volume_masks *v = &h->of[index % VOLUMES];
    const long at = (long)(index / VOLUMES % CELLS);
    const long cell[3] = {at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE};
    *out = (ray_cell){.iso = v->iso};
    for (int n = 0; n < 8; n++)
        out->samples[n] =
            v->samples[cell[0] + (n & 1) +
                       NODES * (cell[1] + (n >> 1 & 1) + NODES * (cell[2] + (n >> 2)))];
    for (int a = 0; a < 3; a++) {
        out->lo[a] = (double)cell[a];
        out->hi[a] = (double)(cell[a] + 1);
        out->d[a] = field_random_in(&r, -1, 1);
        out->o[a] = out->lo[a] + field_random_unit(&r) - 30 * out->d[a];
    }
    return v->active[at];
}
