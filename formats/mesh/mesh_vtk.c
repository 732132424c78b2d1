#include "formats/mesh/mesh_vtk.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/foreign.h"
#include "formats/input/text_tokens.h"
#include "formats/mesh/vtk_cursor.h"
#include "formats/mesh/vtk_unstructured.h"

enum { WORDS_MAX = 8 };
#define COUNT_MAX ((int64_t)1 << 47) /* times components: no overflow */

/* The pass over the file that finds the arrays. */
typedef struct scan {
    vtk_unstructured *g;
    vtk_piece *p;
    byte_stream *s;
    bool text;
    int major; /* of the file's version */
    bool has_points, has_cells, has_types;
    bool in_data;    /* behind POINT_DATA or CELL_DATA */
    vtk_owner owner; /* of that data */
    uint64_t tuples; /* of that data */
    text_line line;
    uint64_t line_at; /* the byte where it starts */
    char *word[WORDS_MAX];
    int words;
} scan;

/* ---- lines ---- */

static status fault(const scan *s, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

static status fault(const scan *s, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: byte %llu: %s", byte_stream_name(s->s),
                           (unsigned long long)s->line_at, text);
}

static status raw_line(scan *s, bool *got) {
    s->line_at = byte_stream_position(s->s);
    return byte_stream_line(s->s, &s->line, got);
}

/* The next line that is not blank, split into words; none at the end of the file. */
static status next_line(scan *s) {
    for (s->words = 0; s->words == 0;) {
        bool got;
        status st = raw_line(s, &got);
        if (st != ST_OK || !got)
            return st;
        char *rest = NULL;
        for (char *w = strtok_r(s->line.text, " \t\r", &rest); w && s->words < WORDS_MAX;
             w = strtok_r(NULL, " \t\r", &rest))
            s->word[s->words++] = w;
    }
    return ST_OK;
}

static bool says(const scan *s, const char *keyword) {
    return s->words > 0 && strcasecmp(s->word[0], keyword) == 0;
}

static status need_words(const scan *s, int count, const char *form) {
    return s->words >= count ? ST_OK : fault(s, ST_CORRUPT, "expected \"%s\"", form);
}

static status parse_count(const scan *s, int word, uint64_t *out) {
    int64_t value = 0;
    if (num_int(s->word[word], "", 0, COUNT_MAX, &value) != ST_OK)
        return fault(s, ST_CORRUPT, "%s: \"%.40s\", expected a number of them", s->word[0],
                     s->word[word]);
    *out = (uint64_t)value;
    return ST_OK;
}

/* ---- types and arrays ---- */

static status parse_type(const scan *s, int word, vtk_type *out) {
    static const struct {
        const char *name;
        vtk_type type;
    } types[] = {
        {"bit", VTK_BIT},
        {"char", VTK_I8},
        {"signed_char", VTK_I8},
        {"unsigned_char", VTK_U8},
        {"short", VTK_I16},
        {"unsigned_short", VTK_U16},
        {"int", VTK_I32},
        {"unsigned_int", VTK_U32},
        {"long", VTK_I64},
        {"unsigned_long", VTK_U64},
        {"long_long", VTK_I64},
        {"unsigned_long_long", VTK_U64},
        {"vtkidtype", VTK_I32},
        {"vtktypeint8", VTK_I8},
        {"vtktypeuint8", VTK_U8},
        {"vtktypeint16", VTK_I16},
        {"vtktypeuint16", VTK_U16},
        {"vtktypeint32", VTK_I32},
        {"vtktypeuint32", VTK_U32},
        {"vtktypeint64", VTK_I64},
        {"vtktypeuint64", VTK_U64},
        {"float", VTK_F32},
        {"double", VTK_F64},
        {"string", VTK_STRING},
        {"utf8_string", VTK_STRING},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcasecmp(s->word[word], types[i].name) == 0) {
            *out = types[i].type;
            return ST_OK;
        }
    return fault(s, ST_UNSUPPORTED, "%s: arrays of \"%.40s\" are not supported", s->word[0],
                 s->word[word]);
}

/* An array that starts where the stream stands. */
static vtk_array array_here(const scan *s, vtk_type type, const char *role) {
    return (vtk_array){.path = s->g->source->path,
                       .role = role,
                       .type = type,
                       .coding = s->text ? VTK_TEXT : VTK_BARE,
                       .big_endian = true,
                       .components = 1,
                       .at = byte_stream_position(s->s)};
}

