#include "formats/leaf/grid_coding.h"

size_t grid_coding_samples(const leaf_layout *l) {
    const size_t side = ((size_t)1 << l->cells_log2) + 1 + 2 * l->halo;
    const size_t root = side * side * side, shell = grid_family_shell_max(l);
    return root > shell ? root : shell;
}

/* The boxes that payload p codes, with samples in `memory`. Returns how many there are. */
static uint32_t boxes_of(const leaf_layout *l, uint32_t p, void *memory,
                         coded_box boxes[FAMILY_PARTS_MAX]) {
    uint32_t set, parent;
    if (leaf_layout_is_shell(l, p, &set, &parent))
        return grid_family_shell_boxes(l, parent, memory, boxes);
    boxes[0] = grid_family_own(l, p % l->treelets, memory);
    return 1;
}

uint32_t grid_coding_room(const leaf_layout *l, uint32_t p) {
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, NULL, boxes);
    size_t samples = 0;
    for (uint32_t i = 0; i < count; i++)
        samples += (size_t)boxes[i].size[0] * boxes[i].size[1] * boxes[i].size[2];
    return (uint32_t)box_coder_room(l->type, samples);
}

size_t grid_coding_pack(const leaf_layout *l, uint32_t p, box_coder *c, const void *from,
                        void *out) {
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, (void *)(uintptr_t)from, boxes);
    return box_coder_encode(c, boxes, count, out);
}

bool grid_coding_unpack(const leaf_layout *l, uint32_t p, box_coder *c, const void *in,
                        size_t bytes, void *to) {
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, to, boxes);
    return box_coder_decode(c, in, bytes, boxes, count);
}
