#include "formats/surface/surface_ply.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/input/binary_fields.h"
#include "formats/input/text_tokens.h"
#include "formats/surface/surface_colour.h"
#include "formats/surface/surface_flow.h"

enum { PROPERTIES_MAX = 256, ELEMENTS_MAX = 64, LIST_MAX = 1 << 24, FIELDS_MAX = 256 };

typedef enum ply_type { I8, U8, I16, U16, I32, U32, F32, F64, TYPES } ply_type;

static const struct {
    const char *old, *now;
    int size;
    bool real, negative;
    double most; /* of a colour */
} types[TYPES] = {
    {"char", "int8", 1, false, true, 127},     {"uchar", "uint8", 1, false, false, 255},
    {"short", "int16", 2, false, true, 32767}, {"ushort", "uint16", 2, false, false, 65535},
    {"int", "int32", 4, false, true, 255},     {"uint", "uint32", 4, false, false, 255},
    {"float", "float32", 4, true, true, 1},    {"double", "float64", 8, true, true, 1}};

typedef struct ply_property {
    char name[64];
    bool list;
    ply_type count_type, type;
    int offset; /* in a binary row of numbers */
} ply_property;

typedef enum ply_element_kind { OTHERS, VERTICES, FACES, STRIPS } ply_element_kind;

typedef struct ply_element {
    char name[64];
    ply_element_kind kind;
    int64_t count;
    int first, properties; /* of the array below */
    int corners;           /* the list of them, from `first`; -1: none */
    int axes[3];           /* properties x, y, z likewise */
    int rgb[3];            /* red, green, blue */
    int normal[3];         /* nx, ny, nz */
    int row;               /* bytes of a binary row; 0: it has lists */
} ply_element;

typedef enum ply_coding { TEXT, LITTLE, BIG } ply_coding;

typedef struct ply {
    surface_choice choice;
    mem *m;
    text_tokens t;
    ply_coding coding;
    ply_element elements[ELEMENTS_MAX];
    ply_property properties[PROPERTIES_MAX];
    int element_count, property_count;
    const ply_element *vertices;
    double row[PROPERTIES_MAX]; /* numbers of the element that is read */
    uint64_t *ids;              /* its corners */
    size_t corners, room;
    double *values; /* the faces' fields taken */
    uint64_t body;  /* the byte behind the header */
} ply;

/* ---- the header ---- */

static status read_word(text_tokens *t, const char *what, char *word, size_t size) {
    status st = text_tokens_next(t);
    if (st == ST_OK && (!t->token[0] || strlen(t->token) >= size))
        return text_tokens_fault(t, "%s", what);
    if (st == ST_OK)
        strcpy(word, t->token);
    return st;
}

static status find_type(const text_tokens *t, ply_type *out) {
    for (int i = 0; i < TYPES; i++)
        if (strcmp(t->token, types[i].old) == 0 || strcmp(t->token, types[i].now) == 0) {
            *out = (ply_type)i;
            return ST_OK;
        }
    return text_tokens_fault(t, "a type of PLY, such as float");
}

static status read_type(text_tokens *t, ply_type *out) {
    status st = text_tokens_next(t);
    return st == ST_OK ? find_type(t, out) : st;
}

static status read_format(ply *p) {
    static const char *const names[] = {
        [TEXT] = "ascii", [LITTLE] = "binary_little_endian", [BIG] = "binary_big_endian"};
    int i = 0;
    status st = text_tokens_next(&p->t);
    if (st != ST_OK)
        return st;
    while (i <= BIG && strcmp(p->t.token, names[i]) != 0)
        i++;
    if (i > BIG)
        return text_tokens_fault(&p->t, "ascii, binary_little_endian or binary_big_endian");
    p->coding = (ply_coding)i;
    st = text_tokens_next(&p->t);
    return st == ST_OK && strcmp(p->t.token, "1.0") != 0 ? text_tokens_fault(&p->t, "1.0") : st;
}

