/* leaf_file.h - open a treelet file: everything but the payloads, checked and in memory.
 *
 * leaf_file_open() validates the header, the directory and every offset and size against the file's
 * length, so users need no checks of their own. Immutable afterwards: any thread may read it.
 * leaf_file_load() (leaf_unpacker.h) checks payload bytes.
 */
#ifndef FORMATS_LEAF_LEAF_FILE_H
#define FORMATS_LEAF_LEAF_FILE_H

#include <stdbool.h>

#include "formats/base/file_mark.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf.h"
#include "formats/leaf/leaf_layout.h"

/* What the directory of a mesh has in addition; an element per treelet. */
typedef struct mesh_directory {
    float (*bounds)[6];    /* lo x y z, hi x y z; where vertices move an element step * treelets +
                              treelet (leaf_layout_bounds()), so that step 0 comes first */
    uint32_t (*counts)[4]; /* for mesh_leaf_shape() */
    uint64_t *first_tet;   /* treelets + 1: number of a treelet's first tet in the whole mesh */
} mesh_directory;

/* A part of a growing file with steps of its own (SERIES.md 4). */
typedef struct leaf_segment {
    uint64_t base; /* where its header lies */
    uint32_t first, steps;
    uint64_t id[2];
} leaf_segment;

typedef struct leaf_file {
    leaf_header header; /* of several segments: steps, sizes and what is said of values as of one
                           file, the id of the last one */
    const struct leaf_geometry *geometry; /* the functions of its kind */
    char name[64]; /* for display: the header's name, or the file's own without its suffix */
    leaf_layout layout;
    /* The directory. ranges, own, flags: an element set * treelets + treelet. offsets, sizes,
     * checksums: an element per payload (leaf_layout_samples(), leaf_layout_values()). */
    float (*ranges)[2]; /* merged */
    float (*own)[2];
    uint8_t *flags;
    uint64_t *offsets;
    uint64_t *sizes;
    uint64_t *checksums;
    leaf_links links;       /* from payloads to those of earlier sets */
    leaf_segment *segments; /* header.segments of them, ascending; NULL: it does not grow */
    uint64_t first_id[2];   /* id of the first header */
    /* Level-0 node coordinates in grid space, never NULL (0, 1, 2, ... for a regular grid). */
    double *axis[3];
    char (*names)[64];          /* per field; without FIELDS the first is the header's, others "" */
    double *times;              /* per step; without TIMES 0, 1, 2 .. */
    bool has_times;             /* section TIMES was there */
    mesh_directory *mesh;       /* NULL: not a mesh */
    leaf_outside *outside;      /* section OUTSIDE of a grid, or NULL; */
    struct chunk_entry *chunks; /* section CHUNKS, or NULL; */
    struct slice_file *slices;  /* section SLICES, or NULL */
    struct outside_samples *samples; /* and the files that they name */
    struct live_samples *live;       /* of a grid that changes in memory (leaf_live.h), or NULL; */
    uint64_t *versions;              /* and per set: how often it has changed */
    /* Of triangles that move in memory (stream/moving_surface.h), or NULL: */
    struct moving_surface *moving;
    float (*step_bounds)[6]; /* and the box at each step, instead of the header's */
    /* Of one that lies between the steps of another (leaf_between.h), else NULL: that one, and what
     * its sets are. */
    struct leaf_file *below;
    bool owns_below; /* the other one is closed with it */
    struct leaf_between *between;
    leaf_part *coarse;     /* per set; NULL: without section COARSE */
    bool stands_in;        /* it is a coarse grid of another file */
    void *besides;         /* what the directory of another kind has in addition */
    histogram *histograms; /* per set; NULL: the file has none */
    world_frame frame;     /* what the world's axes mean; zeros: the file does not say */
    uint16_t *deviations;  /* codes (deviation.h) of the coarse treelets' bricks; NULL: the file has
                              none */
    file *source;
    file_mark mark; /* of the file, or of the whole file if this is a part, when it was opened; all
                       0 for bytes in memory */
    mem *m;
    uint64_t directory_bytes; /* in the file: header, section table, sections */
    uint64_t directory_end;   /* where the sections end */
    uint64_t payloads_end;    /* where the last run of payloads, or the directory behind it, ends */
} leaf_file;

