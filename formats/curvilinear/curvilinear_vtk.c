#include "formats/curvilinear/curvilinear_vtk.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "formats/curvilinear/curvilinear_source.h"
#include "formats/input/text_number.h"
#include "formats/leaf/curvilinear_zones.h"
#include "formats/vtk/vtk_cursor.h"
#include "formats/vtk/vtk_fields.h"
#include "formats/vtk/vtk_legacy.h"
#include "formats/vtk/vtk_xml.h"

enum { CHUNK = 4096, HIDDEN_POINT = 2 };

/* Marks of cells. VTK: vtkDataSetAttributes.h. */
enum { DUPLICATE_CELL = 1, REFINED_CELL = 8, HIDDEN_CELL = 32 };

/* A piece is a zone. */
typedef struct piece {
    vtk_array points;
    vtk_fields fields;
} piece;

/* An array that is read plane by plane, in the zone where it stands. */
typedef struct sweep {
    uint32_t field, component; /* component: 0: the magnitude */
    vtk_cursor *cursor;        /* NULL: it is not open */
    uint32_t zone, next;       /* the next plane */
} sweep;

typedef struct vtk_zones {
    mem *m;
    const char *path;
    piece *pieces;
    uint32_t (*nodes)[3];
    size_t count, piece_room, node_room;
    sweep places, blanks, hidden;
    sweep *values; /* one for each field and component that was asked for */
    size_t value_count, value_room;
    double *chunk;
    bool sized; /* legacy: DIMENSIONS was there */
} vtk_zones;

/* ---- scanning ---- */

/* Add a zone of so many nodes along each axis. */
static status add_piece(vtk_zones *z, const int64_t nodes[3]) {
    if (z->count == UINT32_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: more than 2^32 - 1 pieces", z->path);
    for (int a = 0; a < 3; a++)
        if (nodes[a] < 2 || nodes[a] > CURVILINEAR_NODES_MAX)
            return status_describe(
                ST_UNSUPPORTED, "%s: piece %zu has %lld nodes along %c, expected 2 to %d", z->path,
                z->count + 1, (long long)nodes[a], "ijk"[a], CURVILINEAR_NODES_MAX);
    status st = mem_grow(z->m, &z->pieces, sizeof *z->pieces, z->count, 1, &z->piece_room);
    if (st == ST_OK)
        st = mem_grow(z->m, &z->nodes, sizeof *z->nodes, z->count, 1, &z->node_room);
    if (st != ST_OK)
        return st;
    z->pieces[z->count] = (piece){0};
    for (int a = 0; a < 3; a++)
        z->nodes[z->count][a] = (uint32_t)nodes[a];
    z->count++;
    return ST_OK;
}

/* Our kinds of elements. */
enum {
    ELEMENT_GRID = VTK_XML_OWN,
    ELEMENT_PIECE,
    ELEMENT_POINTS,
    ELEMENT_POINT_DATA,
    ELEMENT_CELL_DATA,
};

static status on_piece(vtk_xml *x, const char **attributes) {
    vtk_extent e;
    int64_t nodes[3];
    const status st = vtk_xml_extent(x, attributes, "Extent", &e);
    if (st != ST_OK)
        return st;
    vtk_extent_nodes(&e, nodes);
    return add_piece(vtk_xml_user(x), nodes);
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    vtk_zones *z = vtk_xml_user(x);
    piece *p = &z->pieces[z->count - 1]; /* these elements are in a piece */
    if (element == ELEMENT_POINT_DATA || element == ELEMENT_CELL_DATA)
        return vtk_fields_add(&p->fields, z->m,
                              element == ELEMENT_CELL_DATA ? VTK_OF_CELLS : VTK_OF_POINTS, name, a);
    if (element != ELEMENT_POINTS)
        return ST_OK;
    if (p->points.type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "the points come twice");
    p->points = *a;
    p->points.role = "points";
    return ST_OK;
}

static status scan_xml(vtk_zones *z, byte_stream *data) {
    static const vtk_xml_element elements[] = {
        {VTK_XML_FILE, "StructuredGrid", ELEMENT_GRID, NULL},
        {ELEMENT_GRID, "Piece", ELEMENT_PIECE, on_piece},
        {ELEMENT_PIECE, "Points", ELEMENT_POINTS, NULL},
        {ELEMENT_PIECE, "PointData", ELEMENT_POINT_DATA, NULL},
        {ELEMENT_PIECE, "CellData", ELEMENT_CELL_DATA, NULL},
        {0, NULL, 0, NULL},
    };
    static const vtk_xml_reader reader = {"StructuredGrid", elements, on_array};
    vtk_appended appended;
    status st = vtk_xml_scan(z->m, z->path, data, &reader, z, &appended);
    for (size_t i = 0; st == ST_OK && i < z->count; i++) {
        vtk_xml_locate(&appended, &z->pieces[i].points);
        vtk_xml_locate_fields(&appended, &z->pieces[i].fields);
    }
    return st;
}

/* The piece is there already, as the pass was begun with its fields. */
static status on_dimensions(vtk_legacy *v) {
    vtk_zones *z = v->user;
    uint64_t points = 1, cells = 1;
    status st = vtk_legacy_need_words(v, 4, "DIMENSIONS ni nj nk");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &z->sized);
    for (int a = 0; st == ST_OK && a < 3; a++) {
        int64_t n;
        if (!text_number_int(v->word[1 + a], 2, CURVILINEAR_NODES_MAX, &n))
            return vtk_legacy_fault(v, ST_UNSUPPORTED,
                                    "DIMENSIONS: \"%.40s\", expected 2 to %d nodes along each axis",
                                    v->word[1 + a], CURVILINEAR_NODES_MAX);
        z->nodes[0][a] = (uint32_t)n;
        if (__builtin_mul_overflow(points, (uint64_t)n, &points) || points >= (uint64_t)1 << 47)
            return vtk_legacy_fault(v, ST_CORRUPT, "DIMENSIONS: more than 2^47 nodes");
        cells *= (uint64_t)n - 1;
    }
    v->tuples_there[VTK_OF_POINTS] = points;
    v->tuples_there[VTK_OF_CELLS] = cells;
    return st;
}

