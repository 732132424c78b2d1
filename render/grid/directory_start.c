#include "render/grid/directory_start.h"

/* The octant of its parent that a treelet is in. */
static unsigned octant_of(const leaf_layout *l, uint32_t t) {
    const uint32_t *at = l->place[t];
    return (at[0] & 1u) | (at[1] & 1u) << 1 | (at[2] & 1u) << 2;
}

void directory_start_begin(directory_start *s, const leaf_layout *layout,
                           const level_planes *levels, const double eye[3], uint32_t first) {
    s->layout = layout;
    s->levels = levels;
    s->eye = eye;
    s->missed = LEAF_NO_TREELET;
    for (uint32_t v = 0; v < layout->levels; v++)
        s->path[v] = LEAF_NO_TREELET;
    for (uint32_t t = first; t > 0; t = leaf_layout_parent(layout, t))
        s->path[layout->level_of[t]] = t;
    if (first > 0)
        s->path[layout->levels - 1] = 0;
}

unsigned directory_start_order(const directory_start *s, uint32_t level, unsigned eye) {
    return ~0u << (octant_of(s->layout, s->path[level - 1]) ^ eye);
}

/* The octant of the eye in a treelet above level 0. */
static unsigned eye_in(const directory_start *s, uint32_t t) {
    const leaf_layout *l = s->layout;
    uint32_t first[3];
    for (int a = 0; a < 3; a++)
        first[a] = l->place[t][a] << l->cells_log2;
    return octant_of_eye(&s->levels[l->level_of[t]], first, 1u << (l->cells_log2 - 1), s->eye);
}

/* Whether treelet a comes before b. Neither is above the other, or they are the same. */
static bool comes_before(const directory_start *s, uint32_t a, uint32_t b) {
    const leaf_layout *l = s->layout;
    while (l->level_of[a] < l->level_of[b])
        a = leaf_layout_parent(l, a);
    while (l->level_of[b] < l->level_of[a])
        b = leaf_layout_parent(l, b);
    while (a != b) {
        const uint32_t above = leaf_layout_parent(l, a), other = leaf_layout_parent(l, b);
        if (above == other) {
            const unsigned eye = eye_in(s, above);
            return (octant_of(l, a) ^ eye) < (octant_of(l, b) ^ eye);
        }
        a = above;
        b = other;
    }
    return false;
}

void directory_start_note(directory_start *s, uint32_t t) {
    if (s->missed == LEAF_NO_TREELET || comes_before(s, t, s->missed))
        s->missed = t;
}
