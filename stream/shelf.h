/* shelf.h - treelets that are resident and not drawn: of another isovalue, of another time step.
 *
 * Found by id and set, given up oldest first. Holds nothing but links: no memory comes or goes.
 */
#ifndef STREAM_SHELF_H
#define STREAM_SHELF_H

#include "formats/base/mem.h"
#include "stream/treelet.h"

typedef struct shelf {
    treelet **of; /* an id: the first of its list */
    treelet *oldest, *newest;
} shelf;

/* shelf_init() - for ids below count; NULL in *of when there is no memory. */
void shelf_init(shelf *s, mem *m, uint32_t count);
void shelf_release(shelf *s, mem *m);

/* shelf_put() - as the newest. */
void shelf_put(shelf *s, treelet *tr);

/* shelf_find() - the treelet of this id and set, or NULL; shelf_remove() - take it away. */
treelet *shelf_find(const shelf *s, uint32_t id, uint32_t set);
void shelf_remove(shelf *s, treelet *tr);

#endif
