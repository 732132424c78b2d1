/* packet_frustum.h - finds what all rays of a packet from one eye miss: boxes by interval
 * arithmetic (W07 5.2 III), isopolygons by the packet's corner rays (W07 4.3). */
#ifndef RENDER_MESH_PACKET_FRUSTUM_H
#define RENDER_MESH_PACKET_FRUSTUM_H

#include <stdbool.h>

#include "render/look/projection.h"
#include "render/mesh/mesh_walk.h"

/* A box, its planes relative to the eye. */
typedef struct packet_box {
    double lo[3], hi[3];
} packet_box;

/* Pixels of a packet, ends included. */
typedef struct packet_rect {
    int x0, x1, y0, y1;
} packet_rect;

typedef struct packet_frustum {
    const projection *projection;
    float x, y; /* centre of the packet's first pixel, from the picture's centre */
    int side;
    double eye[3];
    double least[3], most[3]; /* of the rays' directions */
    double far;               /* no ray looks for anything beyond this t */
    double corner[3][4];      /* directions of unit length that span all rays */
} packet_frustum;

/* packet_frustum_begin() - starts a packet of side x side pixels, without rays; x, y as above.
 * packet_frustum_add() - adds a ray with this direction, none of whose components is 0. `far` and
 * `corner` are the caller's to set. */
void packet_frustum_begin(packet_frustum *s, const projection *p, float x, float y, int side);
void packet_frustum_add(packet_frustum *s, const double d[3]);

/* Bounds for the rays that may meet a box. */
typedef struct packet_reach {
    packet_rect pixels; /* rays of these pixels alone, */
    double near;        /* at this t or behind, as box_interval_in() rounds */
} packet_reach;

/* packet_frustum_box() - false if no ray meets the box at a t from 0 to far. */
bool packet_frustum_box(const packet_frustum *s, const packet_box *b, packet_reach *out);

typedef enum packet_view {
    PACKET_DIFFERS,     /* or unknown */
    PACKET_MISSES,      /* all rays miss it, at any t > 0 */
    PACKET_HITS_FIRST,  /* all rays hit the triangle of points 0 1 2 */
    PACKET_HITS_SECOND, /* all rays hit the triangle of points 0 2 3 */
} packet_view;

/* packet_frustum_polygon() - tells from the corner rays how the packet meets an isopolygon. */
packet_view packet_frustum_polygon(const packet_frustum *s, const isopolygon *g);

#endif
