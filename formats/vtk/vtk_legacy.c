#include "formats/vtk/vtk_legacy.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "formats/base/num.h"
#include "formats/input/text_tokens.h"

#define COUNT_MAX ((int64_t)1 << 47) /* times components: no overflow */
static const char magic[] = "# vtk DataFile Version ";

/* ---- lines ---- */

status vtk_legacy_fault(const vtk_legacy *v, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: byte %llu: %s", byte_stream_name(v->s),
                           (unsigned long long)v->line_at, text);
}

static status raw_line(vtk_legacy *v, bool *got) {
    v->line_at = byte_stream_position(v->s);
    return byte_stream_line(v->s, &v->line, got);
}

status vtk_legacy_next_line(vtk_legacy *v) {
    for (v->words = 0; v->words == 0;) {
        bool got;
        status st = raw_line(v, &got);
        if (st != ST_OK || !got)
            return st;
        char *rest = NULL;
        for (char *w = strtok_r(v->line.text, " \t\r", &rest); w && v->words < VTK_LEGACY_WORDS;
             w = strtok_r(NULL, " \t\r", &rest))
            v->word[v->words++] = w;
    }
    return ST_OK;
}

bool vtk_legacy_says(const vtk_legacy *v, const char *keyword) {
    return v->words > 0 && strcasecmp(v->word[0], keyword) == 0;
}

status vtk_legacy_need_words(const vtk_legacy *v, int count, const char *form) {
    return v->words >= count ? ST_OK : vtk_legacy_fault(v, ST_CORRUPT, "expected \"%s\"", form);
}

status vtk_legacy_count(const vtk_legacy *v, int word, uint64_t *out) {
    int64_t value = 0;
    if (num_int(v->word[word], "", 0, COUNT_MAX, &value) != ST_OK)
        return vtk_legacy_fault(v, ST_CORRUPT, "%s: \"%.40s\", expected a number of them",
                                v->word[0], v->word[word]);
    *out = (uint64_t)value;
    return ST_OK;
}

/* ---- types and arrays ---- */

status vtk_legacy_type(const vtk_legacy *v, int word, vtk_type *out) {
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
        if (strcasecmp(v->word[word], types[i].name) == 0) {
            *out = types[i].type;
            return ST_OK;
        }
    return vtk_legacy_fault(v, ST_UNSUPPORTED, "%s: arrays of \"%.40s\" are not supported",
                            v->word[0], v->word[word]);
}

/* An array that starts where the stream stands. */
static vtk_array array_here(const vtk_legacy *v, vtk_type type, const char *role) {
    return (vtk_array){.path = v->path,
                       .role = role,
                       .type = type,
                       .coding = v->text ? VTK_TEXT : VTK_BARE,
                       .big_endian = true,
                       .components = 1,
                       .at = byte_stream_position(v->s)};
}

static status cut_short(const vtk_array *a, uint64_t got, uint64_t count) {
    return vtk_array_fault(a, ST_CORRUPT, "%llu numbers, expected %llu", (unsigned long long)got,
                           (unsigned long long)count);
}

/* Skip one string in binary data. The first two bits of its length say how many bytes the length
 * has. */
static status skip_binary_string(vtk_legacy *v, const vtk_array *a, uint64_t done, uint64_t count) {
    uint8_t head[8];
    size_t got;
    status st = byte_stream_read(v->s, head, 1, &got);
    if (st != ST_OK || got < 1)
        return st != ST_OK ? st : cut_short(a, done, count);
    size_t more = (size_t[]){7, 3, 1, 0}[head[0] >> 6];
    st = byte_stream_read(v->s, head + 1, more, &got);
    if (st != ST_OK || got < more)
        return st != ST_OK ? st : cut_short(a, done, count);
    uint64_t length = head[0] & 0x3f;
    for (size_t i = 1; i <= more; i++)
        length = length << 8 | head[i];
    return byte_stream_skip(v->s, length);
}

