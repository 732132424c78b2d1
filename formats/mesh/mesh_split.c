#include "formats/mesh/mesh_split.h"

#include <assert.h>
#include <string.h>

enum { NONE = 0xff }; /* the fourth vertex of a triangle */

/* Faces are counterclockwise seen from outside if the cell's base is counterclockwise seen from
 * inside. */
typedef struct shape_faces {
    int vertices, faces;
    uint8_t face[6][4];
} shape_faces;

static const shape_faces shapes[CELL_SPLIT_SHAPES] = {
    [CELL_HEXAHEDRON] =
        {8,
         6,
         {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    [CELL_WEDGE] = {6,
                    5,
                    {{0, 2, 1, NONE}, {3, 4, 5, NONE}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    [CELL_PYRAMID] =
        {5, 5, {{0, 3, 2, 1}, {0, 1, 4, NONE}, {1, 2, 4, NONE}, {2, 3, 4, NONE}, {3, 0, 4, NONE}}},
    [CELL_VOXEL] =
        {8,
         6,
         {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}},
};

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

int mesh_split(cell_shape kind, const uint32_t *ids, uint32_t tets[MESH_SPLIT_TETS][4]) {
    static const uint8_t places[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    if (kind == CELL_TET) {
        memcpy(tets[0], ids, sizeof tets[0]);
        return 1;
    }
    const shape_faces *shape = &shapes[kind];
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
