/* grid.h - a regular or rectilinear grid of samples: sizes, sample type, where its nodes lie.
 *
 * Nodes (i, j, k) hold samples, x fastest; cells lie between eight nodes. Two spaces:
 *   grid space   regular: node (i, j, k) at (i, j, k);
 *                rectilinear: at (axis[0][i], axis[1][j], axis[2][k])
 *   world space  world = to_world * (grid, 1): it alone holds spacings (also negative),
 *                directions and origin
 */
#ifndef FORMATS_GRID_GRID_H
#define FORMATS_GRID_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/base/world_frame.h"
#include "formats/grid/absent.h"

enum {
    GRID_NAME_MAX = 64,
    GRID_NOTE_MAX = 320,
    GRID_PLACE_MAX = 192,
    GRID_FIELDS_MAX = 2048,
    GRID_DIM_MAX = 1 << 20
};

typedef struct grid {
    uint32_t dims[3];      /* nodes per axis, each 2 .. GRID_DIM_MAX */
    sample_type type;      /* type of the samples that are read */
    sample_type source;    /* type in the input where it differs; else 0 */
    double to_world[3][4]; /* row-major affine map, grid space to world space; invertible */
    double *axis[3]; /* rectilinear: dims[a] strictly increasing coordinates; all three NULL for a
                        regular grid */
    char name[GRID_NAME_MAX];
    bool heights;        /* a height field, one layer of cells thick: heights_slices.h */
    bool terrain;        /* its one slice is elevations: to be made a height field */
    world_frame frame;   /* which way the world's axes point, and their units */
    absent_parts absent; /* how many samples its file lacks */
    bool has_missing;    /* of an importer: samples that are `missing` stand for no data */
    double missing;
    char note[GRID_NOTE_MAX];     /* what its file says but the reader did not apply; "": nothing */
    char place[GRID_PLACE_MAX];   /* of an importer: where the samples lie in its input as they are,
                                     sample_place_print(); "": nowhere */
    char fields[GRID_FIELDS_MAX]; /* of an importer: what can be read of its input, the JSON of its
                                     --list, where that is short; "": not told */
} grid;

/* grid_init() - set up a regular grid with unit spacing at the origin. */
void grid_init(grid *g, const uint32_t dims[3], sample_type type);

/* grid_set_axis() - make the grid rectilinear: copy coordinates[dims[a]] of one axis. Axes that are
 * not set become 0, 1, 2, ... Coordinates must be finite and strictly increasing or strictly
 * decreasing: else ST_CORRUPT, naming `what` and the first bad index. Decreasing ones are stored
 * negated, and column a of to_world is negated with them: so axis[] always increases, no sample
 * moves, and every node keeps its place in the world. Set to_world first; set an axis once. On
 * ST_NOMEM, grid_release() as always. */
CHECKED status grid_set_axis(grid *g, mem *m, const char *what, int a, const double *coordinates);

/* grid_set_axis_text() - the same from a text with exactly dims[a] numbers, split by blanks, line
 * ends or commas; `what` names the source. The axis's column of to_world stays and scales the
 * coordinates. To replace a spacing by coordinates, make the column a unit vector before. */
CHECKED status grid_set_axis_text(grid *g, mem *m, const char *what, int a, const char *text);

/* grid_check() - check that dims are in range and the place is sound (leaf_place.h). ST_CORRUPT or
 * ST_UNSUPPORTED, naming `what`. Every importer ends with it. One slice alone passes: it may be a
 * height field. grid_check_volume() - the same, and refuse one slice. */
CHECKED status grid_check(const grid *g, const char *what);
CHECKED status grid_check_volume(const grid *g, const char *what);

bool grid_is_rectilinear(const grid *g);
sample_type grid_source(const grid *g);   /* returns the type of the input's samples */
uint64_t grid_samples(const grid *g);     /* returns dims[0] * dims[1] * dims[2] */
uint64_t grid_slice_bytes(const grid *g); /* returns the bytes of one z slice of g->type */

/* grid_release() - free the axes. */
void grid_release(grid *g, mem *m);

#endif