static status on_points(vtk_legacy *v) {
    vtk_zones *z = v->user;
    vtk_array *points = &z->pieces[0].points;
    vtk_type type = VTK_ABSENT;
    uint64_t count = 0;
    bool before = points->type != VTK_ABSENT;
    status st = vtk_legacy_need_words(v, 3, "POINTS n type");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &before);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &count);
    if (st == ST_OK && (!z->sized || count != v->tuples_there[VTK_OF_POINTS]))
        st = vtk_legacy_fault(v, ST_CORRUPT,
                              "POINTS: \"%.40s\", expected as many as there are nodes, told before",
                              v->word[1]);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    if (st == ST_OK)
        st = vtk_legacy_array(v, type, "POINTS", 3 * count, points);
    points->components = 3;
    return st;
}

static status scan_legacy(vtk_zones *z, byte_stream *data) {
    static const vtk_legacy_keyword keywords[] = {
        {"DIMENSIONS", on_dimensions}, {"POINTS", on_points}, {NULL, NULL}};
    static const vtk_legacy_dataset sets[] = {{"STRUCTURED_GRID", keywords}, {NULL, NULL}};
    status st = add_piece(z, (const int64_t[]){2, 2, 2});
    if (st != ST_OK)
        return st;
    vtk_legacy v = {
        .m = z->m, .path = z->path, .s = data, .fields = &z->pieces[0].fields, .user = z};
    return vtk_legacy_scan(&v, sets);
}

/* ---- reading ---- */

static uint64_t plane_nodes(const vtk_zones *z, uint32_t zone) {
    return (uint64_t)z->nodes[zone][0] * z->nodes[zone][1];
}

/* The planes of an array of a zone's points, or cells. */
typedef struct planes {
    uint64_t each;
    uint32_t count;
} planes;

static planes planes_of(const vtk_zones *z, uint32_t zone, vtk_owner owner) {
    const uint32_t *n = z->nodes[zone], less = owner == VTK_OF_CELLS;
    return (planes){(uint64_t)(n[0] - less) * (n[1] - less), n[2] - less};
}

/* How many numbers such an array has; more than any file, if that is more than fits. */
static uint64_t numbers_of(planes p, uint32_t components) {
    uint64_t count;
    return __builtin_mul_overflow(p.each, (uint64_t)p.count, &count) ||
                   __builtin_mul_overflow(count, components, &count)
               ? UINT64_MAX - 1
               : count;
}

/* Takes numbers of nodes, or of cells: so many from number `at` of those asked for. */
typedef void taking(void *ctx, uint64_t at, size_t nodes, const double *numbers);

/* Read so many nodes; take NULL: skip them. */
static status read_nodes(vtk_zones *z, sweep *s, uint32_t components, uint64_t count, taking *take,
                         void *ctx) {
    const size_t most = CHUNK / components;
    for (uint64_t done = 0; done < count;) {
        const size_t n = count - done < most ? (size_t)(count - done) : most;
        status st = vtk_cursor_doubles(s->cursor, n * components, z->chunk);
        if (st != ST_OK)
            return st;
        if (take)
            take(ctx, done, n, z->chunk);
        done += n;
    }
    return ST_OK;
}

