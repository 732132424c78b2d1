/* ray_kernels.h - a kind's kernels, for one ISA, that trace many rays through a volume together.
 *
 * A kind's row has them for all ISAs (kind.h). NULL: no kernel, rays go one by one. All kernels
 * give the same bits. Experiments and tests may change an open volume's kernels between frames.
 */
#ifndef RENDER_RAY_RAY_KERNELS_H
#define RENDER_RAY_RAY_KERNELS_H

#include "formats/base/cpu.h"
#include "render/ray/extreme_batch.h"
#include "render/ray/ray_batch.h"
#include "render/ray/segment_batch.h"

struct frame;
struct tile_outcome;

/* The most pixels on a side of a kind's tiles. */
enum { TILE_MAX = 32 };

/* tile_fn - trace the primary rays of a tile of pixels: render/frame/tile.h. */
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

/* ray_kernels_of() - the kernels of a kind for an ISA. */
ray_kernels ray_kernels_of(const struct kind *k, cpu_isa isa);

/* No kernels: all rays go one by one. */
extern const ray_kernels ray_kernels_none;

#endif
