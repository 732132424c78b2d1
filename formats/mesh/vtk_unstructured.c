#include "formats/mesh/vtk_unstructured.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/mesh/mesh_choice.h"
#include "formats/mesh/vtk_average.h"
#include "formats/vtk/vtk_cursor.h"

enum { COMPONENTS_MAX = 4096 };

status vtk_unstructured_add_path(vtk_unstructured *g, const char *path, const char **out) {
    status st = mem_grow(g->m, &g->paths, sizeof *g->paths, g->path_count, 4, &g->path_room);
    char *kept = st == ST_OK ? mem_copy_text(g->m, path) : NULL;
    if (!kept)
        return ST_NOMEM;
    *out = g->paths[g->path_count++] = kept;
    return ST_OK;
}

status vtk_unstructured_add_piece(vtk_unstructured *g, const char *path, vtk_piece **out) {
    status st = mem_grow(g->m, &g->pieces, sizeof *g->pieces, g->count, 8, &g->room);
    if (st == ST_OK)
        *out = &g->pieces[g->count++];
    if (st == ST_OK)
        (*out)->path = path;
    return st;
}

/* ---- the field ---- */

static bool is_numeric(const vtk_array *a) {
    return vtk_array_width(a->type) > 0;
}

static const vtk_array *find_anywhere(const vtk_unstructured *g, vtk_owner owner,
                                      const char *name) {
    const vtk_array *a = NULL;
    for (size_t i = 0; !a && i < g->count; i++)
        a = vtk_fields_find(&g->pieces[i].fields, owner, name);
    return a;
}

static status no_field(const vtk_unstructured *g, const mesh_hints *asked) {
    name_list names[VTK_OWNERS] = {0};
    for (size_t i = 0; i < g->count; i++)
        for (int o = 0; o < VTK_OWNERS; o++)
            for (size_t k = 0; k < g->pieces[i].fields.count[o]; k++)
                if (is_numeric(&g->pieces[i].fields.items[o][k]))
                    name_list_add(&names[o], g->pieces[i].fields.items[o][k].name);
    return mesh_choice_missing(g->source->path, asked, &names[VTK_OF_POINTS], &names[VTK_OF_CELLS]);
}

const vtk_array *vtk_unstructured_field(const vtk_unstructured *g, const vtk_piece *p, uint32_t k) {
    return vtk_fields_find(&p->fields, g->owner, g->taken[k]->name);
}

/* Returns the piece's number in its own file, from 1. */
static size_t number_in_file(const vtk_unstructured *g, size_t i) {
    size_t number = 1;
    while (number <= i && g->pieces[i - number].path == g->pieces[i].path)
        number++;
    return number;
}

/* Check the chosen array in each piece that needs it. */
static status check_pieces(const vtk_unstructured *g, const vtk_array *chosen) {
    for (size_t i = 0; i < g->count; i++) {
        const vtk_piece *p = &g->pieces[i];
        const uint64_t tuples = g->owner == VTK_OF_POINTS ? p->points : p->cells.lists.count;
        const vtk_array *field = vtk_fields_find(&p->fields, g->owner, chosen->name);
        if (!field && tuples > 0)
            return status_describe(ST_CORRUPT, "%s: piece %zu has no array \"%s\", unlike others",
                                   p->path, number_in_file(g, i), chosen->name);
        if (!field)
            continue;
        if (!is_numeric(field))
            return vtk_array_fault(field, ST_UNSUPPORTED, "strings and packed bits are no values");
        if (field->components != chosen->components)
            return vtk_array_fault(field, ST_CORRUPT,
                                   "%u components, expected %u as in the first piece",
                                   field->components, chosen->components);
    }
    return ST_OK;
}

/* Take the field of this name; NULL: the first. */
static status take_field(vtk_unstructured *g, const char *name) {
    mesh_hints asked = g->source->hints;
    asked.field = name;
    g->owner = asked.cells_to_points ? VTK_OF_CELLS : VTK_OF_POINTS;
    const vtk_array *chosen = find_anywhere(g, g->owner, name);
    if (!chosen)
        return no_field(g, &asked);
    if (chosen->components > COMPONENTS_MAX)
        return vtk_array_fault(chosen, ST_UNSUPPORTED, "%u components, at most %d are supported",
                               chosen->components, COMPONENTS_MAX);
    status st =
        mesh_choice_component(g->source->path, &asked, chosen->name, (int)chosen->components);
    g->taken[g->taken_count++] = chosen;
    return st == ST_OK ? check_pieces(g, chosen) : st;
}

status vtk_unstructured_take(void *state, const char *const *names, uint32_t count) {
    vtk_unstructured *g = state;
    mem_free(g->m, g->taken);
    g->taken_count = 0;
    g->taken = mem_array(g->m, count, sizeof *g->taken);
    status st = g->taken ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        st = take_field(g, names[i]);
    return st;
}

