#include "prep/grid/pyramid_rows.h"

#include "formats/base/colour_field.h"
#include "prep/grid/pyramid_rows_template.h"

typedef const pyramid_rows *(*pyramid_rows_fn)(sample_type type);
CPU_KERNELS(pyramid_rows_fn, pyramid_rows_kernels, pyramid_rows_scalar, pyramid_rows);

const pyramid_rows *pyramid_rows_for(cpu_isa isa, sample_type type) {
    return pyramid_rows_kernels[isa](type);
}

/* ---- Colours ---- */

/* The three sums of a colour's bytes lie in one number, which is added as one: none is over 4096 *
 * 255. */
enum { BYTE_SUM_BITS = 20 };

static uint64_t apart(float colour) {
    const uint32_t c = colour_field_bytes((double)colour);
    return (uint64_t)(c >> 16) << 2 * BYTE_SUM_BITS | (uint64_t)(c >> 8 & 255U) << BYTE_SUM_BITS |
           (c & 255U);
}

/* Returns a byte's sum over 4096, rounded half to even. */
static uint32_t byte_of(uint64_t sums, int which) {
    const uint32_t sum = (uint32_t)(sums >> which * BYTE_SUM_BITS) & ((1U << BYTE_SUM_BITS) - 1);
    return (sum + (PYRAMID_WHOLE / 2 - 1) + (sum >> 12 & 1U)) >> 12;
}

static void x_colours(const void *row, uint32_t nodes, void *to, uint32_t first, uint32_t end) {
    const float *v = row;
    uint64_t *sums = to, e[PYRAMID_TAPS];
    for (uint32_t i = first; i < end; i++) {
        for (int d = 0; d < PYRAMID_TAPS; d++)
            e[d] = apart(v[nearest_node(2 * (int64_t)i + d - 2, nodes)]);
        sums[i] = PYRAMID_WEIGH(uint64_t, e[0], e[1], e[2], e[3], e[4]);
    }
}

static void y_colours(const void *const taps[PYRAMID_TAPS], void *to, uint32_t first,
                      uint32_t end) {
    const uint64_t *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];
    uint64_t *sums = to;
    for (size_t i = first; i < end; i++)
        sums[i] = PYRAMID_WEIGH(uint64_t, a[i], b[i], c[i], d[i], e[i]);
}

static void z_colours(const void *const taps[PYRAMID_TAPS], void *to, uint32_t first,
                      uint32_t end) {
    const uint64_t *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];
    float *samples = to;
    for (size_t i = first; i < end; i++) {
        const uint64_t sums = PYRAMID_WEIGH(uint64_t, a[i], b[i], c[i], d[i], e[i]);
        samples[i] = (float)(byte_of(sums, 2) << 16 | byte_of(sums, 1) << 8 | byte_of(sums, 0));
    }
}

const pyramid_rows *pyramid_rows_of_colours(void) {
    static const pyramid_rows rows = {sizeof(uint64_t), x_colours, y_colours, z_colours};
    return &rows;
}
