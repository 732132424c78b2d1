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

size_t grid_coding_pack_from(const leaf_layout *l, uint32_t p, box_coder *c, const void *from,
                             const void *earlier, void *out) {
    coded_box boxes[FAMILY_PARTS_MAX], before[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, (void *)(uintptr_t)from, boxes);
    (void)boxes_of(l, p, (void *)(uintptr_t)earlier, before);
    return box_coder_encode_from(c, boxes, before, count, out);
}

uint64_t grid_coding_hash(const leaf_layout *l, uint32_t p, box_coder *c, const void *from) {
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, (void *)(uintptr_t)from, boxes);
    return box_coder_hash(c, boxes, count);
}

bool grid_coding_unpack(const leaf_layout *l, uint32_t p, box_coder *c, const void *in,
                        size_t bytes, bool difference, void *to) {
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = boxes_of(l, p, to, boxes);
    return box_coder_decode(c, in, bytes, boxes, count, difference);
}
