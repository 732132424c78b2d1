/* leaf.h - the treelet file, byte for byte; FORMAT.md says the same in words.
 *
 *   0                  header page, LEAF_HEADER_BYTES
 *   LEAF_HEADER_BYTES  section table: header.sections entries of 32 bytes
 *   ...                directory sections, each at a multiple of 64; of a file of several sets,
 * table and sections lie behind the payloads, at header.directory
 *   ...                payload runs, each at a multiple of 2^run_align_log2: the payloads of one
 *                      family of siblings (grid), or of one block (mesh: all topologies, all
 *                      values of one set, ..), each at a multiple of 64 inside the run; of a
 *                      compressed grid without gaps
 *   ...                parts (mesh: leaf_part)
 *
 * All little endian. Everything not named is zero, and checked to be.
 *
 * A treelet of a grid is a block of up to B^3 cells (B = 2^cells_log2) of one level of detail. It
 * has the samples at their nodes, h more samples on every side, and the codes of the min/max
 * kd-tree over it (M08 4.3, 4.4). Levels count from 0 = full resolution.
 *
 * A treelet of a tetrahedral mesh is a subtree of the bounding volume hierarchy over its tets, with
 * the tets and their vertices (W07 5). It has one payload of topology, and one of values for each
 * set (a field at a time step). Then, where the file has them, come one of gradients for each set,
 * and one of positions for each step but the first. mesh_leaf.h describes these payloads.
 */
#ifndef FORMATS_LEAF_LEAF_H
#define FORMATS_LEAF_LEAF_H

#include <stdint.h>
#include <stdio.h>

#include "formats/base/world_frame.h"

enum {
    LEAF_VERSION = 4,
    LEAF_HEADER_BYTES = 4096,
    LEAF_ALIGN_LOG2 = 6,
    LEAF_ALIGN = 1 << LEAF_ALIGN_LOG2, /* of sections, and of payloads inside a run */
    LEAF_BLOCK_LOG2 = 2,               /* the trees end at blocks of 4^3 cells */
    LEAF_CELLS_LOG2_MIN = 4,
    LEAF_CELLS_LOG2_MAX = 6,
    LEAF_RUN_ALIGN_LOG2_MAX = 21,
    LEAF_LEVELS_MAX = 24,
    LEAF_SECTIONS_MAX = 64,
    LEAF_TREELET_TETS_MAX = 16384, /* so that 16 bits number the vertices of any treelet */
    LEAF_LEAF_TETS_MAX = 64,
    LEAF_SETS_MAX = 65536,     /* fields, steps, and their product */
    LEAF_CHAIN_MAX = 8,        /* codes that a reader needs for one: it, its base, the base's, .. */
    LEAF_CODE_BYTES = 16,      /* of a code of boxes, before its streams (FORMAT.md 10) */
    LEAF_HISTOGRAMS_MAX = 1024 /* files of more sets have no histograms */
};

#define LEAF_MAGIC "\x89LEAF\r\n\x1a"

typedef enum leaf_kind {
    LEAF_KIND_GRID = 1,
    LEAF_KIND_MESH = 2,
    LEAF_KIND_CURVILINEAR = 3,
    LEAF_KIND_MIXED = 4,     /* hexahedra, wedges, pyramids, tets: mixed_geometry.h */
    LEAF_KIND_TRIANGLES = 5, /* a surface: triangle_geometry.h */
    LEAF_KIND_HEIGHTS = 6    /* elevations, as a grid of one layer of cells: HEIGHTS.md */
} leaf_kind;
/* With a compressed codec, a mesh's payload that would not get smaller is stored raw; its stored
 * size shows this. A grid's is always a code (FORMAT.md 10). */
typedef enum leaf_codec { LEAF_CODEC_RAW = 0, LEAF_CODEC_ZSTD = 1 } leaf_codec;

/* What a treelet's directory flags say. */
enum {
    LEAF_FLAG_NON_FINITE = 1u << 0
}; /* a NaN or inf among its own cells' samples or its vertices' values: use the NaN-aware kernel */

enum {
    LEAF_OUTSIDE_BIG_ENDIAN = 1u << 0, /* most significant byte first */
    LEAF_OUTSIDE_COLOURS = 1u << 1, /* all numbers together are their luminance, else magnitude */
    LEAF_OUTSIDE_MISSING = 1u << 2  /* `missing` stands for NaN */
};

