#include "formats/mesh/vtk_average.h"

#include "formats/mesh/mesh_average.h"
#include "formats/vtk/vtk_cursor.h"

enum { TOGETHER = 16 }; /* fields at a time; each has a cursor, with buffers */

/* Up to TOGETHER of a piece's taken fields, while they are averaged. */
typedef struct averaging {
    mem *m;
    const vtk_piece *piece;
    int component;
    uint32_t count;
    const vtk_array *fields[TOGETHER];
    vtk_cursor *values[TOGETHER];
    double *tuple; /* room for a tuple of any field */
    mesh_polyhedron_room room;
    mesh_average sums;
} averaging;

static status open_values(averaging *a) {
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < a->count; k++)
        st = vtk_cursor_open(a->m, a->fields[k],
                             a->piece->cells.lists.count * a->fields[k]->components, &a->values[k]);
    return st;
}

static status close_values(averaging *a, status st) {
    for (uint32_t k = 0; k < a->count; k++) {
        if (st == ST_OK)
            st = vtk_cursor_finish(a->values[k]);
        vtk_cursor_close(a->values[k]);
        a->values[k] = NULL;
    }
    return st;
}

static status add_cell(averaging *a, const vtk_cell *cell) {
    status st = ST_OK;
    size_t points = 0;
    if (cell->polyhedron.faces)
        st = mesh_polyhedron_reserve(&a->room, &cell->polyhedron);
    if (st == ST_OK && cell->polyhedron.faces)
        points = mesh_polyhedron_ids(&cell->polyhedron, a->room.ids);
    for (uint32_t k = 0; st == ST_OK && k < a->count; k++) {
        const size_t n = a->fields[k]->components;
        st = vtk_cursor_doubles(a->values[k], n, a->tuple);
        if (st != ST_OK || !cell->volume || cell->hidden)
            continue;
        const double value = mesh_feed_magnitude(a->tuple, (int)n, a->component);
        if (points)
            mesh_average_add_points(&a->sums, k, a->room.ids, points, value);
        else
            mesh_average_add(&a->sums, k, cell->kind, cell->ids, value);
    }
    return st;
}

/* Add all cells of the piece: one round. */
static status add_cells(averaging *a) {
    vtk_cells *cells = NULL;
    status st = open_values(a);
    if (st == ST_OK)
        st = vtk_cells_open(a->m, &a->piece->cells, &cells);
    for (uint64_t i = 0; st == ST_OK && i < a->piece->cells.lists.count; i++) {
        vtk_cell cell;
        st = vtk_cells_next(cells, &cell);
        if (st == ST_OK)
            st = add_cell(a, &cell);
    }
    vtk_cells_close(cells);
    return close_values(a, st);
}

static status make_tuple(averaging *a) {
    size_t most = 1;
    for (uint32_t k = 0; k < a->count; k++)
        if (a->fields[k] && a->fields[k]->components > most)
            most = a->fields[k]->components;
    a->tuple = mem_array(a->m, most, sizeof *a->tuple);
    return a->tuple ? ST_OK : ST_NOMEM;
}

static status feed_some(averaging *a, uint32_t first, mesh_feed *feed) {
    status st = make_tuple(a);
    if (st == ST_OK)
        st = mesh_average_begin_rounds(&a->sums, a->m, a->piece->points, a->count);
    for (bool more = true; st == ST_OK && more; more = mesh_average_next(&a->sums)) {
        if (a->piece->cells.lists.count > 0) /* else the sums stay 0 */
            st = add_cells(a);
        if (st == ST_OK)
            st = mesh_average_feed(&a->sums, feed, first);
    }
    mesh_average_release(&a->sums);
    mesh_polyhedron_release(&a->room);
    mem_free(a->m, a->tuple);
    return st;
}

status vtk_average_feed(const vtk_unstructured *g, const vtk_piece *p, mesh_feed *feed) {
    status st = ST_OK;
    for (uint32_t first = 0; st == ST_OK && first < g->taken_count; first += TOGETHER) {
        averaging a = {
            .m = g->m, .piece = p, .component = g->source->hints.component, .room = {.m = g->m}};
        for (; a.count < TOGETHER && first + a.count < g->taken_count; a.count++)
            a.fields[a.count] = vtk_unstructured_field(g, p, first + a.count);
        st = feed_some(&a, first, feed);
    }
    return st;
}
