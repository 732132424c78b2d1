#include "formats/mesh/vtk_average.h"

#include "formats/mesh/mesh_average.h"
#include "formats/vtk/vtk_cursor.h"

/* One round over the cells. */
static status add_cells(mem *m, const vtk_piece *p, int component, double *tuple, mesh_average *a) {
    size_t count = p->field->components;
    vtk_cells *cells = NULL;
    vtk_cursor *c = NULL;
    status st = vtk_cursor_open(m, p->field, p->cells.count * count, &c);
    if (st == ST_OK)
        st = vtk_cells_open(m, &p->cells, &cells);
    for (uint64_t i = 0; st == ST_OK && i < p->cells.count; i++) {
        vtk_cell cell;
        st = vtk_cells_next(cells, &cell);
        if (st == ST_OK)
            st = vtk_cursor_doubles(c, count, tuple);
        if (st == ST_OK && cell.volume)
            mesh_average_add(a, cell.kind, cell.ids,
                             mesh_feed_magnitude(tuple, (int)count, component));
    }
    if (st == ST_OK)
        st = vtk_cursor_finish(c);
    vtk_cells_close(cells);
    vtk_cursor_close(c);
    return st;
}

status vtk_average_feed(mem *m, const vtk_piece *p, int component, mesh_feed *feed) {
    bool any = p->field && p->cells.count > 0; /* else the sums stay 0 */
    mesh_average a = {0};
    if (p->points == 0)
        return ST_OK;
    double *tuple = mem_array(m, any ? p->field->components : 1, sizeof *tuple);
    status st = tuple ? mesh_average_begin_rounds(&a, m, p->points) : ST_NOMEM;
    for (bool more = true; st == ST_OK && more; more = mesh_average_next(&a)) {
        if (any)
            st = add_cells(m, p, component, tuple, &a);
        if (st == ST_OK)
            st = mesh_average_feed(&a, feed);
    }
    mesh_average_release(&a);
    mem_free(m, tuple);
    return st;
}
