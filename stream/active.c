#include "stream/active.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/quantize.h"

enum { BLOCK = 1 << LEAF_BLOCK_LOG2, NODES = BLOCK + 1 };

size_t active_bytes(uint32_t node_levels) {
    size_t nodes = active_nodes_at(node_levels);
    size_t blocks = (size_t)1 << (3 * node_levels);
    return sizeof(active_masks) + blocks * sizeof(uint64_t) + (nodes + 7) / 8 * 8 + blocks;
}

active_masks *active_init(void *block, uint32_t node_levels) {
    active_masks *masks = block;
    memset(masks, 0, active_bytes(node_levels));
    masks->cells = (uint64_t *)(masks + 1);
    masks->nodes = (uint8_t *)(masks->cells + ((size_t)1 << (3 * node_levels)));
    masks->whole = masks->nodes + (active_nodes_at(node_levels) + 7) / 8 * 8;
    return masks;
}

/* Morton order of the 4^3 cells of a block, a row of 4 cells at a time: bit positions of (x = 0..3)
 * are 0, 1, 8, 9. */
static uint64_t spread_row(unsigned row) {
    return (row & 3u) | (uint64_t)(row >> 2 & 3u) << 8;
}

static unsigned row_shift(unsigned y, unsigned z) {
    return (y & 1u) << 1 | (y & 2u) << 3 | (z & 1u) << 2 | (z & 2u) << 4;
}

/* A bit per node (sample) of a block. */
typedef uint8_t node_rows[NODES][NODES];

/* Returns the cells with any corner in `reach` and not all corners in `beyond`. */
static uint64_t met_cells(const node_rows reach, const node_rows beyond) {
    uint64_t mask = 0;
    node_rows any, all;
    for (int z = 0; z < NODES; z++) {
        for (int y = 0; y < NODES; y++) {
            any[z][y] = (uint8_t)(reach[z][y] | reach[z][y] >> 1);
            all[z][y] = (uint8_t)(beyond[z][y] & beyond[z][y] >> 1);
        }
    }
    for (unsigned z = 0; z < BLOCK; z++) {
        for (unsigned y = 0; y < BLOCK; y++) {
            unsigned some = any[z][y] | any[z][y + 1] | any[z + 1][y] | any[z + 1][y + 1];
            unsigned every = all[z][y] & all[z][y + 1] & all[z + 1][y] & all[z + 1][y + 1];
            mask |= spread_row(some & ~every & 15u) << row_shift(y, z);
        }
    }
    return mask;
}

/* Returns the cells of a block that touch a set bit. */
static uint64_t touched_cells(const node_rows rows) {
    uint64_t mask = 0;
    for (unsigned z = 0; z < BLOCK; z++) {
        for (unsigned y = 0; y < BLOCK; y++) {
            unsigned some = rows[z][y] | rows[z][y + 1] | rows[z + 1][y] | rows[z + 1][y + 1];
            mask |= spread_row((some | some >> 1) & 15u) << row_shift(y, z);
        }
    }
    return mask;
}

/* The samples of one block, as floats. Nodes beyond the treelet repeat its last sample;
 * valid_cells() excludes their cells. */
typedef struct block_samples {
    float f[NODES][NODES][NODES];
} block_samples;

#define GATHER(NAME, TYPE)                                                                 \
    static void NAME(block_samples *b, const void *samples, const uint32_t n[3],           \
                     const uint32_t at[3], uint32_t halo) {                                \
        const TYPE *s = samples;                                                           \
        for (uint32_t z = 0; z < NODES; z++) {                                             \
            size_t zz = at[2] + z < n[2] - halo ? at[2] + z : n[2] - halo - 1;             \
            for (uint32_t y = 0; y < NODES; y++) {                                         \
                size_t yy = at[1] + y < n[1] - halo ? at[1] + y : n[1] - halo - 1;         \
                const TYPE *row = s + (zz * n[1] + yy) * n[0];                             \
                for (uint32_t x = 0; x < NODES; x++)                                       \
                    b->f[z][y][x] =                                                        \
                        (float)row[at[0] + x < n[0] - halo ? at[0] + x : n[0] - halo - 1]; \
            }                                                                              \
        }                                                                                  \
    }

