/* live_samples.h - the samples of a grid that change while they are drawn: two buffers in memory,
 * of which readers have one, and a writer fills the other (M08 5.1.2).
 *
 * Blocks of 32^3 samples are what is kept count of: when a block last changed, in which buffer it
 * is how old, and its extent: of all its samples, and of those in its first planes along each axis,
 * which belong to the treelets before it, too. So each block is looked at by itself, whatever
 * region it changed with.
 *
 * One writer at a time; readers of the other buffer at any time.
 */
#ifndef FORMATS_LEAF_LIVE_SAMPLES_H
#define FORMATS_LEAF_LIVE_SAMPLES_H

#include "formats/base/cpu.h"
#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/sample.h"
#include "formats/leaf/live_rows.h"

enum { LIVE_BUFFERS = 2, LIVE_BLOCK_LOG2 = 5, LIVE_BLOCK = 1 << LIVE_BLOCK_LOG2 };

typedef struct live_samples live_samples;

/* live_samples_create() - all samples are 0. type: a stored one. threads: that fill a buffer, the
 * caller's among them. */
CHECKED status live_samples_create(mem *m, const uint32_t dims[3], sample_type type, cpu_isa isa,
                                   int threads, live_samples **out);
void live_samples_destroy(live_samples *s); /* NULL is fine */

/* Samples of a region, given by the address of the first one and the bytes from one to the next
 * along x, y, z. */
typedef struct live_region {
    uint32_t first[3], size[3]; /* not empty, within the grid */
    sample_type type;           /* any whose sample_stored() type is the grid's */
    const char *samples;
    ptrdiff_t strides[3];
} live_region;

/* live_samples_put() - copy a region into a buffer. What else is in its blocks is brought up to
 * date before. ST_NOMEM: nothing has changed. */
CHECKED status live_samples_put(live_samples *s, int buffer, const live_region *r);

/* live_samples_finish() - bring all of a buffer up to date: it is then the newest one, and readers
 * may have it. */
CHECKED status live_samples_finish(live_samples *s, int buffer);

/* live_samples_load() - copy a box of samples, in which there are some, out of a buffer, x fastest:
 * of those that do not exist, it has the nearest ones. */
void live_samples_load(const live_samples *s, int buffer, const int64_t first[3],
                       const uint32_t size[3], void *samples);

/* live_samples_range() - the extent of what the treelet at this place has without its halo: nodes
 * 32 i to 32 i + 32 along each axis. live_samples_stamp() - a number that says when what it has
 * with its halo changed last, at least 1: if it is the same, so are the samples. Both of the
 * newest. */
live_range live_samples_range(const live_samples *s, const uint32_t place[3]);
uint64_t live_samples_stamp(const live_samples *s, const uint32_t place[3]);

#endif