/* Values of leaf_header.outside other than 0. */
enum {
    LEAF_IN_FILE = 1,  /* samples of level 0 lie elsewhere: section OUTSIDE */
    LEAF_IN_SLICES = 2 /* and each slice in a file of its own: SLICES, too */
};

/* How the samples of level 0 lie in other files. */
typedef enum leaf_outside_form {
    LEAF_OUTSIDE_PIECE = 0,  /* in one piece of one file */
    LEAF_OUTSIDE_FILES = 1,  /* in chunks, each a file beside the one that describes them */
    LEAF_OUTSIDE_TABLE = 2,  /* in chunks, all in one file: section CHUNKS tells where */
    LEAF_OUTSIDE_SLICES = 3, /* likewise, in the file of their slice: section SLICES */
    LEAF_OUTSIDE_FORM_LAST = 3
} leaf_outside_form;

enum {
    LEAF_CHUNKS_FORTRAN = 1u << 0, /* within a chunk the first axis is fastest, else the last */
    LEAF_CHUNKS_SLASH = 1u << 1,   /* '/' is between the indices of its name, else '.' */
    LEAF_CHUNKS_LINKS = 1u << 2,   /* chunks may lie outside of their folder */
    LEAF_CHUNKS_SUMMED = 1u << 3,  /* 4 bytes of a checksum lie behind a chunk's packed ones */
    LEAF_CHUNKS_CUT = 1u << 4      /* rows of a chunk that are not in the grid may be missing */
};

enum {
    LEAF_CHUNK_AXES = 8,
    LEAF_CHUNK_FILTERS = 8,
    LEAF_FILTER_BIG_ENDIAN = 1u << 0, /* numbers before it was applied */
    LEAF_FILTER_BIG_CODED = 1u << 1   /* numbers behind it */
};

/* clang-format off */
/* Fields that concern grids alone are 0 for a mesh, and the other way round. */
typedef struct leaf_header {   /* offset size */
    char magic[8];             /*    0    8  LEAF_MAGIC, without its NUL */
    uint32_t version;          /*    8    4  LEAF_VERSION */
    uint32_t kind;             /*   12    4  leaf_kind */
    uint32_t sample_type;      /*   16    4  sample_type, one that sample_stored() yields; mesh: f32 */
    uint32_t source_type;      /*   20    4  sample_type of the input */
    uint32_t dims[3];          /*   24   12  grid: nodes per axis of level 0 */
    uint32_t levels;           /*   36    4  grid: the coarsest fits one treelet; mesh: 1 */
    uint32_t cells_log2;       /*   40    4  grid: B = 2^cells_log2 */
    uint32_t halo;             /*   44    4  grid: h: 0 or 1 */
    uint32_t block_log2;       /*   48    4  grid: LEAF_BLOCK_LOG2 */
    uint32_t run_align_log2;   /*   52    4  12: 4096 */
    uint32_t codec;            /*   56    4  leaf_codec */
    uint32_t rectilinear;      /*   60    4  grid: 1: section AXES is there */
    uint32_t fields;           /*   64    4  section FIELDS has their names */
    uint32_t steps;            /*   68    4  section TIMES has their times */
    uint32_t sections;         /*   72    4  entries of the section table */
    uint32_t outside;          /*   76    4  grid: LEAF_IN_*, else 0 */
    uint64_t treelets;         /*   80    8  grid: of all levels; implied by dims and B */
    uint64_t payload_bytes;    /*   88    8  sum of the payloads' stored sizes */
    uint64_t file_bytes;       /*   96    8  length of the whole file */
    uint64_t non_finite;       /*  104    8  NaN and inf samples of level 0; values of a mesh */
    double value_min;          /*  112    8  over the finite samples of level 0, values of a mesh; */
    double value_max;          /*  120    8    min > max when there are none */
    double rounding_error;     /*  128    8  largest |stored - input| of level 0; may be inf */
    double to_world[12];       /*  136   96  3x4 row-major, grid space to world space; mesh: identity */
    uint64_t id[2];            /*  232   16  XXH3-128: header (id, checksum zero), section table */
    uint64_t checksum;         /*  248    8  XXH3-64 of the header page with this field zero */
    char name[64];             /*  256   64  of the data set, NUL-padded UTF-8 */
    char provenance[1024];     /*  320 1024  how it was made; no paths, no times */
    /* mesh: */
    uint64_t tets;             /* 1344    8  sum of COUNTS */
    uint64_t vertices;         /* 1352    8  of the tets, each once, over the whole mesh */
    float bounds[6];           /* 1360   24  of the whole mesh, at all steps: lo x y z, hi x y z */
    uint32_t treelet_tets;     /* 1384    4  at most so many in a treelet */
    uint32_t leaf_tets;        /* 1388    4  at most so many in a leaf of its tree */
    uint64_t flat;             /* 1392    8  of these, tets without a volume */
    uint64_t inverted;         /* 1400    8  tets that were oriented the other way in the input */
    uint64_t repeated;         /* 1408    8  left out: input tets with a vertex twice, */
    uint64_t bad;              /* 1416    8    and with an invalid vertex index */
    char field[64];            /* 1424   64  name of the first field, as name */
    uint32_t gradients;        /* 1488    4  1: each set has gradients too, else 0 */
    uint32_t moving;           /* 1492    4  1: steps behind the first have positions, else 0 */
    uint32_t bare;             /* 1496    4  grid: 1: levels above 0 have no samples, else 0 */
    uint32_t outside_chunks;   /* 1500    4  entries of section CHUNKS */
    uint64_t directory;        /* 1504    8  where the section table lies, behind the payloads; 0: at
                                               LEAF_HEADER_BYTES, before them */
    /* Growing files, segment after segment (SERIES.md 4): */
    uint64_t last;             /* 1512    8  first header: where the last segment's header lies */
    uint32_t segments;         /* 1520    4  first header: how many; 0: a file that does not grow */
    uint32_t steps_before;     /* 1524    4  later ones: steps in all segments before; else 0 */
    uint64_t before;           /* 1528    8  later ones: where the header of the one before lies */
    uint32_t zones;            /* 1536    4  curvilinear: elements of section ZONES, else 0 */
    uint8_t reserved[2556];    /* 1540 2556 */
} leaf_header;