static status cut_short(const vtk_array *a, uint64_t got, uint64_t count) {
    return vtk_array_fault(a, ST_CORRUPT, "%llu numbers, expected %llu", (unsigned long long)got,
                           (unsigned long long)count);
}

/* The length of one string among bytes: its first two bits say how long the length is. */
static status skip_binary_string(scan *s, const vtk_array *a, uint64_t done, uint64_t count) {
    uint8_t head[8];
    size_t got;
    status st = byte_stream_read(s->s, head, 1, &got);
    if (st != ST_OK || got < 1)
        return st != ST_OK ? st : cut_short(a, done, count);
    size_t more = (size_t[]){7, 3, 1, 0}[head[0] >> 6];
    st = byte_stream_read(s->s, head + 1, more, &got);
    if (st != ST_OK || got < more)
        return st != ST_OK ? st : cut_short(a, done, count);
    uint64_t length = head[0] & 0x3f;
    for (size_t i = 1; i <= more; i++)
        length = length << 8 | head[i];
    return byte_stream_skip(s->s, length);
}

static status skip_strings(scan *s, const vtk_array *a, uint64_t count) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        bool got = true;
        st = s->text ? raw_line(s, &got) : skip_binary_string(s, a, i, count);
        if (st == ST_OK && !got)
            return cut_short(a, i, count);
    }
    return st;
}

/* Pass over an array that starts here. */
static status skip_numbers(scan *s, const vtk_array *a, uint64_t count) {
    if (a->type == VTK_STRING)
        return skip_strings(s, a, count);
    if (s->text) {
        uint64_t got;
        text_tokens text = {.s = s->s, .stop = '<'};
        status st = text_tokens_skip(&text, count, &got);
        return st == ST_OK && got < count ? cut_short(a, got, count) : st;
    }
    uint64_t width = vtk_array_width(a->type), left = byte_stream_left(s->s), size;
    if (a->type == VTK_BIT)
        size = (count + 7) / 8;
    else if (__builtin_mul_overflow(count, width, &size))
        size = UINT64_MAX;
    if (size > left)
        return cut_short(a, width ? left / width : 8 * left, count);
    return byte_stream_skip(s->s, size);
}

/* Names have %20 for a blank, and so on. */
static void decode_name(char *name) {
    char *to = name;
    for (const char *at = name; *at; to++) {
        char digits[3] = {at[0] == '%' ? at[1] : 0, at[0] == '%' && at[1] ? at[2] : 0, 0};
        bool coded = strspn(digits, "0123456789abcdefABCDEF") == 2;
        *to = coded ? (char)strtol(digits, NULL, 16) : *at;
        at += coded ? 3 : 1;
    }
    *to = 0;
}

/* An array of the points or cells whose numbers start here; its name is the line's word. */
static status add_array(scan *s, char *name, vtk_type type, uint64_t components, uint64_t tuples) {
    vtk_array a = array_here(s, type, "array");
    uint64_t count;
    if (components < 1 || components > UINT32_MAX)
        return fault(s, ST_CORRUPT, "array \"%.60s\": %llu components", name,
                     (unsigned long long)components);
    if (s->in_data && tuples != s->tuples)
        return fault(s, ST_CORRUPT, "array \"%.60s\": %llu tuples, expected %llu", name,
                     (unsigned long long)tuples, (unsigned long long)s->tuples);
    if (__builtin_mul_overflow(components, tuples, &count))
        return fault(s, ST_CORRUPT, "array \"%.60s\" is larger than any file", name);
    decode_name(name);
    a.components = (uint32_t)components;
    a.name = mem_copy_text(s->g->m, name);
    if (!a.name)
        return ST_NOMEM;
    if (!s->in_data) {
        status st = skip_numbers(s, &a, count);
        mem_free(s->g->m, a.name);
        return st;
    }
    status st = vtk_unstructured_add_field(s->g, s->p, s->owner, &a);
    return st == ST_OK ? skip_numbers(s, &a, count) : st;
}

/* ---- the geometry ---- */

static status once(const scan *s, bool *before) {
    if (*before)
        return fault(s, ST_CORRUPT, "%s comes twice", s->word[0]);
    *before = true;
    return ST_OK;
}

