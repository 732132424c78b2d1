/* tet_pieces.h - a mesh as it is, treelet by treelet: its points, tets and values.
 *
 * The file does not say which vertices of two treelets are one. Vertices count as one if their
 * coordinates and their values of the chosen fields are equal. Tets are turned so that their volume
 * is positive.
 */
#ifndef PREP_EXPORT_TET_PIECES_H
#define PREP_EXPORT_TET_PIECES_H

#include "prep/export/piece.h"
#include "prep/export/tet_bench.h"

typedef struct tet_pieces tet_pieces;

/* tet_pieces_create() - choice must outlive it. */
CHECKED status tet_pieces_create(mem *m, const tet_choice *choice, int threads, tet_pieces **out);
void tet_pieces_destroy(tet_pieces *s); /* NULL is fine */

piece_source tet_pieces_source(tet_pieces *s);

#endif
