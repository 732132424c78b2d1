/* piece_format.h - the formats of surfaces and meshes: a row of a table each.
 *
 * A file is texts and arrays by turns, and a text at its end. An array has an element a vertex or a
 * cell, of a size that is known before any is made: so each piece has its place in each array, and
 * pieces can be written in any order. All is little endian.
 */
#ifndef PREP_EXPORT_PIECE_FORMAT_H
#define PREP_EXPORT_PIECE_FORMAT_H

#include "prep/export/head_text.h"
#include "prep/export/piece.h"

/* What a file is to hold. */
typedef struct piece_info {
    const char *name; /* of the data set; "" */
    bool floats;      /* coordinates as floats instead of doubles */
    uint32_t isovalues;
    const char *const *fields; /* names */
    uint32_t field_count;
    const double *time; /* NULL: none */
    uint64_t vertices, cells;
} piece_info;

/* A piece on its way into the file. */
typedef struct piece_view {
    const piece_info *info;
    const piece *p;
    const uint32_t *order; /* the vertices that are the piece's own, as they are numbered */
    uint32_t owned;
    const uint64_t *numbers; /* of all its vertices */
    uint64_t first_cell;
} piece_view;

typedef struct piece_array {
    head_text before; /* what stands before it */
    size_t stride;    /* bytes of an element */
    bool of_cells;    /* else of vertices */
    uint32_t field;
    /* All of a piece's elements. Returns the byte behind the last one. */
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
    int corners; /* 3: of surfaces; 4: of meshes */
    bool loose;  /* triangles without common vertices, in floats */
    /* ST_UNSUPPORTED: what the format cannot hold. The layout is to be released in any case. */
    status (*lay_out)(mem *m, const piece_info *info, piece_layout *l);
} piece_format;

extern const piece_format piece_formats[];
extern const int piece_format_count;

void piece_layout_release(piece_layout *l);

#endif