static status on_points(scan *s) {
    vtk_type type = VTK_ABSENT;
    status st = need_words(s, 3, "POINTS n type");
    if (st == ST_OK)
        st = once(s, &s->has_points);
    if (st == ST_OK)
        st = parse_count(s, 1, &s->p->points);
    if (st == ST_OK)
        st = parse_type(s, 2, &type);
    if (st != ST_OK)
        return st;
    s->p->position = array_here(s, type, "POINTS");
    s->p->position.components = 3;
    return skip_numbers(s, &s->p->position, 3 * s->p->points);
}

/* "OFFSETS type" or "CONNECTIVITY type" and count numbers. */
static status read_part(scan *s, const char *keyword, uint64_t count, vtk_array *out) {
    vtk_type type = VTK_ABSENT;
    status st = next_line(s);
    if (st == ST_OK && (!says(s, keyword) || s->words < 2))
        return fault(s, ST_CORRUPT, "expected \"%s type\"", keyword);
    if (st == ST_OK)
        st = parse_type(s, 1, &type);
    if (st != ST_OK)
        return st;
    *out = array_here(s, type, keyword);
    return skip_numbers(s, out, count);
}

static status on_cells(scan *s) {
    vtk_cells_source *c = &s->p->cells;
    uint64_t first = 0, second = 0;
    status st = need_words(s, 3, "CELLS n size");
    if (st == ST_OK)
        st = once(s, &s->has_cells);
    if (st == ST_OK)
        st = parse_count(s, 1, &first);
    if (st == ST_OK)
        st = parse_count(s, 2, &second);
    if (st != ST_OK)
        return st;
    c->ids_size = second;
    c->count = first;
    if (s->major < 5) {
        c->ids = array_here(s, VTK_I32, "CELLS");
        return skip_numbers(s, &c->ids, second);
    }
    c->from_zero = true;
    c->count = first ? first - 1 : 0;
    st = read_part(s, "OFFSETS", first, &c->offsets);
    return st == ST_OK ? read_part(s, "CONNECTIVITY", second, &c->ids) : st;
}

static status on_cell_types(scan *s) {
    uint64_t count = 0;
    status st = need_words(s, 2, "CELL_TYPES n");
    if (st == ST_OK)
        st = once(s, &s->has_types);
    if (st == ST_OK)
        st = parse_count(s, 1, &count);
    if (st == ST_OK && (!s->has_cells || count != s->p->cells.count))
        st = fault(s, ST_CORRUPT, "%llu cell types, expected those of %llu cells",
                   (unsigned long long)count, (unsigned long long)s->p->cells.count);
    if (st != ST_OK)
        return st;
    s->p->cells.types = array_here(s, VTK_I32, "CELL_TYPES");
    return skip_numbers(s, &s->p->cells.types, count);
}

/* ---- data ---- */

static status on_data(scan *s) {
    status st = need_words(s, 2, "POINT_DATA n");
    if (st == ST_OK)
        st = parse_count(s, 1, &s->tuples);
    if (st != ST_OK)
        return st;
    s->in_data = true;
    s->owner = says(s, "POINT_DATA") ? VTK_OF_POINTS : VTK_OF_CELLS;
    uint64_t there = s->owner == VTK_OF_POINTS ? s->p->points : s->p->cells.count;
    return s->tuples == there ? ST_OK
                              : fault(s, ST_CORRUPT, "%s of %llu, expected %llu", s->word[0],
                                      (unsigned long long)s->tuples, (unsigned long long)there);
}

static status need_data(const scan *s) {
    return s->in_data ? ST_OK
                      : fault(s, ST_CORRUPT, "%s without POINT_DATA or CELL_DATA in front of it",
                              s->word[0]);
}

/* "LOOKUP_TABLE name" between SCALARS and its numbers. */
static status pass_table_name(scan *s) {
    static const char keyword[] = "LOOKUP_TABLE";
    const uint8_t *data;
    size_t size, length = sizeof keyword - 1;
    bool got;
    status st = byte_stream_peek(s->s, length, &data, &size);
    if (st == ST_OK && size >= length && strncasecmp((const char *)data, keyword, length) == 0)
        st = byte_stream_line(s->s, &s->line, &got);
    return st;
}

