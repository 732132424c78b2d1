#include "formats/mesh/gmsh_file.h"

#include <byteswap.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { TAGS_MAX = 1000, END_MAX = 100 };

/* ---- numbers ---- */

status gmsh_cursor_fault(const gmsh_cursor *c, status st, const char *fmt, ...) {
    char text[400];
    va_list list;
    va_start(list, fmt);
    vsnprintf(text, sizeof text, fmt, list);
    va_end(list);
    bool binary = c->f->binary;
    return status_describe(st, "%s: %s %llu: %s", c->f->path, binary ? "before byte" : "line",
                           (unsigned long long)(binary ? byte_stream_position(c->t.s) : c->t.line),
                           text);
}

static status read_bytes(gmsh_cursor *c, const char *what, void *out, size_t size) {
    size_t got;
    status st = byte_stream_read(c->t.s, out, size, &got);
    if (st == ST_OK && got < size)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu, expected %s", c->f->path,
                               (unsigned long long)byte_stream_position(c->t.s), what);
    return st;
}

static status text_number(gmsh_cursor *c, const char *what, uint64_t *out) {
    int64_t value = 0;
    status st = text_tokens_int(&c->t, what, INT64_MIN, INT64_MAX, &value);
    *out = (uint64_t)value;
    return st;
}

status gmsh_cursor_int(gmsh_cursor *c, const char *what, uint64_t *out) {
    if (!c->f->binary)
        return text_number(c, what, out);
    uint32_t raw = 0;
    status st = read_bytes(c, what, &raw, 4);
    if (c->f->foreign)
        raw = bswap_32(raw);
    *out = (uint64_t)(int64_t)(int32_t)raw;
    return st;
}

status gmsh_cursor_size(gmsh_cursor *c, const char *what, uint64_t *out) {
    if (!c->f->binary || c->f->size_width == 4)
        return gmsh_cursor_int(c, what, out);
    status st = read_bytes(c, what, out, 8);
    if (c->f->foreign)
        *out = bswap_64(*out);
    return st;
}

status gmsh_cursor_double(gmsh_cursor *c, const char *what, double *out) {
    if (!c->f->binary)
        return text_tokens_double(&c->t, what, out);
    uint64_t raw = 0;
    status st = read_bytes(c, what, &raw, 8);
    if (c->f->foreign)
        raw = bswap_64(raw);
    memcpy(out, &raw, 8);
    return st;
}

status gmsh_cursor_line(gmsh_cursor *c, const char *what, uint64_t *out) {
    status st = text_number(c, what, out);
    return st == ST_OK ? text_tokens_end_line(&c->t) : st;
}

status gmsh_cursor_end(gmsh_cursor *c, const char *end) {
    status st = text_tokens_next(&c->t);
    if (st == ST_OK && strcmp(c->t.token, end) != 0)
        return gmsh_cursor_fault(c, ST_CORRUPT, "expected %s behind as many as were announced",
                                 end);
    return st;
}

status gmsh_cursor_open(const gmsh_file *f, const gmsh_section *section, gmsh_cursor *c) {
    *c = (gmsh_cursor){.f = f, .t.line = section->line};
    status st = byte_stream_open(f->m, f->path, &c->t.s);
    return st == ST_OK ? byte_stream_skip(c->t.s, section->at) : st;
}

void gmsh_cursor_close(gmsh_cursor *c) {
    byte_stream_close(c->t.s);
}

/* ---- the scan ---- */

static gmsh_section here(const text_tokens *t) {
    return (gmsh_section){byte_stream_position(t->s), t->line};
}

static size_t line_feeds(const uint8_t *data, size_t size) {
    size_t count = 0;
    for (size_t i = 0; i < size; i++)
        count += data[i] == '\n';
    return count;
}

/* Skip to the line behind a section's end. The section began on line `from`. */
static status skip_to_end(text_tokens *t, const char *name, uint64_t from) {
    char end[END_MAX];
    int length = snprintf(end, sizeof end, "$End%s", name + 1);
    for (bool found = false; !found;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(t->s, BYTE_STREAM_BUFFER, &data, &size);
        if (st != ST_OK)
            return st;
        const uint8_t *at = memmem(data, size, end, (size_t)length);
        if (!at && size < BYTE_STREAM_BUFFER)
            return status_describe(ST_CORRUPT, "%s: ends in the section of line %llu, expected %s",
                                   byte_stream_name(t->s), (unsigned long long)from, end);
        found = at != NULL;
        size_t passed = found ? (size_t)(at - data) + (size_t)length : size - (size_t)length;
        t->line += line_feeds(data, passed);
        byte_stream_take(t->s, passed);
    }
    return text_tokens_end_line(t);
}

/* Read "4.1 0 8", and in binary files the number 1, which tells the byte order. */
static status read_format(gmsh_file *f, text_tokens *t) {
    static const char *const known[] = {"2", "2.0", "2.1", "2.2", "4.1"};
    int64_t binary = 0, width = 0;
    uint64_t one = 1;
    status st = text_tokens_next(t);
    for (int i = 0; st == ST_OK && i < 5; i++)
        if (strcmp(t->token, known[i]) == 0)
            f->version = i < 4 ? 2 : 4;
    if (st == ST_OK && f->version == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: a Gmsh file of version \"%.20s\", expected 2.2 or 4.1",
                               byte_stream_name(t->s), t->token);
    if (st == ST_OK)
        st = text_tokens_int(t, "0 (text) or 1 (binary)", 0, 1, &binary);
    if (st == ST_OK)
        st = text_tokens_int(t, "4 or 8, the bytes of a size", 4, 8, &width);
    if (st == ST_OK)
        st = text_tokens_end_line(t);
    f->binary = binary == 1;
    f->size_width = width == 4 ? 4 : 8;
    gmsh_cursor c = {.f = f, .t = *t};
    if (st == ST_OK && f->binary)
        st = gmsh_cursor_int(&c, "the number 1", &one);
    f->foreign = one == 0x1000000;
    if (st == ST_OK && one != 1 && !f->foreign)
        return gmsh_cursor_fault(&c, ST_CORRUPT, "expected the number 1 in either byte order");
    return st;
}