static ply_element_kind kind_of(const char *name) {
    return strcmp(name, "vertex") == 0      ? VERTICES
           : strcmp(name, "face") == 0      ? FACES
           : strcmp(name, "tristrips") == 0 ? STRIPS
                                            : OTHERS;
}

static status read_element(ply *p) {
    if (p->element_count == ELEMENTS_MAX)
        return text_tokens_fault(&p->t, "up to %d elements", ELEMENTS_MAX);
    ply_element *e = &p->elements[p->element_count++];
    *e = (ply_element){.first = p->property_count, .corners = -1};
    for (int a = 0; a < 3; a++)
        e->axes[a] = e->rgb[a] = e->normal[a] = -1;
    status st = read_word(&p->t, "the name of an element", e->name, sizeof e->name);
    if (st == ST_OK)
        st = text_tokens_int(&p->t, "the number of such elements", 0, (int64_t)1 << 40, &e->count);
    e->kind = kind_of(e->name);
    if (st == ST_OK && e->kind == VERTICES && p->vertices)
        return text_tokens_fault(&p->t, "vertices once");
    p->vertices = e->kind == VERTICES ? e : p->vertices;
    return st;
}

/* Note what a property is for, by its name. */
static void note_use(ply_element *e, const ply_property *q, int number) {
    static const char *const axes[3] = {"x", "y", "z"}, *const normal[3] = {"nx", "ny", "nz"},
                             *const colours[3] = {"red", "green", "blue"};
    for (int a = 0; a < 3; a++) {
        if (!q->list && strcmp(q->name, axes[a]) == 0)
            e->axes[a] = number;
        if (!q->list && strcmp(q->name, colours[a]) == 0)
            e->rgb[a] = number;
        if (!q->list && strcmp(q->name, normal[a]) == 0)
            e->normal[a] = number;
    }
    if (q->list && (strcmp(q->name, "vertex_indices") == 0 || strcmp(q->name, "vertex_index") == 0))
        e->corners = number;
}

static status read_property(ply *p) {
    text_tokens *t = &p->t;
    if (p->element_count == 0)
        return text_tokens_fault(t, "an element before its properties");
    if (p->property_count == PROPERTIES_MAX)
        return text_tokens_fault(t, "up to %d properties", PROPERTIES_MAX);
    ply_element *e = &p->elements[p->element_count - 1];
    ply_property *q = &p->properties[p->property_count];
    *q = (ply_property){.offset = e->row};
    status st = text_tokens_next(t);
    q->list = st == ST_OK && strcmp(t->token, "list") == 0;
    if (st == ST_OK && q->list)
        st = read_type(t, &q->count_type);
    if (st == ST_OK)
        st = q->list ? read_type(t, &q->type) : find_type(t, &q->type);
    if (st == ST_OK && q->list && types[q->count_type].real)
        return text_tokens_fault(t, "a count of whole numbers");
    if (st == ST_OK)
        st = read_word(t, "the name of a property", q->name, sizeof q->name);
    if (st != ST_OK)
        return st;
    note_use(e, q, p->property_count - e->first);
    if (e->corners == p->property_count - e->first && types[q->type].real)
        return text_tokens_fault(t, "corners that are whole numbers");
    e->row += types[q->type].size;
    e->properties++;
    p->property_count++;
    return ST_OK;
}

/* Read one line of the header. *ended: true behind the last line. */
static status read_line(ply *p, bool *ended) {
    char rest[4096];
    status st = text_tokens_next(&p->t);
    const char *word = p->t.token;
    *ended = false;
    if (st != ST_OK)
        return st;
    if (strcmp(word, "comment") == 0 || strcmp(word, "obj_info") == 0)
        return text_tokens_rest(&p->t, rest, sizeof rest);
    if (strcmp(word, "format") == 0)
        st = read_format(p);
    else if (strcmp(word, "element") == 0)
        st = read_element(p);
    else if (strcmp(word, "property") == 0)
        st = read_property(p);
    else if (strcmp(word, "end_header") == 0)
        *ended = true;
    else
        return text_tokens_fault(&p->t, "format, element, property, comment or end_header");
    return st == ST_OK ? text_tokens_end_line(&p->t) : st;
}

