/* preintegrated_table.h - what is seen of a step along which the value goes evenly from one value
 * to another, by both of them (Engel, Kraus, Ertl 2001).
 *
 * side x side entries over the values of a volume, each to 1e-5 of what it hides
 * (medium_stretch.h); between them the four around are interpolated. A step in the transfer
 * function is smeared over an entry, and what values do along a step is taken to be even.
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

/* preintegrated_table_make() - over range[0] .. range[1]. preintegrated_table_release() - also
 * where that failed, and of a zeroed one. */
CHECKED status preintegrated_table_make(preintegrated_table *t, mem *m, pool *threads,
                                        const transfer *medium, const double range[2], double step,
                                        int side);
void preintegrated_table_release(preintegrated_table *t, mem *m);

/* The place of a value between entries, 0 to side - 1. */
static inline float preintegrated_place(const preintegrated_table *t, double value) {
    const double at = (value - t->least) * t->scale, last = t->side - 1;
    return (float)(at > 0.0 ? at < last ? at : last : 0.0);
}

/* preintegrated_look_up() - between two such places. */
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
