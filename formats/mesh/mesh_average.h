/* mesh_average.h - cell data taken to the points: the mean over the cells at a point.
 *
 * Each cell counts once at each of its points, as it stands in the file, before it is split. Sums
 * are double, in the order of the cells. A point of no cell gets 0. 12 bytes a point and field.
 *
 * A reader that can read its cells again may do so in rounds, each for a window of the points:
 *
 *     st = mesh_average_begin_rounds(&a, m, points, fields);
 *     for (bool more = true; st == ST_OK && more; more = mesh_average_next(&a)) {
 *         ... mesh_average_add() of all cells ...
 *         st = mesh_average_feed(&a, feed, 0);
 *     }
 *
 * The values are the same.
 */
#ifndef FORMATS_MESH_MESH_AVERAGE_H
#define FORMATS_MESH_MESH_AVERAGE_H

#include "formats/mesh/mesh_feed.h"

typedef struct mesh_average {
    mem *m;
    uint64_t points;
    uint64_t first; /* the window: of all points, but for rounds */
    size_t count, room;
    uint32_t fields;
    double *sums;    /* of each field those of the window, `room' apart */
    uint32_t *cells; /* at each point, likewise */
} mesh_average;

/* mesh_average_begin() - for so many points and fields, 1 or more. Release in any case, also one
 * that is all zeros. */
CHECKED status mesh_average_begin(mesh_average *a, mem *m, uint64_t points, uint32_t fields);

/* mesh_average_begin_rounds() - the same in windows, of a quarter of what the budget has left.
 * mesh_average_next() - on to the next window, its sums all 0; false behind the last one. */
CHECKED status mesh_average_begin_rounds(mesh_average *a, mem *m, uint64_t points, uint32_t fields);
bool mesh_average_next(mesh_average *a);

void mesh_average_release(mesh_average *a);

/* mesh_average_add() - a cell's value of a field, 0, 1, ..; a cell with an id that is no point is
 * passed over, as mesh_feed_cell() does. */
void mesh_average_add(mesh_average *a, uint32_t field, mesh_cell kind, const uint64_t *ids,
                      double value);

/* mesh_average_add_each() - the same with a value for each of the cell's vertices. */
void mesh_average_add_each(mesh_average *a, uint32_t field, mesh_cell kind, const uint64_t *ids,
                           const float *values);

/* mesh_average_feed() - the values of the window, when the last cell has been added: of the fields
 * from `first' on. */
CHECKED status mesh_average_feed(const mesh_average *a, mesh_feed *feed, uint32_t first);

#endif
