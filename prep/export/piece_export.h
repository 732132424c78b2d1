/* piece_export.h - all pieces of a source into one file: welded, out of core.
 *
 * Two passes: the first counts, and finds out which vertices of several pieces are the same
 * (weld.h); the second makes the pieces again and writes each to its place. To standard output the
 * second goes by once for each array of the format.
 */
#ifndef PREP_EXPORT_PIECE_EXPORT_H
#define PREP_EXPORT_PIECE_EXPORT_H

#include "formats/base/progress.h"
#include "prep/export/piece_format.h"

typedef struct piece_export {
    const piece_source *source;
    const piece_format *format;
    const char *path;   /* "-": standard output */
    const char *beside; /* the path beside which scratch files may be */
    bool force;
    int threads; /* as many as the source is for */
    const progress *p;
} piece_export;

/* piece_export_run() - info: its vertices and cells are set. The file's bytes depend on neither
 * threads nor m's limit. */
CHECKED status piece_export_run(mem *m, const piece_export *e, piece_info *info);

#endif
