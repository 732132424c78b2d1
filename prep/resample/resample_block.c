#include "prep/resample/resample_block.h"

#include <math.h>
#include <string.h>

/* NaNs by their bits: a node that no cell has held yet, and any other. */
static const uint32_t EMPTY = 0x7fc0beef, NO_DATA = 0x7fc00000;

static uint32_t bits_of(const float *x) {
    uint32_t bits;
    memcpy(&bits, x, sizeof bits);
    return bits;
}

/* ---- nodes ---- */

/* The first node at or behind `at`. The search starts at a guess, a few nodes away at most. */
static uint32_t node_from(const resample_grid *g, int axis, double at) {
    const double guess = (at - g->origin[axis]) / g->spacing[axis];
    const uint32_t dims = g->dims[axis];
    uint32_t i = guess < 0 ? 0 : guess > dims ? dims : (uint32_t)guess;
    while (i > 0 && resample_grid_node(g, axis, i - 1) >= at)
        i--;
    while (i < dims && resample_grid_node(g, axis, i) < at)
        i++;
    return i;
}

void resample_grid_nodes(const resample_grid *g, int axis, double lo, double hi, uint32_t *first,
                         uint32_t *end) {
    const uint32_t dims = g->dims[axis];
    *first = node_from(g, axis, lo);
    *end = node_from(g, axis, hi);
    while (*end < dims && resample_grid_node(g, axis, *end) <= hi)
        ++*end;
}

/* ---- samples ---- */

bool resample_block_is_empty(const float *sample) {
    return bits_of(sample) == EMPTY;
}

void resample_block_give(float *sample, float value) {
    *sample = isnan(value) ? NAN : value;
}

void resample_block_clear(const resample_block *b) {
    const size_t count = (size_t)(b->rows * b->grid->dims[0]);
    for (size_t i = 0; i < count; i++)
        memcpy(&b->samples[i], &EMPTY, sizeof EMPTY);
}

uint64_t resample_block_finish(const resample_block *b) {
    const size_t count = (size_t)(b->rows * b->grid->dims[0]);
    uint64_t held = 0;
    for (size_t i = 0; i < count; i++) {
        if (!isnan(b->samples[i])) {
            held++;
            continue;
        }
        held += bits_of(&b->samples[i]) != EMPTY;
        memcpy(&b->samples[i], &NO_DATA, sizeof NO_DATA);
    }
    return held;
}