GATHER(gather_u8, uint8_t)
GATHER(gather_i8, int8_t)
GATHER(gather_u16, uint16_t)
GATHER(gather_i16, int16_t)
GATHER(gather_f32, float)

static void gather(sample_type type, block_samples *b, const void *samples, const uint32_t n[3],
                   const uint32_t at[3], uint32_t halo) {
    switch (type) {
    case SAMPLE_U8: gather_u8(b, samples, n, at, halo); return;
    case SAMPLE_I8: gather_i8(b, samples, n, at, halo); return;
    case SAMPLE_U16: gather_u16(b, samples, n, at, halo); return;
    case SAMPLE_I16: gather_i16(b, samples, n, at, halo); return;
    default: gather_f32(b, samples, n, at, halo);
    }
}

/* Mark the samples of a block at or above a limit. */
static void rows_from(const block_samples *b, float limit, node_rows rows) {
    for (int z = 0; z < NODES; z++) {
        for (int y = 0; y < NODES; y++) {
            unsigned row = 0;
            for (int x = 0; x < NODES; x++)
                row |= (unsigned)(b->f[z][y][x] >= limit) << x;
            rows[z][y] = (uint8_t)row;
        }
    }
}

static void rows_missing(const block_samples *b, node_rows rows) {
    for (int z = 0; z < NODES; z++) {
        for (int y = 0; y < NODES; y++) {
            unsigned row = 0;
            for (int x = 0; x < NODES; x++)
                row |= (unsigned)!isfinite(b->f[z][y][x]) << x;
            rows[z][y] = (uint8_t)row;
        }
    }
}

static uint64_t block_mask(const block_samples *b, const interest_part *in, bool non_finite) {
    node_rows reach, beyond;
    uint64_t mask = 0;
    for (int i = 0; i < in->count; i++) {
        const value_limits at = in->limits[i];
        const bool isovalue = at.reach == at.beyond;
        rows_from(b, at.reach, reach);
        if (!isovalue)
            rows_from(b, at.beyond, beyond);
        mask |= met_cells(reach, isovalue ? reach : beyond);
    }
    if (!non_finite || !mask)
        return mask;
    rows_missing(b, reach);
    return mask & ~touched_cells(reach);
}

/* Returns the cells of a block that exist: none beyond the treelet, whatever codes say. */
static uint64_t valid_cells(const uint32_t cells[3], const uint32_t at[3]) {
    uint64_t mask = 0;
    if (at[0] >= cells[0])
        return 0;
    const unsigned row = at[0] + BLOCK <= cells[0] ? 15u : (1u << (cells[0] - at[0])) - 1u;
    for (unsigned z = 0; z < BLOCK && at[2] + z < cells[2]; z++)
        for (unsigned y = 0; y < BLOCK && at[1] + y < cells[1]; y++)
            mask |= spread_row(row) << row_shift(y, z);
    return mask;
}

static void morton_decode(uint32_t code, uint32_t levels, uint32_t at[3]) {
    at[0] = at[1] = at[2] = 0;
    for (uint32_t l = 0; l < levels; l++)
        for (int a = 0; a < 3; a++)
            at[a] |= (code >> (3 * l + (uint32_t)a) & 1u) << l;
}

/* Returns which of eight siblings meet the interest by their codes: a bit each. */
static uint8_t held_siblings(const uint8_t *lo, const uint8_t *hi, const interest_part *in) {
    unsigned mask = 0;
    for (int i = 0; i < in->count; i++)
        for (unsigned c = 0; c < 8; c++)
            mask |= (unsigned)quantize_holds(in->codes[i], lo[c], hi[c]) << c;
    return (uint8_t)mask;
}

