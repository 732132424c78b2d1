/* piece_export.h - writes all pieces of a source into one file: welded, out of core.
 *
 * The first pass counts, and finds which vertices of several pieces are the same (weld.h). The
 * second pass makes the pieces again and writes each to its place. On standard output the second
 * pass is repeated for each array of the format.
 */
#ifndef PREP_EXPORT_PIECE_EXPORT_H
#define PREP_EXPORT_PIECE_EXPORT_H

#include "formats/base/progress.h"
#include "prep/export/piece_format.h"

typedef struct piece_export {
    const piece_source *source;
    const piece_format *format;
    const char *path;   /* "-": standard output */
    const char *beside; /* path beside which scratch files may lie */
    bool force;
    int threads; /* as many as the source was made for */
    const progress *p;
} piece_export;

/* piece_export_run() - sets vertices and cells of info. The file's bytes depend on neither threads
 * nor m's limit. */
CHECKED status piece_export_run(mem *m, const piece_export *e, piece_info *info);

#endif