/* ---- the fields ---- */

static bool has_colour(const ply_element *e) {
    return e->rgb[0] >= 0 && e->rgb[1] >= 0 && e->rgb[2] >= 0;
}

/* Whether a number of an element may be a field: 0 no, 1 if asked for, 2 unasked. */
static int may_be_field(const ply_element *e, int number, const char *name) {
    static const char *const aside[] = {"nx", "ny",        "nz",        "u",     "v",    "s",
                                        "t",  "texture_u", "texture_v", "flags", "alpha"};
    for (int a = 0; a < 3; a++)
        if ((e->kind == VERTICES && number == e->axes[a]) || (has_colour(e) && number == e->rgb[a]))
            return 0;
    for (size_t i = 0; i < sizeof aside / sizeof *aside; i++)
        if (strcmp(name, aside[i]) == 0)
            return 1;
    return 2;
}

static status add_fields(ply *p, const ply_element *e) {
    surface_field f = {.components = 1, .of_faces = e->kind != VERTICES};
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < e->properties; i++) {
        const ply_property *q = &p->properties[e->first + i];
        const int may = q->list ? 0 : may_be_field(e, i, q->name);
        f.aside = may == 1;
        f.at = (uint32_t)i;
        snprintf(f.name, sizeof f.name, "%s", q->name);
        if (may)
            st = surface_choice_add(&p->choice, &f);
    }
    f.aside = false;
    f.colour = true;
    strcpy(f.name, COLOUR_FIELD);
    return st == ST_OK && has_colour(e) ? surface_choice_add(&p->choice, &f) : st;
}

/* ---- the rest of the header ---- */

/* The fewest bytes that an element takes. */
static uint64_t least_bytes(const ply *p, const ply_element *e) {
    uint64_t bytes = 0;
    for (int i = e->first; i < e->first + e->properties; i++) {
        const ply_property *q = &p->properties[i];
        bytes += p->coding == TEXT ? 2U : (uint64_t)types[q->list ? q->count_type : q->type].size;
    }
    return bytes;
}

static status check_size(const ply *p) {
    uint64_t left = byte_stream_left(p->t.s);
    for (int i = 0; left != UINT64_MAX && i < p->element_count; i++) {
        const ply_element *e = &p->elements[i];
        const uint64_t bytes = least_bytes(p, e);
        if (bytes && (uint64_t)e->count > (left + (p->coding == TEXT)) / bytes)
            return status_describe(ST_CORRUPT,
                                   "%s: the header says %lld of \"%s\", of %llu bytes or more "
                                   "each, but only %llu bytes follow",
                                   byte_stream_name(p->t.s), (long long)e->count, e->name,
                                   (unsigned long long)bytes, (unsigned long long)left);
        left -= bytes * (uint64_t)e->count < left ? bytes * (uint64_t)e->count : left;
    }
    return ST_OK;
}

static status check_header(ply *p) {
    const char *file = byte_stream_name(p->t.s);
    const ply_element *v = p->vertices;
    if (!v || v->axes[0] < 0 || v->axes[1] < 0 || v->axes[2] < 0)
        return status_describe(ST_CORRUPT, "%s: expected vertices with properties x, y and z",
                               file);
    for (int i = 0; i < p->element_count; i++) {
        ply_element *e = &p->elements[i];
        for (int k = e->first; k < e->first + e->properties; k++)
            e->row = p->properties[k].list ? 0 : e->row;
        if ((e->kind == FACES || e->kind == STRIPS) && e->count > 0 && e->corners < 0)
            return status_describe(ST_CORRUPT,
                                   "%s: faces without a list vertex_indices, expected one", file);
        const bool has_fields = e->kind == VERTICES || e->kind == FACES;
        status st = has_fields ? add_fields(p, e) : ST_OK;
        if (st != ST_OK)
            return st;
    }
    return check_size(p);
}