void active_bound(active_masks *masks, uint32_t levels) {
    static const uint8_t lower[3] = {0x55, 0x33, 0x0f};
    const uint8_t *leaves = masks->nodes + active_nodes_at(levels - 1);
    uint32_t layers[3] = {0, 0, 0};
    for (uint32_t group = 0; group < 1u << (3 * (levels - 1)); group++) {
        uint32_t at[3];
        if (!leaves[group])
            continue;
        morton_decode(group, levels - 1, at);
        for (int a = 0; a < 3; a++)
            layers[a] |= ((leaves[group] & lower[a] ? 1u : 0u) |
                          (leaves[group] & ~lower[a] & 255u ? 2u : 0u))
                         << (2 * at[a]);
    }
    for (int a = 0; a < 3 && masks->root; a++) {
        masks->first[a] = (uint8_t)__builtin_ctz(layers[a]);
        masks->end[a] = (uint8_t)(32 - __builtin_clz(layers[a]));
    }
}

void active_range(const leaf_file *f, uint32_t p, const void *payload, uint32_t k, uint32_t i,
                  double range[2]) {
    const quantizer q = quantizer_of(f->own[p][0], f->own[p][1], f->layout.type);
    const uint8_t *lo = (const uint8_t *)payload + leaf_codes_at(k), *hi = lo + (1u << (3 * k));
    /* Where codes are rounded, the values that they were made of may have been rounded, too. */
    const double unsure = q.exact ? 0.0 : 1e-5;
    const double per_code = q.scale > 0.0 ? 1.0 / q.scale : 0.0;
    range[0] = fmax(q.lo + (lo[i] - unsure) * per_code, q.lo);
    range[1] = fmin(q.lo + (hi[i] + unsure) * per_code, q.hi);
}

static bool node_is_active(const active_masks *masks, uint32_t k, uint32_t i) {
    const uint8_t *siblings = k == 1 ? &masks->root : masks->nodes + active_nodes_at(k - 1);
    return siblings[i >> 3] >> (i & 7u) & 1u;
}

void active_whole(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                  const homogeneous *in) {
    const uint32_t levels = leaf_layout_payload(&f->layout, p % f->layout.treelets).node_levels;
    masks->some_whole = false;
    if (in->bins == 0 || (f->flags[p] & LEAF_FLAG_NON_FINITE))
        return;
    memset(masks->whole, 0, (size_t)1 << (3 * levels));
    /* Do not take a single block whole: a ray's few cells in it, by vectors, cost less than a piece
     * of its own. */
    for (uint32_t k = 1; k < levels; k++) {
        const uint32_t below = 3 * (levels - k);
        for (uint32_t i = 0; i < 1u << (3 * k); i++) {
            double range[2];
            if (masks->whole[i << below] || !node_is_active(masks, k, i))
                continue;
            active_range(f, p, payload, k, i, range);
            if (!homogeneous_holds(in, range[0], range[1]))
                continue;
            memset(masks->whole + (i << below), (int)(levels + 1 - k), (size_t)1 << below);
            masks->some_whole = true;
        }
    }
    for (int a = 0; a < 3 && masks->some_whole; a++) {
        masks->first[a] = 0;
        masks->end[a] = (uint8_t)(1u << levels);
    }
}

/* Set inner nodes from the blocks: a child is active iff one of its own children is. */
static void mark_nodes(active_masks *masks, uint32_t levels) {
    for (uint32_t k = levels; k >= 1; k--)
        for (uint32_t group = 0; group < 1u << (3 * (k - 1)); group++) {
            unsigned active = 0;
            for (uint32_t c = 8 * group; c < 8 * group + 8; c++)
                active |= (unsigned)(k == levels ? masks->cells[c] != 0
                                                 : masks->nodes[active_nodes_at(k) + c] != 0)
                          << (c & 7u);
            *(k > 1 ? &masks->nodes[active_nodes_at(k - 1) + group] : &masks->root) =
                (uint8_t)active;
        }
}

static float outward(double x, double to) {
    const float f = (float)x;
    return (double)f == x ? f : nextafterf(f, (float)to);
}

