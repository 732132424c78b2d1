#include "formats/leaf/grid_coding.h"

/* The boxes that payload p codes, with samples in `memory`. Returns how many there are. */
static uint32_t boxes_of(const leaf_layout *l, uint32_t p, void *memory,
                         coded_box boxes[FAMILY_PARTS_MAX]) {
    uint32_t set, parent;
    if (leaf_layout_is_shell(l, p, &set, &parent))
        return grid_family_shell_boxes(l, parent, memory, boxes);
    boxes[0] = grid_family_own(l, p % l->treelets, memory);
    return 1;
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
