#include "formats/surface/surface_vtk.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/surface/surface_colour.h"
#include "formats/surface/surface_flow.h"
#include "formats/vtk/vtk_cursor.h"

enum { COMPONENTS_MAX = 4096 };

static const char *const roles[SURFACE_VTK_KINDS] = {"vertices", "lines", "polygons", "strips"};

status surface_vtk_add_piece(surface_vtk *v, surface_vtk_piece **out) {
    status st = mem_grow(v->m, &v->pieces, sizeof *v->pieces, v->count, 8, &v->room);
    if (st == ST_OK)
        *out = &v->pieces[v->count++];
    return st;
}

/* ---- the fields ---- */

static bool is_colour(const vtk_array *a) {
    return (a->components == 3 || a->components == 4) && (a->type == VTK_U8 || a->colour);
}

static status add_field(surface_vtk *v, vtk_owner owner, const vtk_array *a) {
    surface_field f = {.of_faces = owner == VTK_OF_CELLS, .colour = is_colour(a)};
    if (!vtk_fields_is_one(a))
        return ST_OK;
    snprintf(f.name, sizeof f.name, "%s", a->name);
    f.components = f.colour ? 1 : a->components;
    return surface_choice_add(&v->choice, &f);
}

static status add_fields(surface_vtk *v, const vtk_fields *fields) {
    status st = ST_OK;
    for (int o = 0; o < VTK_OWNERS; o++)
        for (size_t i = 0; st == ST_OK && i < fields->count[o]; i++)
            st = add_field(v, (vtk_owner)o, &fields->items[o][i]);
    return st;
}

/* Returns a piece's array of a field; NULL: it has none. */
static const vtk_array *array_of(const surface_vtk_piece *p, const surface_field *f) {
    return vtk_fields_find(&p->fields, f->of_faces ? VTK_OF_CELLS : VTK_OF_POINTS, f->name);
}

static uint64_t cells_of(const surface_vtk_piece *p) {
    uint64_t cells = 0;
    for (int s = 0; s < SURFACE_VTK_KINDS; s++)
        cells += p->cells[s].count;
    return cells;
}

/* Check a field in each piece that needs it. */
static status check_field(const surface_vtk *v, const surface_field *f) {
    for (size_t i = 0; i < v->count; i++) {
        const surface_vtk_piece *p = &v->pieces[i];
        const vtk_array *a = array_of(p, f);
        if (!a && (f->of_faces ? cells_of(p) : p->points) > 0)
            return status_describe(ST_CORRUPT, "%s: piece %zu has no array \"%s\", unlike others",
                                   byte_stream_name(v->source->data), i + 1, f->name);
        if (!a)
            continue;
        if (!vtk_array_width(a->type))
            return vtk_array_fault(a, ST_UNSUPPORTED, "strings and packed bits are no values");
        if (is_colour(a) != f->colour || (!f->colour && a->components != f->components))
            return vtk_array_fault(a, ST_CORRUPT, "%u components, expected as in the first piece",
                                   a->components);
        if (a->components > COMPONENTS_MAX)
            return vtk_array_fault(a, ST_UNSUPPORTED, "%u components, at most %d are supported",
                                   a->components, COMPONENTS_MAX);
    }
    return ST_OK;
}

status surface_vtk_take(void *state, const char *const *names, uint32_t count) {
    surface_vtk *v = state;
    status st = surface_choice_take(state, names, count);
    for (uint32_t k = 0; st == ST_OK && k < v->choice.taken_count; k++)
        st = check_field(v, surface_choice_taken(&v->choice, k));
    return st;
}

/* ---- opening and closing ---- */

static status check_cells(const surface_vtk *v, surface_vtk_piece *p, surface_vtk_kind kind) {
    const vtk_lists *c = &p->cells[kind];
    const vtk_array *const arrays[2] = {&c->ids, &c->offsets};
    if (c->count > 0 && c->ids.type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the ids of its %s",
                               byte_stream_name(v->source->data), roles[kind]);
    for (int i = 0; c->count > 0 && i < 2; i++)
        if (arrays[i]->type != VTK_ABSENT && !vtk_array_whole(arrays[i]->type))
            return vtk_array_fault(arrays[i], ST_CORRUPT, "expected whole numbers");
    return ST_OK;
}

