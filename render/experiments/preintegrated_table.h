/* preintegrated_table.h - what is seen of a step along which the value changes linearly, by its
 * values at both ends (Engel, Kraus, Ertl 2001).
 *
 * side x side entries over the values of a volume, each to 1e-5 of what it hides
 * (medium_stretch.h). Look-ups interpolate between four entries. So a jump of the transfer function
 * is smeared over an entry, and values are taken to be linear along a step.
 */
#ifndef RENDER_EXPERIMENTS_PREINTEGRATED_TABLE_H
#define RENDER_EXPERIMENTS_PREINTEGRATED_TABLE_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "render/look/transfer.h"

enum { PREINTEGRATED_SIDE_MIN = 16, PREINTEGRATED_SIDE_MAX = 2048 };

/* The light of a step, and the share that comes through. */
typedef float preintegrated_entry __attribute__((vector_size(16)));

typedef struct preintegrated_table {
    int side;
    double least, scale;        /* value to entry */
    double step;                /* world length */
    preintegrated_entry *entry; /* entry[front * side + back]; NULL: none */
} preintegrated_table;

/* preintegrated_table_make() - make the table for values in range[0] .. range[1].
 * preintegrated_table_release() - also after a failed make, and for a zeroed one. */
CHECKED status preintegrated_table_make(preintegrated_table *t, mem *m, pool *threads,
                                        const transfer *medium, const double range[2], double step,
                                        int side);
void preintegrated_table_release(preintegrated_table *t, mem *m);

/* The position of a value among the entries, 0 to side - 1. */
static inline float preintegrated_place(const preintegrated_table *t, double value) {
    const double at = (value - t->least) * t->scale, last = t->side - 1;
    return (float)(at > 0.0 ? at < last ? at : last : 0.0);
}

/* preintegrated_look_up() - the interpolated entry for two positions. */
static inline preintegrated_entry preintegrated_look_up(const preintegrated_table *t, float front,
                                                        float back) {
    const int most = t->side - 2;
    const int i = (int)front < most ? (int)front : most, k = (int)back < most ? (int)back : most;
    const float u = front - (float)i, v = back - (float)k;
    const preintegrated_entry *low = t->entry + (size_t)i * (size_t)t->side + (size_t)k,
                              *high = low + t->side;
    const preintegrated_entry a = low[0] + v * (low[1] - low[0]),
                              b = high[0] + v * (high[1] - high[0]);
    return a + u * (b - a);
}

#endif
