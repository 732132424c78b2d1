/* bench_layers.h - how many surfaces made a pixel: read off its alpha. */
#ifndef RENDER_BENCH_BENCH_LAYERS_H
#define RENDER_BENCH_BENCH_LAYERS_H

#include <math.h>
#include <stdint.h>

/* bench_layers() - surfaces of one opacity behind each other that make this alpha, without a
 * background. Exact: a ray ends long before floats cannot tell their numbers apart. */
static inline uint64_t bench_layers(float alpha, float opacity) {
    if (opacity == 1.0f)
        return alpha > 0.0f;
    return (uint64_t)lround(log1p(-(double)alpha) / log1p(-(double)opacity));
}

#endif