/* Read planes of an array. A step back, or to another zone, opens it anew. */
static status read_planes(vtk_zones *z, sweep *s, const vtk_array *a, vtk_owner owner,
                          uint32_t zone, uint32_t first, uint32_t count, taking *take, void *ctx) {
    const planes p = planes_of(z, zone, owner);
    const uint64_t plane = p.each;
    status st = ST_OK;
    if (!s->cursor || s->zone != zone || first < s->next) {
        vtk_cursor_close(s->cursor);
        s->cursor = NULL;
        s->zone = zone;
        s->next = 0;
        st = vtk_cursor_open(z->m, a, numbers_of(p, a->components), &s->cursor);
    }
    if (st == ST_OK)
        st = read_nodes(z, s, a->components, (first - s->next) * plane, NULL, NULL);
    if (st == ST_OK)
        st = read_nodes(z, s, a->components, count * plane, take, ctx);
    s->next = first + count;
    return st == ST_OK && s->next == p.count ? vtk_cursor_finish(s->cursor) : st;
}

typedef struct place_taking {
    float (*to)[3];
    uint64_t bad; /* the first node that is not finite, from 1; 0: none */
} place_taking;

static void take_places(void *ctx, uint64_t at, size_t nodes, const double *numbers) {
    place_taking *t = ctx;
    for (size_t i = 0; i < nodes; i++)
        for (int a = 0; a < 3; a++) {
            t->to[at + i][a] = (float)numbers[3 * i + (size_t)a];
            if (!isfinite(t->to[at + i][a]) && !t->bad)
                t->bad = at + i + 1;
        }
}

static status read_places(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          float (*out)[3]) {
    vtk_zones *z = state;
    const vtk_array *points = &z->pieces[zone].points;
    place_taking t = {.to = out};
    status st =
        read_planes(z, &z->places, points, VTK_OF_POINTS, zone, first, count, take_places, &t);
    if (st != ST_OK || !t.bad)
        return st;
    const uint64_t node = t.bad - 1 + first * plane_nodes(z, zone), row = node / z->nodes[zone][0];
    return vtk_array_fault(points, ST_CORRUPT,
                           "node %llu %llu %llu: expected finite numbers that a float holds",
                           (unsigned long long)(node % z->nodes[zone][0]),
                           (unsigned long long)(row % z->nodes[zone][1]),
                           (unsigned long long)(row / z->nodes[zone][1]));
}

typedef struct value_taking {
    float *to;
    uint32_t components, component;
} value_taking;

static void take_values(void *ctx, uint64_t at, size_t nodes, const double *numbers) {
    const value_taking *t = ctx;
    for (size_t i = 0; i < nodes; i++) {
        const double *v = numbers + i * t->components;
        double sum = 0;
        for (uint32_t c = 0; c < t->components; c++)
            sum += v[c] * v[c];
        t->to[at + i] = (float)(t->component         ? v[t->component - 1]
                                : t->components == 1 ? v[0]
                                                     : sqrt(sum));
    }
}

/* Returns the field's array of a piece; NULL: there is none. */
static const vtk_array *field_of(const vtk_zones *z, uint32_t zone, uint32_t field) {
    const vtk_fields *f = &z->pieces[0].fields;
    for (size_t i = 0; i < f->count[VTK_OF_POINTS]; i++) {
        const vtk_array *a = &f->items[VTK_OF_POINTS][i];
        if (vtk_fields_is_one(a) && field-- == 0)
            return zone == 0 ? a : vtk_fields_find(&z->pieces[zone].fields, VTK_OF_POINTS, a->name);
    }
    return NULL;
}

static status find_sweep(vtk_zones *z, uint32_t field, uint32_t component, sweep **out) {
    for (size_t i = 0; i < z->value_count; i++)
        if (z->values[i].field == field && z->values[i].component == component) {
            *out = &z->values[i];
            return ST_OK;
        }
    status st = mem_grow(z->m, &z->values, sizeof *z->values, z->value_count, 4, &z->value_room);
    if (st != ST_OK)
        return st;
    *out = &z->values[z->value_count++];
    **out = (sweep){.field = field, .component = component};
    return ST_OK;
}

