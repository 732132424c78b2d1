#include "prep/import/cgns/cgns_cells.h"

#include <cgns_io.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- shapes ---- */

/* The library's names of types begin with the shape, and end in the number of nodes; the corners
 * come first, and those of TETRA_10 are ordered as quadratic_tet.h has them (SIDS, 3.3). */
static const struct {
    const char *begins;
    bool volume;
    cell_shape shape;
} names[] = {
    {"HEXA_", true, CELL_HEXAHEDRON}, {"PENTA_", true, CELL_WEDGE}, {"PYRA_", true, CELL_PYRAMID},
    {"TETRA_", true, CELL_TET},       {"NODE", false, CELL_TET},    {"BAR_", false, CELL_TET},
    {"TRI_", false, CELL_TET},        {"QUAD_", false, CELL_TET},   {"NGON_n", false, CELL_TET},
};
enum { NAMES = sizeof names / sizeof *names };

/* What the library calls a cgsize_t. */
#define NUMBERS (sizeof(cgsize_t) == 4 ? "I4" : "I8")

static status look_up(const cgns_cells *c, int zone, int type, cgns_element *e) {
    const char *name = cg_ElementTypeName((CGNS_ENUMT(ElementType_t))type);
    int i = 0;
    while (i < NAMES && strncmp(name, names[i].begins, strlen(names[i].begins)) != 0)
        i++;
    if (i == NAMES)
        return status_describe(ST_UNSUPPORTED,
                               "%s: zone %d has elements %.32s, expected hexahedra, wedges, "
                               "pyramids or tets",
                               c->f->path, zone + 1, name);
    *e = (cgns_element){.known = true, .volume = names[i].volume, .shape = names[i].shape};
    if (cg_npe((CGNS_ENUMT(ElementType_t))type, &e->nodes) != CG_OK)
        return cgns_file_failed(c->f, name);
    if (e->volume)
        e->shape = import_mesh_shape(e->shape, (size_t)e->nodes, c->by_corners);
    if (e->volume && e->nodes > cell_shape_vertices(e->shape) && !c->by_corners)
        return status_describe(ST_UNSUPPORTED,
                               "%s: zone %d has elements %.32s: higher order (--by-corners takes "
                               "them as linear ones)",
                               c->f->path, zone + 1, name);
    return ST_OK;
}

/* Find what elements of a type are. ST_UNSUPPORTED: they cannot be taken. */
static status find_type(cgns_cells *c, int zone, long long type, const cgns_element **out) {
    if (type < 0 || type >= NofValidElementTypes)
        return status_describe(ST_CORRUPT, "%s: zone %d: elements of type %lld", c->f->path,
                               zone + 1, type);
    *out = &c->types[type];
    return c->types[type].known ? ST_OK : look_up(c, zone, (int)type, &c->types[type]);
}

static void count_cells(cgns_cells *c, int zone, const cgns_element *e, uint64_t cells) {
    if (!e->volume) {
        c->skipped += cells;
        return;
    }
    c->of[e->shape] += cells;
    c->in_zone[zone] += cells;
    c->higher += e->nodes > cell_shape_vertices(e->shape) ? cells : 0;
}

/* ---- elements of a section ---- */

/* Read elements of one type into the buffer, from element w->at of the section on. */
static status fill(cgns_walk *w, const cgns_section *s) {
    const cgns_file *f = w->c->f;
    const uint64_t left = (uint64_t)(s->end - s->start) + 1 - w->at;
    const uint64_t most = CGNS_WALK_IDS / (uint64_t)s->element.nodes;
    const cgsize_t first = s->start + (cgsize_t)w->at;
    w->begun = w->at;
    w->held = (size_t)(left < most ? left : most);
    return cg_elements_partial_read(f->id, f->base, s->zone + 1, s->number, first,
                                    first + (cgsize_t)w->held - 1, w->ids, NULL) == CG_OK
               ? ST_OK
               : cgns_file_failed(f, "elements");
}

/* Read numbers of a mixed section, from number w->at on. The library's call for elements would read
 * all of the section for each part. */
