/* export_kind.h - how the verb export writes files of one kind of geometry: a row each, for
 * export_main.c. */
#ifndef PREP_EXPORT_EXPORT_KIND_H
#define PREP_EXPORT_EXPORT_KIND_H

#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_tell.h"
#include "prep/export/export_request.h"
#include "prep/export/piece.h"

typedef struct export_kind {
    const leaf_geometry *of; /* NULL: all whose cells are hexahedra */
    const leaf_teller *told; /* not NULL: of these alone */
    /* Write the samples of a lattice, and report. NULL: it has none. */
    status (*samples)(export_request *a, mem *m, leaf_file *f, double start);
    /* Write isosurfaces, or its cells if a->pieces->solid. */
    status (*pieces)(export_request *a, mem *m, leaf_file *f, piece_info *info);
    const char *cells;   /* what they are called; NULL: they cannot be written */
    const char *instead; /* advice where a format cannot hold it */
    bool given;          /* a surface by itself: pieces() writes its triangles, as they are */
} export_kind;

#endif
