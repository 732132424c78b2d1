/* treelet.h - a resident treelet: the head that all kinds share. Each kind has a struct of its own
 * that begins with this one (grid_resident.h, mesh_resident.h).
 *
 * Several treelets may have the same id, one per set (a field at a time step). Those of a mesh
 * share their topology. While other threads may use a treelet, only its masks and nodes change, and
 * only when the selection has changed.
 */
#ifndef STREAM_TREELET_H
#define STREAM_TREELET_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct treelet {
    uint32_t id;
    uint32_t set;         /* of its values; TREELET_NO_SET: it has none yet */
    const void *payload;  /* shared with other sets, if its kind shares */
    atomic_size_t masked; /* its masks' selection; 0: no masks; or LOADER_MASKING */
    /* For the loader: */
    size_t bytes; /* of memory, without a shared payload */
    bool alone;   /* its payload is another copy of the shared one, as both were read at once */
    struct treelet *older, *newer, *next; /* in the cache: by age, and by id */
} treelet;

enum { TREELET_NO_SET = UINT32_MAX };

#endif
