/* leaf_file_coarse.c - the coarse grids in a treelet file. */
#include <assert.h>
#include <string.h>

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_geometry.h"

bool leaf_file_has_coarse(const leaf_file *f, uint32_t set) {
    return f->coarse && f->coarse[set].bytes;
}

/* Whether it is the file named, and a grid, or no more cells of the same kind as f, which is whole.
 */
static bool stands_for(const leaf_file *coarse, const leaf_file *f, const leaf_part *part) {
    const leaf_geometry *g = coarse->geometry;
    const bool fewer = g == f->geometry && !f->stands_in && coarse->layout.sets == 1 &&
                       g->verifier->cells(coarse) <= g->verifier->cells(f);
    return !coarse->header.segments && !coarse->header.steps_before && (g->has_map || fewer) &&
           memcmp(coarse->header.id, part->id, sizeof part->id) == 0;
}

status leaf_file_open_coarse(mem *m, const leaf_file *f, uint32_t set, leaf_file **out) {
    assert(leaf_file_has_coarse(f, set));
    const leaf_part *part = &f->coarse[set];
    leaf_file *coarse = NULL;
    status st = leaf_file_open_part(m, f, part->offset, part->bytes, &coarse);
    if (st == ST_OK && !stands_for(coarse, f, part))
        st = status_describe(
            ST_CORRUPT, "%s: expected the grid %016llx%016llx, found %016llx%016llx of kind %u",
            file_path(coarse->source), (unsigned long long)part->id[1],
            (unsigned long long)part->id[0], (unsigned long long)coarse->header.id[1],
            (unsigned long long)coarse->header.id[0], coarse->header.kind);
    if (st != ST_OK) {
        leaf_file_close(coarse);
        return st;
    }
    coarse->stands_in = true;
    *out = coarse;
    return ST_OK;
}
