/* transfer_file.h - transfer functions and colour maps from files, and ours written.
 *
 * Our own form is text, a point a line, linear colours and extinctions per world length:
 *
 *   # value  red green blue  extinction
 *   40       0.9 0.6 0.4     0
 *   80       0.9 0.6 0.4     0.02
 *   80       1   1   1       0.5
 *
 * Blanks, tabs or commas divide numbers; # begins a comment; values do not fall, and two points at
 * one value are a step, at which the second holds. ParaView's colour maps are read as well
 * (paraview_map.h). A file is told by what it begins with, not by its name; it may be packed.
 */
#ifndef RENDER_APP_TRANSFER_FILE_H
#define RENDER_APP_TRANSFER_FILE_H

#include <stdio.h>

#include "render/app/transfer_list.h"

/* Start with all zeros. */
typedef struct transfer_file {
    transfer_list colours;
    transfer_list extinctions; /* without points: the file has colours alone */
    bool per_length; /* extinctions are per world length; else they are those of ParaView's
                        opacities over a length of 1 */
} transfer_file;

/* transfer_file_read() - "FILE", or "FILE#NAME": one of the maps of a file. ST_CORRUPT and
 * ST_UNSUPPORTED with file, line or point, and what was expected; ST_USAGE where it is not clear
 * which map is meant; ST_IO, ST_NOMEM. transfer_file_release() in any case. */
CHECKED status transfer_file_read(mem *m, const char *path, transfer_file *out);
void transfer_file_release(transfer_file *t);

/* transfer_file_print() - points in our own form; read again, they have the same bits. */
void transfer_file_print(const leafcast_transfer_point *points, size_t count, FILE *out);

#endif
