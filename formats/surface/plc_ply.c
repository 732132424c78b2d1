#include "formats/surface/plc_ply.h"

#include <endian.h>
#include <stdio.h>
#include <string.h>

#include "formats/input/text_tokens.h"

enum { PROPERTIES_MAX = 256, ELEMENTS_MAX = 64, LIST_MAX = 1 << 24 };

typedef enum ply_type { I8, U8, I16, U16, I32, U32, F32, F64, TYPES } ply_type;

static const struct {
    const char *old, *now;
    int size;
} types[TYPES] = {{"char", "int8", 1},     {"uchar", "uint8", 1},   {"short", "int16", 2},
                  {"ushort", "uint16", 2}, {"int", "int32", 4},     {"uint", "uint32", 4},
                  {"float", "float32", 4}, {"double", "float64", 8}};

/* How a property is used. */
typedef enum ply_use { SKIPPED, AXIS_X, AXIS_Y, AXIS_Z, VALUE, CORNERS } ply_use;

typedef struct ply_property {
    bool list;
    ply_type count_type, type;
    ply_use use;
} ply_property;

typedef struct ply_element {
    char name[64];
    int64_t count;
    int first, properties; /* of the array below */
} ply_element;

typedef enum ply_coding { TEXT, LITTLE, BIG } ply_coding;

typedef struct ply {
    plc_source *s;
    text_tokens t;
    ply_coding coding;
    ply_element elements[ELEMENTS_MAX];
    ply_property properties[PROPERTIES_MAX];
    int element_count, property_count;
    bool has_value, strips;
} ply;

/* ---- the header ---- */

static status read_word(ply *p, const char *what, char *word, size_t size) {
    status st = text_tokens_next(&p->t);
    if (st == ST_OK && (!p->t.token[0] || strlen(p->t.token) >= size))
        return text_tokens_fault(&p->t, "%s", what);
    if (st == ST_OK)
        strcpy(word, p->t.token);
    return st;
}

static status read_type(ply *p, ply_type *out) {
    char word[16] = "";
    status st = read_word(p, "a type of PLY", word, sizeof word);
    for (int i = 0; st == ST_OK && i < TYPES; i++)
        if (strcmp(word, types[i].old) == 0 || strcmp(word, types[i].now) == 0) {
            *out = (ply_type)i;
            return ST_OK;
        }
    return st == ST_OK ? text_tokens_fault(&p->t, "a type of PLY, such as float") : st;
}

static status read_format(ply *p) {
    char word[32];
    status st = read_word(p, "ascii or binary_..", word, sizeof word);
    if (st != ST_OK)
        return st;
    if (strcmp(word, "ascii") == 0)
        p->coding = TEXT;
    else if (strcmp(word, "binary_little_endian") == 0)
        p->coding = LITTLE;
    else if (strcmp(word, "binary_big_endian") == 0)
        p->coding = BIG;
    else
        return text_tokens_fault(&p->t, "ascii, binary_little_endian or binary_big_endian");
    st = text_tokens_next(&p->t);
    return st == ST_OK && strcmp(p->t.token, "1.0") != 0 ? text_tokens_fault(&p->t, "1.0") : st;
}

static status read_element(ply *p) {
    if (p->element_count == ELEMENTS_MAX)
        return text_tokens_fault(&p->t, "up to %d elements", ELEMENTS_MAX);
    ply_element *e = &p->elements[p->element_count++];
    e->first = p->property_count;
    status st = read_word(p, "the name of an element", e->name, sizeof e->name);
    if (st == ST_OK)
        st = text_tokens_int(&p->t, "the number of such elements", 0, (int64_t)1 << 40, &e->count);
    p->strips = p->strips || strcmp(e->name, "tristrips") == 0;
    return st;
}

static bool names_corners(const char *name) {
    return strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0;
}

/* Returns the use of a vertex's property. Unless a field is asked for, the field is the first
 * property that is no colour, normal or place in a picture. */