static status read_values(void *state, uint32_t zone, uint32_t field, uint32_t component,
                          uint32_t first, uint32_t count, float *out) {
    vtk_zones *z = state;
    const vtk_array *a = field_of(z, zone, field);
    sweep *s;
    status st = find_sweep(z, field, component, &s);
    value_taking t = {.to = out, .components = a->components, .component = component};
    return st == ST_OK ? read_planes(z, s, a, VTK_OF_POINTS, zone, first, count, take_values, &t)
                       : st;
}

static const vtk_array *hides_points(const piece *p) {
    return vtk_fields_find(&p->fields, VTK_OF_POINTS, VTK_GHOST_TYPE);
}

static void take_blanks(void *ctx, uint64_t at, size_t nodes, const double *numbers) {
    uint8_t *to = ctx;
    for (size_t i = 0; i < nodes; i++)
        to[at + i] = !((unsigned)numbers[i] & HIDDEN_POINT);
}

/* The marks of cells that are no part of the grid. What a piece has twice is, unless another zone
 * has it. Older files mark by a distance only what another piece has. */
static unsigned hiding_marks(const vtk_zones *z, const vtk_array *ghosts) {
    const unsigned other = z->count > 1 ? DUPLICATE_CELL : 0;
    return strcmp(ghosts->name, VTK_GHOST_TYPE) == 0 ? HIDDEN_CELL | REFINED_CELL | other
           : other                                   ? UINT8_MAX
                                                     : 0;
}

typedef struct cell_taking {
    uint8_t *to; /* per node */
    const uint32_t *nodes;
    unsigned marks;
} cell_taking;

static void take_cells(void *ctx, uint64_t at, size_t cells, const double *numbers) {
    const cell_taking *t = ctx;
    for (size_t c = 0; c < cells; c++) {
        const uint64_t row = (at + c) / (t->nodes[0] - 1), i = (at + c) % (t->nodes[0] - 1);
        const uint64_t k = row / (t->nodes[1] - 1), j = row % (t->nodes[1] - 1);
        uint8_t *to = &t->to[i + t->nodes[0] * (j + t->nodes[1] * k)];
        if ((unsigned)numbers[c] & t->marks && *to)
            *to |= CURVILINEAR_HIDDEN;
    }
}

/* Planes of nodes, and of the cells that begin there: none at the last one. */
static status read_blanks(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          uint8_t *out) {
    vtk_zones *z = state;
    const piece *p = &z->pieces[zone];
    const vtk_array *a = hides_points(p), *cells = vtk_fields_ghosts(&p->fields);
    const uint32_t last = z->nodes[zone][2] - 1, end = first + count < last ? first + count : last;
    status st = ST_OK;
    memset(out, CURVILINEAR_NODE, (size_t)(count * plane_nodes(z, zone)));
    if (a)
        st = read_planes(z, &z->blanks, a, VTK_OF_POINTS, zone, first, count, take_blanks, out);
    if (st != ST_OK || !cells || first >= end)
        return st;
    cell_taking t = {out, z->nodes[zone], hiding_marks(z, cells)};
    return read_planes(z, &z->hidden, cells, VTK_OF_CELLS, zone, first, end - first, take_cells,
                       &t);
}

/* ---- opening ---- */

static void close_zones(void *state) {
    vtk_zones *z = state;
    if (!z)
        return;
    vtk_cursor_close(z->places.cursor);
    vtk_cursor_close(z->blanks.cursor);
    vtk_cursor_close(z->hidden.cursor);
    for (size_t i = 0; i < z->value_count; i++)
        vtk_cursor_close(z->values[i].cursor);
    for (size_t i = 0; i < z->count; i++)
        vtk_fields_release(&z->pieces[i].fields, z->m);
    mem_free(z->m, z->pieces);
    mem_free(z->m, z->nodes);
    mem_free(z->m, z->values);
    mem_free(z->m, z->chunk);
    mem_free(z->m, z);
}

/* Check that the file has room for an array of all nodes or cells, before anybody makes room for
 * them. */
static status check_room(const vtk_zones *z, uint32_t zone, vtk_owner owner, const vtk_array *a) {
    vtk_cursor *c = NULL;
    status st = vtk_cursor_open(z->m, a, numbers_of(planes_of(z, zone, owner), a->components), &c);
    vtk_cursor_close(c);
    return st;
}