static status check_piece(surface_vtk *v, surface_vtk_piece *p) {
    status st = ST_OK;
    for (int s = 0; st == ST_OK && s < SURFACE_VTK_KINDS; s++)
        st = check_cells(v, p, (surface_vtk_kind)s);
    if (st != ST_OK || p->points == 0)
        return st;
    if (p->position.type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the positions of %llu points",
                               byte_stream_name(v->source->data), (unsigned long long)p->points);
    if (p->position.components != 3 || !vtk_array_width(p->position.type))
        return vtk_array_fault(&p->position, ST_CORRUPT, "%u components, expected 3",
                               p->position.components);
    if (p->points > MESH_POINTS_MAX || v->points + p->points > MESH_POINTS_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: more than %llu points",
                               byte_stream_name(v->source->data),
                               (unsigned long long)MESH_POINTS_MAX);
    v->points += p->points;
    return ST_OK;
}

status surface_vtk_open(mesh_source *source, status (*scan)(surface_vtk *v), void **state) {
    surface_vtk *v = mem_zalloc(source->m, sizeof *v);
    if (!v)
        return ST_NOMEM;
    *state = v;
    v->m = source->m;
    v->choice.source = v->source = source;
    status st = vtk_array_check_file(source->path);
    if (st == ST_OK)
        st = scan(v);
    for (size_t i = 0; st == ST_OK && i < v->count; i++) {
        st = check_piece(v, &v->pieces[i]);
        if (st == ST_OK)
            st = add_fields(v, &v->pieces[i].fields);
    }
    return st;
}

void surface_vtk_counts(const void *state, uint64_t *points, uint64_t *cells) {
    const surface_vtk *v = state;
    *points = v->points;
    *cells = 0;
    for (size_t i = 0; i < v->count; i++)
        *cells += v->pieces[i].cells[SURFACE_VTK_POLYGONS].count +
                  v->pieces[i].cells[SURFACE_VTK_STRIPS].count;
}

void surface_vtk_close(void *state) {
    surface_vtk *v = state;
    if (!v)
        return;
    for (size_t i = 0; i < v->count; i++)
        vtk_fields_release(&v->pieces[i].fields, v->m);
    mem_free(v->m, v->pieces);
    surface_choice_release(&v->choice);
    mem_free(v->m, v);
}

/* ---- points ---- */

static status read_points(surface_vtk *v, const surface_vtk_piece *p, surface_flow *flow) {
    vtk_cursor *c = NULL;
    status st = p->points ? vtk_cursor_open(v->m, &p->position, 3 * p->points, &c) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < p->points; i++) {
        double xyz[3];
        st = vtk_cursor_doubles(c, 3, xyz);
        if (st == ST_OK)
            st = surface_flow_point(flow, xyz);
    }
    if (st == ST_OK && c)
        st = vtk_cursor_finish(c);
    vtk_cursor_close(c);
    return st;
}

/* Whether an array is the normals of points: the attribute of that name, or by its own name. */
static const vtk_array *normals_of(const surface_vtk_piece *p) {
    const vtk_array *found = NULL;
    for (size_t i = 0; i < p->fields.count[VTK_OF_POINTS]; i++) {
        const vtk_array *a = &p->fields.items[VTK_OF_POINTS][i];
        if (a->components != 3 || !vtk_array_width(a->type))
            continue;
        if (a->normal)
            return a;
        found = strcmp(a->name, "Normals") == 0 ? a : found;
    }
    return found;
}

static bool has_normals(const surface_vtk *v) {
    bool any = false;
    for (size_t i = 0; i < v->count; i++)
        any = any || (v->pieces[i].points > 0 && normals_of(&v->pieces[i]));
    return any;
}