static status skip_strings(vtk_legacy *v, const vtk_array *a, uint64_t count) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        bool got = true;
        st = v->text ? raw_line(v, &got) : skip_binary_string(v, a, i, count);
        if (st == ST_OK && !got)
            return cut_short(a, i, count);
    }
    return st;
}

/* Skip an array that starts here. */
static status skip_numbers(vtk_legacy *v, const vtk_array *a, uint64_t count) {
    if (a->type == VTK_STRING)
        return skip_strings(v, a, count);
    if (v->text) {
        uint64_t got;
        text_tokens text = {.s = v->s, .stop = '<'};
        status st = text_tokens_skip(&text, count, &got);
        return st == ST_OK && got < count ? cut_short(a, got, count) : st;
    }
    uint64_t width = vtk_array_width(a->type), left = byte_stream_left(v->s), size;
    if (a->type == VTK_BIT)
        size = (count + 7) / 8;
    else if (__builtin_mul_overflow(count, width, &size))
        size = UINT64_MAX;
    if (size > left)
        return cut_short(a, width ? left / width : 8 * left, count);
    return byte_stream_skip(v->s, size);
}

/* Decode a name: %20 stands for a blank, and so on. */
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

/* Add an array of the points or cells whose numbers start here. Its name is a word of the line. */
static status add_array(vtk_legacy *v, char *name, vtk_type type, uint64_t components,
                        uint64_t tuples) {
    vtk_array a = array_here(v, type, "array");
    uint64_t count;
    a.normal = vtk_legacy_says(v, "NORMALS");
    if (components < 1 || components > UINT32_MAX)
        return vtk_legacy_fault(v, ST_CORRUPT, "array \"%.60s\": %llu components", name,
                                (unsigned long long)components);
    if (v->in_data && tuples != v->tuples)
        return vtk_legacy_fault(v, ST_CORRUPT, "array \"%.60s\": %llu tuples, expected %llu", name,
                                (unsigned long long)tuples, (unsigned long long)v->tuples);
    if (__builtin_mul_overflow(components, tuples, &count))
        return vtk_legacy_fault(v, ST_CORRUPT, "array \"%.60s\" is larger than any file", name);
    decode_name(name);
    char *kept = mem_copy_text(v->m, name); /* strings that follow overwrite its line */
    if (!kept)
        return ST_NOMEM;
    a.components = (uint32_t)components;
    a.name = kept;
    status st = v->in_data ? vtk_fields_add(v->fields, v->m, v->owner, kept, &a) : ST_OK;
    if (st == ST_OK)
        st = skip_numbers(v, &a, count);
    mem_free(v->m, kept);
    return st;
}

status vtk_legacy_array(vtk_legacy *v, vtk_type type, const char *role, uint64_t count,
                        vtk_array *out) {
    *out = array_here(v, type, role);
    return skip_numbers(v, out, count);
}

status vtk_legacy_once(const vtk_legacy *v, bool *before) {
    if (*before)
        return vtk_legacy_fault(v, ST_CORRUPT, "%s comes twice", v->word[0]);
    *before = true;
    return ST_OK;
}

/* ---- points and lists of them ---- */

status vtk_legacy_points(vtk_legacy *v, bool *before, uint64_t *points, vtk_array *out) {
    vtk_type type = VTK_ABSENT;
    status st = vtk_legacy_need_words(v, 3, "POINTS n type");
    if (st == ST_OK)
        st = vtk_legacy_once(v, before);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, points);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    if (st != ST_OK)
        return st;
    v->tuples_there[VTK_OF_POINTS] = *points;
    st = vtk_legacy_array(v, type, "POINTS", 3 * *points, out);
    out->components = 3;
    return st;
}