/* Check the arrays of a piece: points, marks, and each field of the first piece. */
static status check_piece(vtk_zones *z, uint32_t zone, uint32_t fields) {
    const piece *p = &z->pieces[zone];
    const vtk_array *marks = hides_points(p), *cells = vtk_fields_ghosts(&p->fields);
    if (p->points.type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the points of piece %u", z->path,
                               zone + 1);
    if (p->points.components != 3 || vtk_array_width(p->points.type) == 0)
        return vtk_array_fault(&p->points, ST_CORRUPT, "%u components, expected 3 numbers",
                               p->points.components);
    if (marks && (marks->components != 1 || marks->type != VTK_U8))
        return vtk_array_fault(marks, ST_CORRUPT, "expected a byte a point");
    if (cells && (cells->components != 1 || cells->type != VTK_U8))
        return vtk_array_fault(cells, ST_CORRUPT, "expected a byte a cell");
    status st = check_room(z, zone, VTK_OF_POINTS, &p->points);
    if (st == ST_OK && marks)
        st = check_room(z, zone, VTK_OF_POINTS, marks);
    if (st == ST_OK && cells)
        st = check_room(z, zone, VTK_OF_CELLS, cells);
    for (uint32_t i = 0; st == ST_OK && i < fields; i++) {
        const vtk_array *first = field_of(z, 0, i), *a = field_of(z, zone, i);
        if (!a)
            return status_describe(ST_CORRUPT, "%s: piece %u has no array \"%s\", unlike the first",
                                   z->path, zone + 1, first->name);
        if (a->components != first->components || vtk_array_width(a->type) == 0)
            return vtk_array_fault(a, ST_CORRUPT, "expected %u numbers a point, as in the first",
                                   first->components);
        if (a->components > CHUNK)
            return vtk_array_fault(a, ST_UNSUPPORTED, "%u components, expected up to %d",
                                   a->components, CHUNK);
        st = check_room(z, zone, VTK_OF_POINTS, a);
    }
    return st;
}

static status open_zones(curvilinear_opening *o, status (*scan)(vtk_zones *, byte_stream *),
                         void **state) {
    vtk_zones *z = *state = mem_zalloc(o->m, sizeof *z);
    if (!z)
        return ST_NOMEM;
    *z = (vtk_zones){.m = o->m, .path = byte_stream_path(o->data)};
    if (o->hints.solutions.count > 0 || o->hints.functions.count > 0 || o->hints.layout)
        return status_describe(ST_USAGE,
                               "%s: a grid of VTK, expected PLOT3D where a layout, a solution or "
                               "functions are given",
                               z->path);
    z->chunk = mem_array(o->m, CHUNK, sizeof *z->chunk);
    status st = z->chunk ? scan(z, o->data) : ST_NOMEM;
    if (st == ST_OK && z->count == 0)
        st = status_describe(ST_CORRUPT, "%s: expected a Piece in a StructuredGrid", z->path);
    while (st == ST_OK && field_of(z, 0, o->fields))
        o->fields++;
    for (uint32_t i = 0; st == ST_OK && i < z->count; i++) {
        st = check_piece(z, i, o->fields);
        o->blanked =
            o->blanked || hides_points(&z->pieces[i]) || vtk_fields_ghosts(&z->pieces[i].fields);
    }
    o->zones = (uint32_t)z->count;
    o->nodes = (const uint32_t(*)[3])z->nodes;
    return st;
}

static const char *name_field(void *state, uint32_t field, uint32_t *components) {
    const vtk_array *a = field_of(state, 0, field);
    *components = a->components;
    return a->name;
}

static bool is_xml(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    char type[VTK_XML_TYPE_MAX];
    (void)bytes;
    return vtk_xml_type(start, size, type) && strcmp(type, "StructuredGrid") == 0;
}

static status open_xml(curvilinear_opening *o, void **state) {
    return open_zones(o, scan_xml, state);
}

static bool is_legacy(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    char name[VTK_LEGACY_NAME_MAX];
    (void)bytes;
    return vtk_legacy_names(start, size, name) && strcasecmp(name, "STRUCTURED_GRID") == 0;
}

static status open_legacy(curvilinear_opening *o, void **state) {
    return open_zones(o, scan_legacy, state);
}

const curvilinear_reader curvilinear_vtk_xml_reader = {.format = "VTK structured grid",
                                                       .known = is_xml,
                                                       .open = open_xml,
                                                       .close = close_zones,
                                                       .field = name_field,
                                                       .places = read_places,
                                                       .values = read_values,
                                                       .blanks = read_blanks};

const curvilinear_reader curvilinear_vtk_legacy_reader = {.format = "legacy VTK structured grid",
                                                          .known = is_legacy,
                                                          .open = open_legacy,
                                                          .close = close_zones,
                                                          .field = name_field,
                                                          .places = read_places,
                                                          .values = read_values,
                                                          .blanks = read_blanks};
