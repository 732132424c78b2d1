/* piece_format.h - formats of surfaces and meshes, one row of a table each.
 *
 * A file alternates texts and arrays, with a text at its end. An array has one element per vertex,
 * cell or corner of a cell, of a size known beforehand. So each piece has its place in each array,
 * and pieces can be written in any order. All is little endian.
 */
#ifndef PREP_EXPORT_PIECE_FORMAT_H
#define PREP_EXPORT_PIECE_FORMAT_H

#include "prep/export/head_text.h"
#include "prep/export/piece.h"

/* Contents of a file. */
typedef struct piece_info {
    const char *name; /* of the data set; "": none */
    bool floats;      /* coordinates as floats instead of doubles */
    bool given;       /* a surface with values of fields; else isosurfaces, with normals */
    bool normals;     /* a given one has normals, too */
    uint32_t isovalues;
    const char *const *fields; /* their names */
    uint32_t field_count;
    const double *time;                /* NULL: none */
    uint64_t vertices, cells, corners; /* corners: of all cells */
} piece_info;

/* A piece, as its encoders see it. */
typedef struct piece_view {
    const piece_info *info;
    const piece *p;
    const uint32_t *order; /* the vertices that the piece owns, in the order of their numbers */
    uint32_t owned;
    const uint64_t *numbers; /* numbers of all its vertices in the file */
    uint64_t first_corner;   /* number of its first cell's first corner in the file */
} piece_view;

/* What an array has an element of. */
typedef enum piece_domain {
    PIECE_VERTICES,
    PIECE_CELLS,
    PIECE_CORNERS,
    PIECE_DOMAINS
} piece_domain;

typedef struct piece_array {
    head_text before; /* text before the array */
    size_t stride;    /* bytes of an element */
    piece_domain of;
    uint32_t field;
    /* Encode all of a piece's elements. Returns the byte behind the last one. */
    char *(*encode)(const piece_view *v, const struct piece_array *a, char *to);
} piece_array;

typedef struct piece_layout {
    piece_array *arrays;
    int count;
    head_text tail;
    mem *m;
} piece_layout;

typedef struct piece_format {
    const char *name, *suffix;
    bool solid; /* of meshes; else of surfaces */
    bool loose; /* separate triangles without shared vertices, in floats */
    /* ST_UNSUPPORTED: the format cannot hold this. Release the layout in any case. */
    status (*lay_out)(mem *m, const piece_info *info, piece_layout *l);
} piece_format;

/* piece_elements() - of an array, for what a file holds. */
uint64_t piece_elements(const piece_info *info, piece_domain of);

extern const piece_format piece_formats[];
extern const int piece_format_count;

void piece_layout_release(piece_layout *l);

#endif