static status read_normals(surface_vtk *v, const surface_vtk_piece *p, surface_flow *flow) {
    const vtk_array *of = normals_of(p);
    vtk_cursor *c = NULL;
    if (!of)
        return surface_flow_no_normals(flow, p->points);
    status st = vtk_cursor_open(v->m, of, 3 * p->points, &c);
    for (uint64_t i = 0; st == ST_OK && i < p->points; i++) {
        double normal[3];
        st = vtk_cursor_doubles(c, 3, normal);
        if (st == ST_OK)
            st = surface_flow_normal(flow, normal);
    }
    if (st == ST_OK && c)
        st = vtk_cursor_finish(c);
    vtk_cursor_close(c);
    return st;
}

/* The numbers of one field of a piece, a tuple at a time. */
typedef struct values {
    const vtk_array *array;
    vtk_cursor *cursor;
    double *tuple;
    int component; /* the hints' */
} values;

static status open_values(surface_vtk *v, const vtk_array *a, uint64_t tuples, values *out) {
    *out = (values){.array = a, .component = v->source->hints.component};
    out->tuple = mem_array(v->m, a->components, sizeof *out->tuple);
    return out->tuple ? vtk_cursor_open(v->m, a, tuples * a->components, &out->cursor) : ST_NOMEM;
}

static status close_values(surface_vtk *v, values *x, status st) {
    if (st == ST_OK && x->cursor)
        st = vtk_cursor_finish(x->cursor);
    vtk_cursor_close(x->cursor);
    mem_free(v->m, x->tuple);
    return st;
}

static status next_value(values *x, double *out) {
    const vtk_array *a = x->array;
    status st = vtk_cursor_doubles(x->cursor, a->components, x->tuple);
    if (st == ST_OK)
        *out = is_colour(a) ? surface_colour_value(x->tuple, a->type == VTK_U8 ? 255 : 1)
                            : mesh_feed_magnitude(x->tuple, (int)a->components, x->component);
    return st;
}

/* Read the k-th field taken, which is one of the points. */
static status read_values(surface_vtk *v, const surface_vtk_piece *p, uint32_t k,
                          surface_flow *flow) {
    values x = {0};
    double value = 0;
    status st = open_values(v, array_of(p, surface_choice_taken(&v->choice, k)), p->points, &x);
    for (uint64_t i = 0; st == ST_OK && i < p->points; i++) {
        st = next_value(&x, &value);
        if (st == ST_OK)
            st = surface_flow_value(flow, k, value);
    }
    return close_values(v, &x, st);
}

/* ---- cells ---- */

/* A piece's cells while they are read. */
typedef struct cells {
    surface_vtk *v;
    const surface_vtk_piece *p;
    surface_flow *flow;
    values *fields; /* of the fields taken; those of the points stay closed */
    double *now;    /* their values of this cell */
    vtk_cursor *ghosts, *offsets, *ids;
    uint64_t end;  /* where the ids of the cell before end */
    uint64_t used; /* numbers among the ids so far */
    uint64_t *corners;
    size_t room;
} cells;

static status open_cells(cells *c) {
    surface_vtk *v = c->v;
    const uint32_t taken = v->choice.taken_count;
    const uint64_t count = cells_of(c->p);
    const vtk_array *ghosts = vtk_fields_ghosts(&c->p->fields);
    c->fields = mem_array(v->m, taken + 1, sizeof *c->fields);
    c->now = mem_array(v->m, taken + 1, sizeof *c->now);
    status st = c->fields && c->now ? ST_OK : ST_NOMEM;
    for (uint32_t k = 0; st == ST_OK && count > 0 && k < taken; k++) {
        const surface_field *f = surface_choice_taken(&v->choice, k);
        if (f->of_faces)
            st = open_values(v, array_of(c->p, f), count, &c->fields[k]);
    }
    if (st == ST_OK && ghosts && !vtk_array_whole(ghosts->type))
        return vtk_array_fault(ghosts, ST_CORRUPT, "expected whole numbers");
    if (st == ST_OK && ghosts && ghosts->components != 1)
        return vtk_array_fault(ghosts, ST_CORRUPT, "%u components, expected 1", ghosts->components);
    return st == ST_OK && ghosts && count > 0 ? vtk_cursor_open(v->m, ghosts, count, &c->ghosts)
                                              : st;
}

