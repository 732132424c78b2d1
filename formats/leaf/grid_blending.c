/* grid_blending.c - times between the steps of a grid (leaf_blending.h). */
#include <assert.h>
#include <string.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/grid_codes.h"
#include "formats/leaf/grid_geometry.h"
#include "formats/leaf/leaf_blending.h"

static uint32_t first_set(const leaf_layout *l) {
    (void)l;
    return 0;
}

static status lay_out(leaf_file *f) {
    const leaf_layout *of = &f->below->layout;
    leaf_layout *l = &f->layout;
    const status st =
        leaf_layout_init(l, f->m, f->below->header.dims, of->cells_log2, of->halo, SAMPLE_F32);
    if (st != ST_OK)
        return st;
    (void)leaf_layout_repeat(l, 1, LEAF_BETWEEN_SETS, false); /* checked */
    if (of->sampled < of->levels)
        leaf_layout_bare(l);
    leaf_layout_keep_beside(l, (uint32_t)sample_size(of->type));
    assert(grid_codes_scratch_bytes(leaf_node_levels(l)) <=
           LEAF_BESIDE_SCRATCH(leaf_node_levels(l)));
    return ST_OK;
}

/* Copy the coordinates of all axes into one block, which axis[0] owns. */
static status take_axes(leaf_file *f) {
    const uint32_t *dims = f->header.dims;
    const size_t count = (size_t)dims[0] + dims[1] + dims[2];
    double *at = f->axis[0] = mem_array(f->m, count, sizeof *at);
    for (int a = 0; a < 3 && at; at += dims[a++]) {
        f->axis[a] = at;
        memcpy(at, f->below->axis[a], dims[a] * sizeof *at);
    }
    return at ? ST_OK : ST_NOMEM;
}

static status allocate(leaf_file *f) {
    const size_t deviations = deviation_count(&f->layout);
    const status st = take_axes(f);
    if (st != ST_OK || !f->below->deviations || !deviations)
        return st;
    f->deviations = mem_array(f->m, deviations, sizeof *f->deviations);
    return f->deviations ? ST_OK : ST_NOMEM;
}

/* Deviations of a coarse treelet. Blends that are not rounded deviate by the blend of deviations,
 * at most. Each sample is rounded by less than 2^-24 + 2^-50 of the greatest magnitude, or by
 * 2^-150, and the interpolants of two levels differ by such samples. */
static void blend_deviations(leaf_file *f, uint32_t set, const uint32_t sets[2], double share,
                             uint32_t t) {
    const leaf_layout *l = &f->layout, *of = &f->below->layout;
    const float *range = f->ranges[leaf_layout_samples(l, set, t)];
    const double most = fmax(fabs((double)range[0]), fabs((double)range[1]));
    const double rounding = range[0] <= range[1] ? most * 0x1p-22 + 0x1p-148 : INFINITY;
    const uint16_t *a = f->below->deviations + deviation_at(of, sets[0], t);
    const uint16_t *b = f->below->deviations + deviation_at(of, sets[1], t);
    uint16_t *to = f->deviations + deviation_at(l, set, t);
    for (uint32_t i = 0; i < deviation_bricks(l); i++)
        to[i] = deviation_code((1.0 - share) * deviation_value(a[i]) +
                               share * deviation_value(b[i]) + rounding);
}

static void fill(leaf_file *f, uint32_t set, const uint32_t sets[2], double share) {
    for (uint32_t t = 0; f->deviations && t < f->layout.treelets; t++)
        if (f->layout.level_of[t] > 0)
            blend_deviations(f, set, sets, share, t);
}

static uint32_t set_of(const leaf_layout *l, uint32_t p) {
    return p / l->treelets;
}

static uint32_t alike(const leaf_layout *l, uint32_t p, const leaf_layout *of, uint32_t set) {
    return leaf_layout_samples(of, set, p % l->treelets);
}

static leaf_beside beside(const leaf_layout *l, uint32_t p) {
    return leaf_layout_payload(l, p % l->treelets).beside;
}

static void make(const leaf_file *f, uint32_t p, const leaf_mix *m) {
    const leaf_payload shape = leaf_layout_payload(&f->layout, m->treelet);
    const uint32_t from = leaf_layout_payload(&f->below->layout, m->treelet).samples_at;
    m->blend(m->part[0] + from, m->part[1] ? m->part[1] + from : NULL, m->share,
             (float *)(m->payload + shape.samples_at),
             (size_t)shape.samples[0] * shape.samples[1] * shape.samples[2]);
    grid_codes_make_within(&f->layout, m->treelet, f->own[p], m->scratch, m->payload);
}

const leaf_blending grid_blending = {.blocks = LEAF_BETWEEN_SETS,
                                     .first_set = first_set,
                                     .lay_out = lay_out,
                                     .allocate = allocate,
                                     .fill = fill,
                                     .set_of = set_of,
                                     .alike = alike,
                                     .beside = beside,
                                     .make = make};
