/* ray_box_template.h - ray_box.h for vectors of rays; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_RAY_RAY_BOX_TEMPLATE_H
#define RENDER_RAY_RAY_BOX_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

/* ray_slabs() - ray_box_slab() of VD_N rays; lo and hi are relative to the rays' origins. */
SIMD void ray_slabs(vd lo, vd hi, vd d, vd *t0, vd *t1) {
    const vd to_lo = lo / d, to_hi = hi / d;
    const md down = d_lt(d, d_set(0.0));
    const vd near = d_select(down, to_hi, to_lo), far = d_select(down, to_lo, to_hi);
    *t0 = d_select(d_gt(near, *t0), near, *t0);
    *t1 = d_select(d_lt(far, *t1), far, *t1);
}

#endif
#endif