/* Read the string tags. The first is the array's name, in quotes. */
static status read_name(text_tokens *t, char name[MESH_NAME_MAX + 1]) {
    int64_t tags;
    status st = text_tokens_int(t, "the number of string tags", 0, TAGS_MAX, &tags);
    if (st == ST_OK)
        st = text_tokens_end_line(t);
    for (int64_t i = 0; st == ST_OK && i < tags; i++) {
        char text[1000];
        st = text_tokens_rest(t, text, sizeof text);
        size_t length = st == ST_OK ? strlen(text) : 0;
        bool quoted = length > 1 && text[0] == '"' && text[length - 1] == '"';
        if (st == ST_OK && i == 0)
            snprintf(name, MESH_NAME_MAX + 1, "%.*s",
                     (int)(quoted ? length - 2 < MESH_NAME_MAX ? length - 2 : MESH_NAME_MAX
                                  : MESH_NAME_MAX),
                     text + quoted);
    }
    return st;
}

/* Read the real tags; the first is the time. */
static status read_time(text_tokens *t, double *time) {
    int64_t tags;
    double value;
    *time = NAN;
    status st = text_tokens_int(t, "the number of real tags", 0, TAGS_MAX, &tags);
    for (int64_t i = 0; st == ST_OK && i < tags; i++) {
        st = text_tokens_double(t, "a real tag", &value);
        if (i == 0)
            *time = value;
    }
    return st;
}

/* Read the integer tags: time step, components, rows, and others. */
static status read_shape(text_tokens *t, gmsh_array *a) {
    int64_t tags, value = 0;
    status st = text_tokens_int(t, "the number of integer tags, at least 3", 3, TAGS_MAX, &tags);
    for (int64_t i = 0; st == ST_OK && i < tags; i++) {
        if (i == 1)
            st = text_tokens_int(t, "1 to 9 components", 1, GMSH_COMPONENTS_MAX, &value);
        else if (i == 2)
            st = text_tokens_int(t, "the number of rows", 0, INT64_MAX, &value);
        else
            st = text_tokens_int(t, "an integer tag", INT64_MIN, INT64_MAX, &value);
        if (i == 1)
            a->components = (int)value;
        if (i == 2)
            a->count = (uint64_t)value;
    }
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_array(gmsh_file *f, text_tokens *t, gmsh_owner owner) {
    status st = mem_grow(f->m, &f->arrays, sizeof *f->arrays, f->count, 16, &f->room);
    if (st != ST_OK)
        return st;
    gmsh_array *a = &f->arrays[f->count++];
    a->owner = owner;
    st = read_name(t, a->name);
    if (st == ST_OK)
        st = read_time(t, &a->time);
    if (st == ST_OK)
        st = read_shape(t, a);
    a->rows = here(t);
    return st;
}

/* Read the section whose name is the last word read. */
static status read_section(gmsh_file *f, text_tokens *t) {
    char name[END_MAX - 10];
    uint64_t from = t->line;
    if (t->token[0] != '$' || strlen(t->token) >= sizeof name)
        return text_tokens_fault(t, "a section, such as $Nodes");
    strcpy(name, t->token);
    bool format = strcmp(name, "$MeshFormat") == 0;
    bool nodes = strcmp(name, "$Nodes") == 0, elements = strcmp(name, "$Elements") == 0;
    if (f->version == 0 && !format && strcmp(name, "$Comments") != 0)
        return text_tokens_fault(t, "$MeshFormat");
    if ((format && f->version != 0) || (nodes && f->nodes.at) || (elements && f->elements.at))
        return text_tokens_fault(t, "one section %s", name);
    status st = text_tokens_end_line(t);
    if (st == ST_OK && format)
        st = read_format(f, t);
    else if (nodes)
        f->nodes = here(t);
    else if (elements)
        f->elements = here(t);
    else if (st == ST_OK && strcmp(name, "$NodeData") == 0)
        st = read_array(f, t, GMSH_NODES);
    else if (st == ST_OK && strcmp(name, "$ElementNodeData") == 0)
        st = read_array(f, t, GMSH_ELEMENT_NODES);
    else if (st == ST_OK && strcmp(name, "$ElementData") == 0)
        st = read_array(f, t, GMSH_ELEMENTS);
    return st == ST_OK ? skip_to_end(t, name, from) : st;
}

status gmsh_file_scan(gmsh_file *f, mem *m, byte_stream *s) {
    *f = (gmsh_file){.m = m, .path = byte_stream_name(s)};
    text_tokens t = {.s = s, .line = 1};
    status st = text_tokens_next(&t);
    while (st == ST_OK && t.token[0]) {
        st = read_section(f, &t);
        if (st == ST_OK)
            st = text_tokens_next(&t);
    }
    if (st == ST_OK && !(f->nodes.at && f->elements.at))
        return status_describe(ST_CORRUPT, "%s: expected the section %s", f->path,
                               f->nodes.at ? "$Elements" : "$Nodes");
    return st;
}

void gmsh_file_release(gmsh_file *f) {
    if (f->m)
        mem_free(f->m, f->arrays);
}
