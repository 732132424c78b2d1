/* piece.h - one treelet's part of a surface or mesh: vertices, and triangles or solid cells between
 * them, numbered within the piece.
 *
 * A piece is a pure function of its number, so it can be made again instead of being kept. Vertices
 * that other pieces may have, too, carry a key. Equal keys mean the same vertex, with coordinates
 * equal to the bit.
 */
#ifndef PREP_EXPORT_PIECE_H
#define PREP_EXPORT_PIECE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/cell_shape.h"
#include "formats/base/hash.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct piece_vertex {
    double at[3];     /* in world space */
    double normal[3]; /* of length 1, towards smaller values; 0 0 0: none */
} piece_vertex;

typedef struct piece_share {
    hash_id key;
    uint32_t vertex; /* its number in the piece */
} piece_share;

/* Start with {.m = budget}. Arrays grow, and are reused for the next piece. */
typedef struct piece {
    mem *m;
    bool solid;      /* cells have shapes; else all are triangles */
    double isovalue; /* of the surface */
    uint32_t vertices, cells, shares;
    uint32_t corners; /* of all cells */
    piece_vertex *vertex;
    uint32_t *corner;     /* cell after cell; triangles: counterclockwise as seen from the side of
                             smaller values; solid: in the shape's order, with a positive volume */
    uint8_t *shape;       /* [cells]: the cell_shape; only if solid */
    piece_share *share;   /* ascending by vertex */
    const float **values; /* fields at the vertices, as many as the source says; its maker owns
                             them */
    size_t vertex_room, corner_room, shape_room, share_room;
} piece;

/* piece_begin() - empty the piece. piece_corners() - the corners of a cell. */
void piece_begin(piece *p, bool solid, double isovalue);
int piece_corners(const piece *p, uint32_t cell);

/* piece_add_vertex() - *index: the new vertex's number. */
CHECKED status piece_add_vertex(piece *p, const piece_vertex *v, uint32_t *index);
CHECKED status piece_add_share(piece *p, uint32_t vertex, hash_id key);
CHECKED status piece_add_triangle(piece *p, const uint32_t corner[3]);
CHECKED status piece_add_solid(piece *p, cell_shape shape, const uint32_t corner[]);

/* piece_key() - of a vertex with these coordinates and values, wherever it is: 0 and -0 are the
 * same, and so in `floats` behind the call. */
hash_id piece_key(float *floats, size_t count);

/* piece_drop_flat() - remove triangles with two corners that are equal once rounded to floats. */
void piece_drop_flat(piece *p);

/* piece_unit_normals() - give normals length 1; those without a direction become 0 0 0. */
void piece_unit_normals(piece *p);

void piece_release(piece *p);

/* Makes pieces. */
typedef struct piece_source {
    void *ctx;
    uint32_t pieces;
    uint32_t values; /* fields per vertex */
    /* Make piece `index`. A worker makes one piece at a time. */
    status (*make)(void *ctx, uint32_t index, int worker, piece *p);
    void (*destroy)(void *ctx);
} piece_source;

/* piece_source_release() - one with all members 0 is fine. */
void piece_source_release(piece_source *s);

#endif