static status fill_mixed(cgns_walk *w, const cgns_section *s) {
    const cgns_file *f = w->c->f;
    const uint64_t left = s->numbers - w->at;
    const cgsize_t one = 1, start = (cgsize_t)w->at + 1;
    int io = 0;
    w->begun = w->at;
    w->held = (size_t)(left < CGNS_WALK_IDS ? left : CGNS_WALK_IDS);
    const cgsize_t count = (cgsize_t)w->held, end = start + count - 1;
    if (cg_get_cgio(f->id, &io) != CG_OK)
        return cgns_file_failed(f, "elements");
    /* Only the first call is there for ADF, and only the second one converts. */
    const int error = s->as_it_is ? cgio_read_data(io, s->node, &start, &end, &one, 1, &count, &one,
                                                   &count, &one, w->ids)
                                  : cgio_read_data_type(io, s->node, &start, &end, &one, NUMBERS, 1,
                                                        &count, &one, &count, &one, w->ids);
    if (error == CGIO_ERR_NONE)
        return ST_OK;
    char said[CGIO_MAX_ERROR_LENGTH + 1] = "";
    cgio_error_message(said);
    return status_describe(ST_CORRUPT, "%s: zone %d: elements: libcgns: %s", f->path, s->zone + 1,
                           said);
}

/* Take the next element of a section. *e: NULL behind the last one. *ids: of its nodes, from 1. */
static status next_element(cgns_walk *w, const cgns_section *s, const cgns_element **e,
                           const cgsize_t **ids) {
    status st = ST_OK;
    *e = NULL;
    if (w->at > (uint64_t)(s->end - s->start))
        return ST_OK;
    if (w->held == 0 || w->at - w->begun >= w->held)
        st = fill(w, s);
    *e = &s->element;
    *ids = w->ids + (w->at - w->begun) * (uint64_t)s->element.nodes;
    w->at++;
    return st;
}

enum { NODES_MAX = 125 }; /* HEXA_125 */

static status next_mixed(cgns_walk *w, const cgns_section *s, const cgns_element **e,
                         const cgsize_t **ids) {
    const uint64_t wanted = s->numbers - w->at < 1 + NODES_MAX ? s->numbers : w->at + 1 + NODES_MAX;
    status st = ST_OK;
    *e = NULL;
    if (w->at >= s->numbers)
        return ST_OK;
    if (w->held == 0 || wanted > w->begun + w->held)
        st = fill_mixed(w, s);
    if (st != ST_OK)
        return st;
    *ids = w->ids + (w->at - w->begun) + 1;
    st = find_type(w->c, s->zone, (*ids)[-1], e);
    if (st == ST_OK && (*e)->nodes < 1)
        st =
            status_describe(ST_UNSUPPORTED,
                            "%s: zone %d: a mixed section has an element of type %lld, whose nodes "
                            "are not counted",
                            w->c->f->path, s->zone + 1, (long long)(*ids)[-1]);
    else if (st == ST_OK && (uint64_t)(*e)->nodes >= s->numbers - w->at)
        st = status_describe(ST_CORRUPT,
                             "%s: zone %d: the last element of a mixed section is cut off",
                             w->c->f->path, s->zone + 1);
    w->at += st == ST_OK ? 1 + (uint64_t)(*e)->nodes : 0;
    return st;
}

/* ---- the sections ---- */

/* Find where a mixed section's numbers are. */
static status find_numbers(const cgns_file *f, const char *name, cgns_section *s) {
    char path[CGNS_NAME + 32], type[CGIO_MAX_DATATYPE_LENGTH + 1] = "";
    double zone = 0;
    int io = 0, rank = 0;
    cgsize_t dims[12] = {0};
    snprintf(path, sizeof path, "%s/ElementConnectivity", name);
    if (cg_get_cgio(f->id, &io) != CG_OK || cg_zone_id(f->id, f->base, s->zone + 1, &zone) != CG_OK)
        return cgns_file_failed(f, name);
    if (cgio_get_node_id(io, zone, path, &s->node) != CGIO_ERR_NONE ||
        cgio_get_dimensions(io, s->node, &rank, dims) != CGIO_ERR_NONE ||
        cgio_get_data_type(io, s->node, type) != CGIO_ERR_NONE || rank != 1 || dims[0] < 0)
        return status_describe(ST_CORRUPT, "%s: zone %d: section %s has no ElementConnectivity",
                               f->path, s->zone + 1, name);
    s->numbers = (uint64_t)dims[0];
    s->as_it_is = strcmp(type, NUMBERS) == 0;
    return ST_OK;
}

