#include "prep/import/cgns/cgns_cells.h"

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
    {"TRI_", false, CELL_TET},        {"QUAD_", false, CELL_TET},
};
enum { NAMES = sizeof names / sizeof *names };

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

/* Read numbers of a mixed section, from number w->at on. */
static status fill_mixed(cgns_walk *w, const cgns_section *s) {
    const uint64_t left = s->numbers.count - w->at;
    w->begun = w->at;
    w->held = (size_t)(left < CGNS_WALK_IDS ? left : CGNS_WALK_IDS);
    return cgns_numbers_read(w->c->f, &s->numbers, w->at, w->held, w->ids);
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
    const uint64_t wanted =
        s->numbers.count - w->at < 1 + NODES_MAX ? s->numbers.count : w->at + 1 + NODES_MAX;
    status st = ST_OK;
    *e = NULL;
    if (w->at >= s->numbers.count)
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
    else if (st == ST_OK && (uint64_t)(*e)->nodes >= s->numbers.count - w->at)
        st = status_describe(ST_CORRUPT,
                             "%s: zone %d: the last element of a mixed section is cut off",
                             w->c->f->path, s->zone + 1);
    w->at += st == ST_OK ? 1 + (uint64_t)(*e)->nodes : 0;
    return st;
}

/* Take the next polyhedron of a section. */
static status next_polyhedron(cgns_walk *w, const cgns_section *s, cgns_cell *cell, bool *more) {
    const cgsize_t *faces;
    size_t count;
    if (w->at++ == 0)
        w->lists = (cgns_lists_walk){.held = 0};
    status st = cgns_lists_next(&w->lists, w->c->f, &s->lists, &faces, &count);
    *more = st == ST_OK && faces;
    if (!*more)
        return st;
    cell->zone = s->zone;
    return cgns_faces_polyhedron(&w->c->faces, s->zone, w->lists.element - 1, faces, count,
                                 &cell->polyhedron);
}

/* ---- the sections ---- */

static status count_mixed(cgns_cells *c, const cgns_section *s) {
    cgns_walk *w = mem_alloc(c->f->m, sizeof *w);
    const uint64_t all = (uint64_t)(s->end - s->start) + 1;
    uint64_t elements = 0;
    status st = w ? ST_OK : ST_NOMEM;
    if (w)
        cgns_walk_begin(w, c, CGNS_ALL);
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

/* Find what a section's elements are, and count them. Polyhedra are counted when the zone's
 * polygons are known, and polygons that are no faces. */
static status look_into(cgns_cells *c, const char *name, CGNS_ENUMT(ElementType_t) type,
                        cgns_section *s) {
    const uint64_t count = (uint64_t)(s->end - s->start) + 1;
    const cgns_element *e = NULL;
    s->mixed = type == CGNS_ENUMV(MIXED);
    s->polyhedra = type == CGNS_ENUMV(NFACE_n);
    if (s->polyhedra)
        return cgns_lists_find(c->f, s->zone, name, count, &s->lists);
    if (type == CGNS_ENUMV(NGON_n))
        return cgns_faces_add(&c->faces, s->zone, name, s->start, s->end);
    status st =
        s->mixed ? cgns_numbers_find(c->f, s->zone, name, "ElementConnectivity", NULL, &s->numbers)
                 : find_type(c, s->zone, type, &e);
    if (st == ST_OK && s->mixed)
        return count_mixed(c, s);
    if (st != ST_OK)
        return st;
    s->element = *e;
    count_cells(c, s->zone, e, count);
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
    if (st != ST_OK || (!s.mixed && !s.polyhedra && !s.element.volume))
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

/* Count the polyhedra of a section, and the numbers and points that they take. */
static status count_polyhedra(cgns_cells *c, const cgns_section *s, cgns_walk *w) {
    const uint64_t nodes = c->f->nodes;
    status st = ST_OK;
    for (bool more = true; st == ST_OK && more;) {
        cgns_cell cell;
        st = next_polyhedron(w, s, &cell, &more);
        if (st != ST_OK || !more)
            break;
        c->polyhedra++;
        c->in_zone[s->zone]++;
        c->numbers += 2 + cell.polyhedron.size;
        if (mesh_polyhedron_inside(&cell.polyhedron, nodes))
            c->middles += mesh_polyhedron_middles(&cell.polyhedron);
    }
    return st;
}

/* Count what a zone's polygons are for: the faces of its polyhedra, or nothing that is drawn. */
static status count_polygons(cgns_cells *c, int zone, size_t first) {
    cgns_walk *w = mem_alloc(c->f->m, sizeof *w);
    bool any = false;
    status st = w ? ST_OK : ST_NOMEM;
    for (size_t i = first; i < c->count && st == ST_OK; i++)
        if (c->sections[i].polyhedra) {
            any = true;
            cgns_walk_begin(w, c, CGNS_POLYHEDRA);
            st = count_polyhedra(c, &c->sections[i], w);
        }
    mem_free(c->f->m, w);
    for (size_t i = 0; i < c->faces.count && !any; i++)
        c->skipped += c->faces.sections[i].zone == zone ? c->faces.sections[i].lists.count : 0;
    return st;
}

static status add_zone(cgns_cells *c, int zone) {
    const size_t first = c->count;
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
    if (st == ST_OK)
        st = count_polygons(c, zone, first);
    if (st == ST_OK && z->cells[0] > 0 && c->in_zone[zone] == 0)
        st = status_describe(
            ST_UNSUPPORTED,
            "%s: zone %d tells of %llu cells, and has none by its nodes or faces (NFACE_n): "
            "polyhedra of which only the faces tell (ParentElements) are not read",
            c->f->path, zone + 1, (unsigned long long)z->cells[0]);
    return st;
}

status cgns_cells_open(cgns_file *f, bool by_corners, cgns_cells *c) {
    *c = (cgns_cells){.f = f, .by_corners = by_corners, .faces = {.f = f}};
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
    cgns_faces_release(&c->faces);
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

static bool takes(const cgns_walk *w, int shape) {
    return w->shape == CGNS_ALL || w->shape == shape;
}

static void take_ids(const cgns_file *f, int zone, cell_shape shape, const cgsize_t *ids,
                     cgns_cell *cell) {
    const cgns_zone *z = &f->zones[zone];
    cell->shape = shape;
    cell->zone = zone;
    cell->polyhedron.faces = 0;
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
    cell->polyhedron.faces = 0;
    for (int v = 0; v < 8; v++)
        cell->ids[v] =
            (uint32_t)(z->first + (i + corners[v][0]) +
                       z->dims[0] * ((j + corners[v][1]) + z->dims[1] * (k + corners[v][2])));
}

/* Take the next cell of a structured zone; false: it has no more. */
static bool next_of_zone(cgns_walk *w, cgns_cell *cell) {
    const cgns_zone *z = &w->c->f->zones[w->zone];
    if (!z->structured || w->at >= z->cells[0] * z->cells[1] * z->cells[2] ||
        !takes(w, CELL_HEXAHEDRON))
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
    if (s->polyhedra)
        return takes(w, CGNS_POLYHEDRA) ? next_polyhedron(w, s, cell, more) : ST_OK;
    if (!s->mixed && !takes(w, (int)e->shape))
        return ST_OK;
    while (st == ST_OK && !*more && e) {
        st = s->mixed ? next_mixed(w, s, &e, &ids) : next_element(w, s, &e, &ids);
        *more = st == ST_OK && e && e->volume && takes(w, (int)e->shape);
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