static status read_header(ply *p) {
    bool ended = false;
    status st = text_tokens_next(&p->t);
    if (st == ST_OK && strcmp(p->t.token, "ply") != 0)
        return text_tokens_fault(&p->t, "ply");
    if (st == ST_OK)
        st = text_tokens_end_line(&p->t);
    while (st == ST_OK && !ended)
        st = read_line(p, &ended);
    p->body = byte_stream_position(p->t.s);
    return st == ST_OK ? check_header(p) : st;
}

/* ---- numbers ---- */

static double number_at(const uint8_t *at, ply_type type, bool big) {
    const int size = types[type].size;
    return types[type].real       ? binary_real(at, size, big)
           : types[type].negative ? (double)binary_signed(at, size, big)
                                  : (double)binary_unsigned(at, size, big);
}

static status cut_short(const ply *p, const ply_element *e, int64_t index, size_t size) {
    return status_describe(
        ST_CORRUPT, "%s: ends at byte %llu, inside %s %lld (from 0)", byte_stream_name(p->t.s),
        (unsigned long long)(byte_stream_position(p->t.s) + size), e->name, (long long)index);
}

static status read_number(ply *p, const ply_element *e, int64_t index, ply_type type, double *out) {
    const uint8_t *at;
    size_t size;
    const size_t width = (size_t)types[type].size;
    if (p->coding == TEXT)
        return text_tokens_double(&p->t, "a number", out);
    status st = byte_stream_peek(p->t.s, width, &at, &size);
    if (st == ST_OK && size < width)
        return cut_short(p, e, index, size);
    if (st == ST_OK) {
        *out = number_at(at, type, p->coding == BIG);
        byte_stream_take(p->t.s, width);
    }
    return st;
}

/* Read a row of numbers without lists, all at once. */
static status read_row(ply *p, const ply_element *e, int64_t index) {
    const uint8_t *at;
    size_t size;
    status st = byte_stream_peek(p->t.s, (size_t)e->row, &at, &size);
    if (st == ST_OK && size < (size_t)e->row)
        return cut_short(p, e, index, size);
    for (int i = 0; st == ST_OK && i < e->properties; i++) {
        const ply_property *q = &p->properties[e->first + i];
        p->row[i] = number_at(at + q->offset, q->type, p->coding == BIG);
    }
    if (st == ST_OK)
        byte_stream_take(p->t.s, (size_t)e->row);
    return st;
}

static status read_count(ply *p, const ply_element *e, int64_t index, const ply_property *q,
                         int64_t most, int64_t *out) {
    double count = 0;
    status st = read_number(p, e, index, q->count_type, &count);
    if (st == ST_OK && !(count >= 0 && count <= (double)most && count == floor(count)))
        return status_describe(
            ST_CORRUPT,
            "%s: %s %lld (counted from 0): a list of %g, expected a whole number in 0 .. %lld",
            byte_stream_name(p->t.s), e->name, (long long)index, count, (long long)most);
    *out = st == ST_OK ? (int64_t)count : 0;
    return st;
}

/* A number that is no vertex's gives an id that none has. */
static uint64_t id_of(double number) {
    return number >= 0 && number < (double)MESH_POINTS_MAX && number == floor(number)
               ? (uint64_t)number
               : UINT64_MAX;
}

/* ---- elements ---- */

static status skip_list(ply *p, const ply_element *e, int64_t index, const ply_property *q) {
    int64_t count = 0;
    double number;
    status st = read_count(p, e, index, q, LIST_MAX, &count);
    for (int64_t i = 0; st == ST_OK && i < count; i++)
        st = read_number(p, e, index, q->type, &number);
    return st;
}