static status count_mixed(cgns_cells *c, const cgns_section *s) {
    cgns_walk *w = mem_alloc(c->f->m, sizeof *w);
    const uint64_t all = (uint64_t)(s->end - s->start) + 1;
    uint64_t elements = 0;
    status st = w ? ST_OK : ST_NOMEM;
    if (w)
        cgns_walk_begin(w, c, -1);
    for (bool more = true; st == ST_OK && more;) {
        const cgns_element *e;
        const cgsize_t *ids;
        st = next_mixed(w, s, &e, &ids);
        more = st == ST_OK && e;
        if (more)
            count_cells(c, s->zone, e, 1);
        elements += more;
    }
    mem_free(c->f->m, w);
    if (st == ST_OK && elements != all)
        st = status_describe(
            ST_CORRUPT, "%s: zone %d: a mixed section of %llu elements, expected %llu", c->f->path,
            s->zone + 1, (unsigned long long)elements, (unsigned long long)all);
    return st;
}

/* Find what a section's elements are, and count them. */
static status look_into(cgns_cells *c, const char *name, CGNS_ENUMT(ElementType_t) type,
                        cgns_section *s) {
    const cgns_element *e = NULL;
    s->mixed = type == CGNS_ENUMV(MIXED);
    status st = s->mixed ? find_numbers(c->f, name, s) : find_type(c, s->zone, type, &e);
    if (st == ST_OK && s->mixed)
        return count_mixed(c, s);
    if (st != ST_OK)
        return st;
    s->element = *e;
    count_cells(c, s->zone, e, (uint64_t)(s->end - s->start) + 1);
    return ST_OK;
}

static status add_section(cgns_cells *c, int zone, int number) {
    const cgns_file *f = c->f;
    cgns_section s = {.zone = zone, .number = number};
    CGNS_ENUMT(ElementType_t) type;
    char name[CGNS_NAME];
    int boundary, parents;
    if (cg_section_read(f->id, f->base, zone + 1, number, name, &type, &s.start, &s.end, &boundary,
                        &parents) != CG_OK)
        return cgns_file_failed(f, "a section of elements");
    if (s.start < 1 || s.end < s.start - 1)
        return status_describe(ST_CORRUPT, "%s: zone %d: section %s has elements %lld to %lld",
                               f->path, zone + 1, name, (long long)s.start, (long long)s.end);
    if (s.end < s.start)
        return ST_OK;
    status st = look_into(c, name, type, &s);
    if (st != ST_OK || (!s.mixed && !s.element.volume))
        return st;
    st = mem_grow(f->m, &c->sections, sizeof s, c->count, 16, &c->room);
    if (st == ST_OK)
        c->sections[c->count++] = s;
    return st;
}

static int compare(const void *a, const void *b) {
    const cgns_section *x = a, *y = b;
    return x->zone != y->zone ? (x->zone > y->zone) - (x->zone < y->zone)
                              : (x->start > y->start) - (x->start < y->start);
}

static status add_zone(cgns_cells *c, int zone) {
    const cgns_zone *z = &c->f->zones[zone];
    int sections = 0;
    if (z->structured) {
        c->in_zone[zone] = z->cells[0] * z->cells[1] * z->cells[2];
        c->of[CELL_HEXAHEDRON] += c->in_zone[zone];
        return ST_OK;
    }
    if (cg_nsections(c->f->id, c->f->base, zone + 1, &sections) != CG_OK)
        return cgns_file_failed(c->f, "sections of elements");
    status st = ST_OK;
    for (int s = 1; s <= sections && st == ST_OK; s++)
        st = add_section(c, zone, s);
    if (st == ST_OK && z->cells[0] > 0 && c->in_zone[zone] == 0)
        st = status_describe(
            ST_UNSUPPORTED,
            "%s: zone %d tells of %llu cells, and has none by its nodes: polyhedra by "
            "their faces (NGON_n) are not read",
            c->f->path, zone + 1, (unsigned long long)z->cells[0]);
    return st;
}