/* Read "OFFSETS type" or "CONNECTIVITY type" and count numbers. */
static status read_part(vtk_legacy *v, const char *keyword, uint64_t count, vtk_array *out) {
    vtk_type type = VTK_ABSENT;
    status st = vtk_legacy_next_line(v);
    if (st == ST_OK && (!vtk_legacy_says(v, keyword) || v->words < 2))
        return vtk_legacy_fault(v, ST_CORRUPT, "expected \"%s type\"", keyword);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 1, &type);
    return st == ST_OK ? vtk_legacy_array(v, type, keyword, count, out) : st;
}

status vtk_legacy_lists(vtk_legacy *v, const char *keyword, bool *before, vtk_lists *out) {
    uint64_t first = 0, second = 0;
    char form[64];
    snprintf(form, sizeof form, "%s n size", keyword);
    status st = vtk_legacy_need_words(v, 3, form);
    if (st == ST_OK)
        st = vtk_legacy_once(v, before);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &first);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &second);
    if (st != ST_OK)
        return st;
    out->ids_size = second;
    out->from_zero = v->major >= 5;
    out->count = out->from_zero && first ? first - 1 : first;
    v->tuples_there[VTK_OF_CELLS] += out->count;
    if (!out->from_zero)
        return vtk_legacy_array(v, VTK_I32, keyword, second, &out->ids);
    st = read_part(v, "OFFSETS", first, &out->offsets);
    return st == ST_OK ? read_part(v, "CONNECTIVITY", second, &out->ids) : st;
}

/* ---- data ---- */

static status on_data(vtk_legacy *v) {
    status st = vtk_legacy_need_words(v, 2, "POINT_DATA n");
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &v->tuples);
    if (st != ST_OK)
        return st;
    v->in_data = true;
    v->owner = vtk_legacy_says(v, "POINT_DATA") ? VTK_OF_POINTS : VTK_OF_CELLS;
    uint64_t there = v->tuples_there[v->owner];
    return v->tuples == there
               ? ST_OK
               : vtk_legacy_fault(v, ST_CORRUPT, "%s of %llu, expected %llu", v->word[0],
                                  (unsigned long long)v->tuples, (unsigned long long)there);
}

static status need_data(const vtk_legacy *v) {
    return v->in_data
               ? ST_OK
               : vtk_legacy_fault(v, ST_CORRUPT,
                                  "%s without POINT_DATA or CELL_DATA in front of it", v->word[0]);
}

/* Skip "LOOKUP_TABLE name" between SCALARS and its numbers. */
static status pass_table_name(vtk_legacy *v) {
    static const char keyword[] = "LOOKUP_TABLE";
    const uint8_t *data;
    size_t size, length = sizeof keyword - 1;
    bool got;
    status st = byte_stream_peek(v->s, length, &data, &size);
    if (st == ST_OK && size >= length && strncasecmp((const char *)data, keyword, length) == 0)
        st = byte_stream_line(v->s, &v->line, &got);
    return st;
}

static status on_scalars(vtk_legacy *v) {
    vtk_type type = VTK_ABSENT;
    uint64_t components = 1;
    status st = vtk_legacy_need_words(v, 3, "SCALARS name type");
    if (st == ST_OK)
        st = need_data(v);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    if (st == ST_OK && v->words > 3)
        st = vtk_legacy_count(v, 3, &components);
    if (st != ST_OK)
        return st;
    char *name = mem_copy_text(v->m, v->word[1]);
    if (!name)
        return ST_NOMEM;
    st = pass_table_name(v);
    if (st == ST_OK)
        st = add_array(v, name, type, components, v->tuples);
    mem_free(v->m, name);
    return st;
}

/* Read VECTORS and others: a name, a type; the keyword sets the number of components. */
static status on_attribute(vtk_legacy *v) {
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
        if (vtk_legacy_says(v, known[i].keyword))
            components = known[i].components;
    status st = vtk_legacy_need_words(v, 3, "VECTORS name type");
    if (st == ST_OK)
        st = need_data(v);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    return st == ST_OK ? add_array(v, v->word[1], type, components, v->tuples) : st;
}

