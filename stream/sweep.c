#include "stream/sweep.h"

#include <string.h>

/* The inner loop has no branch. */
void sweep_ranges(const float (*ranges)[2], uint32_t count, const interest *in, uint8_t *held) {
    memset(held, 0, count);
    for (int i = 0; i < in->count; i++) {
        const value_limits at = in->limits[i];
        for (uint32_t t = 0; t < count; t++)
            held[t] |= (uint8_t)((ranges[t][0] < at.beyond) & (ranges[t][1] >= at.reach));
    }
}

bool sweep_is_whole(const leaf_file *f, size_t i, const homogeneous *in) {
    return in->bins > 0 && !(f->flags[i] & LEAF_FLAG_NON_FINITE) &&
           homogeneous_holds(in, (double)f->own[i][0], (double)f->own[i][1]);
}

void sweep_whole(const leaf_file *f, uint32_t set, const homogeneous *in, uint8_t *own,
                 uint8_t *whole) {
    const size_t first = (size_t)f->layout.treelets * set;
    for (uint32_t t = 0; t < f->layout.treelets && in->bins > 0; t++) {
        whole[t] = own[t] && sweep_is_whole(f, first + t, in);
        own[t] = own[t] && !whole[t];
    }
}
