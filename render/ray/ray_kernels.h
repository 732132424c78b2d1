/* ray_kernels.h - what takes many rays through a volume together: its kind's kernels for one ISA.
 *
 * A kind's row has them for all ISAs (kind.h). NULL: there is none, and rays go one by one. All
 * give the same bits. Those of an open volume may be changed between frames, by experiments and
 * tests.
 */
#ifndef RENDER_RAY_RAY_KERNELS_H
#define RENDER_RAY_RAY_KERNELS_H

#include "formats/base/cpu.h"
#include "render/ray/extreme_batch.h"
#include "render/ray/ray_batch.h"
#include "render/ray/segment_batch.h"

struct frame;
struct tile_outcome;

/* tile_fn - primary rays of a tile of pixels: render/frame/tile.h. */
typedef void (*tile_fn)(const struct frame *f, uint32_t x0, uint32_t y0, const uint32_t pixels[],
                        struct tile_outcome *out, ray_counters *counters);

typedef struct ray_kernels {
    cpu_isa isa;
    tile_fn tile;
    batch_fn batch;
    segment_batch_fn segment_batch;
    extreme_batch_fn extreme_batch;
} ray_kernels;

struct kind;

/* ray_kernels_of() - those of a kind for an ISA. */
ray_kernels ray_kernels_of(const struct kind *k, cpu_isa isa);

#endif
