/* volume_layout.h - a volume's header: its grid, and where and how the samples are stored.
 *
 * Each format's reader fills one in. volume.c streams the samples from it in the same way for all.
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
    char *path; /* path of the input, "-" for standard input: NRRD's header, say; owned */
    grid g;     /* without type and source, which volume_layout_settle() sets */
    stored_samples stored;
    volume_encoding encoding;
    bool big_endian;           /* for numbers wider than a byte; VOLUME_TEXT has none */
    bool ordered;              /* the samples lie in an order of their own */
    uint8_t order[ORDER_AXES]; /* the axes of that order, the fastest first */
    uint32_t steps;            /* time steps, one behind the other unless `ordered`; 0: 1 */
    uint32_t step;             /* the step to take */
    bool all_steps;            /* later steps follow, one after the other */
    double first_time;         /* time of step 0, and from step to step; 0: unknown */
    double time_step;
    uint64_t skip_decoded; /* packed samples: decompressed bytes in front of them */
    bool has_missing;      /* `missing` stands for no data, as volume_hints.missing */
    double missing;
    bool has_tail;     /* the format has a part behind the samples */
    byte_stream *data; /* at the first byte of the encoded samples; owned */
} volume_layout;

void volume_layout_release(volume_layout *l);

/* volume_layout_open() - replace l->data by the file `name`; a relative name is looked for beside
 * the header's file (header: its path). follow_links: as in named_file.h; true for a name that
 * follows from the header's own. open: byte_stream_open() or byte_stream_open_stored(). */
CHECKED status volume_layout_open(volume_layout *l, const char *header, const char *name,
                                  bool follow_links,
                                  status (*open)(mem *m, const char *path, byte_stream **out));

/* volume_layout_packer() - returns what unpacks the samples; NULL: they are not packed. */
const packer *volume_layout_packer(const volume_layout *l);

/* volume_layout_skip() - move l->data to the samples: skip `lines` lines, then `bytes` bytes. bytes
 * = -1 - n: the samples end n bytes before the file does (raw files only). For packed samples,
 * bytes count in the decompressed data (bytes >= 0). */
CHECKED status volume_layout_skip(volume_layout *l, uint64_t lines, int64_t bytes);

/* volume_layout_settle() - apply the hints that choose among what is stored: a component, a step.
 * ST_USAGE if it is not there. */
CHECKED status volume_layout_settle(volume_layout *l, const volume_hints *hints);

/* volume_layout_step_bytes() - returns the stored bytes of all samples of one step, at most
 * UINT64_MAX. */
uint64_t volume_layout_step_bytes(const volume_layout *l);

/* volume_layout_check() - check that the grid is sound (grid_check()), and that the rest of l->data
 * is long enough for its samples. Call it before anything is allocated for them. */
CHECKED status volume_layout_check(const volume_layout *l);

/* volume_layout_place() - set to_world from spacings, direction vectors of any length
 * (direction[a]: of axis a) and the position of node (0, 0, 0). */
void volume_layout_place(volume_layout *l, double direction[3][3], const double spacing[3],
                         const double origin[3]);

#endif
