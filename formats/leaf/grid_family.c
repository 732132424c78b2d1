#include "formats/leaf/grid_family.h"

#include <string.h>

/* A family's samples along one axis. */
typedef struct extent {
    uint32_t all;         /* how many */
    uint32_t from, to;    /* those that both treelets have; both 0: there is one treelet */
    uint32_t segments[2]; /* how many lie before them, and behind */
} extent;

static extent extent_of(const leaf_layout *l, uint32_t parent, int axis) {
    const leaf_level *v = &l->level[l->level_of[parent] - 1];
    const uint32_t b = 1U << l->cells_log2, shared = 1 + 2 * l->halo;
    const uint32_t left = v->cells[axis] - l->place[parent][axis] * 2 * b;
    const uint32_t cells = left < 2 * b ? left : 2 * b;
    if (cells <= b)
        return (extent){.all = cells + shared, .segments = {cells + shared, 0}};
    return (extent){.all = cells + shared, .from = b, .to = b + shared, .segments = {b, cells - b}};
}

static uint32_t begin_of(const extent *e, int segment) {
    return segment ? e->to : 0;
}

uint32_t grid_family_parts(const leaf_layout *l, uint32_t parent,
                           family_part parts[FAMILY_PARTS_MAX]) {
    const extent x = extent_of(l, parent, 0), y = extent_of(l, parent, 1),
                 z = extent_of(l, parent, 2);
    uint32_t n = 0;
    if (z.to)
        parts[n++] = (family_part){{0, 0, z.from}, {x.all, y.all, z.to - z.from}};
    for (int i = 0; i < 2 && z.segments[i]; i++) {
        const uint32_t at = begin_of(&z, i), deep = z.segments[i];
        if (y.to)
            parts[n++] = (family_part){{0, y.from, at}, {x.all, y.to - y.from, deep}};
        for (int k = 0; x.to && k < 2 && y.segments[k]; k++)
            parts[n++] =
                (family_part){{x.from, begin_of(&y, k), at}, {x.to - x.from, y.segments[k], deep}};
    }
    return n;
}

static size_t part_samples(const family_part *p) {
    return (size_t)p->size[0] * p->size[1] * p->size[2];
}

/* Turn a box that is thin along x, so that its rows run along y. Rows of 1 or 3 samples would be
 * slow to decode, and hard to predict along. */
static coded_box box_of(const family_part *p, void *at) {
    const uint32_t *s = p->size, row = s[0], sheet = s[0] * s[1];
    if (s[0] < s[1])
        return (coded_box){{s[1], s[2], s[0]}, {row, sheet, 1}, at};
    return (coded_box){{s[0], s[1], s[2]}, {1, row, sheet}, at};
}

uint32_t grid_family_shell_boxes(const leaf_layout *l, uint32_t parent, void *samples,
                                 coded_box boxes[FAMILY_PARTS_MAX]) {
    family_part parts[FAMILY_PARTS_MAX];
    const uint32_t count = grid_family_parts(l, parent, parts);
    char *at = samples;
    for (uint32_t i = 0; i < count; i++) {
        boxes[i] = box_of(&parts[i], at);
        at += part_samples(&parts[i]) * sample_size(l->type);
    }
    return count;
}

coded_box grid_family_own(const leaf_layout *l, uint32_t treelet, void *payload) {
    const leaf_payload p = leaf_layout_payload(l, treelet);
    const leaf_level *v = &l->level[l->level_of[treelet]];
    const uint32_t shared = 1 + 2 * l->halo;
    const uint32_t stride[3] = {1, p.samples[0], p.samples[0] * p.samples[1]};
    coded_box box = {.stride = {stride[0], stride[1], stride[2]}};
    size_t at = 0;
    for (int a = 0; a < 3; a++) {
        const uint32_t place = l->place[treelet][a];
        const bool second = place % 2, first_of_two = !second && place + 1 < v->treelets[a];
        box.size[a] = second || first_of_two ? p.samples[a] - shared : p.samples[a];
        at += second ? (size_t)shared * stride[a] : 0;
    }
    box.at = (char *)payload + p.samples_at + at * sample_size(l->type);
    return box;
}

/* Copy what lies both in a box of the shell and in a treelet, which has `count` samples from sample
 * `first` of the family on. */
static void take_part(const family_part *part, const uint32_t first[3], const uint32_t count[3],
                      size_t size, const char *from, char *to) {
    uint32_t lo[3], hi[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t part_end = part->at[a] + part->size[a], end = first[a] + count[a];
        lo[a] = part->at[a] > first[a] ? part->at[a] : first[a];
        hi[a] = part_end < end ? part_end : end;
        if (lo[a] >= hi[a])
            return;
    }
    const size_t row = (hi[0] - lo[0]) * size;
    for (uint32_t z = lo[2]; z < hi[2]; z++)
        for (uint32_t y = lo[1]; y < hi[1]; y++) {
            const size_t i = lo[0] - part->at[0] +
                             part->size[0] * ((size_t)(y - part->at[1]) +
                                              (size_t)part->size[1] * (z - part->at[2]));
            const size_t o =
                lo[0] - first[0] +
                count[0] * ((size_t)(y - first[1]) + (size_t)count[1] * (z - first[2]));
            memcpy(to + o * size, from + i * size, row);
        }
}

void grid_family_take(const leaf_layout *l, uint32_t parent, uint32_t treelet, const void *shell,
                      void *payload) {
    const leaf_payload p = leaf_layout_payload(l, treelet);
    const size_t size = sample_size(l->type);
    family_part parts[FAMILY_PARTS_MAX];
    const uint32_t count = grid_family_parts(l, parent, parts);
    const char *from = shell;
    uint32_t first[3];
    for (int a = 0; a < 3; a++)
        first[a] = (l->place[treelet][a] % 2) << l->cells_log2;
    for (uint32_t i = 0; i < count; i++) {
        take_part(&parts[i], first, p.samples, size, from, (char *)payload + p.samples_at);
        from += part_samples(&parts[i]) * size;
    }
}
