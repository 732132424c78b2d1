/* transfer_list.h - the points of a transfer function that is being made.
 *
 * A list may hold colours, extinctions or both; the others are 0 in all points. Values do not fall
 * from point to point. Several points at one value are a step: the first and the last count. Beyond
 * its ends a list is constant.
 */
#ifndef RENDER_APP_TRANSFER_LIST_H
#define RENDER_APP_TRANSFER_LIST_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "render/leafcast.h"

/* The largest extinction that a scene takes; a larger one would look the same. */
#define TRANSFER_LIST_MOST 1e100

/* Start with all zeros but for m. */
typedef struct transfer_list {
    mem *m;
    leafcast_transfer_point *points;
    size_t count, room;
} transfer_list;

/* transfer_list_add() - append a point. ST_UNSUPPORTED for more than LEAFCAST_TRANSFER_POINTS_MAX;
 * ST_NOMEM. */
CHECKED status transfer_list_add(transfer_list *t, leafcast_transfer_point point);

/* transfer_list_release() - free the points; the list is empty again and keeps m. */
void transfer_list_release(transfer_list *t);

/* transfer_list_at() - returns the function at a value; at a step, the point before it (`after`
 * false) or behind it. count must not be 0. */
leafcast_transfer_point transfer_list_at(const transfer_list *t, double value, bool after);

/* transfer_list_stretch() - move the points so that value from[0] becomes to[0], and from[1]
 * becomes to[1]. All are finite, from[0] <= all values <= from[1], to[0] <= to[1]. If from[0]
 * equals from[1], all values become to[0]. */
void transfer_list_stretch(transfer_list *t, const double from[2], const double to[2]);

/* transfer_list_join() - join the colours of one list and `factor` times the extinctions of another
 * into an empty list, with the points of both. Products are cut at TRANSFER_LIST_MOST. Neither
 * input is empty. Errors as from transfer_list_add(). */
CHECKED status transfer_list_join(transfer_list *out, const transfer_list *colours,
                                  const transfer_list *extinctions, double factor);

#endif