static status read_corners(ply *p, const ply_element *e, int64_t index, const ply_property *q) {
    int64_t count = 0;
    double number = 0;
    status st = read_count(p, e, index, q, SURFACE_CORNERS_MAX, &count);
    p->corners = 0;
    for (int64_t i = 0; st == ST_OK && i < count; i++) {
        st = read_number(p, e, index, q->type, &number);
        if (st == ST_OK)
            st = mem_grow(p->m, &p->ids, sizeof *p->ids, p->corners, 16, &p->room);
        if (st == ST_OK)
            p->ids[p->corners++] = id_of(number);
    }
    return st;
}

/* Put the triangles of a list of strips, each but the last with -1 behind it. */
static status put_strips(ply *p, const ply_element *e, int64_t index, const ply_property *q,
                         surface_flow *flow) {
    int64_t count = 0;
    double number = 0;
    surface_strip strip = {.count = 0};
    status st = read_count(p, e, index, q, (int64_t)1 << 40, &count);
    for (int64_t i = 0; st == ST_OK && i < count; i++) {
        st = read_number(p, e, index, q->type, &number);
        if (st == ST_OK && number == -1)
            strip = (surface_strip){.count = 0};
        else if (st == ST_OK)
            st = surface_flow_strip(flow, &strip, id_of(number), p->values);
    }
    return st;
}

/* Read one element: its numbers into the row, a face's corners; a strip's triangles are put. */
static status read_one(ply *p, const ply_element *e, int64_t index, surface_flow *flow) {
    status st = ST_OK;
    if (p->coding != TEXT && e->row > 0)
        return read_row(p, e, index);
    for (int i = 0; st == ST_OK && i < e->properties; i++) {
        const ply_property *q = &p->properties[e->first + i];
        if (!q->list)
            st = read_number(p, e, index, q->type, &p->row[i]);
        else if (i == e->corners && e->kind == FACES)
            st = read_corners(p, e, index, q);
        else if (i == e->corners && e->kind == STRIPS)
            st = put_strips(p, e, index, q, flow);
        else
            st = skip_list(p, e, index, q);
    }
    return st;
}

static double field_value(const ply *p, const ply_element *e, const surface_field *f) {
    if (!f->colour)
        return p->row[f->at];
    const double rgb[3] = {p->row[e->rgb[0]], p->row[e->rgb[1]], p->row[e->rgb[2]]};
    return surface_colour_value(rgb, types[p->properties[e->first + e->rgb[0]].type].most);
}

static bool has_normals(const ply_element *e) {
    return e->normal[0] >= 0 && e->normal[1] >= 0 && e->normal[2] >= 0;
}

static status put_vertex(ply *p, const ply_element *e, surface_flow *flow) {
    const double xyz[3] = {p->row[e->axes[0]], p->row[e->axes[1]], p->row[e->axes[2]]};
    status st = surface_flow_point(flow, xyz);
    if (st == ST_OK && has_normals(e) && mesh_feed_takes_normals(flow->feed)) {
        const double normal[3] = {p->row[e->normal[0]], p->row[e->normal[1]], p->row[e->normal[2]]};
        st = surface_flow_normal(flow, normal);
    }
    for (uint32_t k = 0; st == ST_OK && k < p->choice.taken_count; k++) {
        const surface_field *f = surface_choice_taken(&p->choice, k);
        if (!f->of_faces)
            st = surface_flow_value(flow, k, field_value(p, e, f));
    }
    return st;
}

static status put_face(ply *p, const ply_element *e, surface_flow *flow) {
    for (uint32_t k = 0; k < p->choice.taken_count; k++) {
        const surface_field *f = surface_choice_taken(&p->choice, k);
        if (f->of_faces)
            p->values[k] = field_value(p, e, f);
    }
    return surface_flow_polygon(flow, p->ids, p->corners, p->values);
}

/* Check that nothing follows but line ends. */
static status check_end(ply *p) {
    const uint8_t *more;
    size_t size;
    if (p->coding == TEXT) {
        status st = text_tokens_next(&p->t);
        return st == ST_OK && p->t.token[0] ? text_tokens_fault(&p->t, "the end") : st;
    }
    status st = byte_stream_peek(p->t.s, 1, &more, &size);
    if (st == ST_OK && size > 0)
        return status_describe(ST_CORRUPT, "%s: more bytes at %llu, expected the end",
                               byte_stream_name(p->t.s),
                               (unsigned long long)byte_stream_position(p->t.s));
    return st;
}

