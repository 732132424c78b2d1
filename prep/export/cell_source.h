/* cell_source.h - pieces that are made of treelets of cells by several threads: a piece for each
 * treelet, or for each isovalue and each treelet that has its surface.
 */
#ifndef PREP_EXPORT_CELL_SOURCE_H
#define PREP_EXPORT_CELL_SOURCE_H

#include "prep/export/cell_choice.h"
#include "prep/export/piece.h"

/* How pieces of a kind are made. */
typedef struct cell_source_kind {
    size_t bench; /* bytes of what a thread has to make them with, zero at first */
    status (*create)(mem *m, const cell_choice *choice, void *bench);
    void (*release)(void *bench); /* also if create() has failed */
    /* Fill a piece, which has begun. Normals of a surface may have any length. */
    status (*make)(void *bench, uint32_t treelet, piece *p);
    bool flat; /* without isovalues its cells are triangles */
} cell_source_kind;

/* cell_source_create() - release *out. isovalues: count of them, for surfaces of the choice's first
 * field, ordered by isovalue, then by treelet; count 0: its cells, of all treelets. choice and
 * isovalues must outlive it. */
CHECKED status cell_source_create(mem *m, const cell_source_kind *kind, const cell_choice *choice,
                                  const double *isovalues, uint32_t count, int threads,
                                  piece_source *out);

#endif