static status check_piece(const vtk_piece *p) {
    if (p->points == 0)
        return ST_OK;
    if (p->position.type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the positions of %llu points", p->path,
                               (unsigned long long)p->points);
    if (p->position.components != 3 || !is_numeric(&p->position))
        return vtk_array_fault(&p->position, ST_CORRUPT, "%u components, expected 3",
                               p->position.components);
    return ST_OK;
}

static status check(vtk_unstructured *g) {
    for (size_t i = 0; i < g->count; i++) {
        vtk_piece *p = &g->pieces[i];
        status st = check_piece(p);
        if (st != ST_OK)
            return st;
        if (p->points > MESH_POINTS_MAX || g->points + p->points > MESH_POINTS_MAX)
            return status_describe(ST_UNSUPPORTED, "%s: more than %llu points", g->source->path,
                                   (unsigned long long)MESH_POINTS_MAX);
        g->points += p->points;
    }
    return ST_OK;
}

/* ---- opening and closing ---- */

status vtk_unstructured_open(mesh_source *source,
                             status (*scan)(vtk_unstructured *g, byte_stream *data), void **state) {
    vtk_unstructured *g = mem_zalloc(source->m, sizeof *g);
    if (!g)
        return ST_NOMEM;
    *state = g;
    g->m = source->m;
    g->source = source;
    status st = vtk_array_check_file(source->path);
    if (st == ST_OK)
        st = scan(g, source->data);
    for (size_t i = 0; i < g->count; i++) {
        g->pieces[i].cells.ghosts = vtk_fields_ghosts(&g->pieces[i].fields);
        g->pieces[i].cells.by_corners = source->hints.by_corners;
    }
    return st == ST_OK ? check(g) : st;
}

void vtk_unstructured_close(void *state) {
    vtk_unstructured *g = state;
    if (!g)
        return;
    for (size_t i = 0; i < g->count; i++)
        vtk_fields_release(&g->pieces[i].fields, g->m);
    for (size_t i = 0; i < g->path_count; i++)
        mem_free(g->m, g->paths[i]);
    mem_free(g->m, g->paths);
    vtk_parts_release(&g->parts, g->m);
    mem_free(g->m, g->pieces);
    mem_free(g->m, g->taken);
    mem_free(g->m, g);
}

/* ---- reading ---- */

static status read_points(vtk_unstructured *g, const vtk_piece *p, mesh_feed *feed) {
    vtk_cursor *c = NULL;
    status st = p->points ? vtk_cursor_open(g->m, &p->position, 3 * p->points, &c) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < p->points; i++) {
        double xyz[3];
        st = vtk_cursor_doubles(c, 3, xyz);
        if (st == ST_OK)
            st = mesh_feed_point(feed, xyz);
    }
    if (st == ST_OK && c)
        st = vtk_cursor_finish(c);
    vtk_cursor_close(c);
    return st;
}

/* Read the k-th field of a piece. */
static status read_values(vtk_unstructured *g, const vtk_piece *p, uint32_t k, mesh_feed *feed) {
    const vtk_array *field = vtk_unstructured_field(g, p, k);
    const int count = (int)field->components;
    vtk_cursor *c = NULL;
    double *tuple = mem_array(g->m, (size_t)count, sizeof *tuple);
    status st = tuple ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = vtk_cursor_open(g->m, field, p->points * (uint64_t)count, &c);
    for (uint64_t i = 0; st == ST_OK && i < p->points; i++) {
        st = vtk_cursor_doubles(c, (size_t)count, tuple);
        if (st == ST_OK)
            st = mesh_feed_value(feed, k,
                                 mesh_feed_magnitude(tuple, count, g->source->hints.component));
    }
    if (st == ST_OK)
        st = vtk_cursor_finish(c);
    vtk_cursor_close(c);
    mem_free(g->m, tuple);
    return st;
}

/* Whether a polyhedron is handed over. */
static bool is_taken(const vtk_piece *p, const vtk_cell *cell) {
    return cell->polyhedron.faces && !cell->copied && !cell->hidden &&
           mesh_polyhedron_inside(&cell->polyhedron, p->points);
}

/* The file is read several times: its polyhedra must add the points that were counted. */
static status changed(const vtk_piece *p) {
    return status_describe(ST_IO, "%s: changed while it was read", p->path);
}

