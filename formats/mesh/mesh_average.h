/* mesh_average.h - cell data averaged to the points: each point gets the mean of its cells' values.
 *
 * A cell counts once at each of its points, before it is split into tets. Sums are double, added in
 * the order of the cells. A point without cells gets NaN. Takes 12 bytes a point and field.
 *
 * A reader that can read its cells again may do so in rounds, each for a window of the points:
 *
 *     st = mesh_average_begin_rounds(&a, m, points, fields);
 *     for (bool more = true; st == ST_OK && more; more = mesh_average_next(&a)) {
 *         ... mesh_average_add() of all cells ...
 *         st = mesh_average_feed(&a, feed, 0);
 *     }
 *
 * The values are the same as without rounds.
 */
#ifndef FORMATS_MESH_MESH_AVERAGE_H
#define FORMATS_MESH_MESH_AVERAGE_H

#include <math.h>

#include "formats/mesh/mesh_feed.h"

typedef struct mesh_average {
    mem *m;
    uint64_t points;
    uint64_t first; /* first point of the window; without rounds the window is all points */
    size_t count, room;
    uint32_t fields;
    double *sums;    /* the window's sums, field after field, `room` apart */
    uint32_t *cells; /* number of cells at each point, likewise */
} mesh_average;

/* mesh_average_begin() - begin with all points at once, for 1 or more fields. Release in any case;
 * a zeroed mesh_average may be released, too. */
CHECKED status mesh_average_begin(mesh_average *a, mem *m, uint64_t points, uint32_t fields);

/* mesh_average_begin_rounds() - the same in windows, which take a quarter of what the budget has
 * left.
 * mesh_average_next() - go to the next window and set its sums to 0. Returns false behind the last
 * one. */
CHECKED status mesh_average_begin_rounds(mesh_average *a, mem *m, uint64_t points, uint32_t fields);
bool mesh_average_next(mesh_average *a);

void mesh_average_release(mesh_average *a);

/* mesh_average_add() - add a cell's value of a field (0, 1, ..) to its points. A cell with an id
 * outside the points is skipped, as by mesh_feed_cell(). */
void mesh_average_add(mesh_average *a, uint32_t field, cell_shape kind, const uint64_t *ids,
                      double value);

/* mesh_average_add_points() - the same for points that are all different. */
void mesh_average_add_points(mesh_average *a, uint32_t field, const uint64_t *ids, size_t count,
                             double value);

/* mesh_average_add_each() - the same with a value for each of the cell's vertices. */
void mesh_average_add_each(mesh_average *a, uint32_t field, cell_shape kind, const uint64_t *ids,
                           const float *values);

/* mesh_average_value() - point i's value of a field when the last cell has been added; counted from
 * the window's first. */
static inline double mesh_average_value(const mesh_average *a, uint32_t field, size_t i) {
    const size_t at = field * a->room + i;
    return a->cells[at] ? a->sums[at] / a->cells[at] : (double)NAN;
}

/* mesh_average_feed() - feed the window's values when the last cell has been added. The first field
 * is fed as field `first`, the others follow. */
CHECKED status mesh_average_feed(const mesh_average *a, mesh_feed *feed, uint32_t first);

#endif
