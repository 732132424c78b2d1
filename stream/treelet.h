/* treelet.h - a resident treelet: the head that every kind's has. What follows it is the kind's
 * own: a struct that begins with one of these (grid_resident.h, mesh_resident.h).
 *
 * There may be several of the same id, one a set (a field at a time step); of a mesh they share
 * their topology. Only masks and nodes ever change while anybody looks, and only from one selection
 * to the next.
 */
#ifndef STREAM_TREELET_H
#define STREAM_TREELET_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

typedef struct treelet {
    uint32_t id;
    uint32_t set;         /* whose values these are; TREELET_NO_SET: none, as yet */
    const void *payload;  /* what sets share of it, where they do */
    atomic_size_t masked; /* the selection of its masks, 0: none; or LOADER_MASKING */
    /* The loader's: */
    size_t bytes;                         /* that it holds, without what it shares */
    struct treelet *older, *newer, *next; /* in the cache: by age; the next one of this id */
} treelet;

enum { TREELET_NO_SET = UINT32_MAX };

#endif
