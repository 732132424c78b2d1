/* treelet.h - a resident treelet: what every kind has, and the kind's part.
 *
 * There may be several of the same id, one a set (a field at a time step); of a mesh they share
 * their topology. Only masks and nodes ever change while anybody looks, and only from one selection
 * to the next.
 */
#ifndef STREAM_TREELET_H
#define STREAM_TREELET_H

#include <stdatomic.h>
#include <stdbool.h>

#include "formats/leaf/leaf_layout.h"
#include "formats/mesh/mesh_leaf.h"
#include "stream/active.h"
#include "stream/mesh_active.h"

typedef struct treelet {
    uint32_t id;
    uint32_t set;         /* whose values these are; TREELET_NO_SET: none, as yet */
    const void *payload;  /* of a mesh: its topology */
    void *derived;        /* see mesh_derived.h; NULL: nothing */
    atomic_size_t masked; /* the selection of masks or active, 0: none; or LOADER_MASKING */
    union {
        struct { /* of a grid */
            uint32_t level;
            uint32_t first_cell[3]; /* of its level's grid */
            leaf_payload shape;
            const void *samples; /* at the halo's first sample */
            active_masks *masks;
        };
        struct { /* of a mesh */
            const void *values;
            const float (*gradients)[3]; /* at its vertices; NULL: not asked for */
            const void *moved; /* payload of positions, where they are not the topology's */
            mesh_shape mesh;
            const mesh_node *nodes;      /* with the boxes of its step */
            const float (*positions)[3]; /* of its step */
            uint64_t first_tet;          /* index of its first tet in the whole mesh */
            const float *bounds;         /* lo x y z, hi x y z */
            mesh_frame planes;           /* what its nodes' codes mean */
            mesh_active *active;
            bool refit; /* values and moved are memory of its own */
        };
    };
    /* The loader's: */
    size_t bytes;                         /* that it holds, without what it shares */
    struct treelet *older, *newer, *next; /* in the cache: by age; the next one of this id */
} treelet;

enum { TREELET_NO_SET = UINT32_MAX };

#endif