typedef struct leaf_section {  /* offset size */
    uint32_t kind;             /*    0    4  leaf_section_kind */
    uint32_t version;          /*    4    4  leaf_section_version */
    uint64_t offset;           /*    8    8  from the file's start, a multiple of LEAF_ALIGN */
    uint64_t bytes;            /*   16    8  in the file */
    uint64_t checksum;         /*   24    8  XXH3-64 of those bytes */
} leaf_section;

/* A complete grid treelet file inside a mesh's: the values of a set, resampled, for pictures before
 * the mesh has been read. Parts lie behind the last payload's run, set after set without gaps, each
 * a multiple of 2^run_align_log2 long. */
typedef struct leaf_part {     /* offset size */
    uint64_t offset;           /*    0    8  from the file's start; 0: none, and all fields are 0 */
    uint64_t bytes;            /*    8    8 */
    uint64_t id[2];            /*   16   16  of its header */
} leaf_part;
/* A filter that was applied to the numbers of a chunk before packing. */
typedef struct leaf_filter {   /* offset size */
    uint32_t kind;             /*    0    4  as in OUTSIDE.md, from 1 */
    uint32_t element;          /*    4    4  shuffle: bytes of an element; rows: numbers of one */
    uint32_t type;             /*    8    4  sample_type of a number before it was applied */
    uint32_t coded_type;       /*   12    4  and behind it */
    uint32_t flags;            /*   16    4  LEAF_FILTER_* */
    uint32_t row;              /*   20    4  rows: numbers of a row, else 0 */
    double scale, offset;      /*   24   16  fixedscaleoffset */
} leaf_filter;
/* Where the samples of level 0 lie in files of another format: as they are, x fastest, in one piece,
 * or in chunks. They become the samples of this one as OUTSIDE.md says. */