static status close_cells(cells *c, status st) {
    for (uint32_t k = 0; c->fields && k < c->v->choice.taken_count; k++)
        st = close_values(c->v, &c->fields[k], st);
    if (st == ST_OK && c->ghosts)
        st = vtk_cursor_finish(c->ghosts);
    vtk_cursor_close(c->ghosts);
    mem_free(c->v->m, c->fields);
    mem_free(c->v->m, c->now);
    mem_free(c->v->m, c->corners);
    return st;
}

/* Read the next cell's values, and whether it is left out: another piece has it, or it is hidden
 * (vtkGhostType has bits for that, vtkGhostLevels a distance). */
static status next_data(cells *c, bool *ghost) {
    enum { DUPLICATE = 1, REFINED = 8, HIDDEN = 32 };
    status st = ST_OK;
    uint64_t word = 0;
    for (uint32_t k = 0; st == ST_OK && k < c->v->choice.taken_count; k++)
        if (c->fields[k].cursor)
            st = next_value(&c->fields[k], &c->now[k]);
    if (st == ST_OK && c->ghosts)
        st = vtk_cursor_whole(c->ghosts, 1, &word);
    const bool levels =
        c->ghosts && strcmp(vtk_fields_ghosts(&c->p->fields)->name, VTK_GHOST_LEVELS) == 0;
    *ghost = levels ? word > 0 : (word & (DUPLICATE | REFINED | HIDDEN)) != 0;
    return st;
}

/* Read the number of the next cell's ids. */
static status next_size(cells *c, const vtk_lists *of, uint64_t number, uint64_t *size) {
    uint64_t end = 0;
    const vtk_array *told = c->offsets ? &of->offsets : &of->ids;
    status st = vtk_cursor_whole(c->offsets ? c->offsets : c->ids, 1, &end);
    if (st != ST_OK)
        return st;
    *size = c->offsets ? end - c->end : end;
    if (c->offsets && end < c->end)
        return vtk_array_fault(told, ST_CORRUPT, "cell %llu ends at %llu, before its first id",
                               (unsigned long long)number, (unsigned long long)end);
    if (*size > UINT32_MAX)
        return vtk_array_fault(told, ST_CORRUPT, "cell %llu has %llu points",
                               (unsigned long long)number, (unsigned long long)*size);
    c->used += *size + !c->offsets;
    c->end = end;
    return ST_OK;
}

static status read_strip(cells *c, uint64_t size, bool ghost) {
    surface_strip strip = {.count = 0};
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < size; i++) {
        uint64_t id;
        st = vtk_cursor_whole(c->ids, 1, &id);
        if (st == ST_OK && !ghost)
            st = surface_flow_strip(c->flow, &strip, id, c->now);
    }
    return st;
}

static status read_polygon(cells *c, const vtk_array *ids, uint64_t size, bool ghost) {
    status st = ST_OK;
    if (size > SURFACE_CORNERS_MAX)
        return vtk_array_fault(ids, ST_UNSUPPORTED,
                               "a polygon of %llu corners, expected at most %d",
                               (unsigned long long)size, SURFACE_CORNERS_MAX);
    for (size_t i = 0; st == ST_OK && i < size; i++) {
        st = mem_grow(c->v->m, &c->corners, sizeof *c->corners, i, 16, &c->room);
        if (st == ST_OK)
            st = vtk_cursor_whole(c->ids, 1, &c->corners[i]);
    }
    return st == ST_OK && !ghost ? surface_flow_polygon(c->flow, c->corners, (size_t)size, c->now)
                                 : st;
}