static status on_texture(vtk_legacy *v) {
    vtk_type type = VTK_ABSENT;
    uint64_t components = 0;
    status st = vtk_legacy_need_words(v, 4, "TEXTURE_COORDINATES name n type");
    if (st == ST_OK)
        st = need_data(v);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &components);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 3, &type);
    return st == ST_OK ? add_array(v, v->word[1], type, components, v->tuples) : st;
}

static status on_colours(vtk_legacy *v) {
    uint64_t components = 0;
    status st = vtk_legacy_need_words(v, 3, "COLOR_SCALARS name n");
    if (st == ST_OK)
        st = need_data(v);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &components);
    vtk_type type = v->text ? VTK_F32 : VTK_U8;
    if (st == ST_OK)
        st = add_array(v, v->word[1], type, components, v->tuples);
    if (st == ST_OK)
        v->fields->items[v->owner][v->fields->count[v->owner] - 1].colour = true;
    return st;
}

static status on_table(vtk_legacy *v) {
    uint64_t count = 0;
    status st = vtk_legacy_need_words(v, 3, "LOOKUP_TABLE name size");
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &count);
    vtk_array a = array_here(v, VTK_U8, "LOOKUP_TABLE");
    return st == ST_OK ? skip_numbers(v, &a, 4 * count) : st;
}

/* Skip lines up to a blank one. */
static status on_metadata(vtk_legacy *v) {
    for (bool more = true; more;) {
        bool got;
        status st = raw_line(v, &got);
        if (st != ST_OK)
            return st;
        more = got && v->line.length > 0;
    }
    return ST_OK;
}

/* Read "FIELD name n", then n times "name components tuples type" and the numbers. */
static status on_field(vtk_legacy *v) {
    uint64_t arrays = 0;
    status st = vtk_legacy_need_words(v, 3, "FIELD name n");
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &arrays);
    while (st == ST_OK && arrays > 0) {
        uint64_t components = 0, tuples = 0;
        vtk_type type = VTK_ABSENT;
        st = vtk_legacy_next_line(v);
        if (st == ST_OK && vtk_legacy_says(v, "METADATA")) {
            st = on_metadata(v);
            continue;
        }
        if (st == ST_OK)
            st = vtk_legacy_need_words(v, 4, "name components tuples type");
        if (st == ST_OK)
            st = vtk_legacy_count(v, 1, &components);
        if (st == ST_OK)
            st = vtk_legacy_count(v, 2, &tuples);
        if (st == ST_OK)
            st = vtk_legacy_type(v, 3, &type);
        if (st == ST_OK)
            st = add_array(v, v->word[0], type, components, tuples);
        arrays--;
    }
    return st;
}

/* ---- the file ---- */

static const vtk_legacy_keyword keywords[] = {
    {"POINT_DATA", on_data},       {"CELL_DATA", on_data},
    {"FIELD", on_field},           {"SCALARS", on_scalars},
    {"VECTORS", on_attribute},     {"NORMALS", on_attribute},
    {"TENSORS", on_attribute},     {"TENSORS6", on_attribute},
    {"GLOBAL_IDS", on_attribute},  {"PEDIGREE_IDS", on_attribute},
    {"EDGE_FLAGS", on_attribute},  {"TEXTURE_COORDINATES", on_texture},
    {"COLOR_SCALARS", on_colours}, {"LOOKUP_TABLE", on_table},
    {"METADATA", on_metadata},     {NULL, NULL},
};

/* Find the row of the line's first word; a row of NULLs when there is none. */
static const vtk_legacy_keyword *find_keyword(const vtk_legacy *v,
                                              const vtk_legacy_keyword *table) {
    while (table->keyword && !vtk_legacy_says(v, table->keyword))
        table++;
    return table;
}

static status scan_sections(vtk_legacy *v) {
    for (;;) {
        status st = vtk_legacy_next_line(v);
        if (st != ST_OK || v->words == 0)
            return st;
        const vtk_legacy_keyword *k = find_keyword(v, keywords);
        if (!k->keyword)
            k = find_keyword(v, v->dataset->keywords);
        if (!k->keyword)
            return vtk_legacy_fault(v, ST_CORRUPT,
                                    "\"%.40s\", expected a keyword of the format, as %s",
                                    v->word[0], v->dataset->keywords->keyword);
        st = k->handle(v);
        if (st != ST_OK)
            return st;
    }
}

