/* transfer_file.h - read transfer functions and colour maps from files, and write our own form.
 *
 * Our own form is text, one point per line, with linear colours and extinctions per world length:
 *
 *   # value red green blue extinction
 *   40       0.9 0.6 0.4 0
 *   80       0.9 0.6 0.4 0.02
 *   80       1 1 1 0.5
 *
 * Blanks, tabs or commas separate numbers; # begins a comment. Values do not fall; two points at
 * one value are a step, at which the second counts. ParaView's colour maps are read as well
 * (paraview_map.h). The form of a file is recognised by its first byte, not by its name. Files may
 * be compressed.
 */
#ifndef RENDER_APP_TRANSFER_FILE_H
#define RENDER_APP_TRANSFER_FILE_H

#include <stdio.h>

#include "render/app/transfer_list.h"

/* Start with all zeros. */
typedef struct transfer_file {
    transfer_list colours;
    transfer_list extinctions; /* empty: the file has colours alone */
    bool per_length; /* extinctions are per world length; false: made from ParaView's opacities,
                        over a length of 1 */
} transfer_file;

/* transfer_file_read() - read "FILE", or "FILE#NAME": one of the maps of a file. ST_CORRUPT and
 * ST_UNSUPPORTED name the file, the line or point, and what was expected; ST_USAGE if it is unclear
 * which map is meant; ST_IO, ST_NOMEM. Call transfer_file_release() in any case. */
CHECKED status transfer_file_read(mem *m, const char *path, transfer_file *out);
void transfer_file_release(transfer_file *t);

/* transfer_file_print() - print points in our own form; reading it gives the same bits again. */
void transfer_file_print(const leafcast_transfer_point *points, size_t count, FILE *out);

#endif
