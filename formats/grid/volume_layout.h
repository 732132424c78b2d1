/* volume_layout.h - what a header says about a volume: its grid, and where and how the samples are
 * stored.
 *
 * Each format's reader fills one in; volume.c streams the samples from it, the same way for all.
 */
#ifndef FORMATS_GRID_VOLUME_LAYOUT_H
#define FORMATS_GRID_VOLUME_LAYOUT_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/input/byte_stream.h"

typedef enum volume_encoding { VOLUME_RAW, VOLUME_DEFLATE, VOLUME_TEXT } volume_encoding;

typedef struct volume_layout {
    mem *m;
    char *path; /* of the input, "-" for standard input: NRRD's header, say; owned */
    grid g;
    volume_encoding encoding;
    bool big_endian;       /* of samples wider than a byte; VOLUME_TEXT has none */
    uint64_t skip_decoded; /* VOLUME_DEFLATE: decompressed bytes in front of the samples */
    byte_stream *data;     /* at the first byte of the encoded samples; owned */
} volume_layout;

void volume_layout_release(volume_layout *l);

/* volume_layout_open() - replace l->data by the file `name`; a relative one is looked for beside
 * the header's file (header: its path). */
CHECKED status volume_layout_open(volume_layout *l, const char *header, const char *name);

/* volume_layout_skip() - move l->data on to the samples: behind `lines` lines, then `bytes` bytes;
 * bytes = -1 - n: so that the samples end n bytes before the file does (raw files only). In
 * decompressed data for VOLUME_DEFLATE (bytes >= 0). */
CHECKED status volume_layout_skip(volume_layout *l, uint64_t lines, int64_t bytes);

/* volume_layout_check() - the grid is sound (grid_check()) and what is left of l->data can hold its
 * samples, before anybody allocates for them. */
CHECKED status volume_layout_check(const volume_layout *l);

/* volume_layout_place() - to_world from spacings, unit or longer direction vectors (direction[a]:
 * of axis a) and the position of node (0, 0, 0). */
void volume_layout_place(volume_layout *l, double direction[3][3], const double spacing[3],
                         const double origin[3]);

#endif