void active_wide(active_masks *masks, const active_masks *exact, const leaf_file *f, uint32_t p,
                 const void *payload, const interest *in) {
    const leaf_layout *l = &f->layout;
    const uint32_t t = p % l->treelets;
    const leaf_payload shape = leaf_layout_payload(l, t);
    const uint16_t *codes = f->deviations + deviation_at(l, p / l->treelets, t);
    for (uint32_t m = 0; m < 1u << (3 * shape.node_levels); m++) {
        uint32_t at[3];
        double range[2];
        morton_decode(m, shape.node_levels, at);
        for (int a = 0; a < 3; a++)
            at[a] *= BLOCK;
        const uint64_t cells = valid_cells(shape.cells, at);
        const uint16_t code = codes[deviation_brick(l, at[0], at[1], at[2])];
        masks->cells[m] = code == DEVIATION_UNKNOWN ? exact->cells[m] : 0;
        if (!cells || code == DEVIATION_UNKNOWN)
            continue;
        active_range(f, p, payload, shape.node_levels, m, range);
        if (interest_meets(in, outward(range[0] - deviation_value(code), -INFINITY),
                           outward(range[1] + deviation_value(code), INFINITY)))
            masks->cells[m] = cells;
    }
    mark_nodes(masks, shape.node_levels);
    memset(masks->first, 0, sizeof masks->first);
    memset(masks->end, 0, sizeof masks->end);
    active_bound(masks, shape.node_levels);
}

void active_compute(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                    const interest *in) {
    const leaf_payload shape = leaf_layout_payload(&f->layout, p % f->layout.treelets);
    const uint32_t levels = shape.node_levels, blocks = 1u << (3 * levels);
    const uint8_t *bytes = payload;
    const bool non_finite = f->flags[p] & LEAF_FLAG_NON_FINITE;
    const quantizer q = quantizer_of(f->own[p][0], f->own[p][1], f->layout.type);
    interest_part part;
    interest_within(&part, in, &q);

    /* Leaves: blocks whose codes meet the interest get their exact cell mask. */
    const uint8_t *lo = bytes + leaf_codes_at(levels), *hi = lo + blocks;
    block_samples b;
    for (uint32_t group = 0; group < blocks; group += 8) {
        unsigned held = held_siblings(lo + group, hi + group, &part), active = 0;
        for (uint32_t c = 0; c < 8; c++) {
            uint64_t mask = 0;
            if (held >> c & 1u) {
                uint32_t at[3], from[3];
                morton_decode(group + c, levels, at);
                for (int a = 0; a < 3; a++) {
                    at[a] *= BLOCK;
                    from[a] = at[a] + f->layout.halo;
                }
                gather(f->layout.type, &b, bytes + shape.samples_at, shape.samples, from,
                       f->layout.halo);
                mask = block_mask(&b, &part, non_finite) & valid_cells(shape.cells, at);
            }
            masks->cells[group + c] = mask;
            active |= (unsigned)(mask != 0) << c;
        }
        if (levels > 1)
            masks->nodes[active_nodes_at(levels - 1) + group / 8] = (uint8_t)active;
        else
            masks->root = (uint8_t)active;
    }
    /* Inner nodes: a child is active iff one of its own children is. */
    for (uint32_t k = levels - 1; k >= 1; k--) {
        uint32_t nodes = 1u << (3 * k);
        for (uint32_t group = 0; group < nodes; group += 8) {
            unsigned active = 0;
            for (uint32_t c = 0; c < 8; c++)
                active |= (unsigned)(masks->nodes[active_nodes_at(k) + group + c] != 0) << c;
            if (k > 1)
                masks->nodes[active_nodes_at(k - 1) + group / 8] = (uint8_t)active;
            else
                masks->root = (uint8_t)active;
        }
    }
    active_bound(masks, levels);
}

typedef active_fn *active_version;
CPU_KERNELS(active_version, active_kernels, active_compute, active_compute);

active_fn *active_for(cpu_isa isa) {
    return active_kernels[isa];
}