/* Go through the polyhedra of a piece: count the points that they add, or feed these. */
static status each_polyhedron(vtk_unstructured *g, vtk_piece *p, mesh_feed *feed) {
    mesh_polyhedron_room room = {.m = g->m};
    uint64_t fed = 0;
    vtk_cells *cells = NULL;
    status st = p->cells.lists.count ? vtk_cells_open(g->m, &p->cells, &cells) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < p->cells.lists.count; i++) {
        vtk_cell cell;
        st = vtk_cells_next(cells, &cell);
        if (st != ST_OK || !is_taken(p, &cell))
            continue;
        if (!feed) {
            p->middles += mesh_polyhedron_middles(&cell.polyhedron);
            continue;
        }
        fed += mesh_polyhedron_middles(&cell.polyhedron);
        st = fed <= p->middles ? mesh_polyhedron_reserve(&room, &cell.polyhedron) : changed(p);
        if (st == ST_OK)
            st = mesh_polyhedron_feed_middles(&cell.polyhedron, feed, g->taken_count, &room);
    }
    vtk_cells_close(cells);
    mesh_polyhedron_release(&room);
    return st == ST_OK && feed && fed < p->middles ? changed(p) : st;
}

static status count_middles(vtk_unstructured *g, uint64_t *points) {
    *points = 0;
    for (size_t i = 0; i < g->count; i++) {
        vtk_piece *p = &g->pieces[i];
        bool some;
        status st = vtk_cells_may_hold_polyhedra(g->m, &p->cells, &some);
        p->middles = 0;
        if (st == ST_OK && some)
            st = each_polyhedron(g, p, NULL);
        if (st != ST_OK)
            return st;
        *points += p->points + p->middles;
    }
    return ST_OK;
}

/* Read a piece's cells. Its points are numbered from `first` on, behind the points of the pieces
 * before. */
static status read_cells(vtk_unstructured *g, const vtk_piece *p, uint64_t first, mesh_feed *feed) {
    vtk_cells *cells = NULL;
    uint64_t middle = first + p->points;
    const uint64_t end = middle + p->middles;
    status st = p->cells.lists.count ? vtk_cells_open(g->m, &p->cells, &cells) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < p->cells.lists.count; i++) {
        vtk_cell cell;
        st = vtk_cells_next(cells, &cell);
        if (st != ST_OK)
            break;
        if (is_taken(p, &cell)) {
            const uint64_t own = mesh_polyhedron_middles(&cell.polyhedron);
            st = own <= end - middle ? mesh_polyhedron_feed(&cell.polyhedron, feed, first, middle)
                                     : changed(p);
            middle += own;
            continue;
        }
        for (int v = 0; v < cell.count; v++)
            cell.ids[v] = cell.ids[v] < p->points ? first + cell.ids[v] : UINT64_MAX;
        if (cell.copied || cell.hidden)
            feed->report->ghosts++;
        else if (cell.polyhedron.faces)
            feed->report->bad_indices++;
        else if (cell.volume) {
            feed->report->by_corners += cell.bent;
            st = mesh_feed_cell(feed, cell.kind, cell.ids);
        } else
            feed->report->skipped++;
    }
    if (st == ST_OK && cells)
        st = vtk_cells_finish(cells);
    vtk_cells_close(cells);
    return st;
}

static status read_fields(vtk_unstructured *g, const vtk_piece *p, mesh_feed *feed) {
    status st = ST_OK;
    if (p->points == 0 || g->taken_count == 0)
        return ST_OK;
    if (g->owner == VTK_OF_CELLS)
        return vtk_average_feed(g, p, feed);
    for (uint32_t k = 0; st == ST_OK && k < g->taken_count; k++)
        st = read_values(g, p, k, feed);
    return st;
}

status vtk_unstructured_read(void *state, mesh_feed *feed) {
    vtk_unstructured *g = state;
    if (g->taken_count > 0)
        snprintf(feed->report->field, sizeof feed->report->field, "%s", g->taken[0]->name);
    uint64_t first = 0, points;
    status st = count_middles(g, &points);
    if (st == ST_OK)
        st = mesh_feed_expect(feed, points);
    for (size_t i = 0; i < g->count; i++) {
        g->pieces[i].cells.quadratic = mesh_feed_takes_quadratic(feed);
        mesh_feed_expect_cells(feed, g->pieces[i].cells.lists.count);
    }
    for (size_t i = 0; st == ST_OK && i < g->count; i++) {
        vtk_piece *p = &g->pieces[i];
        st = mesh_feed_keep(feed, p->middles ? p->points : 0);
        if (st == ST_OK)
            st = read_points(g, p, feed);
        if (st == ST_OK)
            st = read_fields(g, p, feed);
        if (st == ST_OK && p->middles)
            st = each_polyhedron(g, p, feed);
        if (st == ST_OK)
            st = read_cells(g, p, first, feed);
        first += p->points + p->middles;
    }
    return st == ST_OK && g->taken_count == 0 ? mesh_feed_zeros(feed) : st;
}

void vtk_unstructured_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const vtk_unstructured *g = state;
    for (size_t i = 0; i < g->count; i++)
        for (size_t k = 0; k < g->pieces[i].fields.count[g->owner]; k++) {
            const vtk_array *a = &g->pieces[i].fields.items[g->owner][k];
            if (vtk_fields_is_one(a))
                take(ctx, a->name, (int)a->components);
        }
}
