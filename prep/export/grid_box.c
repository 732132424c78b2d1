#include "prep/export/grid_box.h"

#include <string.h>

grid_box grid_box_of(const grid_part *part) {
    grid_box b = {.level = part->level};
    memcpy(b.lo, part->lo, sizeof b.lo);
    memcpy(b.end, part->end, sizeof b.end);
    return b;
}

uint32_t grid_box_treelet(const leaf_layout *l, uint32_t level, int axis, uint32_t node) {
    const uint32_t t = node >> l->cells_log2, last = l->level[level].treelets[axis] - 1;
    return t < last ? t : last;
}

uint32_t grid_box_end(const leaf_layout *l, uint32_t level, int axis, uint32_t treelet) {
    const leaf_level *of = &l->level[level];
    return treelet + 1 == of->treelets[axis] ? of->dims[axis] : (treelet + 1) << l->cells_log2;
}

void grid_box_treelets(const grid_box *b, const leaf_layout *l, uint32_t first[3],
                       uint32_t count[3]) {
    for (int a = 0; a < 3; a++) {
        first[a] = grid_box_treelet(l, b->level, a, b->lo[a]);
        count[a] = grid_box_treelet(l, b->level, a, b->end[a] - 1) - first[a] + 1;
    }
}

void grid_box_copy(const grid_box *b, const leaf_layout *l, const uint32_t place[3],
                   const char *payload) {
    const leaf_payload p = leaf_layout_payload(l, leaf_layout_find(l, b->level, place));
    const size_t width = sample_size(l->type), row = width * (b->end[0] - b->lo[0]);
    const size_t slice = row * (b->end[1] - b->lo[1]);
    uint32_t first[3], end[3], within[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t own = place[a] << l->cells_log2;
        const uint32_t own_end = grid_box_end(l, b->level, a, place[a]);
        first[a] = own > b->lo[a] ? own : b->lo[a];
        end[a] = own_end < b->end[a] ? own_end : b->end[a];
        within[a] = first[a] + l->halo - own;
    }
    for (uint32_t z = first[2]; z < end[2]; z++)
        for (uint32_t y = first[1]; y < end[1]; y++) {
            const size_t at =
                ((size_t)(within[2] + z - first[2]) * p.samples[1] + within[1] + y - first[1]) *
                    p.samples[0] +
                within[0];
            memcpy(b->samples + (z - b->lo[2]) * slice + (y - b->lo[1]) * row +
                       (first[0] - b->lo[0]) * width,
                   payload + p.samples_at + at * width, (end[0] - first[0]) * width);
        }
}