/* Read "DATASET name" and find the data set. */
static status find_dataset(vtk_legacy *v, const vtk_legacy_dataset *sets) {
    if (!vtk_legacy_says(v, "DATASET") || v->words < 2)
        return vtk_legacy_fault(v, ST_CORRUPT, "expected \"DATASET %s\"", sets->name);
    for (v->dataset = sets; v->dataset->name; v->dataset++)
        if (strcasecmp(v->word[1], v->dataset->name) == 0)
            return ST_OK;
    return vtk_legacy_fault(v, ST_UNSUPPORTED, "DATASET %.40s; %s is supported", v->word[1],
                            sets->name);
}

/* Read four lines: version, title, ASCII or BINARY, DATASET. */
static status scan_header(vtk_legacy *v, const vtk_legacy_dataset *sets) {
    bool got;
    int minor;
    status st = raw_line(v, &got);
    if (st != ST_OK)
        return st;
    const char *line = got ? v->line.text : "";
    if (strncasecmp(line, magic, sizeof magic - 1) != 0 ||
        sscanf(line + sizeof magic - 1, "%d.%d", &v->major, &minor) != 2)
        return vtk_legacy_fault(v, ST_CORRUPT, "expected \"%sx.y\"", magic);
    if (v->major < 1 || v->major > 5)
        return vtk_legacy_fault(v, ST_UNSUPPORTED, "version %d; 1.0 to 5.1 are supported",
                                v->major);
    st = raw_line(v, &got);
    if (st == ST_OK)
        st = vtk_legacy_next_line(v);
    if (st != ST_OK)
        return st;
    v->text = vtk_legacy_says(v, "ASCII");
    if (!v->text && !vtk_legacy_says(v, "BINARY"))
        return vtk_legacy_fault(v, ST_CORRUPT, "expected ASCII or BINARY");
    st = vtk_legacy_next_line(v);
    return st == ST_OK ? find_dataset(v, sets) : st;
}

status vtk_legacy_scan(vtk_legacy *v, const vtk_legacy_dataset *sets) {
    v->line.m = v->m;
    status st = scan_header(v, sets);
    if (st == ST_OK)
        st = scan_sections(v);
    byte_stream_line_release(&v->line);
    return st;
}

/* ---- recognising ---- */

bool vtk_legacy_known(const uint8_t *start, size_t size) {
    static const char begin[] = "# vtk DataFile";
    return size >= sizeof begin - 1 &&
           strncasecmp((const char *)start, begin, sizeof begin - 1) == 0;
}

/* Returns the place behind the next line feed; the end when there is none. */
static const char *next_line(const char *at, const char *end) {
    const char *feed = memchr(at, '\n', (size_t)(end - at));
    return feed ? feed + 1 : end;
}

/* Read, behind version and title: ASCII or BINARY, DATASET, its name. */
bool vtk_legacy_names(const uint8_t *start, size_t size, char name[VTK_LEGACY_NAME_MAX]) {
    const char *at = (const char *)start, *end = at + size;
    bool is_dataset = false;
    *name = 0;
    if (!vtk_legacy_known(start, size))
        return false;
    at = next_line(next_line(at, end), end);
    for (int i = 0; i < 3; i++) {
        size_t length = 0;
        while (at < end && strchr(" \t\r\n", *at))
            at++;
        for (; at < end && !strchr(" \t\r\n", *at); at++)
            if (length + 1 < VTK_LEGACY_NAME_MAX)
                name[length++] = *at;
        name[length] = 0;
        is_dataset = i == 1 ? strcasecmp(name, "DATASET") == 0 : is_dataset;
    }
    return is_dataset && *name;
}