static status read_elements(ply *p, surface_flow *flow) {
    status st = surface_flow_piece(flow, (uint64_t)p->vertices->count);
    for (int i = 0; st == ST_OK && i < p->element_count; i++) {
        const ply_element *e = &p->elements[i];
        if (flow->apart && e->kind >= FACES && e < p->vertices)
            return status_describe(
                ST_UNSUPPORTED,
                "%s: faces in front of the vertices, expected them behind: their "
                "values give each face points of its own",
                byte_stream_name(p->t.s));
        /* A strip has no values of faces. */
        for (uint32_t k = 0; e->kind == STRIPS && k < p->choice.taken_count; k++)
            p->values[k] = (double)NAN;
        for (int64_t k = 0; st == ST_OK && k < (e->properties ? e->count : 0); k++) {
            st = read_one(p, e, k, flow);
            if (st == ST_OK && e->kind == VERTICES)
                st = put_vertex(p, e, flow);
            else if (st == ST_OK && e->kind == FACES)
                st = put_face(p, e, flow);
        }
    }
    if (st == ST_OK)
        st = check_end(p);
    return st == ST_OK ? surface_flow_end_piece(flow) : st;
}

/* The triangles are counted on a stream of their own. */
static status pass(void *state, surface_flow *flow) {
    ply *p = state;
    const text_tokens kept = p->t;
    byte_stream *again = NULL;
    status st = ST_OK;
    if (flow->dry) {
        st = byte_stream_open(p->m, p->choice.source->path, &again);
        if (st == ST_OK)
            st = byte_stream_skip(again, p->body);
        p->t.s = again;
    }
    if (st == ST_OK)
        st = read_elements(p, flow);
    if (flow->dry) {
        byte_stream_close(again);
        p->t = kept;
    }
    return st;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    return (size >= 4 && (memcmp(start, "ply\n", 4) == 0 || memcmp(start, "ply\r", 4) == 0)) ||
           text_ends_in(path, ".ply");
}

static status open_file(mesh_source *source, void **state) {
    ply *p = mem_zalloc(source->m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    *state = p;
    p->m = source->m;
    p->choice.source = source;
    p->t = (text_tokens){.s = source->data, .line = 1};
    return read_header(p);
}

static status read(void *state, mesh_feed *feed) {
    ply *p = state;
    p->values = mem_array(p->m, p->choice.taken_count + 1, sizeof *p->values);
    if (!p->values)
        return ST_NOMEM;
    for (int i = 0; i < p->element_count; i++)
        if (p->elements[i].kind == FACES)
            mesh_feed_expect_cells(feed, (uint64_t)p->elements[i].count);
    surface_flow_expect_polygons(&p->choice, feed);
    return surface_flow_run(&p->choice, feed, (uint64_t)p->vertices->count,
                            !byte_stream_is_pipe(p->t.s), pass, p);
}

static void counts(const void *state, uint64_t *points, uint64_t *cells) {
    const ply *p = state;
    *points = (uint64_t)p->vertices->count;
    *cells = 0;
    for (int i = 0; i < p->element_count; i++)
        if (p->elements[i].kind >= FACES)
            *cells += (uint64_t)p->elements[i].count;
}

static void close_file(void *state) {
    ply *p = state;
    if (!p)
        return;
    surface_choice_release(&p->choice);
    mem_free(p->m, p->ids);
    mem_free(p->m, p->values);
    mem_free(p->m, p);
}

const mesh_reader surface_ply_reader = {.format = "PLY",
                                        .known = known,
                                        .open = open_file,
                                        .read = read,
                                        .close = close_file,
                                        .take = surface_choice_take,
                                        .fields = surface_choice_fields,
                                        .counts = counts};
