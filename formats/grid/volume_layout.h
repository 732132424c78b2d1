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
#include "formats/grid/sample_order.h"
#include "formats/grid/stored_samples.h"
#include "formats/grid/volume_hints.h"
#include "formats/input/byte_stream.h"
#include "formats/input/unpack_stream.h"

typedef enum volume_encoding {
    VOLUME_RAW,
    VOLUME_DEFLATE,
    VOLUME_BZIP2,
    VOLUME_TEXT
} volume_encoding;

typedef struct volume_layout {
    mem *m;
    char *path; /* of the input, "-" for standard input: NRRD's header, say; owned */
    grid g;     /* but for its type and source, which volume_layout_settle() sets */
    stored_samples stored;
    volume_encoding encoding;
    bool big_endian;           /* of numbers wider than a byte; VOLUME_TEXT has none */
    bool ordered;              /* the samples lie in an order of their own: */
    uint8_t order[ORDER_AXES]; /* its axes, the fastest first */
    uint32_t steps;            /* of time, one behind the other where `ordered` is not; 0: 1 */
    uint32_t step;             /* the one to take */
    bool all_steps;            /* and those behind it, one after the other */
    double first_time;         /* of step 0, and from one to the next; 0: untold */
    double time_step;
    uint64_t skip_decoded; /* of packed ones: decompressed bytes in front of the samples */
    bool has_tail;         /* what is behind the samples is part of the format */
    byte_stream *data;     /* at the first byte of the encoded samples; owned */
} volume_layout;

void volume_layout_release(volume_layout *l);

/* volume_layout_open() - replace l->data by the file `name`; a relative one is looked for beside
 * the header's file (header: its path). follow_links: as named_file.h has it; true for a name that
 * follows from the header's own. open: byte_stream_open() or byte_stream_open_stored(). */
CHECKED status volume_layout_open(volume_layout *l, const char *header, const char *name,
                                  bool follow_links,
                                  status (*open)(mem *m, const char *path, byte_stream **out));

/* volume_layout_packer() - what unpacks the samples; NULL: they are not packed. */
const packer *volume_layout_packer(const volume_layout *l);

/* volume_layout_skip() - move l->data on to the samples: behind `lines` lines, then `bytes` bytes;
 * bytes = -1 - n: so that the samples end n bytes before the file does (raw files only). In
 * decompressed data for packed samples (bytes >= 0). */
CHECKED status volume_layout_skip(volume_layout *l, uint64_t lines, int64_t bytes);

/* volume_layout_settle() - apply the hints that choose among what is stored: a component, a step.
 * ST_USAGE for one that is not there. */
CHECKED status volume_layout_settle(volume_layout *l, const volume_hints *hints);

/* volume_layout_step_bytes() - of all samples of one step, as they are stored; UINT64_MAX for more.
 */
uint64_t volume_layout_step_bytes(const volume_layout *l);

/* volume_layout_check() - the grid is sound (grid_check()) and what is left of l->data can hold its
 * samples, before anybody allocates for them. */
CHECKED status volume_layout_check(const volume_layout *l);

/* volume_layout_place() - to_world from spacings, unit or longer direction vectors (direction[a]:
 * of axis a) and the position of node (0, 0, 0). */
void volume_layout_place(volume_layout *l, double direction[3][3], const double spacing[3],
                         const double origin[3]);

#endif
