/* transfer_list.h - the points of a transfer function while it is put together.
 *
 * A list may hold colours, extinctions or both: what it does not hold is 0 throughout. Values do
 * not fall from point to point; of several points at one value the first and the last count, a
 * step. Beyond its ends a list goes on as it is there.
 */
#ifndef RENDER_APP_TRANSFER_LIST_H
#define RENDER_APP_TRANSFER_LIST_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "render/leafcast.h"

/* The largest extinction that a scene takes; no ray could tell it from a larger one. */
#define TRANSFER_LIST_MOST 1e100

/* Start with all zeros but for m. */
typedef struct transfer_list {
    mem *m;
    leafcast_transfer_point *points;
    size_t count, room;
} transfer_list;

/* transfer_list_add() - behind the others. ST_UNSUPPORTED where there would be more than
 * LEAFCAST_TRANSFER_POINTS_MAX; ST_NOMEM. */
CHECKED status transfer_list_add(transfer_list *t, leafcast_transfer_point point);

/* transfer_list_release() - as it was at the start. */
void transfer_list_release(transfer_list *t);

/* transfer_list_at() - the function at a value: where it steps, before (`after` false) or behind
 * the step. count is not 0. */
leafcast_transfer_point transfer_list_at(const transfer_list *t, double value, bool after);

/* transfer_list_stretch() - move the points so that a value from[0] comes to to[0], and from[1] to
 * to[1]; all are finite, from[0] <= all values <= from[1], to[0] <= to[1]. Where from[0] is
 * from[1], all come to to[0]. */
void transfer_list_stretch(transfer_list *t, const double from[2], const double to[2]);

/* transfer_list_join() - the colours of one list and the extinctions of another one, times
 * `factor` (at most TRANSFER_LIST_MOST), into an empty one, with the points of both. Neither is
 * empty. Errors as of transfer_list_add(). */
CHECKED status transfer_list_join(transfer_list *out, const transfer_list *colours,
                                  const transfer_list *extinctions, double factor);

#endif
