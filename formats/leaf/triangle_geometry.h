/* triangle_geometry.h - the table of functions for surfaces of triangles in a treelet file.
 *
 * Blocks of payloads are those of a mesh without gradients (leaf.h). In a treelet of n vertices and
 * c triangles:
 *
 *   topology   float x[n], y[n], z[n] at step 0; uint32_t normal[n], if it has normals
 *              (triangle_normal.h); zeros up to a multiple of LEAF_ALIGN; uint16_t rows[c][3]: a
 *              triangle's vertices; zeros up to a multiple of LEAF_ALIGN
 *   positions  float x[n], y[n], z[n], normals likewise, at a later step; zeros likewise
 *   values     float[n]; zeros likewise
 *
 * Vertices are in the order in which rows use them first. What of two triangles is at one place
 * need not be one vertex. Triangles are in the order of a space-filling curve. COUNTS: c, n,
 * how many normals: 0 or n, 0.
 * Of the header: tets: triangles; vertices: points of the input that have triangles; treelet_tets:
 * triangles in a treelet at most; flat: triangles whose vertices are on a line.
 *
 * A field may hold colours (colour_field.h).
 */
#ifndef FORMATS_LEAF_TRIANGLE_GEOMETRY_H
#define FORMATS_LEAF_TRIANGLE_GEOMETRY_H

#include "formats/leaf/leaf_cells.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_layout.h"

enum {
    TRIANGLE_CORNERS = 3,
    TRIANGLES_MAX = 16384 /* of a treelet, so that 16 bits number its vertices */
};

/* Where the parts of a treelet's payloads begin, in bytes. */
typedef struct triangle_shape {
    uint32_t triangles, vertices;
    uint32_t normals;                                  /* 0, or as many as vertices */
    uint32_t place_bytes, topology_bytes, value_bytes; /* rows begin where places end */
} triangle_shape;

/* triangle_shape_of() - counts: an element of COUNTS, without a triangle_counts_fault().
 * triangle_counts_fault() - what a treelet of a file with this header cannot have; NULL: it is
 * sound. */
triangle_shape triangle_shape_of(const uint32_t counts[4]);
const char *triangle_counts_fault(const uint32_t counts[4], uint32_t treelet_triangles);

static inline uint32_t triangle_rows_bytes(const triangle_shape *s) {
    return s->triangles * TRIANGLE_CORNERS * (uint32_t)sizeof(uint16_t);
}

/* Of positions and normals, without what fills them up. */
static inline uint32_t triangle_place_bytes(const triangle_shape *s) {
    return s->vertices * (uint32_t)sizeof(float[3]) + s->normals * (uint32_t)sizeof(uint32_t);
}

/* The parts. topology, places: a treelet's payloads. */
static inline const float *triangle_coordinates(const triangle_shape *s, const void *places,
                                                int axis) {
    return (const float *)places + (size_t)axis * s->vertices;
}
/* NULL: it has no normals. */
static inline const uint32_t *triangle_place_normals(const triangle_shape *s, const void *places) {
    return s->normals ? (const uint32_t *)places + 3 * (size_t)s->vertices : NULL;
}
static inline const uint16_t (*triangle_rows(const triangle_shape *s, const void *topology))[3] {
    return (const uint16_t(*)[3])(const void *)((const char *)topology + s->place_bytes);
}

/* triangle_is_flat() - whether a triangle has no area, exactly: then no ray meets it. */
bool triangle_is_flat(const float p[3][3]);

/* triangle_directory_of() - what the directory has besides. */
static inline const leaf_cells_directory *triangle_directory_of(const leaf_file *f) {
    return f->besides;
}

/* triangle_have_normals() - whether some of a file's vertices have. */
bool triangle_have_normals(const leaf_file *f);

extern const leaf_geometry triangle_geometry;

#endif