/* Read the next cell of a kind. Ids of vertices and lines are not looked at. */
static status read_cell(cells *c, surface_vtk_kind kind, uint64_t number) {
    const vtk_lists *of = &c->p->cells[kind];
    uint64_t size = 0;
    bool ghost;
    status st = next_data(c, &ghost);
    if (kind <= SURFACE_VTK_LINES || st != ST_OK)
        return st;
    c->flow->feed->report->ghosts += ghost && !c->flow->dry;
    st = next_size(c, of, number, &size);
    if (st != ST_OK)
        return st;
    return kind == SURFACE_VTK_STRIPS ? read_strip(c, size, ghost)
                                      : read_polygon(c, &of->ids, size, ghost);
}

static status open_ids(cells *c, const vtk_lists *of) {
    uint64_t zero = 0;
    status st = vtk_cursor_open(c->v->m, &of->ids, of->ids_size, &c->ids);
    if (st == ST_OK && of->offsets.type != VTK_ABSENT)
        st = vtk_cursor_open(c->v->m, &of->offsets, of->count + of->from_zero, &c->offsets);
    if (st == ST_OK && of->from_zero)
        st = vtk_cursor_whole(c->offsets, 1, &zero);
    if (st == ST_OK && zero != 0)
        st = vtk_array_fault(&of->offsets, ST_CORRUPT, "begins with %llu, expected 0",
                             (unsigned long long)zero);
    c->end = c->used = 0;
    return st;
}

static status read_kind(cells *c, surface_vtk_kind kind) {
    const vtk_lists *of = &c->p->cells[kind];
    const bool taken = kind > SURFACE_VTK_LINES && of->count > 0;
    status st = taken ? open_ids(c, of) : ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < of->count; i++)
        st = read_cell(c, kind, i);
    if (st == ST_OK && taken && of->ids_size != VTK_CURSOR_ANY && c->used != of->ids_size)
        st = vtk_array_fault(&of->ids, ST_CORRUPT, "%llu numbers, but its cells have %llu",
                             (unsigned long long)of->ids_size, (unsigned long long)c->used);
    if (st == ST_OK && c->offsets)
        st = vtk_cursor_finish(c->offsets);
    if (st == ST_OK && c->ids)
        st = vtk_cursor_finish(c->ids);
    if (!taken)
        surface_flow_skip(c->flow, of->count);
    vtk_cursor_close(c->offsets);
    vtk_cursor_close(c->ids);
    c->offsets = c->ids = NULL;
    return st;
}

static status read_cells(surface_vtk *v, const surface_vtk_piece *p, surface_flow *flow) {
    cells c = {.v = v, .p = p, .flow = flow};
    status st = open_cells(&c);
    for (int s = 0; st == ST_OK && s < SURFACE_VTK_KINDS; s++)
        st = read_kind(&c, (surface_vtk_kind)s);
    return close_cells(&c, st);
}

/* ---- reading ---- */

static status read_piece(surface_vtk *v, const surface_vtk_piece *p, surface_flow *flow) {
    status st = surface_flow_piece(flow, p->points);
    if (st == ST_OK)
        st = read_points(v, p, flow);
    if (st == ST_OK && p->points > 0 && mesh_feed_takes_normals(flow->feed) && has_normals(v))
        st = read_normals(v, p, flow);
    for (uint32_t k = 0; st == ST_OK && p->points > 0 && k < v->choice.taken_count; k++)
        if (!surface_choice_taken(&v->choice, k)->of_faces)
            st = read_values(v, p, k, flow);
    if (st == ST_OK)
        st = read_cells(v, p, flow);
    return st == ST_OK ? surface_flow_end_piece(flow) : st;
}

static status pass(void *state, surface_flow *flow) {
    surface_vtk *v = state;
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < v->count; i++)
        st = read_piece(v, &v->pieces[i], flow);
    return st;
}

status surface_vtk_read(void *state, mesh_feed *feed) {
    surface_vtk *v = state;
    for (size_t i = 0; i < v->count; i++)
        mesh_feed_expect_cells(feed, cells_of(&v->pieces[i]));
    surface_flow_expect_polygons(&v->choice, feed);
    return surface_flow_run(&v->choice, feed, v->points, true, pass, v);
}
