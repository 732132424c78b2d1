/* piece.h - one treelet's part of a surface or mesh: vertices, and triangles or tets between them,
 * numbered within the piece.
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
    int corners;     /* of a cell: 3 or 4 */
    double isovalue; /* of the surface */
    uint32_t vertices, cells, shares;
    piece_vertex *vertex;
    uint32_t *corner;     /* [cells][corners], counterclockwise as seen from the side of smaller
                             values; tets: with a positive volume */
    piece_share *share;   /* ascending by vertex */
    const float **values; /* fields at the vertices, as many as the source says; its maker owns
                             them */
    size_t vertex_room, corner_room, share_room;
} piece;

/* piece_begin() - empty the piece. */
void piece_begin(piece *p, int corners, double isovalue);

/* piece_add_vertex() - *index: the new vertex's number. */
CHECKED status piece_add_vertex(piece *p, const piece_vertex *v, uint32_t *index);
CHECKED status piece_add_share(piece *p, uint32_t vertex, hash_id key);
CHECKED status piece_add_cell(piece *p, const uint32_t corner[]);

/* piece_drop_flat() - remove triangles with two corners that are equal once rounded to floats. */
void piece_drop_flat(piece *p);

void piece_release(piece *p);

/* Makes pieces. */
typedef struct piece_source {
    void *ctx;
    uint32_t pieces;
    int corners;
    uint32_t values; /* fields per vertex */
    /* Make piece `index`. A worker makes one piece at a time. */
    status (*make)(void *ctx, uint32_t index, int worker, piece *p);
} piece_source;

#endif
