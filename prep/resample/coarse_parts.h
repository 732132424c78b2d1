/* coarse_parts.h - puts what stands for each set of a treelet file into it (leaf.h, COARSE). */
#ifndef PREP_RESAMPLE_COARSE_PARTS_H
#define PREP_RESAMPLE_COARSE_PARTS_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"

/* How it is made. */
typedef struct coarse_maker {
    const void *ctx;
    /* Write the treelet file that stands for a set of f to `path`, whose runs are aligned like f's.
     * Files that it writes beside that it removes. *made = false: none is worth it. */
    status (*make)(const void *ctx, mem *m, leaf_file *f, uint32_t set, const char *path,
                   const progress *p, bool *made);
} coarse_maker;

enum { COARSE_PARTS_SUFFIX = 64 };

/* coarse_parts_embed() - put one for each set into w, which must be settled. output: path beside
 * which scratch files may lie. */
CHECKED status coarse_parts_embed(mem *m, leaf_writer *w, const char *output,
                                  const coarse_maker *maker, const progress *p);

/* coarse_parts_remove() - remove a scratch file, if it is there. */
void coarse_parts_remove(const char *path);

#endif
