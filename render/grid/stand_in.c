#include "render/grid/stand_in.h"

#include <math.h>

#include "formats/leaf/deviation.h"

stand_in stand_in_for(const tracer *tr, uint32_t t) {
    const leaf_layout *layout = tr->layout;
    const loader *l = tr->treelets;
    const uint32_t level = layout->level_of[t];
    for (uint32_t k = 1; level + k < layout->sampled && k <= layout->cells_log2; k++) {
        uint32_t place[3];
        for (int a = 0; a < 3; a++)
            place[a] = layout->place[t][a] >> k;
        const uint32_t up = leaf_layout_find(layout, level + k, place);
        if (l->whole[up])
            return (stand_in){NULL, up};
        /* The ancestor has no active cells: draw nothing. */
        if (!l->own[up])
            return (stand_in){NULL, LEAF_NO_TREELET};
        const treelet *at = loader_lookup(l, up);
        if (at) {
            tracer_touch(tr, up);
            return (stand_in){resident_grid_of(at), up};
        }
    }
    return (stand_in){NULL, tr->doubts ? t : LEAF_NO_TREELET};
}

/* Deviations say how far a level is from level 0, so they bound only treelets of level 0. */
bool stand_in_is_bounded(const tracer *tr, uint32_t t, const stand_in *of) {
    const leaf_file *f = tr->treelets->file;
    uint32_t up;
    return f->deviations && tr->layout->level_of[t] == 0 &&
           deviation_over(tr->layout, f->deviations, tr->set, t, of->at->level, &up) < INFINITY;
}
