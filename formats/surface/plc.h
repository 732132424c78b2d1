/* plc.h - a piecewise linear complex: points and facets for tetrahedralize, held in memory as a
 * whole.
 *
 * Read from TetGen (.node, .poly, .smesh), PLY, STL, OFF and tables of text (.csv, .txt, .xyz),
 * through a fixed buffer. A header's counts are not trusted before the data come. A facet is one
 * polygon, or several in one plane, and may have holes. One thread.
 */
#ifndef FORMATS_SURFACE_PLC_H
#define FORMATS_SURFACE_PLC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_input.h"

/* The most points, corners or facets: TetGen counts in int. */
#define PLC_MAX ((uint64_t)1 << 26)

/* A list that grows. */
typedef struct plc_list {
    void *data;
    size_t count, room;
} plc_list;

typedef struct plc {
    mem *m;
    char field[MESH_NAME_MAX + 1]; /* name of the values; "": there are none */
    plc_list points;               /* double[3], finite */
    plc_list values;               /* double; NaN: no data; empty without a field */
    plc_list facets;               /* plc_facet */
    plc_list polygons;             /* uint32_t: the first corner of each */
    plc_list corners;              /* uint32_t: points, from 0 */
    plc_list facet_holes;          /* double[3]: points in holes of facets */
    plc_list holes;                /* double[3]: points in regions that are not to be filled */
    plc_list regions;      /* double[5]: a point, an attribute, the largest volume or <= 0 */
    bool loose;            /* facets may have free edges (.poly): walls inside */
    unsigned counted_from; /* the number of the file's first point or facet */
} plc;

typedef struct plc_facet {
    uint32_t number;  /* in the file, from 0 */
    uint32_t polygon; /* the first of its polygons */
    uint32_t hole;    /* the first of its holes */
} plc_facet;

/* What the command line says. Zero/NULL = not given. */
typedef struct plc_hints {
    const char *field;  /* field of the points; NULL: the first there is */
    const char *format; /* node csv ply stl off poly smesh; NULL: by the path's end or the file's
                           beginning */
    bool optional;      /* the field need not be there */
} plc_hints;

/* plc_read() - read a path, or "-" for standard input. ST_CORRUPT, ST_UNSUPPORTED or ST_IO, naming
 * file and place. Release in any case. */
CHECKED status plc_read(mem *m, const char *path, const plc_hints *hints, plc *out);
void plc_release(plc *x); /* zeroed is fine */

/* The ranges of facets' polygons and of polygons' corners: first .. end. */
static inline const plc_facet *plc_facet_at(const plc *x, size_t f) {
    return (const plc_facet *)x->facets.data + f;
}
static inline size_t plc_polygons_end(const plc *x, size_t f) {
    return f + 1 < x->facets.count ? plc_facet_at(x, f + 1)->polygon : x->polygons.count;
}
static inline size_t plc_facet_holes_end(const plc *x, size_t f) {
    return f + 1 < x->facets.count ? plc_facet_at(x, f + 1)->hole : x->facet_holes.count;
}
static inline size_t plc_corners_begin(const plc *x, size_t polygon) {
    return polygon < x->polygons.count ? ((const uint32_t *)x->polygons.data)[polygon]
                                       : x->corners.count;
}
static inline const double *plc_point(const plc *x, size_t i) {
    return (const double *)x->points.data + 3 * i;
}

/* ---- for readers ---- */

typedef struct plc_source {
    byte_stream *data; /* at its start */
    const char *path;  /* "-": standard input */
    plc_hints hints;
    plc *out;
} plc_source;

/* plc_add() - add an element of size bytes to a list. ST_UNSUPPORTED above PLC_MAX elements. */
CHECKED status plc_add(plc *x, plc_list *list, const void *element, size_t size);

/* plc_add_point() - add a point. ST_CORRUPT unless it is finite, also as floats; line: for the
 * message. */
CHECKED status plc_add_point(const plc_source *s, const double xyz[3], uint64_t line);

/* Add a facet, a polygon of it, or a corner of that. A corner may have any number: plc_read()
 * checks that it is a point. */
CHECKED status plc_add_facet(plc *x, uint64_t number);
CHECKED status plc_add_polygon(plc *x);
CHECKED status plc_add_corner(plc *x, uint64_t point);

#endif
