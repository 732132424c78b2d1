#include "formats/mesh/mesh_split.h"

#include <assert.h>
#include <string.h>

enum { NONE = 0xff }; /* the fourth vertex of a triangle */

/* Faces are counterclockwise seen from outside if the cell's base is counterclockwise seen from
 * inside. */
typedef struct cell_shape {
    int vertices, faces;
    uint8_t face[6][4];
} cell_shape;

static const cell_shape shapes[MESH_SPLIT_KINDS] = {
    [MESH_HEX] =
        {8,
         6,
         {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    [MESH_WEDGE] = {6,
                    5,
                    {{0, 2, 1, NONE}, {3, 4, 5, NONE}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    [MESH_PYRAMID] =
        {5, 5, {{0, 3, 2, 1}, {0, 1, 4, NONE}, {1, 2, 4, NONE}, {2, 3, 4, NONE}, {3, 0, 4, NONE}}},
    [MESH_VOXEL] =
        {8,
         6,
         {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}},
};

int mesh_split_vertices(mesh_cell kind) {
    return kind == MESH_TET ? 4 : shapes[kind].vertices;
}

/* Returns the place of the smallest id; of equal ids the first. */
static int smallest(const uint32_t *ids, const uint8_t *places, int count) {
    int best = 0;
    for (int i = 1; i < count; i++)
        if (ids[places[i]] < ids[places[best]])
            best = i;
    return best;
}

static bool has(const uint8_t face[4], int vertex) {
    return memchr(face, vertex, 4) != NULL;
}

static void join(const uint32_t *ids, int apex, int a, int b, int c, uint32_t tet[4]) {
    tet[0] = ids[a];
    tet[1] = ids[c]; /* the apex is inside, where the face turns the other way */
    tet[2] = ids[b];
    tet[3] = ids[apex];
}

int mesh_split(mesh_cell kind, const uint32_t *ids, uint32_t tets[MESH_SPLIT_TETS][4]) {
    static const uint8_t places[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    if (kind == MESH_TET) {
        memcpy(tets[0], ids, sizeof tets[0]);
        return 1;
    }
    const cell_shape *shape = &shapes[kind];
    int apex = smallest(ids, places, shape->vertices), count = 0;
    for (int i = 0; i < shape->faces; i++) {
        const uint8_t *f = shape->face[i];
        if (has(f, apex))
            continue;
        bool quad = f[3] != NONE;
        int from = quad ? smallest(ids, f, 4) : 0;
        const int turn = quad ? 4 : 3;
        for (int k = 1; k + 1 < turn; k++)
            join(ids, apex, f[from], f[(from + k) % turn], f[(from + k + 1) % turn], tets[count++]);
    }
    assert(count <= MESH_SPLIT_TETS);
    return count;
}
