#include "render/bench/bench_tree.h"

#include <assert.h>
#include <math.h>

#include "formats/leaf/leaf_unpacker.h"

/* ---- samples ---- */

static void copy_treelet(const leaf_file *f, uint32_t id, const void *payload, bench_tree *t) {
    const leaf_payload p = leaf_layout_payload(&f->layout, id);
    const char *samples = (const char *)payload + p.samples_at;
    const size_t h = f->layout.halo;
    const uint32_t *place = f->layout.place[id], log2 = f->layout.cells_log2;
    for (size_t z = 0; z <= p.cells[2]; z++)
        for (size_t y = 0; y <= p.cells[1]; y++)
            for (size_t x = 0; x <= p.cells[0]; x++) {
                const size_t from = x + h + p.samples[0] * (y + h + p.samples[1] * (z + h));
                const size_t row = ((size_t)place[2] << log2) + z;
                const size_t column = ((size_t)place[1] << log2) + y;
                const size_t at = ((size_t)place[0] << log2) + x;
                t->samples[at + t->nodes[0] * (column + t->nodes[1] * row)] =
                    sample_get(t->type, samples, from);
            }
}

static status load_samples(leaf_file *f, bench_tree *t) {
    const leaf_level *level = &f->layout.level[0];
    leaf_unpacker *u = NULL;
    for (int a = 0; a < 3; a++) {
        t->nodes[a] = level->dims[a];
        t->n[0][a] = level->cells[a];
    }
    t->type = f->layout.type;
    t->lo = f->header.value_min;
    t->hi = f->header.value_max;
    if (f->header.non_finite)
        return status_describe(ST_UNSUPPORTED, "samples that are not finite: no such tree");
    void *payload = mem_alloc(t->m, leaf_layout_payload_max(&f->layout));
    t->samples = mem_array(t->m, (size_t)t->nodes[0] * t->nodes[1] * t->nodes[2], sizeof(float));
    status st = payload && t->samples ? leaf_unpacker_create(t->m, f, &u) : ST_NOMEM;
    for (uint32_t i = level->first; i < level->first + level->count && st == ST_OK; i++) {
        st = leaf_file_load(f, i, u, payload);
        if (st == ST_OK)
            copy_treelet(f, i, payload, t);
    }
    mem_free(t->m, payload);
    leaf_unpacker_destroy(u);
    return st;
}

/* ---- ranges ---- */

static void node_at(const bench_tree *t, uint32_t k, size_t index, uint32_t at[3]) {
    at[0] = (uint32_t)(index % t->n[k][0]);
    at[1] = (uint32_t)(index / t->n[k][0] % t->n[k][1]);
    at[2] = (uint32_t)(index / t->n[k][0] / t->n[k][1]);
}

static void widen(float range[2], const float by[2]) {
    range[0] = by[0] < range[0] ? by[0] : range[0];
    range[1] = by[1] > range[1] ? by[1] : range[1];
}

/* Of the finest blocks, over their samples. */
static void range_of_samples(const bench_tree *t, const uint32_t at[3], float range[2]) {
    uint32_t end[3];
    for (int a = 0; a < 3; a++)
        end[a] = 2 * at[a] + 3 < t->nodes[a] ? 2 * at[a] + 3 : t->nodes[a];
    for (uint32_t z = 2 * at[2]; z < end[2]; z++)
        for (uint32_t y = 2 * at[1]; y < end[1]; y++)
            for (uint32_t x = 2 * at[0]; x < end[0]; x++) {
                const float s = t->samples[x + t->nodes[0] * (y + (size_t)t->nodes[1] * z)];
                widen(range, (const float[2]){s, s});
            }
}