static status on_scalars(scan *s) {
    vtk_type type = VTK_ABSENT;
    uint64_t components = 1;
    status st = need_words(s, 3, "SCALARS name type");
    if (st == ST_OK)
        st = need_data(s);
    if (st == ST_OK)
        st = parse_type(s, 2, &type);
    if (st == ST_OK && s->words > 3)
        st = parse_count(s, 3, &components);
    if (st != ST_OK)
        return st;
    char *name = mem_copy_text(s->g->m, s->word[1]);
    if (!name)
        return ST_NOMEM;
    st = pass_table_name(s);
    if (st == ST_OK)
        st = add_array(s, name, type, components, s->tuples);
    mem_free(s->g->m, name);
    return st;
}

/* VECTORS and others: a name, a type, as many components as the keyword says. */
static status on_attribute(scan *s) {
    static const struct {
        const char *keyword;
        uint64_t components;
    } known[] = {
        {"VECTORS", 3},    {"NORMALS", 3},      {"TENSORS", 9},    {"TENSORS6", 6},
        {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1},
    };
    uint64_t components = 1;
    vtk_type type = VTK_ABSENT;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (says(s, known[i].keyword))
            components = known[i].components;
    status st = need_words(s, 3, "VECTORS name type");
    if (st == ST_OK)
        st = need_data(s);
    if (st == ST_OK)
        st = parse_type(s, 2, &type);
    return st == ST_OK ? add_array(s, s->word[1], type, components, s->tuples) : st;
}

static status on_texture(scan *s) {
    vtk_type type = VTK_ABSENT;
    uint64_t components = 0;
    status st = need_words(s, 4, "TEXTURE_COORDINATES name n type");
    if (st == ST_OK)
        st = need_data(s);
    if (st == ST_OK)
        st = parse_count(s, 2, &components);
    if (st == ST_OK)
        st = parse_type(s, 3, &type);
    return st == ST_OK ? add_array(s, s->word[1], type, components, s->tuples) : st;
}

static status on_colours(scan *s) {
    uint64_t components = 0;
    status st = need_words(s, 3, "COLOR_SCALARS name n");
    if (st == ST_OK)
        st = need_data(s);
    if (st == ST_OK)
        st = parse_count(s, 2, &components);
    vtk_type type = s->text ? VTK_F32 : VTK_U8;
    return st == ST_OK ? add_array(s, s->word[1], type, components, s->tuples) : st;
}

static status on_table(scan *s) {
    uint64_t count = 0;
    status st = need_words(s, 3, "LOOKUP_TABLE name size");
    if (st == ST_OK)
        st = parse_count(s, 2, &count);
    vtk_array a = array_here(s, VTK_U8, "LOOKUP_TABLE");
    return st == ST_OK ? skip_numbers(s, &a, 4 * count) : st;
}

/* Lines up to a blank one. */
static status on_metadata(scan *s) {
    for (bool more = true; more;) {
        bool got;
        status st = raw_line(s, &got);
        if (st != ST_OK)
            return st;
        more = got && s->line.length > 0;
    }
    return ST_OK;
}

/* "FIELD name n", then n times "name components tuples type" and the numbers. */
static status on_field(scan *s) {
    uint64_t arrays = 0;
    status st = need_words(s, 3, "FIELD name n");
    if (st == ST_OK)
        st = parse_count(s, 2, &arrays);
    while (st == ST_OK && arrays > 0) {
        uint64_t components = 0, tuples = 0;
        vtk_type type = VTK_ABSENT;
        st = next_line(s);
        if (st == ST_OK && says(s, "METADATA")) {
            st = on_metadata(s);
            continue;
        }
        if (st == ST_OK)
            st = need_words(s, 4, "name components tuples type");
        if (st == ST_OK)
            st = parse_count(s, 1, &components);
        if (st == ST_OK)
            st = parse_count(s, 2, &tuples);
        if (st == ST_OK)
            st = parse_type(s, 3, &type);
        if (st == ST_OK)
            st = add_array(s, s->word[0], type, components, tuples);
        arrays--;
    }
    return st;
}

/* ---- the file ---- */

