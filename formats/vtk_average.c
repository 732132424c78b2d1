#include "formats/vtk_average.h"

#include <string.h>

#include "formats/vtk_cursor.h"

enum { WINDOW_MIN = 1 << 10, WINDOW_MAX = 1 << 24 };

/* The points first .. first + count - 1. */
typedef struct window {
    uint64_t first;
    size_t count;
    double *sum;
    uint32_t *cells;
} window;

static size_t window_size(const mem *m, uint64_t points) {
    size_t most = WINDOW_MAX;
    if (m->limit > 0) {
        size_t used = mem_used(m), left = m->limit > used ? m->limit - used : 0;
        size_t fitting = left / 4 / (sizeof(double) + sizeof(uint32_t));
        if (fitting < most)
            most = fitting;
    }
    if (most < WINDOW_MIN)
        most = WINDOW_MIN;
    return points < most ? (size_t)points : most;
}

static bool all_points(const vtk_cell *cell, uint64_t points) {
    for (int v = 0; v < cell->count; v++)
        if (cell->ids[v] >= points)
            return false;
    return true;
}

static bool came_before(const vtk_cell *cell, int v) {
    for (int i = 0; i < v; i++)
        if (cell->ids[i] == cell->ids[v])
            return true;
    return false;
}

static void add_cell(window *w, const vtk_cell *cell, double value) {
    for (int v = 0; v < cell->count; v++) {
        uint64_t at = cell->ids[v] - w->first;
        if (cell->ids[v] < w->first || at >= w->count || came_before(cell, v))
            continue;
        w->sum[at] += value;
        w->cells[at]++;
    }
}

/* One round over the cells. */
static status add_cells(mem *m, const vtk_piece *p, int component, double *tuple, window *w) {
    size_t count = p->field->components;
    vtk_cells *cells = NULL;
    vtk_cursor *c = NULL;
    memset(w->sum, 0, w->count * sizeof *w->sum);
    memset(w->cells, 0, w->count * sizeof *w->cells);
    status st = vtk_cursor_open(m, p->field, p->cells.count * count, &c);
    if (st == ST_OK)
        st = vtk_cells_open(m, &p->cells, &cells);
    for (uint64_t i = 0; st == ST_OK && i < p->cells.count; i++) {
        vtk_cell cell;
        st = vtk_cells_next(cells, &cell);
        if (st == ST_OK)
            st = vtk_cursor_doubles(c, count, tuple);
        if (st == ST_OK && cell.volume && all_points(&cell, p->points))
            add_cell(w, &cell, mesh_feed_magnitude(tuple, (int)count, component));
    }
    if (st == ST_OK)
        st = vtk_cursor_finish(c);
    vtk_cells_close(cells);
    vtk_cursor_close(c);
    return st;
}

static status feed_means(const window *w, mesh_feed *feed) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < w->count; i++)
        st = mesh_feed_value(feed, w->cells[i] ? w->sum[i] / w->cells[i] : 0);
    return st;
}

status vtk_average_feed(mem *m, const vtk_piece *p, int component, mesh_feed *feed) {
    size_t most = window_size(m, p->points);
    window w = {0};
    double *tuple = NULL;
    if (p->points == 0)
        return ST_OK;
    w.sum = mem_array(m, most, sizeof *w.sum);
    w.cells = mem_array(m, most, sizeof *w.cells);
    if (p->field)
        tuple = mem_array(m, p->field->components, sizeof *tuple);
    status st = w.sum && w.cells && (tuple || !p->field) ? ST_OK : ST_NOMEM;
    for (; st == ST_OK && w.first < p->points; w.first += most) {
        uint64_t left = p->points - w.first;
        w.count = left < most ? (size_t)left : most;
        if (p->field && p->cells.count > 0)
            st = add_cells(m, p, component, tuple, &w);
        if (st == ST_OK)
            st = feed_means(&w, feed);
    }
    mem_free(m, tuple);
    mem_free(m, w.cells);
    mem_free(m, w.sum);
    return st;
}