typedef struct leaf_outside {  /* offset size */
    uint64_t file_bytes;       /*    0    8  length of that file, */
    int64_t modified_s;        /*    8    8    and its time of last modification, since 1970, */
    uint32_t modified_ns;      /*   16    4    with nanoseconds below a second */
    uint32_t type;             /*   20    4  sample_type of a number */
    uint64_t offset;           /*   24    8  of the first number in that file */
    uint32_t components;       /*   32    4  numbers a sample, side by side: 1 or more */
    uint32_t component;        /*   36    4  the one that is taken, from 1; 0: all together */
    uint32_t flags;            /*   40    4  LEAF_OUTSIDE_* */
    uint32_t reserved0;        /*   44    4 */
    double slope, intercept;   /*   48   16  value = slope * number + intercept; slope 0: the number */
    double missing;            /*   64    8  this value stands for NaN, if flags say so; else 0 */
    uint8_t reserved[56];      /*   72   56 */
    char path[3968];           /*  128 3968  of that file, from this one's folder; NUL-padded */
    uint32_t form;             /* 4096    4  leaf_outside_form; LEAF_OUTSIDE_PIECE: the rest is 0 */
    uint32_t axes;             /* 4100    4  of the array of chunks */
    uint32_t chunk_flags;      /* 4104    4  LEAF_CHUNKS_* */
    uint32_t codec;            /* 4108    4  that packs a chunk: zarr_codec */
    uint32_t filters;          /* 4112    4  how many were applied before */
    uint32_t step;             /* 4116    4  index along the axis of steps */
    uint32_t levels_up;        /* 4120    4  the folder in which all must lie is so far up */
    uint32_t reserved1;        /* 4124    4 */
    uint8_t fill[8];           /* 4128    8  the number that absent chunks have, little endian */
    uint64_t sum;              /* 4136    8  XXH3-64 of the file at `path` */
    uint32_t chunk[LEAF_CHUNK_AXES]; /* 4144 32  numbers of a chunk along each axis, else 0 */
    uint32_t role[LEAF_CHUNK_AXES];  /* 4176 32  of each axis: 0 none, 1 x, 2 y, 3 z, 4 number, 5 step */
    leaf_filter filter[LEAF_CHUNK_FILTERS]; /* 4208 320  in the order in which they were applied */
    uint8_t reserved2[80];     /* 4528   80 */
} leaf_outside;
/* clang-format on */

_Static_assert(sizeof(leaf_filter) == 40, "leaf_filter is 40 bytes");
_Static_assert(sizeof(leaf_outside) == 4608, "leaf_outside is 4608 bytes");
_Static_assert(sizeof(leaf_part) == 32, "leaf_part is 32 bytes");
_Static_assert(sizeof(leaf_header) == LEAF_HEADER_BYTES, "leaf_header is a page");
_Static_assert(sizeof(leaf_section) == 32, "leaf_section is 32 bytes");

/* leaf_id_text() - print the id for people. Returns text. */
enum { LEAF_ID_TEXT = 33 };
static inline const char *leaf_id_text(const leaf_header *h, char text[LEAF_ID_TEXT]) {
    snprintf(text, LEAF_ID_TEXT, "%016llx%016llx", (unsigned long long)h->id[1],
             (unsigned long long)h->id[0]);
    return text;
}

/* leaf_table_at() - where the section table lies. leaf_payloads_at() - where payloads begin, if the
 * sections end at `end`. */
static inline uint64_t leaf_table_at(const leaf_header *h) {
    return h->directory ? h->directory : LEAF_HEADER_BYTES;
}
static inline uint64_t leaf_payloads_at(const leaf_header *h, uint64_t end) {
    return h->directory ? LEAF_HEADER_BYTES : end;
}

/* leaf_is_behind() - whether the directory of so many sets lies behind the payloads, which may lead
 * to those of other sets. */
static inline bool leaf_is_behind(const leaf_header *h) {
    return (uint64_t)h->fields * h->steps > 1 || h->steps_before > 0;
}

/* leaf_has_segments() - whether this is the header of a segment of a growing file. */
static inline bool leaf_has_segments(const leaf_header *h) {
    return h->segments > 0 || h->steps_before > 0;
}

/* An entry of SAME or BASES with this bit leads to an earlier segment: the rest is the number of
 * the set there. */
#define LEAF_LINK_BEFORE (UINT32_C(1) << 31)

/* leaf_aligned() - the first multiple of LEAF_ALIGN at or behind byte `at` of a payload. */
static inline uint32_t leaf_aligned(uint32_t at) {
    return (at + LEAF_ALIGN - 1) / LEAF_ALIGN * LEAF_ALIGN;
}

