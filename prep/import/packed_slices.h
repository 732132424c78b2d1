/* packed_slices.h - slices of packed samples, read in slabs as deep as the chunks of a file.
 *
 * An importer fills in the upper part of the struct, and loads slabs as they are stored. Readers
 * get unpacked slices. So each chunk is read and decompressed once, and only one slab is held.
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
    uint64_t chunk_depth; /* slices per chunk; 0: there are no chunks */
    uint64_t chunk_bytes; /* decompressed */
    /* Load slices first .. first + count - 1, with all components, in native byte order. */
    status (*load)(void *ctx, uint32_t first, uint32_t count, void *stored);
    void *ctx;
    double *scales; /* allocated from m, now owned: scale and offset per slice, instead of those of
                       `packed`; NULL: those hold for all */
    /* private: */
    uint64_t slice_bytes; /* bytes of a stored slice */
    void *slab;           /* slices slab_first .. slab_first + slab_count - 1 */
    uint32_t depth;       /* slices that fit in the slab */
    uint32_t slab_first, slab_count;
} packed_slices;

/* packed_slices_begin() - allocate a slab of at most half the budget, which must be limited. If
 * that does not hold a chunk's depth, slabs are equal parts of it, and a chunk is loaded once for
 * each. ST_NOMEM also if a chunk takes more than a quarter of the budget.
 */
CHECKED status packed_slices_begin(packed_slices *s);
void packed_slices_end(packed_slices *s); /* a zeroed struct is fine */

/* packed_slices_read() - as slice_source.read(), with packed_type(). */
CHECKED status packed_slices_read(packed_slices *s, uint32_t first, uint32_t count, void *slices);

#endif
