/* live_rows.h - rows of samples that change while they are drawn (live_samples.h): copied, and
 * their extent found on the way. By type and for each ISA; all give the same.
 */
#ifndef FORMATS_LEAF_LIVE_ROWS_H
#define FORMATS_LEAF_LIVE_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/base/sample.h"

/* At most so many samples of a row are taken at once: what is kept of them stays in the cache. */
enum { LIVE_ROW_MAX = 1024, LIVE_PART = 256 };

/* Of each place along x, the least and the greatest finite sample of all rows so far, of their own
 * type; and whether one was not finite. */
typedef struct live_extent {
    _Alignas(64) char lo[LIVE_ROW_MAX * sizeof(float)];
    _Alignas(64) char hi[LIVE_ROW_MAX * sizeof(float)];
    _Alignas(64) uint32_t bad[LIVE_ROW_MAX]; /* 0: all were finite */
    size_t part; /* LIVE_PART, but no constant: bytes that are copied at once */
} live_extent;

/* The extent of a part of a row: lo > hi: nothing is finite. */
typedef struct live_range {
    float lo, hi;
    bool bad; /* something is not finite */
} live_range;

/* count: up to LIVE_ROW_MAX. */
typedef struct live_rows {
    void (*begin)(live_extent *e, size_t count);                           /* no rows so far */
    void (*widen)(live_extent *e, const void *row, size_t count);          /* by one row */
    void (*copy)(live_extent *e, const void *row, void *to, size_t count); /* and copy it */
    live_range (*range)(const live_extent *e, size_t first, size_t count);
} live_rows;

/* live_rows_for() - the functions of an ISA for samples of sample_stored() types. */
const live_rows *live_rows_for(cpu_isa isa, sample_type type);

#endif
