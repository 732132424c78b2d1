/* simd_exp.h - portable_exp() (portable_math.h) for vectors: the same bits. */
#ifndef FORMATS_BASE_SIMD_EXP_H
#define FORMATS_BASE_SIMD_EXP_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <stddef.h>

#include "formats/base/portable_math.h"

/* simd_exp() - e^x for x <= 0. */
SIMD vd simd_exp(vd x) {
    static const double series[] = PORTABLE_EXP_SERIES;
    const vd ordinary = d_max(x, d_set(-700.0));
    const vd rounder = d_set(PORTABLE_ROUNDER);
    const vd n = ordinary * d_set(PORTABLE_LOG2_E) + rounder - rounder;
    const vd r = (ordinary - n * d_set(PORTABLE_LN2_HIGH)) - n * d_set(PORTABLE_LN2_LOW);
    vd p = d_set(series[0]);
    for (size_t i = 1; i < sizeof series / sizeof *series; i++)
        p = p * r + d_set(series[i]);
    const vd value = d_set(1.0) + (r + r * r * p);
    /* 2^n: the lowest bits of the sum are n + 1023. */
    const vl bits = (vl)(n + d_set(0x1.8p52 + 1023.0)) << 52;
    return d_select(d_lt(x, d_set(-700.0)), d_set(0.0), value * (vd)bits);
}

#endif
#endif
