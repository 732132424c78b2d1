/* heights_field.h - a height field, prepared for the rays of a frame, and the elevations in a
 * resident treelet.
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_FIELD_H
#define RENDER_HEIGHTS_HEIGHTS_FIELD_H

#include "formats/leaf/quantize.h"
#include "render/heights/heights_patch.h"
#include "render/ray/tracer.h"
#include "stream/grid_resident.h"

/* tracer.own. */
typedef struct heights_field {
    sample_type type;
    uint32_t halo;
    double unit[3];    /* world lengths of grid units */
    double light[256]; /* of a byte of a colour */
} heights_field;

/* A treelet, prepared for rays. */
typedef struct heights_block {
    const resident_grid *of;
    const uint8_t *codes;
    const void *first; /* the sample of its first node */
    sample_type type;
    size_t row, slice; /* samples from node to node along axes 0 and 2 */
    double size, inverse;
    uint32_t cells[2];         /* of the level, along axes 0 and 2 */
    double range[2];           /* of all elevations */
    double least, step, slack; /* a code c means least + c * step, give or take slack */
} heights_block;

static inline double heights_sample(const heights_block *b, size_t i) {
    switch (b->type) {
    case SAMPLE_U8: return ((const uint8_t *)b->first)[i];
    case SAMPLE_I8: return ((const int8_t *)b->first)[i];
    case SAMPLE_U16: return ((const uint16_t *)b->first)[i];
    case SAMPLE_I16: return ((const int16_t *)b->first)[i];
    default: return (double)((const float *)b->first)[i];
    }
}

static inline heights_block heights_block_of(const tracer *tr, const treelet *at) {
    const resident_grid *g = resident_grid_of(at);
    const heights_field *field = tr->own;
    const leaf_level *level = &tr->layout->level[g->level];
    const size_t row = g->shape.samples[0], slice = row * g->shape.samples[1];
    const float *own = tracer_range(tr, at->id);
    const quantizer q = quantizer_of(own[0], own[1], field->type);
    heights_block b = {.of = g,
                       .codes = at->payload,
                       .type = field->type,
                       .row = 1,
                       .slice = slice,
                       .size = ldexp(1.0, (int)g->level),
                       .inverse = ldexp(1.0, -(int)g->level),
                       .cells = {level->cells[0], level->cells[2]},
                       .range = {q.lo, q.hi},
                       .least = q.lo,
                       .step = q.scale > 0.0 ? 1.0 / q.scale : 0.0};
    b.slack = 0x1p-40 * (q.hi - q.lo) + 0x1p-48 * (fabs(q.hi) + fabs(q.lo));
    b.first = (const char *)g->samples + field->halo * (1 + row + slice) * sample_size(b.type);
    return b;
}

/* heights_block_patch() - the patch over a cell of the treelet. False: it is a hole. */
static inline bool heights_block_patch(const heights_block *b, uint32_t i, uint32_t k,
                                       heights_patch *p) {
    const size_t at = i + k * b->slice;
    p->h[0] = heights_sample(b, at);
    p->h[1] = heights_sample(b, at + 1);
    p->h[2] = heights_sample(b, at + b->slice);
    p->h[3] = heights_sample(b, at + b->slice + 1);
    p->x = (double)(b->of->first_cell[0] + i) * b->size;
    p->z = (double)(b->of->first_cell[2] + k) * b->size;
    p->size = b->size;
    p->inverse = b->inverse;
    const double sum = (p->h[0] - p->h[1]) + (p->h[2] - p->h[3]);
    return sum - sum == 0.0; /* finite */
}

/* heights_block_cell() - the number of a cell in its level. */
static inline uint64_t heights_block_cell(const heights_block *b, uint32_t i, uint32_t k) {
    return b->of->first_cell[0] + i + (uint64_t)b->cells[0] * (b->of->first_cell[2] + k);
}

/* heights_block_range() - elevations of a node, at depth k, 1 or more, of the treelet's tree (leaf
 * FORMAT.md 6). False: no cell of it has any. */
static inline bool heights_block_range(const heights_block *b, uint32_t k, uint32_t morton,
                                       double range[2]) {
    const uint8_t *codes = b->codes + leaf_codes_at(k) + morton;
    const uint8_t lo = codes[0], hi = codes[(size_t)1 << 3 * k];
    range[0] = b->least + lo * b->step - b->slack;
    range[1] = b->least + hi * b->step + b->slack;
    return lo <= hi;
}

/* heights_hit_slope() - at a ray's hit with a patch: the gradient of height - elevation in grid
 * space and in world space, and the unit normal, upwards. Returns the height. */
static inline double heights_hit_slope(const affine *space, const heights_patch *p, const ray *r,
                                       double t, double slope[3], double gradient[3],
                                       float normal[3]) {
    const double u = heights_share(r->o[0], r->d[0], t, p->x, p->inverse);
    const double v = heights_share(r->o[2], r->d[2], t, p->z, p->inverse);
    double length = 0.0;
    slope[0] = heights_patch_slope(p, 0, v);
    slope[1] = -1.0;
    slope[2] = heights_patch_slope(p, 1, u);
    affine_gradient_to_world(space, slope, gradient);
    for (int a = 0; a < 3; a++)
        length += gradient[a] * gradient[a];
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)(-gradient[a] / length);
    return heights_patch_at(p->h, u, v);
}

/* heights_hit_surface() - the surface point of a hit in this treelet. */
surface_point heights_hit_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h);

#endif
