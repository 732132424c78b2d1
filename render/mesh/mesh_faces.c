#include "render/mesh/mesh_faces.h"

#include <string.h>

#include "formats/base/exact.h"
#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_sight.h"

static size_t words_of(const mesh_shape *shape) {
    return (shape->tets + 63) / 64;
}

static size_t faces_bytes(const mesh_shape *shape) {
    return sizeof(mesh_faces) + 8 * words_of(shape) + 4 * sizeof(uint32_t) * shape->tets +
           sizeof(uint32_t) * shape->vertices + shape->nodes;
}

static mesh_faces *lay_out(void *block, const mesh_shape *shape) {
    mesh_faces *f = block;
    f->outer.tets = (uint64_t *)(f + 1);
    f->beyond = (uint32_t(*)[4])(f->outer.tets + words_of(shape));
    f->first = (uint32_t *)(f->beyond + shape->tets);
    f->outer.children = (uint8_t *)(f->first + shape->vertices);
    f->outer.sides = NULL;
    return f;
}

/* ---- Neighbours ---- */

/* During the search, a face that has no neighbour yet is in the list of its first vertex; `beyond`
 * holds the next face of the list. The side of a face is the side on which its tet lies. */
typedef struct face_search {
    const uint16_t (*tets)[4];
    mesh_faces *faces;
} face_search;

static uint32_t *entry_of(const face_search *s, uint32_t at) {
    return &s->faces->beyond[at >> 2][at & 3];
}

static bool same_face(const face_search *s, uint32_t a, uint32_t b) {
    const uint16_t *x = s->tets[a >> 2], *y = s->tets[b >> 2];
    const uint8_t *i = tet_faces[a & 3].vertex, *j = tet_faces[b & 3].vertex;
    return x[i[0]] == y[j[0]] && x[i[1]] == y[j[1]] && x[i[2]] == y[j[2]];
}

static int orientation_of(const resident_mesh *tr, uint32_t local) {
    const uint16_t *v = mesh_leaf_tets(&tr->mesh, tr->head.payload)[local];
    double p[4][3];
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            p[i][a] = (double)tr->positions[v[i]][a];
    return exact_orientation((const double(*)[3])p);
}

static int side_of(const resident_mesh *tr, uint32_t at) {
    return tet_faces[at & 3].inwards * orientation_of(tr, at >> 2);
}

/* Pair a face of a tet that is not flat with its neighbour, or put it into the list. side: the
 * face's side. */
static void match(const resident_mesh *tr, const face_search *s, uint32_t at, int side) {
    uint32_t *link = &s->faces->first[s->tets[at >> 2][tet_faces[at & 3].vertex[0]]];
    uint32_t *const first = link;
    for (; *link != MESH_OUTER; link = entry_of(s, *link)) {
        const uint32_t other = *link;
        if (!same_face(s, at, other) || side_of(tr, other) != -side)
            continue;
        *link = *entry_of(s, other);
        *entry_of(s, other) = at;
        *entry_of(s, at) = other;
        return;
    }
    *entry_of(s, at) = *first;
    *first = at;
}

static void find_neighbours(const resident_mesh *tr, mesh_faces *f) {
    const face_search s = {.tets = mesh_leaf_tets(&tr->mesh, tr->head.payload), .faces = f};
    memset(f->first, 0xff, tr->mesh.vertices * sizeof *f->first);
    memset(f->beyond, 0xff, tr->mesh.tets * sizeof *f->beyond);
    for (uint32_t i = 0; i < tr->mesh.tets; i++) {
        const int orientation = orientation_of(tr, i);
        for (uint32_t k = 0; k < TET_FACES && orientation != 0; k++)
            match(tr, &s, 4 * i + k, tet_faces[k].inwards * orientation);
    }
    for (uint32_t v = 0; v < tr->mesh.vertices; v++)
        for (uint32_t at = f->first[v]; at != MESH_OUTER;) {
            uint32_t *entry = entry_of(&s, at);
            at = *entry;
            *entry = MESH_OUTER;
        }
}

/* ---- Masks ---- */

static bool any_outer(const mesh_faces *f, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++)
        if (f->outer.tets[i / 64] >> i % 64 & 1u)
            return true;
    return false;
}

static void find_outer(const resident_mesh *tr, mesh_faces *f) {
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->head.payload);
    memset(f->outer.tets, 0, words_of(&tr->mesh) * sizeof *f->outer.tets);
    for (uint32_t i = 0; i < tr->mesh.tets; i++)
        for (int k = 0; k < TET_FACES; k++)
            f->outer.tets[i / 64] |= (uint64_t)(f->beyond[i][k] == MESH_OUTER) << i % 64;
    /* Children have larger numbers, so go backwards. */
    for (uint32_t n = tr->mesh.nodes; n-- > 0;) {
        f->outer.children[n] = 0;
        for (unsigned c = 0; c < MESH_CHILDREN; c++) {
            const uint16_t child = tr->nodes[n].child[c];
            const uint32_t leaf = child & ~(uint32_t)MESH_LEAF;
            if (child == MESH_NO_CHILD)
                continue;
            const bool any = child & MESH_LEAF ? any_outer(f, first[leaf], first[leaf + 1])
                                               : f->outer.children[child] != 0;
            f->outer.children[n] |= (uint8_t)(any << c);
        }
    }
}

static void make_faces(resident_mesh *tr, const interest *in) {
    (void)in;
    mesh_faces *f = lay_out(tr->derived, &tr->mesh);
    /* Faces do not depend on the interest: make them only for another set. */
    if (f->set != tr->head.set + 1) {
        find_neighbours(tr, f);
        find_outer(tr, f);
        f->set = tr->head.set + 1;
    }
    tr->faces = f;
}

mesh_derived mesh_faces_kind(void) {
    return (mesh_derived){faces_bytes, make_faces};
}