status cgns_cells_open(cgns_file *f, bool by_corners, cgns_cells *c) {
    *c = (cgns_cells){.f = f, .by_corners = by_corners};
    c->in_zone = mem_array(f->m, (size_t)f->zone_count + 1, sizeof *c->in_zone);
    status st = c->in_zone ? ST_OK : ST_NOMEM;
    for (int z = 0; z < f->zone_count && st == ST_OK; z++)
        st = add_zone(c, z);
    if (c->count > 0)
        qsort(c->sections, c->count, sizeof *c->sections, compare);
    return st;
}

void cgns_cells_release(cgns_cells *c) {
    if (!c->f)
        return;
    mem_free(c->f->m, c->sections);
    mem_free(c->f->m, c->in_zone);
}

/* ---- the walk ---- */

void cgns_walk_begin(cgns_walk *w, cgns_cells *c, int shape) {
    w->c = c;
    w->shape = shape;
    w->zone = 0;
    w->section = 0;
    w->at = 0;
    w->held = 0;
}

static void take_ids(const cgns_file *f, int zone, cell_shape shape, const cgsize_t *ids,
                     cgns_cell *cell) {
    const cgns_zone *z = &f->zones[zone];
    cell->shape = shape;
    cell->zone = zone;
    for (int i = 0; i < cell_shape_vertices(shape); i++)
        cell->ids[i] = ids[i] >= 1 && (uint64_t)ids[i] <= z->nodes
                           ? (uint32_t)(z->first + (uint64_t)ids[i] - 1)
                           : UINT32_MAX;
}

/* The hexahedron of a structured zone's cell. */
static void make_cell(const cgns_file *f, int zone, uint64_t at, cgns_cell *cell) {
    static const uint8_t corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                          {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const cgns_zone *z = &f->zones[zone];
    const uint64_t i = at % z->cells[0], j = at / z->cells[0] % z->cells[1],
                   k = at / z->cells[0] / z->cells[1];
    cell->shape = CELL_HEXAHEDRON;
    cell->zone = zone;
    for (int v = 0; v < 8; v++)
        cell->ids[v] =
            (uint32_t)(z->first + (i + corners[v][0]) +
                       z->dims[0] * ((j + corners[v][1]) + z->dims[1] * (k + corners[v][2])));
}

/* Take the next cell of a structured zone; false: it has no more. */
static bool next_of_zone(cgns_walk *w, cgns_cell *cell) {
    const cgns_zone *z = &w->c->f->zones[w->zone];
    if (!z->structured || w->at >= z->cells[0] * z->cells[1] * z->cells[2] ||
        (w->shape >= 0 && w->shape != CELL_HEXAHEDRON))
        return false;
    make_cell(w->c->f, w->zone, w->at++, cell);
    return true;
}

/* Take the next cell of a section; *more: false: it has no more. */
static status next_of_section(cgns_walk *w, const cgns_section *s, cgns_cell *cell, bool *more) {
    const cgns_element *e = &s->element;
    const cgsize_t *ids = NULL;
    status st = ST_OK;
    *more = false;
    if (!s->mixed && w->shape >= 0 && w->shape != (int)e->shape)
        return ST_OK;
    while (st == ST_OK && !*more && e) {
        st = s->mixed ? next_mixed(w, s, &e, &ids) : next_element(w, s, &e, &ids);
        *more = st == ST_OK && e && e->volume && (w->shape < 0 || w->shape == (int)e->shape);
    }
    if (*more)
        take_ids(w->c->f, s->zone, e->shape, ids, cell);
    return st;
}

status cgns_walk_next(cgns_walk *w, cgns_cell *cell, bool *more) {
    const cgns_cells *c = w->c;
    status st = ST_OK;
    *more = false;
    while (st == ST_OK && !*more && w->zone < c->f->zone_count) {
        const bool inside = w->section < c->count && c->sections[w->section].zone == w->zone;
        if (inside)
            st = next_of_section(w, &c->sections[w->section], cell, more);
        else
            *more = next_of_zone(w, cell);
        if (st != ST_OK || *more)
            break;
        w->section += inside;
        w->zone += !inside;
        w->at = 0;
        w->held = 0;
    }
    return st;
}
