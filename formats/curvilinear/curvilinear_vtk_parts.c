#include "formats/curvilinear/curvilinear_vtk_parts.h"

#include <math.h>
#include <string.h>

#include "formats/curvilinear/curvilinear_source.h"
#include "formats/curvilinear/curvilinear_vtk.h"
#include "formats/input/named_file.h"
#include "formats/leaf/curvilinear_zones.h"
#include "formats/vtk/vtk_parts.h"
#include "formats/vtk/vtk_xml.h"

/* ---- a file that is named ---- */

typedef struct part {
    curvilinear_opening from;
    const curvilinear_reader *reader;
    void *state;
} part;

static void close_part(part *p) {
    if (p->reader)
        p->reader->close(p->state);
    byte_stream_close(p->from.data);
    *p = (part){0};
}

/* Open a file that `by` names, by one of the readers. Close it in any case. */
static status open_part(mem *m, const char *by, const char *path, const curvilinear_hints *hints,
                        const curvilinear_reader *const readers[], part *out) {
    const uint8_t *start;
    size_t size;
    *out = (part){.from = {.m = m, .hints = *hints}};
    status st = byte_stream_open(m, path, &out->from.data);
    if (st == ST_OK)
        st = vtk_array_check_file(path);
    if (st == ST_OK)
        st = byte_stream_peek(out->from.data, CURVILINEAR_READER_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    for (; *readers && !out->reader; readers++)
        if ((*readers)->known(byte_stream_kind(out->from.data), start, size,
                              byte_stream_left(out->from.data)))
            out->reader = *readers;
    if (!out->reader)
        return status_describe(ST_UNSUPPORTED, "%s: names %s, expected a structured grid of VTK",
                               by, path);
    return out->reader->open(&out->from, &out->state);
}

/* ---- pieces ---- */

typedef struct piece {
    char *path;
    int64_t lo[3], nodes[3]; /* from the whole's first node on */
    part file;
    uint32_t *fields; /* its number of each of the first piece's fields */
} piece;

typedef struct joined {
    mem *m;
    const char *path;
    bool follow_links, sized;
    vtk_extent whole;
    uint32_t nodes[1][3];
    piece *pieces;
    size_t count, room;
    float (*plane)[3]; /* of the largest piece */
} joined;

enum { ELEMENT_GRID = VTK_XML_OWN, ELEMENT_PIECE };

static status on_grid(vtk_xml *x, const char **attributes) {
    joined *j = vtk_xml_user(x);
    if (j->sized)
        return vtk_xml_fault(x, ST_CORRUPT, "the grid comes twice");
    j->sized = true;
    const status st = vtk_xml_extent(x, attributes, "WholeExtent", &j->whole);
    int64_t nodes[3];
    if (st != ST_OK)
        return st;
    vtk_extent_nodes(&j->whole, nodes);
    for (int a = 0; a < 3; a++) {
        if (nodes[a] < 2 || nodes[a] > CURVILINEAR_NODES_MAX)
            return vtk_xml_fault(x, ST_UNSUPPORTED, "%lld nodes along %c, expected 2 to %d",
                                 (long long)nodes[a], "ijk"[a], CURVILINEAR_NODES_MAX);
        j->nodes[0][a] = (uint32_t)nodes[a];
    }
    return ST_OK;
}

/* Processes without nodes have empty pieces. */
static status on_piece(vtk_xml *x, const char **attributes) {
    joined *j = vtk_xml_user(x);
    const char *name = vtk_xml_attribute(attributes, "Source");
    vtk_extent e = {0};
    status st = vtk_xml_extent(x, attributes, "Extent", &e);
    if (st == ST_OK && !name)
        st = vtk_xml_fault(x, ST_CORRUPT, "expected the attribute Source");
    if (st != ST_OK || vtk_extent_is_empty(&e))
        return st;
    if (!vtk_extent_holds(&j->whole, &e))
        return vtk_xml_fault(x, ST_CORRUPT, "a piece's extent lies outside of WholeExtent");
    st = mem_grow(j->m, &j->pieces, sizeof *j->pieces, j->count, 16, &j->room);
    if (st != ST_OK)
        return st;
    piece *p = &j->pieces[j->count++];
    *p = (piece){0};
    vtk_extent_nodes(&e, p->nodes);
    for (int a = 0; a < 3; a++)
        p->lo[a] = e.lo[a] - j->whole.lo[a];
    return named_file_find(j->m, j->path, name, j->follow_links, &p->path);
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    (void)x, (void)element, (void)name, (void)a;
    return ST_OK;
}

static status scan_pieces(joined *j, byte_stream *data) {
    static const vtk_xml_element elements[] = {
        {VTK_XML_FILE, "PStructuredGrid", ELEMENT_GRID, on_grid},
        {ELEMENT_GRID, "Piece", ELEMENT_PIECE, on_piece},
        {0, NULL, 0, NULL},
    };
    static const vtk_xml_reader reader = {"PStructuredGrid", elements, on_array};
    vtk_appended appended;
    const status st = vtk_xml_scan(j->m, j->path, data, &reader, j, &appended);
    return st == ST_OK && j->count == 0
               ? status_describe(ST_CORRUPT, "%s: it names no pieces", j->path)
               : st;
}

/* Set *out to the piece's number of a field of the first piece. */
static status find_field(const joined *j, const piece *p, uint32_t field, uint32_t *out) {
    const part *first = &j->pieces[0].file;
    uint32_t components, expected;
    char name[CURVILINEAR_NAME_MAX + 1];
    strncpy(name, first->reader->field(first->state, field, &expected), sizeof name - 1);
    name[sizeof name - 1] = 0;
    for (*out = 0; *out < p->file.from.fields; ++*out)
        if (strncmp(p->file.reader->field(p->file.state, *out, &components), name,
                    sizeof name - 1) == 0 &&
            components == expected)
            return ST_OK;
    return status_describe(ST_CORRUPT, "%s: no array \"%s\" of %u components, as %s has", p->path,
                           name, expected, j->pieces[0].path);
}

static status open_piece(joined *j, piece *p, const curvilinear_hints *hints) {
    static const curvilinear_reader *const readers[] = {&curvilinear_vtk_xml_reader, NULL};
    status st = open_part(j->m, j->path, p->path, hints, readers, &p->file);
    if (st != ST_OK)
        return st;
    bool alike = p->file.from.zones == 1;
    for (int a = 0; a < 3; a++)
        alike = alike && p->file.from.nodes[0][a] == p->nodes[a];
    if (!alike)
        return status_describe(
            ST_CORRUPT, "%s: expected one piece of %lld x %lld x %lld nodes, as %s says", p->path,
            (long long)p->nodes[0], (long long)p->nodes[1], (long long)p->nodes[2], j->path);
    const uint32_t fields = j->pieces[0].file.from.fields;
    p->fields = mem_array(j->m, fields ? fields : 1, sizeof *p->fields);
    st = p->fields ? ST_OK : ST_NOMEM;
    for (uint32_t f = 0; st == ST_OK && f < fields; f++)
        st = find_field(j, p, f, &p->fields[f]);
    return st;
}

static void close_pieces(void *state) {
    joined *j = state;
    if (!j)
        return;
    for (size_t i = 0; i < j->count; i++) {
        close_part(&j->pieces[i].file);
        mem_free(j->m, j->pieces[i].fields);
        mem_free(j->m, j->pieces[i].path);
    }
    mem_free(j->m, j->pieces);
    mem_free(j->m, j->plane);
    mem_free(j->m, j);
}

static status open_pieces(curvilinear_opening *o, void **state) {
    joined *j = *state = mem_zalloc(o->m, sizeof *j);
    if (!j)
        return ST_NOMEM;
    j->m = o->m;
    j->path = byte_stream_path(o->data);
    j->follow_links = o->hints.trust.follow_links;
    status st = vtk_array_check_file(j->path);
    if (st == ST_OK)
        st = scan_pieces(j, o->data);
    uint64_t most = 0;
    for (size_t i = 0; st == ST_OK && i < j->count; i++) {
        piece *p = &j->pieces[i];
        const uint64_t plane = (uint64_t)p->nodes[0] * (uint64_t)p->nodes[1];
        most = plane > most ? plane : most;
        st = open_piece(j, p, &o->hints);
        o->blanked = o->blanked || p->file.from.blanked;
    }
    if (st != ST_OK)
        return st;
    j->plane = mem_array(j->m, most, sizeof *j->plane);
    o->zones = 1;
    o->nodes = (const uint32_t(*)[3])j->nodes;
    o->fields = j->pieces[0].file.from.fields;
    return j->plane ? ST_OK : ST_NOMEM;
}

static const char *name_piece_field(void *state, uint32_t field, uint32_t *components) {
    const joined *j = state;
    const part *first = &j->pieces[0].file;
    return first->reader->field(first->state, field, components);
}

/* ---- planes ---- */

/* What is read: one of them. */
typedef struct wanted {
    float (*places)[3];
    float *values;
    uint8_t *is_node;
    uint32_t field, component; /* of values */
} wanted;

/* Read plane k of a piece. */
static status read_plane(const joined *j, const piece *p, uint32_t k, const wanted *w) {
    const curvilinear_reader *r = p->file.reader;
    void *state = p->file.state;
    return w->places ? r->places(state, 0, k, 1, j->plane)
           : w->values
               ? r->values(state, 0, p->fields[w->field], w->component, k, 1, (float *)j->plane)
               : r->blanks(state, 0, k, 1, (uint8_t *)j->plane);
}

/* Put a row of a piece's plane where it is in the whole's. A cell that begins at a piece's last
 * node is another one's, so what is known of a cell stays. */
static void put_row(const joined *j, size_t from, size_t count, size_t to, const wanted *w) {
    if (w->places)
        memcpy(w->places[to], j->plane[from], count * sizeof *w->places);
    else if (w->values)
        memcpy(w->values + to, (const float *)j->plane + from, count * sizeof *w->values);
    for (size_t i = 0; w->is_node && i < count; i++) {
        const uint8_t now = ((const uint8_t *)j->plane)[from + i];
        const uint8_t hidden = w->is_node[to + i] & CURVILINEAR_HIDDEN;
        w->is_node[to + i] = now ? now | hidden : 0;
    }
}

static status join_planes(const joined *j, uint32_t first, uint32_t count, const wanted *w) {
    const size_t plane = (size_t)j->nodes[0][0] * j->nodes[0][1];
    for (uint32_t k = 0; k < count; k++)
        for (size_t i = 0; i < j->count; i++) {
            const piece *p = &j->pieces[i];
            const int64_t own = (int64_t)first + k - p->lo[2];
            if (own < 0 || own >= p->nodes[2])
                continue;
            const status st = read_plane(j, p, (uint32_t)own, w);
            if (st != ST_OK)
                return st;
            const size_t row = (size_t)p->nodes[0];
            size_t to = k * plane + (size_t)p->lo[1] * j->nodes[0][0] + (size_t)p->lo[0];
            for (size_t y = 0; y < (size_t)p->nodes[1]; y++, to += j->nodes[0][0])
                put_row(j, y * row, row, to, w);
        }
    return ST_OK;
}

static status join_places(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          float (*out)[3]) {
    const joined *j = state;
    const size_t plane = (size_t)j->nodes[0][0] * j->nodes[0][1];
    (void)zone;
    for (size_t n = 0; n < count * plane; n++)
        out[n][0] = NAN;
    const status st = join_planes(j, first, count, &(wanted){.places = out});
    for (size_t n = 0; st == ST_OK && n < count * plane; n++)
        if (isnan(out[n][0]))
            return status_describe(ST_CORRUPT, "%s: no piece has node %zu %zu %zu", j->path,
                                   n % j->nodes[0][0], n / j->nodes[0][0] % j->nodes[0][1],
                                   first + n / plane);
    return st;
}

static status join_values(void *state, uint32_t zone, uint32_t field, uint32_t component,
                          uint32_t first, uint32_t count, float *out) {
    const joined *j = state;
    const size_t plane = (size_t)j->nodes[0][0] * j->nodes[0][1];
    (void)zone;
    for (size_t n = 0; n < count * plane; n++)
        out[n] = NAN;
    return join_planes(j, first, count,
                       &(wanted){.values = out, .field = field, .component = component});
}

/* A node where pieces overlap is one if the last of them says so. */
static status join_blanks(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          uint8_t *out) {
    const joined *j = state;
    (void)zone;
    memset(out, 0, (size_t)j->nodes[0][0] * j->nodes[0][1] * count);
    return join_planes(j, first, count, &(wanted){.is_node = out});
}

static bool are_pieces(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    char type[VTK_XML_TYPE_MAX];
    (void)bytes;
    return vtk_xml_type(start, size, type) && strcmp(type, "PStructuredGrid") == 0;
}

const curvilinear_reader curvilinear_vtk_pieces_reader = {.format = "VTK structured grid in pieces",
                                                          .known = are_pieces,
                                                          .open = open_pieces,
                                                          .close = close_pieces,
                                                          .names_files = true,
                                                          .field = name_piece_field,
                                                          .places = join_places,
                                                          .values = join_values,
                                                          .blanks = join_blanks};

/* ---- collections ---- */

typedef struct collection {
    mem *m;
    const char *path;
    vtk_parts parts;
    part file; /* of the step */
} collection;

static void close_collection(void *state) {
    collection *c = state;
    if (!c)
        return;
    close_part(&c->file);
    vtk_parts_release(&c->parts, c->m);
    mem_free(c->m, c);
}

static status seek_step(curvilinear_opening *o, void *state) {
    static const curvilinear_reader *const readers[] = {&curvilinear_vtk_xml_reader,
                                                        &curvilinear_vtk_pieces_reader, NULL};
    collection *c = state;
    const vtk_parts *p = &c->parts;
    const uint32_t step = o->hints.step;
    char names[VTK_PARTS_TEXT];
    status st = vtk_parts_check_step(p, c->path, step);
    if (st != ST_OK)
        return st;
    if (p->first[step + 1] - p->first[step] > 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: several grids at one time: give one of them itself: %s",
                               c->path, vtk_parts_list(p, step, names));
    close_part(&c->file);
    st = open_part(c->m, c->path, p->items[p->first[step]].path, &o->hints, readers, &c->file);
    o->zones = c->file.from.zones;
    o->nodes = c->file.from.nodes;
    o->blanked = c->file.from.blanked;
    o->fields = c->file.from.fields;
    return st;
}

static status open_collection(curvilinear_opening *o, void **state) {
    collection *c = *state = mem_zalloc(o->m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = o->m;
    c->path = byte_stream_path(o->data);
    status st = vtk_array_check_file(c->path);
    if (st == ST_OK)
        st = vtk_parts_read(c->m, c->path, o->data, o->hints.trust.follow_links, &c->parts);
    return st == ST_OK ? seek_step(o, c) : st;
}

static uint32_t tell_steps(const void *state, const double **times) {
    const collection *c = state;
    *times = c->parts.times;
    return c->parts.steps;
}

static const char *name_field(void *state, uint32_t field, uint32_t *components) {
    const collection *c = state;
    return c->file.reader->field(c->file.state, field, components);
}

static status read_places(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          float (*p)[3]) {
    const collection *c = state;
    return c->file.reader->places(c->file.state, zone, first, count, p);
}

static status read_values(void *state, uint32_t zone, uint32_t field, uint32_t component,
                          uint32_t first, uint32_t count, float *values) {
    const collection *c = state;
    return c->file.reader->values(c->file.state, zone, field, component, first, count, values);
}

static status read_blanks(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          uint8_t *is_node) {
    const collection *c = state;
    return c->file.reader->blanks(c->file.state, zone, first, count, is_node);
}

static bool is_collection(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    char type[VTK_XML_TYPE_MAX];
    (void)bytes;
    return vtk_xml_type(start, size, type) && strcmp(type, "Collection") == 0 &&
           vtk_parts_begin_with(start, size, ".vts .pvts ");
}

const curvilinear_reader curvilinear_vtk_collection_reader = {.format =
                                                                  "collection of structured grids",
                                                              .known = is_collection,
                                                              .open = open_collection,
                                                              .close = close_collection,
                                                              .names_files = true,
                                                              .field = name_field,
                                                              .places = read_places,
                                                              .values = read_values,
                                                              .blanks = read_blanks,
                                                              .steps = tell_steps,
                                                              .seek = seek_step};
