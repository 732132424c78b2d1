#include "render/surface/surface_value.h"

#include <math.h>

#include "render/ray/kind.h"
#include "render/ray/open_volume.h"

/* Sample treelets of one level one after the other, from *wanted on, until one holds the point.
 * Returns false if *wanted is needed first. */
static bool sample_level(const tracer *tr, const leafcast *v, uint32_t level, const double point[3],
                         uint32_t *wanted, bool *provisional, leafcast_sample *out,
                         surface_value *value) {
    const kind_walks *walks = v->kind->walks;
    uint32_t t = *wanted;
    if (t == LEAF_NO_TREELET)
        t = walks->treelet_at(v, level, point, LEAF_NO_TREELET);
    while (t != LEAF_NO_TREELET) {
        double unused;
        *wanted = LEAF_NO_TREELET;
        const treelet *at = tracer_enter(tr, t, 0.0, &unused, wanted, provisional);
        if (*wanted != LEAF_NO_TREELET)
            return false;
        if (at)
            v->kind->cell_in(v, at, point, out);
        if (at && tr->coloured)
            value->light = v->kind->colour_in(v, at, point, value->rgb);
        t = out->inside ? LEAF_NO_TREELET : walks->treelet_at(v, level, point, t);
    }
    return true;
}

bool surface_value_at(const frame *f, const surface_lookup *by, const double at[3],
                      uint32_t *wanted, bool *provisional, surface_value *out) {
    const tracer *tr = &f->tracer[by->object];
    const uint32_t levels = tr->layout->sampled;
    leafcast_sample s = {.value = (double)NAN};
    *out = (surface_value){.value = (double)NAN};
    double own[3];
    const double *point = placement_point(&tr->place, at, own);
    if (!sample_level(tr, by->volume, tr->target_level, point, wanted, provisional, &s, out))
        return false;
    /* A preview that lacks the treelet takes the finest level that is there. */
    for (uint32_t level = tr->target_level + 1; tr->preview && !s.inside && level < levels; level++)
        (void)sample_level(tr, by->volume, level, point, wanted, provisional, &s, out);
    if (s.inside)
        out->value = s.value;
    return true;
}
