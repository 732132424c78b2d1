#include "formats/leaf/grid_codes.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/code_rows.h"

struct grid_codes_scratch {
    float *lo, *hi; /* ranges of the 4^3 blocks, Morton order, in `room`; lo > hi: empty */
    _Alignas(64) float room[];
};

static uint32_t blocks_of(uint32_t node_levels) {
    return 1U << (3 * node_levels);
}

size_t grid_codes_scratch_bytes(uint32_t node_levels) {
    return sizeof(grid_codes_scratch) + 2 * blocks_of(node_levels) * sizeof(float);
}

/* Returns the treelet's flags. */
static uint8_t block_ranges(grid_codes_scratch *s, const leaf_layout *l, const leaf_payload *p,
                            const char *samples) {
    const size_t row = p->samples[0], slice = row * p->samples[1];
    const code_samples own = {.first = samples + l->halo * (1 + row + slice) * sample_size(l->type),
                              .row = row,
                              .slice = slice,
                              .cells = {p->cells[0], p->cells[1], p->cells[2]}};
    const uint32_t blocks = blocks_of(p->node_levels);
    s->lo = s->room;
    s->hi = s->room + blocks;
    for (uint32_t m = 0; m < blocks; m++) {
        s->lo[m] = INFINITY;
        s->hi[m] = -INFINITY;
    }
    return code_rows_for(cpu_best(), l->type)->ranges(&own, s->lo, s->hi) ? LEAF_FLAG_NON_FINITE
                                                                          : 0;
}

static void merge_children(const uint8_t *child_lo, const uint8_t *child_hi, uint32_t nodes,
                           uint8_t *lo, uint8_t *hi) {
    for (uint32_t m = 0; m < nodes; m++) {
        uint8_t a = 255, b = 0;
        for (uint32_t c = 8 * m; c < 8 * m + 8; c++) {
            a = child_lo[c] < a ? child_lo[c] : a;
            b = child_hi[c] > b ? child_hi[c] : b;
        }
        lo[m] = a;
        hi[m] = b;
    }
}

/* Write codes relative to a range, and zeros behind codes and samples. */
static void encode(const leaf_payload *p, sample_type type, const grid_codes_scratch *s,
                   const float range[2], void *payload) {
    const uint32_t blocks = blocks_of(p->node_levels);
    uint8_t *codes = payload, *lo = codes + leaf_codes_at(p->node_levels);
    const quantizer q = quantizer_of(range[0], range[1], type);
    code_rows_for(cpu_best(), type)->encode(&q, s->lo, s->hi, blocks, lo, lo + blocks);
    for (uint32_t k = p->node_levels - 1; k >= 1; k--) {
        const uint32_t nodes = blocks_of(k);
        const uint8_t *below = codes + leaf_codes_at(k + 1);
        uint8_t *here = codes + leaf_codes_at(k);
        merge_children(below, below + 8 * nodes, nodes, here, here + nodes);
    }
    const uint32_t codes_end = leaf_codes_at(p->node_levels + 1);
    const uint32_t samples_end = p->samples_at + (uint32_t)leaf_payload_sample_bytes(p, type);
    memset(codes + codes_end, 0, p->samples_at - codes_end);
    memset(codes + samples_end, 0, leaf_aligned(samples_end) - samples_end);
}

grid_summary grid_codes_make(const leaf_layout *l, uint32_t t, grid_codes_scratch *s,
                             void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    grid_summary summary = {.flags = block_ranges(s, l, &p, (const char *)payload + p.samples_at)};
    float own[2];
    code_rows_for(cpu_best(), l->type)->whole(s->lo, s->hi, blocks_of(p.node_levels), own);
    /* -0 + 0 is +0: so the bytes do not depend on which zero came first. */
    for (int i = 0; i < 2; i++)
        summary.own[i] = own[i] + 0.0F;
    encode(&p, l->type, s, summary.own, payload);
    return summary;
}

void grid_codes_make_within(const leaf_layout *l, uint32_t t, const float range[2],
                            grid_codes_scratch *s, void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    (void)block_ranges(s, l, &p, (const char *)payload + p.samples_at);
    encode(&p, l->type, s, range, payload);
}