/* leaf_file_open() - ST_CORRUPT names file, byte and what was expected. A file whose samples lie in
 * another one opens that, too. A growing file has the segments that are there now. */
CHECKED status leaf_file_open(mem *m, const char *path, leaf_file **out);

/* leaf_file_open_memory() - open the bytes of a file. They stay the caller's, and must not change
 * until it is closed. name: used as its path. Any alignment. */
CHECKED status leaf_file_open_memory(mem *m, const char *name, const void *bytes, size_t size,
                                     leaf_file **out);
void leaf_file_close(leaf_file *f); /* NULL is fine */

/* leaf_file_open_as() - the same of a file that is about to get the name `as`. */
CHECKED status leaf_file_open_as(mem *m, const char *path, const char *as, leaf_file **out);

/* leaf_file_open_part() - open bytes [offset, offset + bytes) of f's file as a treelet file of its
 * own. leaf_file_open_segment() - open segment i of f alone: what leads to earlier segments leads
 * nowhere. For checks. leaf_file_join() - make a file of all its segments of a growing one, of
 * which the first is open; for leaf_file.c. */
CHECKED status leaf_file_open_part(mem *m, const leaf_file *f, uint64_t offset, uint64_t bytes,
                                   leaf_file **out);
CHECKED status leaf_file_open_segment(mem *m, const leaf_file *f, const leaf_segment *s,
                                      leaf_file **out);
CHECKED status leaf_file_join(leaf_file *f);

/* leaf_file_open_first() - the same as leaf_file_open() of a file that is about to get another
 * first header. */
CHECKED status leaf_file_open_first(mem *m, const char *path, const leaf_header *first,
                                    leaf_file **out);

/* leaf_file_newer() - open the file of f anew if segments were added to it since f was opened:
 * *out, the caller's to close. NULL: none were, or f's bytes are in memory. Changes nothing in f.
 * ST_CORRUPT where the file is no longer what f was opened from with more behind it, or is damaged.
 * leaf_file_exchange() - exchange what later segments add to a file: sets, steps and what is said
 * of them. All else of f stays where it is in memory. Calling it again undoes it. */
CHECKED status leaf_file_newer(const leaf_file *f, leaf_file **out);
void leaf_file_exchange(leaf_file *f, leaf_file *newer);

/* leaf_file_allocate_changing() - make the directory's arrays, all zero, of a file that never was
 * one: its header and layout are there; its sets change (versions). On failure some are there:
 * leaf_file_close(). */
CHECKED status leaf_file_allocate_changing(leaf_file *f);

/* leaf_file_number() - the number that a set has in entries of SAME and BASES of later segments.
 * leaf_file_numbered() - the set of that number.
 * leaf_file_segment_sets() - how many sets the segment has that a set is in; of a file without
 * segments all. */
uint32_t leaf_file_number(const leaf_file *f, uint32_t set);
uint32_t leaf_file_numbered(const leaf_file *f, uint32_t number);
uint32_t leaf_file_segment_sets(const leaf_file *f, uint32_t set);

/* leaf_file_changed() - ST_CORRUPT if the file, or the one its samples lie in, has changed since it
 * was opened. That it has grown is no change. */
CHECKED status leaf_file_changed(const leaf_file *f);

/* leaf_file_has_coarse() - whether f has a coarse grid of a set.
 * leaf_file_open_coarse() - open it: a treelet file like any other, which may outlive f. It is of
 * kind grid, or else of f's kind with one set, and may have a coarse grid of kind grid then.
 * Messages call it F.leaf (from byte N), and count its bytes from there. ST_CORRUPT also where it
 * is not the file that the directory names. */
