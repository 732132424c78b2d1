#include "formats/leaf/leaf_histogram.h"

#include <math.h>
#include <string.h>

/* The box of nodes of a treelet, without samples. */
static histogram_block block_of(const leaf_layout *l, const histogram_draw *d, uint32_t t,
                                const leaf_payload *p) {
    histogram_block b = {.type = l->type};
    for (int a = 0; a < 3; a++) {
        b.first[a] = l->place[t][a] << l->cells_log2;
        b.end[a] = b.first[a] + p->cells[a];
        /* The last treelet also has the nodes of the far face. */
        b.end[a] += b.end[a] + 1 == d->dims[a];
    }
    return b;
}

void leaf_histogram_take(const leaf_layout *l, const histogram_draw *d, const histogram_space *s,
                         uint32_t t, const void *payload, histogram_cell *cells) {
    const leaf_payload p = leaf_layout_payload(l, t);
    histogram_block b = block_of(l, d, t, &p);
    b.row = p.samples[0];
    b.slice = b.row * p.samples[1];
    b.samples = (const char *)payload + p.samples_at +
                l->halo * (1 + b.row + b.slice) * sample_size(l->type);
    histogram_draw_take(d, s, &b, cells);
}

/* Use a single row of equal samples as every row of every slice. */
void leaf_histogram_take_one(const leaf_layout *l, const histogram_draw *d,
                             const histogram_space *s, uint32_t t, const void *sample,
                             histogram_cell *cells) {
    enum { ROW = (1 << LEAF_CELLS_LOG2_MAX) + 1 };
    const leaf_payload p = leaf_layout_payload(l, t);
    const size_t width = sample_size(l->type);
    float row[ROW];
    histogram_block b = block_of(l, d, t, &p);
    for (size_t i = 0; i < ROW; i++)
        memcpy((char *)row + i * width, sample, width);
    b.samples = row;
    histogram_draw_take(d, s, &b, cells);
}

histogram_run leaf_histogram_run(const leaf_file *f, uint32_t set, uint64_t cells) {
    return histogram_draw_tets(cells, leaf_file_segment_sets(f, set));
}

void leaf_histogram_take_tets(const histogram_run *r, uint64_t first_tet, const mesh_shape *s,
                              const uint16_t (*tets)[4], const float (*positions)[3],
                              const float *values, histogram_cell *cells) {
    const uint64_t end = first_tet + s->tets;
    for (uint64_t i = first_tet / r->step; i * r->step < end; i++) {
        const uint64_t tet = histogram_draw_tet(r, (uint32_t)i);
        if (tet < first_tet || tet >= end)
            continue;
        const uint16_t *corner = tets[tet - first_tet];
        const float *at[4];
        float value[4];
        for (int c = 0; c < 4; c++) {
            at[c] = positions[corner[c]];
            value[c] = values[corner[c]];
        }
        cells[i] = histogram_tet(at, value);
    }
}

/* The own ranges of a set's treelets of level 0. */
static const float (*own_ranges(const leaf_file *f, uint32_t set))[2] {
    const leaf_layout *l = &f->layout;
    return (const float(*)[2])f->own + (size_t)set * l->treelets + l->level[0].first;
}

void leaf_histogram_range(const leaf_file *f, uint32_t set, double range[2]) {
    const float(*own)[2] = own_ranges(f, set);
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (uint32_t t = 0; t < f->layout.level[0].count; t++) {
        range[0] = fmin(range[0], (double)own[t][0]);
        range[1] = fmax(range[1], (double)own[t][1]);
    }
}

/* Treat treelets as cells, with their ranges' widths as slopes. */
static status guess(mem *m, const leaf_file *f, uint32_t set, histogram *out) {
    const leaf_layout *l = &f->layout;
    const leaf_level *level = &l->level[0];
    const uint32_t step = level->count / HISTOGRAM_DRAWS + 1, count = (level->count - 1) / step + 1;
    const float(*own)[2] = own_ranges(f, set);
    double range[2];
    histogram_cell *cells = mem_array(m, count, sizeof *cells);
    if (!cells)
        return ST_NOMEM;
    leaf_histogram_range(f, set, range);
    for (uint32_t i = 0; i < count; i++) {
        const float lo = own[(size_t)i * step][0], hi = own[(size_t)i * step][1];
        const bool any = lo <= hi;
        cells[i] = (histogram_cell){.value = any ? 0.5F * lo + 0.5F * hi : NAN, .lo = lo, .hi = hi};
        if (lo < hi) {
            cells[i].slope = fminf(hi - lo, 1e30F);
            cells[i].area = 1;
        }
    }
    histogram_build(out, cells, count, l->type, range, level->count);
    mem_free(m, cells);
    return ST_OK;
}

status leaf_histogram_get(mem *m, const leaf_file *f, uint32_t set, histogram *out) {
    if (!f->histograms)
        return guess(m, f, set, out);
    *out = f->histograms[set];
    return ST_OK;
}
