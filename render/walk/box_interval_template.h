/* box_interval_template.h - box_interval.h for many rays; included by the units of an ISA (see
 * formats/base/simd.h). By how much boxes are widened, and why: render/ray/ray_box.h. */
#ifndef RENDER_WALK_BOX_INTERVAL_TEMPLATE_H
#define RENDER_WALK_BOX_INTERVAL_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/ray/ray_box_template.h"
#include "render/walk/box_interval.h"

/* Returns which of VD_N rays with directions d meet a box within [from, to], as box_interval_in()
 * does. Its corners are relative to the rays' origin; directions have no 0. */
SIMD unsigned box_interval_meets(const vd d[3], const double lo[3], const double hi[3], vd from,
                                 vd to) {
    vd t_in = d_set(-INFINITY), t_out = d_set(INFINITY);
    for (int a = 0; a < 3; a++)
        ray_slabs(d_set(lo[a]), d_set(hi[a]), d[a], &t_in, &t_out);
    /* If a number is not finite, min and max take the other operand: every box may then be met. */
    const vd generosity = d_set(2.0 * BOX_INTERVAL_MARGIN), length = t_out - t_in;
    const vd first = t_in - generosity * (d_abs(t_in) + length);
    const vd last = t_out + generosity * (d_abs(t_out) + length);
    return md_bits(d_le(d_max(first, from), d_min(last, to)));
}

#endif
#endif