bool leaf_file_has_coarse(const leaf_file *f, uint32_t set);
CHECKED status leaf_file_open_coarse(mem *m, const leaf_file *f, uint32_t set, leaf_file **out);

/* leaf_file_is_raw() - whether payload p is stored as it is: always with the raw codec; with a
 * compressed one, payloads of meshes that would not have become smaller. */
bool leaf_file_is_raw(const leaf_file *f, uint32_t p);

/* leaf_file_has_bytes() - whether payload p has bytes in the file. Of others:
 * leaf_file_is_outside() - whether its samples lie in another file (outside_samples.h);
 * leaf_file_is_bare() - whether it is of a treelet that has no samples (leaf_layout_is_bare());
 * leaf_file_is_implied() - whether it follows from the directory (implied_payload.h). */
bool leaf_file_has_bytes(const leaf_file *f, uint32_t p);
bool leaf_file_is_outside(const leaf_file *f, uint32_t p);
bool leaf_file_is_bare(const leaf_file *f, uint32_t p);
bool leaf_file_is_implied(const leaf_file *f, uint32_t p);

/* leaf_file_stores() - the file that has the payloads of f: f itself, or the one below. */
static inline leaf_file *leaf_file_stores(leaf_file *f) {
    return f->below ? f->below : f;
}

/* leaf_file_bounds() - the box of a file without a map (mesh, triangles, ..): at all steps, or
 * where it changes in memory at this one. */
static inline const float *leaf_file_bounds(const leaf_file *f, uint32_t step) {
    return f->step_bounds ? f->step_bounds[step] : f->header.bounds;
}

/* leaf_file_same() - whether payloads p and q, which hold the same of a treelet in two sets, are
 * the same, as far as the directory tells. */
bool leaf_file_same(const leaf_file *f, uint32_t p, uint32_t q);

/* leaf_file_home() - leaf_layout_home(). leaf_file_chain() - leaf_layout_chain().
 * leaf_file_is_home() - whether payload p has bytes in the file, and is the first to have these.
 * leaf_file_stored() - the bytes of the codes that payload p's samples need; 0: none. */
uint32_t leaf_file_home(const leaf_file *f, uint32_t p);
static inline bool leaf_file_is_home(const leaf_file *f, uint32_t p) {
    return f->sizes[p] > 0 && !(f->links.same && f->links.same[p]);
}
int leaf_file_chain(const leaf_file *f, uint32_t p, uint32_t chain[LEAF_CHAIN_MAX]);
uint64_t leaf_file_stored(const leaf_file *f, uint32_t p);

/* leaf_file_check_level() - ST_USAGE, with the reason, if f has no samples of a level of detail. */
CHECKED status leaf_file_check_level(const leaf_file *f, uint32_t level);

/* leaf_file_fetch() - read payload p's stored bytes, and check them. */
CHECKED status leaf_file_fetch(leaf_file *f, uint32_t p, void *stored);

/* leaf_file_check() - check the bytes of payload p, which are in memory already (a mapping).
 * Thread-safe. */
CHECKED status leaf_file_check(const leaf_file *f, uint32_t p, const void *stored);

/* leaf_file_holds_indices() - whether payloads hold indices or offsets. Such bytes must be copied
 * before they are checked and used, as another process may write to the file meanwhile. */
bool leaf_file_holds_indices(const leaf_file *f);

/* leaf_file_field_name() - a field's name; "" where it has none.
 * leaf_file_step_time() - a step's time in the units of the input; its number where there are no
 * times. */
const char *leaf_file_field_name(const leaf_file *f, uint32_t field);
double leaf_file_step_time(const leaf_file *f, uint32_t step);

/* leaf_file_find_field() - the field of a name, or of a number. ST_USAGE where there is none such.
 */
CHECKED status leaf_file_find_field(const leaf_file *f, const char *name, uint32_t *field);

#endif
