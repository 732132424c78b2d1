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

/* transfer_list_stretch() - move the points so that the first is at `lo` and the last at `hi`,
 * finite and lo <= hi. Where all are at one value, they all come to `lo`. */
void transfer_list_stretch(transfer_list *t, double lo, double hi);

/* transfer_list_join() - the colours of one list and the extinctions of another one, times
 * `factor`, into an empty one, with the points of both. Neither is empty. Errors as of
 * transfer_list_add(). */
CHECKED status transfer_list_join(transfer_list *out, const transfer_list *colours,
                                  const transfer_list *extinctions, double factor);

#endif