/* Sections follow the table in its order, each at the first multiple of LEAF_ALIGN behind the one
 * before. Payloads follow the sections, or the header page, in order (leaf_placing_next()). So
 * sizes alone fix every offset, and no byte is unaccounted for.
 *
 * Grids: a directory section is one array with an element per treelet, which has one payload. The
 * order is: coarsest level first; within a level by the parent's index, then by octant x + 2y + 4z.
 * So siblings are neighbours, and the root is treelet 0. Which children exist, and every treelet's
 * place, follows from dims and B alone. Several sets come set after set (leaf_layout_samples()).
 *
 * Meshes: n treelets in the order of their tets, fields * steps sets of values; set = field * steps
 * + step. Payloads come in blocks of n; payload block * n + t belongs to treelet t. There is one
 * block of topologies and a block of values for each set; with header.gradients a block of
 * gradients for each set; with header.moving a block of positions for each step 1 .. steps - 1
 * (leaf_layout_values() and so on). RANGES, OWN, FLAGS: an element set * n + t. OFFSETS, SIZES,
 * CHECKSUMS: an element per payload. BOUNDS: an element step * n + t with header.moving, else one
 * per treelet. COUNTS: an element per treelet.
 *
 * Curvilinear grids: as meshes without gradients, with places instead of topologies, and ZONES
 * instead of COUNTS (curvilinear_geometry.h). */
typedef enum leaf_section_kind {
    LEAF_SECTION_RANGES = 1,  /* float[2]: lo, hi over the finite samples of the treelet and of all
                                 its descendants; mesh: as OWN */
    LEAF_SECTION_OWN = 2,     /* float[2]: lo, hi over the treelet's own finite samples, without the
                                 halo; codes are relative to it */
    LEAF_SECTION_FLAGS = 3,   /* uint8_t: LEAF_FLAG_* */
    LEAF_SECTION_OFFSETS = 4, /* uint64_t: payload's offset in the file */
    LEAF_SECTION_SIZES = 5,   /* uint64_t: payload's stored bytes */
    LEAF_SECTION_CHECKSUMS = 6, /* uint64_t: XXH3-64 of the stored bytes */
    LEAF_SECTION_AXES = 7,    /* grid: double[dims[0] + dims[1] + dims[2]]: node coordinates in grid
                                 space, level 0 */
    LEAF_SECTION_BOUNDS = 8,  /* mesh: float[6]: lo x y z, hi x y z of the treelet's vertices */
    LEAF_SECTION_COUNTS = 9,  /* mesh: uint32_t[4]: tets, vertices, nodes, leaves */
    LEAF_SECTION_FIELDS = 10, /* may be missing: char[64]: name of a field, as header.field */
    LEAF_SECTION_TIMES = 11,  /* of two steps or more, may be missing: double: time of a step,
                                 ascending */
    LEAF_SECTION_COARSE = 12, /* no grid, may be missing: leaf_part: a set's coarse grid */
    LEAF_SECTION_OUTSIDE = 13, /* grid with header.outside: leaf_outside */
    LEAF_SECTION_CHUNKS = 14,  /* grid with header.outside_chunks: chunk_entry (chunk_array.h) */
    LEAF_SECTION_SAME = 15,    /* two sets or more, may be missing: uint32_t per payload: 0, or 1 +
                                  an earlier set, whose payload in its place has the same bytes; or
                                  LEAF_LINK_BEFORE */
    LEAF_SECTION_BASES = 16,   /* compressed grid of two sets or more, may be missing: likewise: the
                                  set whose samples a payload has the differences to */
    LEAF_SECTION_SLICES = 17,  /* grid with LEAF_IN_SLICES: slice_file (slice_folder.h) per slice */
    LEAF_SECTION_ZONES = 18,   /* curvilinear grid: uint32_t[4] per zone: nodes along i, j, k; 0 */
    LEAF_SECTION_LAST = 18,    /* the last that is known here */
    LEAF_SECTION_ANCILLARY =
        1 << 30, /* set in kinds that a reader may skip; it must know all others */
    LEAF_SECTION_HISTOGRAMS = LEAF_SECTION_ANCILLARY | 1, /* histogram (histogram.h): an element per
                                                             set */
    LEAF_SECTION_DEVIATIONS =
        LEAF_SECTION_ANCILLARY | 2, /* grid: uint16_t (deviation.h): an element per brick of each
                                       coarse treelet */
    LEAF_SECTION_WORLD =
        LEAF_SECTION_ANCILLARY | 3, /* may be missing: a world_frame, not all zeros */
    LEAF_ANCILLARY_LAST = 3         /* the last that is known here */
} leaf_section_kind;
/* How a section is stored: as it is, or as a frame of zstd. */
typedef enum leaf_section_version {
    LEAF_SECTION_PLAIN = 1,
    LEAF_SECTION_ZSTD = 2
} leaf_section_version;
/* A treelet without a finite sample has lo = +inf, hi = -inf. */

#endif
