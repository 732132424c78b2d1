/* leaf_geometry.h - what a kind of geometry decides about a treelet file: one table of functions
 * each.
 *
 * The container is header, section table, directory and payloads. A table says what a kind adds to
 * what all files have. Adding a kind adds a file with its table, and a line in
 * leaf_geometries.c.
 */
#ifndef FORMATS_LEAF_LEAF_GEOMETRY_H
#define FORMATS_LEAF_LEAF_GEOMETRY_H

#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_file.h"

enum { LEAF_PARTS_MAX = 3 };

typedef struct leaf_row {
    uint32_t first, width;
} leaf_row;
enum { LEAF_ROWS_MAX = 2 };

/* How files of a kind grow by segments (SERIES.md 4). */
typedef struct leaf_growth {
    /* Whether a file that is no segment may become the first one; else *why not. */
    bool (*may)(const leaf_header *h, const char **why);
    /* Whether a later segment's cells are those of the first one, as their sections tell. Their
     * headers' are the same already. */
    bool (*alike)(const leaf_file *first, const leaf_file *part);
    /* Give the layout of a segment so many steps. False: that makes too many payloads. */
    bool (*repeat)(leaf_layout *l, uint32_t steps);
    /* The payloads of each set, in rows: in row i, those of set s are `width` from payload `first`
     * + s * width on. Payloads before all rows belong to no set: a later segment has those of the
     * first one. Returns how many rows there are. */
    int (*rows)(const leaf_layout *l, leaf_row rows[LEAF_ROWS_MAX]);
} leaf_growth;

/* What one thread has to check treelets with (leaf_verify.h). */
typedef struct leaf_verifying leaf_verifying;
struct leaf_verifying {
    leaf_file *f;
    char *room; /* leaf_verifier.room() bytes, 64-byte aligned */
    /* For histograms: `count` cells of each set, set after set; NULL: the file has none. */
    histogram_cell *cells;
    size_t count;
    struct leaf_unpacker *unpacker;
    /* leaf_file_load() of payload p. */
    status (*load)(const leaf_verifying *v, uint32_t p, void *payload);
};

/* How the treelets of a kind are checked, whose sets share payloads: one after the other, with all
 * of its payloads. */
typedef struct leaf_verifier {
    const char *drawn;                     /* what its histograms count: "tets" */
    uint64_t (*cells)(const leaf_file *f); /* of the whole file: histograms draw from these */
    size_t (*room)(const leaf_file *f);
    /* Check all payloads of a treelet. Add the values that are not finite, in all sets, to
     * *non_finite: treelets share nodes, of which a file counts each once. Measure the cells that
     * histograms draw. */
    status (*treelet)(const leaf_verifying *v, uint32_t treelet, uint64_t *non_finite);
} leaf_verifier;

typedef struct leaf_geometry {
    bool holds_indices;             /* result of leaf_file_holds_indices() */
    const struct leaf_cells *cells; /* what a cell's record is (leaf_cells.h); NULL: no records */
    const struct leaf_blending *blending; /* NULL: no times between its steps (leaf_between.h) */
    const leaf_growth *growth;            /* NULL: a file of it has no segments */
    bool coarse;                          /* sets may have coarse grids: section COARSE */
    bool has_map; /* to_world is meaningful, so section WORLD may name its axes */

    /* ---- The header: parts of leaf_check_header() and leaf_check_layout() ---- */

    /* check_parameters(): fields that say how the file is made. check_values(): fields that say
     * what is in it, and to_world. check_rest(): the rest of the page, from header.tets on. */
    status (*check_parameters)(const char *path, const leaf_header *h);
    status (*check_values)(const char *path, const leaf_header *h);
    status (*check_rest)(const char *path, const leaf_header *h);
    status (*check_layout)(const char *path, const leaf_header *h, leaf_layout *l);

    /* ---- The directory ---- */

    /* sets(): elements per treelet of RANGES, OWN, FLAGS. payloads(): elements of OFFSETS, SIZES,
     * CHECKSUMS. section_bytes(): the size of a section of this geometry's own; 0: it has none of
     * that kind. */
    uint64_t (*sets)(const leaf_header *h);
    uint64_t (*payloads)(const leaf_header *h);
    /* Whether sections FIELDS and TIMES are allowed. */
    bool (*labels)(const leaf_header *h);
    uint64_t (*section_bytes)(const leaf_header *h, uint32_t kind);
    /* allocate(): make room for what the directory has in addition. section(): where to read one of
     * its own sections to; NULL: nowhere. release(): free the room, if any. */
    status (*allocate)(leaf_file *f);
    void *(*section)(const leaf_file *f, uint32_t kind);
    void (*release)(leaf_file *f);
    /* Called when all sections have been read: check its own, and make f->layout. d: in and out; at
     * and end are set, and what leaf_check_directory() needs in addition is to be added. */
    status (*lay_out)(leaf_file *f, leaf_directory *d);
    /* The part of leaf_check_directory() after payloads: ranges, flags, sections of its own. */
    status (*check_directory)(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d);

    /* ---- Payloads, see leaf_layout.h ---- */

    uint32_t (*payload_bytes)(const leaf_layout *l, uint32_t p);
    bool (*begins_run)(const leaf_layout *l, uint32_t p);
    leaf_series (*series)(const leaf_layout *l, uint32_t p);
    const char *(*payload_name)(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]);
    /* List the payloads that hold a treelet's cells and values in a set. Returns how many. */
    int (*parts)(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads[LEAF_PARTS_MAX]);

    /* How payloads are turned into streams for a compressor; NULL: not at all. Of a kind whose
     * section BOUNDS is float[6] of each treelet, those of the first step first. */
    const struct leaf_coder *coder;

    /* How its treelets have nodes, and cells between these (hex_treelet.h); NULL: otherwise. */
    const struct leaf_noded *noded;

    const leaf_verifier *verifier; /* NULL: leaf_verify.c goes set by set, as of a grid */

    /* Payloads without bytes, which follow from the directory. may_be_empty(): whether the
     * directory allows payload p to be one; *must: and nothing else. implies(): whether this
     * payload of a treelet is one. imply(): write its bytes. All three NULL: there are none. */
    bool (*may_be_empty)(const leaf_layout *l, uint32_t p, const leaf_directory *d, bool *must);
    bool (*implies)(const leaf_layout *l, uint32_t p, const float own[2], uint8_t flags,
                    const void *payload);
    void (*imply)(const leaf_layout *l, uint32_t p, const float own[2], void *payload);
} leaf_geometry;

/* leaf_geometry_of() - the table of a leaf_kind; NULL: this program does not know the kind. */
const leaf_geometry *leaf_geometry_of(uint32_t kind);

#endif
