#include "prep/import/cgns/cgns_faces.h"

#include <stdlib.h>

#include "formats/mesh/mesh_stream.h"

status cgns_faces_add(cgns_faces *x, int zone, const char *name, cgsize_t start, cgsize_t end) {
    cgns_polygons section = {.zone = zone, .start = start, .end = end};
    status st = cgns_lists_find(x->f, zone, name, (uint64_t)(end - start) + 1, &section.lists);
    if (st == ST_OK)
        st = mem_grow(x->f->m, &x->sections, sizeof section, x->count, 16, &x->room);
    if (st == ST_OK)
        x->sections[x->count++] = section;
    return st;
}

static void forget(cgns_faces *x) {
    mem_free(x->f->m, x->ids);
    mem_free(x->f->m, x->ends);
    x->ids = NULL;
    x->ends = NULL;
    x->zone = 0;
}

void cgns_faces_release(cgns_faces *x) {
    if (!x->f)
        return;
    forget(x);
    mem_free(x->f->m, x->sections);
    mem_free(x->f->m, x->stream);
}

/* ---- a zone's faces in memory ---- */

static int compare(const void *a, const void *b) {
    const cgns_polygons *x = a, *y = b;
    return (x->start > y->start) - (x->start < y->start);
}

/* Make room for a zone's faces, whose sections are in the order of their numbers from then on. */
static status make_room(cgns_faces *x, int zone) {
    const mem *m = x->f->m;
    uint64_t faces = 0, nodes = 0;
    x->first = 0;
    x->some = 0;
    while (x->first < x->count && x->sections[x->first].zone != zone)
        x->first++;
    while (x->first + x->some < x->count && x->sections[x->first + x->some].zone == zone)
        x->some++;
    if (x->some > 1)
        qsort(x->sections + x->first, x->some, sizeof *x->sections, compare);
    for (size_t i = 0; i < x->some; i++) {
        cgns_polygons *s = &x->sections[x->first + i];
        s->first = faces;
        faces += s->lists.count;
        nodes += s->lists.numbers.count;
    }
    x->ids = mem_array(x->f->m, nodes + 1, sizeof *x->ids);
    x->ends = mem_array(x->f->m, faces + 1, sizeof *x->ends);
    if (!x->stream)
        x->stream = mem_array(x->f->m, MESH_STREAM_POLYHEDRON_MAX, sizeof *x->stream);
    if (x->ids && x->ends && x->stream)
        return ST_OK;
    return status_describe(ST_NOMEM,
                           "%s: zone %d: the %llu faces of its polyhedra take %llu MiB, more than "
                           "is left of --memory (%zu MiB)",
                           x->f->path, zone + 1, (unsigned long long)faces,
                           (unsigned long long)((faces * 8 + nodes * 4) >> 20) + 1, m->limit >> 20);
}

/* Read the faces of a section behind those before. */
static status read_section(cgns_faces *x, const cgns_polygons *s, cgns_lists_walk *w) {
    const cgns_zone *z = &x->f->zones[s->zone];
    const cgsize_t *list;
    size_t length;
    status st = ST_OK;
    *w = (cgns_lists_walk){.held = 0};
    for (uint64_t i = s->first; st == ST_OK; i++) {
        uint64_t at = i > 0 ? x->ends[i - 1] : 0;
        st = cgns_lists_next(w, x->f, &s->lists, &list, &length);
        if (st != ST_OK || !list)
            break;
        for (size_t k = 0; k < length; k++)
            x->ids[at++] = list[k] >= 1 && (uint64_t)list[k] <= z->nodes
                               ? (uint32_t)(z->first + (uint64_t)list[k] - 1)
                               : UINT32_MAX;
        x->ends[i] = at;
    }
    return st;
}

static status load(cgns_faces *x, int zone) {
    forget(x);
    cgns_lists_walk *w = mem_alloc(x->f->m, sizeof *w);
    status st = w ? make_room(x, zone) : ST_NOMEM;
    for (size_t i = 0; i < x->some && st == ST_OK; i++)
        st = read_section(x, &x->sections[x->first + i], w);
    mem_free(x->f->m, w);
    if (st == ST_OK)
        x->zone = zone + 1;
    return st;
}

/* ---- a polyhedron ---- */

/* Find a face by its number among those in memory; UINT64_MAX: there is none. */
static uint64_t find_face(const cgns_faces *x, uint64_t number) {
    size_t low = x->first, high = x->first + x->some;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if ((uint64_t)x->sections[middle].start <= number)
            low = middle;
        else
            high = middle;
    }
    const cgns_polygons *s = &x->sections[low];
    const bool is = x->some > 0 && number >= (uint64_t)s->start && number <= (uint64_t)s->end;
    return is ? s->first + (number - (uint64_t)s->start) : UINT64_MAX;
}

/* Add a face to the stream, so that it is seen from outside. */
static status add_face(cgns_faces *x, int zone, uint64_t which, cgsize_t number,
                       mesh_polyhedron *p) {
    const uint64_t face = find_face(x, number < 0 ? 0 - (uint64_t)number : (uint64_t)number);
    if (face == UINT64_MAX)
        return status_describe(ST_CORRUPT,
                               "%s: zone %d: polyhedron %llu (of its section, counted from 0) has "
                               "face %lld, which is no element of a "
                               "section NGON_n",
                               x->f->path, zone + 1, (unsigned long long)which, (long long)number);
    const uint64_t from = face > 0 ? x->ends[face - 1] : 0;
    const size_t corners = (size_t)(x->ends[face] - from);
    if (corners >= MESH_STREAM_POLYHEDRON_MAX - p->size - 2)
        return status_describe(ST_UNSUPPORTED,
                               "%s: zone %d: polyhedron %llu (of its section, counted from 0) has "
                               "more than %d numbers",
                               x->f->path, zone + 1, (unsigned long long)which,
                               MESH_STREAM_POLYHEDRON_MAX);
    x->stream[p->size++] = corners;
    for (size_t i = 0; i < corners; i++)
        x->stream[p->size++] = x->ids[number < 0 ? x->ends[face] - 1 - i : from + i];
    p->faces++;
    return ST_OK;
}

status cgns_faces_polyhedron(cgns_faces *x, int zone, uint64_t which, const cgsize_t *numbers,
                             size_t count, mesh_polyhedron *p) {
    status st = x->zone == zone + 1 ? ST_OK : load(x, zone);
    *p = (mesh_polyhedron){.faces = 0};
    for (size_t i = 0; i < count && st == ST_OK; i++)
        st = add_face(x, zone, which, numbers[i], p);
    p->stream = x->stream;
    const char *fault = st == ST_OK ? mesh_polyhedron_fault(p) : NULL;
    return fault
               ? status_describe(ST_CORRUPT,
                                 "%s: zone %d: polyhedron %llu (of its section, counted from 0) %s",
                                 x->f->path, zone + 1, (unsigned long long)which, fault)
               : st;
}
