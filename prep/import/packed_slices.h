/* packed_slices.h - slices of packed samples, by slabs that are as deep as the chunks of a file.
 *
 * An importer fills in the upper part, and loads slabs as they are stored; whoever asks for slices
 * gets them unpacked. So each chunk is read and decompressed once, and no more than a slab is held.
 */
#ifndef PREP_IMPORT_PACKED_SLICES_H
#define PREP_IMPORT_PACKED_SLICES_H

#include "formats/base/mem.h"
#include "prep/import/packed_samples.h"

typedef struct packed_slices {
    mem *m;
    const char *file, *field; /* for messages */
    packed_samples packed;
    uint32_t dims[3];     /* of the grid */
    uint64_t chunk_depth; /* slices that chunks have; 0: there are no chunks */
    uint64_t chunk_bytes; /* decompressed */
    /* Slices first .. first + count - 1, with all components, native byte order. */
    status (*load)(void *ctx, uint32_t first, uint32_t count, void *stored);
    void *ctx;
    double *scales; /* of m, taken over: scale and offset of each slice, in place of those of
                       `packed`; NULL: all have these */
    /* what follows is its own */
    uint64_t slice_bytes; /* of a slice as stored */
    void *slab;           /* slices slab_first .. slab_first + slab_count - 1 */
    uint32_t depth;       /* for so many there is room */
    uint32_t slab_first, slab_count;
} packed_slices;

/* packed_slices_begin() - room for a slab: half of the budget, which has a limit. Where it does not
 * hold a chunk's depth, slabs are an equal part of that, and a chunk is loaded once for each.
 * ST_NOMEM also for a chunk of more than a quarter of the budget.
 */
CHECKED status packed_slices_begin(packed_slices *s);
void packed_slices_end(packed_slices *s); /* zeros are fine */

/* packed_slices_read() - as slice_source.read(), with packed_type(). */
CHECKED status packed_slices_read(packed_slices *s, uint32_t first, uint32_t count, void *slices);

#endif