static void fill_ranges(bench_tree *t, uint32_t k) {
    for (size_t i = 0; i < t->count[k]; i++) {
        uint32_t at[3], child[3];
        float *range = t->range[k][i];
        range[0] = INFINITY;
        range[1] = -INFINITY;
        node_at(t, k, i, at);
        if (k == BENCH_TREE_FINEST)
            range_of_samples(t, at, range);
        for (unsigned o = 0; k > BENCH_TREE_FINEST && o < 8; o++)
            if (bench_tree_child(t, k, at, o, child))
                widen(range, t->range[k - 1][bench_tree_index(t, k - 1, child)]);
    }
}

/* ---- how they are kept ---- */

static bench_codes8 encode(const quantizer *q, const float range[2]) {
    return (bench_codes8){quantizer_floor(q, (double)range[0]),
                          quantizer_ceil(q, (double)range[1])};
}

static void fill_codes(bench_tree *t, uint32_t k) {
    const quantizer volume = quantizer_of((float)t->lo, (float)t->hi, t->type);
    const float least = t->type == SAMPLE_I8 ? -128.0f : t->type == SAMPLE_I16 ? -32768.0f : 0.0f;
    for (size_t i = 0; i < t->count[k]; i++) {
        const float *range = t->range[k][i];
        t->of_volume[k][i] = encode(&volume, range);
        if (sample_size(t->type) == 1)
            t->own8[k][i] =
                (bench_codes8){(uint8_t)(range[0] - least), (uint8_t)(range[1] - least)};
        else if (sample_size(t->type) == 2)
            t->own16[k][i] =
                (bench_codes16){(uint16_t)(range[0] - least), (uint16_t)(range[1] - least)};
        if (k == BENCH_TREE_TREELET)
            t->treelet[i] = quantizer_of(range[0], range[1], t->type);
    }
}

/* After the treelets' ranges are there. */
static void fill_treelet_codes(bench_tree *t, uint32_t k) {
    for (size_t i = 0; i < t->count[k]; i++) {
        uint32_t at[3];
        node_at(t, k, i, at);
        for (int a = 0; a < 3; a++)
            at[a] >>= BENCH_TREE_TREELET - k;
        t->of_treelet[k][i] =
            encode(&t->treelet[bench_tree_index(t, BENCH_TREE_TREELET, at)], t->range[k][i]);
    }
}

/* Children of a node follow each other, families in the order of their parents. */
static void fill_large(bench_tree *t, uint32_t k, size_t *slot_of, size_t *slot_below) {
    size_t *order = slot_below; /* by index: the slot that a node of the level below gets */
    uint32_t next = 0;
    bench_large_node *nodes = t->large[k];
    for (size_t i = 0; i < t->count[k]; i++)
        nodes[slot_of[i]].exists = (uint32_t)i; /* which node the slot holds, for the moment */
    for (size_t slot = 0; slot < t->count[k]; slot++) {
        const size_t i = nodes[slot].exists;
        uint32_t at[3], child[3];
        node_at(t, k, i, at);
        nodes[slot] = (bench_large_node){t->range[k][i][0], t->range[k][i][1], next, 0};
        for (unsigned o = 0; k > BENCH_TREE_FINEST && o < 8; o++)
            if (bench_tree_child(t, k, at, o, child)) {
                order[bench_tree_index(t, k - 1, child)] = next++;
                nodes[slot].exists |= 1u << o;
            }
    }
}

static status link_large(bench_tree *t) {
    size_t *slots[2] = {mem_array(t->m, t->count[BENCH_TREE_FINEST], sizeof **slots),
                        mem_array(t->m, t->count[BENCH_TREE_FINEST], sizeof **slots)};
    const bool room = slots[0] && slots[1];
    for (uint32_t k = t->levels - 1; room && k >= BENCH_TREE_FINEST; k--)
        fill_large(t, k, slots[k & 1u], slots[~k & 1u]);
    mem_free(t->m, slots[0]);
    mem_free(t->m, slots[1]);
    return room ? ST_OK : ST_NOMEM;
}

/* ---- loading ---- */