static ply_use use_of(ply *p, const char *name) {
    static const char *const others[] = {"nx",   "ny",        "nz",        "red",  "green",
                                         "blue", "alpha",     "u",         "v",    "s",
                                         "t",    "texture_u", "texture_v", "flags"};
    const plc_hints *hints = &p->s->hints;
    for (int a = 0; a < 3; a++)
        if (name[0] == "xyz"[a] && !name[1])
            return (ply_use)(AXIS_X + a);
    if (p->has_value)
        return SKIPPED;
    for (size_t i = 0; !hints->field && i < sizeof others / sizeof *others; i++)
        if (strcmp(name, others[i]) == 0)
            return SKIPPED;
    if (hints->field && strcmp(name, hints->field) != 0)
        return SKIPPED;
    p->has_value = true;
    snprintf(p->s->out->field, sizeof p->s->out->field, "%s", name);
    return VALUE;
}

static status read_property(ply *p) {
    ply_property q = {0};
    char name[64] = "";
    if (p->element_count == 0)
        return text_tokens_fault(&p->t, "an element before its properties");
    if (p->property_count == PROPERTIES_MAX)
        return text_tokens_fault(&p->t, "up to %d properties", PROPERTIES_MAX);
    ply_element *e = &p->elements[p->element_count - 1];
    bool more;
    const uint8_t *ahead = NULL;
    size_t size = 0;
    status st = text_tokens_more(&p->t, &more);
    if (st == ST_OK)
        st = byte_stream_peek(p->t.s, 5, &ahead, &size);
    q.list = st == ST_OK && size >= 5 && memcmp(ahead, "list", 4) == 0 && ahead[4] <= ' ';
    if (q.list)
        st = text_tokens_next(&p->t);
    if (st == ST_OK && q.list)
        st = read_type(p, &q.count_type);
    if (st == ST_OK)
        st = read_type(p, &q.type);
    if (st == ST_OK)
        st = read_word(p, "the name of a property", name, sizeof name);
    if (st == ST_OK && !q.list && strcmp(e->name, "vertex") == 0)
        q.use = use_of(p, name);
    if (st == ST_OK && q.list && strcmp(e->name, "face") == 0 && names_corners(name))
        q.use = CORNERS;
    p->properties[p->property_count++] = q;
    e->properties++;
    return st;
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

/* Check that x, y and z are there, and the field, and that faces have corners. */
static status check_header(const ply *p) {
    unsigned seen = 0;
    bool corners = true;
    for (int e = 0; e < p->element_count; e++) {
        const ply_element *x = &p->elements[e];
        bool found = strcmp(x->name, "face") != 0 || x->count == 0;
        for (int i = x->first; i < x->first + x->properties; i++) {
            const ply_use use = p->properties[i].use;
            seen |= 1u << use;
            found = found || use == CORNERS;
        }
        corners = corners && found;
    }
    const char *file = byte_stream_name(p->t.s);
    const unsigned axes = 1u << AXIS_X | 1u << AXIS_Y | 1u << AXIS_Z;
    if ((seen & axes) != axes)
        return status_describe(ST_CORRUPT, "%s: expected vertices with properties x, y and z",
                               file);
    if (p->strips)
        return status_describe(ST_UNSUPPORTED, "%s: strips of triangles, expected faces", file);
    if (!corners)
        return status_describe(ST_CORRUPT, "%s: faces without a list vertex_indices, expected one",
                               file);
    if (p->s->hints.field && !p->s->hints.optional && !p->has_value)
        return status_describe(ST_UNSUPPORTED, "%s: the vertices have no property \"%s\"", file,
                               p->s->hints.field);
    return ST_OK;
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
    return st == ST_OK ? check_header(p) : st;
}

/* ---- the elements ---- */

static double number_of(const uint8_t *at, ply_type type, bool big) {
    uint64_t bits = 0;
    const int size = types[type].size;
    for (int i = 0; i < size; i++)
        bits |= (uint64_t)at[big ? size - 1 - i : i] << (8 * i);
    float f;
    double d;
    const uint32_t low = (uint32_t)bits;
    switch (type) {
    case I8: return (int8_t)bits;
    case I16: return (int16_t)bits;
    case I32: return (int32_t)bits;
    case F32: memcpy(&f, &low, sizeof f); return (double)f;
    case F64: memcpy(&d, &bits, sizeof d); return d;
    default: return (double)low;
    }
}

static status read_number(ply *p, const ply_element *e, int64_t index, ply_type type, double *out) {
    const uint8_t *at;
    size_t size;
    if (p->coding == TEXT)
        return text_tokens_double(&p->t, "a number", out);
    status st = byte_stream_peek(p->t.s, (size_t)types[type].size, &at, &size);
    if (st == ST_OK && size < (size_t)types[type].size)
        return status_describe(
            ST_CORRUPT, "%s: ends at byte %llu, inside %s %lld (from 0)", byte_stream_name(p->t.s),
            (unsigned long long)(byte_stream_position(p->t.s) + size), e->name, (long long)index);
    if (st == ST_OK) {
        *out = number_of(at, type, p->coding == BIG);
        byte_stream_take(p->t.s, (size_t)types[type].size);
    }
    return st;
}

/* Read a list. Corners go to the polygon; other lists are skipped. */
static status read_list(ply *p, const ply_element *e, int64_t index, const ply_property *q) {
    double count = 0, number;
    status st = read_number(p, e, index, q->count_type, &count);
    if (st == ST_OK && !(count >= 0 && count <= LIST_MAX))
        return status_describe(
            ST_CORRUPT, "%s: %s %lld (counted from 0): a list of %g, expected 0 to %d",
            byte_stream_name(p->t.s), e->name, (long long)index, count, LIST_MAX);
    for (int64_t i = 0; st == ST_OK && i < (int64_t)count; i++) {
        st = read_number(p, e, index, q->type, &number);
        if (st == ST_OK && q->use == CORNERS)
            st = plc_add_corner(p->s->out,
                                number >= 0 && number < PLC_MAX ? (uint64_t)number : UINT64_MAX);
    }
    return st;
}

/* Read one element of any kind. */
static status read_one(ply *p, const ply_element *e, int64_t index, bool vertex, bool face) {
    double number = 0, xyz[3] = {0}, value = 0;
    plc *x = p->s->out;
    status st = face ? plc_add_facet(x, (uint64_t)index) : ST_OK;
    if (st == ST_OK && face)
        st = plc_add_polygon(x);
    for (int i = e->first; st == ST_OK && i < e->first + e->properties; i++) {
        const ply_property *q = &p->properties[i];
        st = q->list ? read_list(p, e, index, q) : read_number(p, e, index, q->type, &number);
        if (q->use >= AXIS_X && q->use <= AXIS_Z)
            xyz[q->use - AXIS_X] = number;
        else if (q->use == VALUE)
            value = number;
    }
    if (st == ST_OK && vertex)
        st = plc_add_point(p->s, xyz, p->coding == TEXT ? p->t.line : 0);
    if (st == ST_OK && vertex && p->has_value)
        st = plc_add(x, &x->values, &value, sizeof value);
    return st;
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

status plc_ply_read(plc_source *s) {
    ply *p = mem_zalloc(s->out->m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    p->s = s;
    p->t = (text_tokens){.s = s->data, .line = 1};
    status st = read_header(p);
    for (int e = 0; st == ST_OK && e < p->element_count; e++) {
        const ply_element *x = &p->elements[e];
        const bool vertex = strcmp(x->name, "vertex") == 0, face = strcmp(x->name, "face") == 0;
        for (int64_t i = 0; st == ST_OK && i < (x->properties ? x->count : 0); i++)
            st = read_one(p, x, i, vertex, face);
    }
    if (st == ST_OK)
        st = check_end(p);
    mem_free(s->out->m, p);
    return st;
}
