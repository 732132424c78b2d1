#include "prep/resample/grid_fill.h"

#include <math.h>
#include <string.h>

status grid_fill_init(grid_fill *f, mem *m, const uint32_t dims[3]) {
    *f = (grid_fill){.m = m, .row = dims[0], .plane = (size_t)dims[0] * dims[1]};
    f->edges = mem_array(m, f->row, 1);
    f->squares = mem_array(m, f->plane, 1);
    if (!f->edges || !f->squares)
        return ST_NOMEM;
    memset(f->squares, 0, f->plane);
    return ST_OK;
}

void grid_fill_release(grid_fill *f) {
    mem_free(f->m, f->squares);
    mem_free(f->m, f->edges);
}

void grid_fill_count(grid_fill *f, const float *samples, size_t count) {
    for (size_t s = 0; s < count; s++) {
        const size_t i = f->at % f->row;
        const bool node = !isnan(samples[s]), edge = i && f->before && node,
                   square = f->at >= f->row && edge && f->edges[i],
                   cell = square && f->squares[f->at];
        f->nodes += node;
        f->cells += cell;
        f->before = node;
        f->edges[i] = edge;
        f->squares[f->at] = square;
        f->at = f->at + 1 < f->plane ? f->at + 1 : 0;
    }
}