static status make_level(bench_tree *t, uint32_t k) {
    for (int a = 0; a < 3; a++)
        t->n[k][a] = (t->n[k - 1][a] + 1) / 2;
    const size_t count = t->count[k] = (size_t)t->n[k][0] * t->n[k][1] * t->n[k][2];
    t->range[k] = mem_array(t->m, count, sizeof *t->range[k]);
    t->own16[k] = mem_array(t->m, count, sizeof *t->own16[k]);
    t->own8[k] = mem_array(t->m, count, sizeof *t->own8[k]);
    t->of_volume[k] = mem_array(t->m, count, sizeof *t->of_volume[k]);
    t->of_treelet[k] = mem_array(t->m, count, sizeof *t->of_treelet[k]);
    t->large[k] = mem_array(t->m, count, sizeof *t->large[k]);
    if (k == BENCH_TREE_TREELET && !(t->treelet = mem_array(t->m, count, sizeof *t->treelet)))
        return ST_NOMEM;
    const bool room = t->range[k] && t->own16[k] && t->own8[k] && t->of_volume[k] &&
                      t->of_treelet[k] && t->large[k];
    return room ? ST_OK : ST_NOMEM;
}

static status make_levels(bench_tree *t) {
    status st = ST_OK;
    for (t->levels = 1; st == ST_OK; t->levels++) {
        const uint32_t k = t->levels;
        if (k > BENCH_TREE_TREELET && t->count[k - 1] == 1)
            break;
        assert(k < BENCH_TREE_LEVELS);
        st = make_level(t, k);
        if (st == ST_OK) {
            fill_ranges(t, k);
            fill_codes(t, k);
        }
    }
    for (uint32_t k = BENCH_TREE_FINEST; k < BENCH_TREE_TREELET && st == ST_OK; k++)
        fill_treelet_codes(t, k);
    return st == ST_OK ? link_large(t) : st;
}

status bench_tree_load(bench_tree *t, mem *m, const char *path) {
    leaf_file *f = NULL;
    *t = (bench_tree){.m = m};
    status st = leaf_file_open(m, path, &f);
    if (st == ST_OK && (f->mesh || f->besides))
        st = status_describe(ST_UNSUPPORTED, "%s: trees over samples are measured of grids", path);
    if (st == ST_OK)
        st = load_samples(f, t);
    leaf_file_close(f);
    return st == ST_OK ? make_levels(t) : st;
}

void bench_tree_release(bench_tree *t) {
    for (uint32_t k = 0; k < BENCH_TREE_LEVELS; k++) {
        mem_free(t->m, t->range[k]);
        mem_free(t->m, t->own16[k]);
        mem_free(t->m, t->own8[k]);
        mem_free(t->m, t->of_volume[k]);
        mem_free(t->m, t->of_treelet[k]);
        mem_free(t->m, t->large[k]);
    }
    mem_free(t->m, t->treelet);
    mem_free(t->m, t->samples);
}

double bench_tree_bytes(const bench_tree *t, bench_keeping keeping, uint32_t finest, double *node) {
    const bool treelets = keeping == KEEP_TREELET || keeping == KEEP_REUSE;
    double sum = 0.0;
    *node = keeping == KEEP_LARGE   ? (double)sizeof(bench_large_node)
            : keeping == KEEP_FLOAT ? 8.0
            : keeping == KEEP_OWN   ? 2.0 * (double)sample_size(t->type)
                                    : 2.0;
    for (uint32_t k = finest; k < t->levels; k++) {
        /* From the treelets' roots on up, the directory has floats. */
        if (treelets && k >= BENCH_TREE_TREELET)
            sum += 8.0 * (double)t->count[k];
        else
            sum += *node * (double)t->count[k];
        if (keeping == KEEP_REUSE && k < BENCH_TREE_TREELET)
            sum -= (2.0 - 6.0 / 8.0) * (double)t->count[k + 1];
    }
    if (keeping == KEEP_REUSE)
        *node -= (2.0 - 6.0 / 8.0) / 8.0;
    return sum;
}
