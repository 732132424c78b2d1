/* quantize.h - min/max ranges as 8-bit codes relative to their treelet's own exact range
 * (M08 4.3.2.4).
 *
 * One monotone function g maps [lo, hi] onto [0, 255]; a range is stored as floor(g(min)),
 * ceil(g(max)). Writer, reader and renderer all use these functions, so that rounding can lose no
 * surface: a block whose samples hold min < iso && iso <= max passes quantize_holds() for every
 * isovalue. Bit-reproducible: only - * / and comparisons in double.
 */
#ifndef FORMATS_LEAF_QUANTIZE_H
#define FORMATS_LEAF_QUANTIZE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/sample.h"

typedef struct quantizer {
    double lo, hi; /* the treelet's own range; lo > hi: no finite sample */
    double scale;  /* codes per unit of value; 0 when lo == hi */
    bool exact; /* integer samples on at most 256 values: codes are value - lo, and lose nothing */
} quantizer;

/* The isovalue's code interval: a node holds the isovalue only if its lo code <= below and its hi
 * code >= above. */
typedef struct quantized_iso {
    int below, above; /* no node qualifies: below = -1 */
} quantized_iso;

static inline quantizer quantizer_of(float lo, float hi, sample_type type) {
    quantizer q = {.lo = (double)lo, .hi = (double)hi};
    q.exact = type != SAMPLE_F32 && q.hi - q.lo <= 255.0 && q.hi >= q.lo;
    q.scale = q.hi > q.lo ? (q.exact ? 1.0 : 255.0 / (q.hi - q.lo)) : 0.0;
    return q;
}

/* g itself: monotone, 0 at lo, within [0, 255]. */
static inline double quantizer_map(const quantizer *q, double value) {
    double g = (value - q->lo) * q->scale;
    return g < 0.0 ? 0.0 : g > 255.0 ? 255.0 : g;
}

static inline uint8_t quantizer_floor(const quantizer *q, double value) {
    return (uint8_t)floor(quantizer_map(q, value));
}

static inline uint8_t quantizer_ceil(const quantizer *q, double value) {
    return (uint8_t)ceil(quantizer_map(q, value));
}

/* quantizer_iso() - once per treelet and isovalue. A range holds an isovalue iff min < iso && iso
 * <= max; with exact codes the strict side stays strict. Integers relate to iso as they do to
 * ceil(iso), whose difference to lo is exact where that of iso may round (lo = -100, iso = 1e-20).
 */
static inline quantized_iso quantizer_iso(const quantizer *q, double iso) {
    quantized_iso c = {-1, 256};
    if (!(q->lo < iso && iso <= q->hi))
        return c;
    double g = quantizer_map(q, q->exact ? ceil(iso) : iso);
    c.above = (int)ceil(g);
    c.below = q->exact ? c.above - 1 : (int)floor(g);
    return c;
}

static inline bool quantize_holds(quantized_iso iso, uint8_t lo_code, uint8_t hi_code) {
    return (int)lo_code <= iso.below && (int)hi_code >= iso.above;
}

#endif