static const struct {
    const char *keyword;
    status (*handle)(scan *s);
} keywords[] = {
    {"POINTS", on_points},
    {"CELLS", on_cells},
    {"CELL_TYPES", on_cell_types},
    {"POINT_DATA", on_data},
    {"CELL_DATA", on_data},
    {"FIELD", on_field},
    {"SCALARS", on_scalars},
    {"VECTORS", on_attribute},
    {"NORMALS", on_attribute},
    {"TENSORS", on_attribute},
    {"TENSORS6", on_attribute},
    {"GLOBAL_IDS", on_attribute},
    {"PEDIGREE_IDS", on_attribute},
    {"EDGE_FLAGS", on_attribute},
    {"TEXTURE_COORDINATES", on_texture},
    {"COLOR_SCALARS", on_colours},
    {"LOOKUP_TABLE", on_table},
    {"METADATA", on_metadata},
};

static status scan_sections(scan *s) {
    for (;;) {
        status st = next_line(s);
        if (st != ST_OK || s->words == 0)
            return st;
        size_t k = 0, count = sizeof keywords / sizeof *keywords;
        while (k < count && !says(s, keywords[k].keyword))
            k++;
        if (k == count)
            return fault(s, ST_CORRUPT, "\"%.40s\", expected a keyword of the format, as POINTS",
                         s->word[0]);
        st = keywords[k].handle(s);
        if (st != ST_OK)
            return st;
    }
}

/* Four lines: version, title, ASCII or BINARY, DATASET. */
static status scan_header(scan *s) {
    static const char magic[] = "# vtk DataFile Version ";
    bool got;
    int minor;
    status st = raw_line(s, &got);
    if (st != ST_OK)
        return st;
    const char *line = got ? s->line.text : "";
    if (strncasecmp(line, magic, sizeof magic - 1) != 0 ||
        sscanf(line + sizeof magic - 1, "%d.%d", &s->major, &minor) != 2)
        return fault(s, ST_CORRUPT, "expected \"%sx.y\"", magic);
    if (s->major < 1 || s->major > 5)
        return fault(s, ST_UNSUPPORTED, "version %d; 1.0 to 5.1 are supported", s->major);
    st = raw_line(s, &got);
    if (st == ST_OK)
        st = next_line(s);
    if (st != ST_OK)
        return st;
    s->text = says(s, "ASCII");
    if (!s->text && !says(s, "BINARY"))
        return fault(s, ST_CORRUPT, "expected ASCII or BINARY");
    st = next_line(s);
    if (st == ST_OK && (!says(s, "DATASET") || s->words < 2))
        return fault(s, ST_CORRUPT, "expected \"DATASET UNSTRUCTURED_GRID\"");
    if (st == ST_OK && strcasecmp(s->word[1], "UNSTRUCTURED_GRID") != 0)
        return fault(s, ST_UNSUPPORTED, "DATASET %.40s; UNSTRUCTURED_GRID is supported",
                     s->word[1]);
    return st;
}

static status check_parts(const scan *s) {
    if (!s->has_points || (s->p->cells.count > 0 && !s->has_types))
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu without %s",
                               byte_stream_name(s->s),
                               (unsigned long long)byte_stream_position(s->s),
                               s->has_points ? "CELL_TYPES" : "POINTS");
    return ST_OK;
}

static status scan_file(vtk_unstructured *g, byte_stream *data) {
    scan s = {.g = g, .s = data, .line = {.m = g->m}};
    status st = vtk_unstructured_add_piece(g, &s.p);
    if (st == ST_OK)
        st = scan_header(&s);
    if (st == ST_OK)
        st = scan_sections(&s);
    if (st == ST_OK)
        st = check_parts(&s);
    byte_stream_line_release(&s.line);
    return st;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    static const char magic[] = "# vtk DataFile";
    bool starts =
        size >= sizeof magic - 1 && strncasecmp((const char *)start, magic, sizeof magic - 1) == 0;
    return (starts || text_ends_in(path, ".vtk")) && !foreign_is_other_vtk(start, size);
}

static status open_file(mesh_source *source, void **state) {
    return vtk_unstructured_open(source, scan_file, state);
}

const mesh_reader mesh_vtk_reader = {
    .format = "VTK",
    .known = known,
    .open = open_file,
    .read = vtk_unstructured_read,
    .close = vtk_unstructured_close,
    .fields = vtk_unstructured_fields,
};
