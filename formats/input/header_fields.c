#include "formats/input/header_fields.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

enum { FIELDS_MAX = 4096, WHERE_MAX = 512 };

static const char *skip_blanks(const char *text) {
    return text + strspn(text, " \t");
}

bool header_fields_same(const char *a, const char *b) {
    for (;; a++, b++) {
        a = skip_blanks(a);
        b = skip_blanks(b);
        if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
            return false;
        if (!*a)
            return true;
    }
}

/* Returns a hash that is equal for keys that are header_fields_same() (FNV-1a). Long keys that
 * differ in their last letter alone need not be compared with each field. */
static uint64_t hash_key(const char *key) {
    uint64_t hash = 0xcbf29ce484222325;
    for (key = skip_blanks(key); *key; key = skip_blanks(key + 1))
        hash = (hash ^ (uint64_t)tolower((unsigned char)*key)) * 0x100000001b3;
    return hash;
}

static const header_field *find(const header_fields *h, const char *key, bool pair) {
    const uint64_t hash = hash_key(key);
    for (size_t i = 0; i < h->count; i++)
        if (h->items[i].hash == hash && h->items[i].pair == pair &&
            header_fields_same(h->items[i].key, key))
            return &h->items[i];
    return NULL;
}

const header_field *header_fields_find(const header_fields *h, const char *key) {
    return find(h, key, false);
}

const header_field *header_fields_find_pair(const header_fields *h, const char *key) {
    return find(h, key, true);
}

static void print_where(const header_fields *h, const header_field *f, char where[WHERE_MAX]) {
    snprintf(where, WHERE_MAX, "%s: line %u: %.60s", h->name, f->line, f->key);
}

status header_fields_fault(const header_fields *h, const header_field *f, status st,
                           const char *fmt, ...) {
    char where[WHERE_MAX], text[STATUS_TEXT_MAX];
    print_where(h, f, where);
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: %s", where, text);
}

status header_fields_missing(const header_fields *h, const char *key) {
    return status_describe(ST_CORRUPT, "%s: the header ends without \"%s\"", h->name, key);
}

/* Split a line at its separator and keep it. */
static status add_field(header_fields *h, const char *line, unsigned number, char separator) {
    const char *at = strchr(line, separator);
    if (!at || h->count == FIELDS_MAX)
        return status_describe(ST_CORRUPT, "%s: line %u: expected \"key%c value\", not \"%.60s\"",
                               h->name, number, separator, line);
    status st = mem_grow(h->m, &h->items, sizeof *h->items, h->count, 16, &h->room);
    if (st != ST_OK)
        return st;
    header_field f = {.line = number, .pair = separator == ':' && at[1] == '='};
    f.key = mem_copy_text(h->m, line);
    if (!f.key)
        return ST_NOMEM;
    char *key_end = f.key + (at - line);
    f.value = key_end + 1 + f.pair;
    f.value += strspn(f.value, " \t");
    while (key_end > f.key && strchr(" \t", key_end[-1]))
        key_end--;
    *key_end = 0;
    f.hash = hash_key(f.key);
    if (find(h, f.key, f.pair)) {
        st = header_fields_fault(h, &f, ST_CORRUPT, "comes twice");
        mem_free(h->m, f.key);
        return st;
    }
    h->items[h->count++] = f;
    return ST_OK;
}

static bool is_end(const header_field *f, const header_style *style) {
    const char *value = style->end_value ? style->end_value : "";
    return style->end_key && header_fields_same(f->key, style->end_key) &&
           strncmp(f->value, value, strlen(value)) == 0;
}

static status read_lines(header_fields *h, byte_stream *s, const header_style *style,
                         text_line *line) {
    for (unsigned number = style->lines_read + 1;; number++) {
        bool got;
        status st = byte_stream_line(s, line, &got);
        if (st != ST_OK || !got)
            return st;
        const char *text = skip_blanks(line->text);
        if (!*text && style->ends_blank)
            return ST_OK;
        if (!*text || *text == '#')
            continue;
        st = add_field(h, text, number, style->separator);
        if (st != ST_OK)
            return st;
        if (is_end(&h->items[h->count - 1], style))
            return ST_OK;
    }
}

status header_fields_read(header_fields *h, mem *m, byte_stream *s, const header_style *style) {
    *h = (header_fields){.m = m, .name = byte_stream_name(s)};
    text_line line = {.m = m};
    status st = read_lines(h, s, style, &line);
    byte_stream_line_release(&line);
    return st;
}

void header_fields_release(header_fields *h) {
    for (size_t i = 0; i < h->count; i++)
        mem_free(h->m, h->items[i].key);
    mem_free(h->m, h->items);
    *h = (header_fields){.m = h->m};
}

/* num.h, made for command lines, calls a malformed number a usage error. Here the file is at fault.
 */
static status blame_file(status st) {
    return st == ST_USAGE ? ST_CORRUPT : st;
}

status header_fields_numbers(const header_fields *h, const header_field *f, int count,
                             double *out) {
    char where[WHERE_MAX];
    print_where(h, f, where);
    return blame_file(num_doubles(f->value, where, " ", count, out));
}

status header_fields_int(const header_fields *h, const header_field *f, int64_t lo, int64_t hi,
                         int64_t *out) {
    char where[WHERE_MAX];
    print_where(h, f, where);
    return blame_file(num_int(f->value, where, lo, hi, out));
}

status header_fields_sizes(const header_fields *h, const header_field *f, int count,
                           uint32_t *out) {
    double sizes[HEADER_FIELDS_AXES];
    status st = header_fields_numbers(h, f, count, sizes);
    for (int i = 0; st == ST_OK && i < count; i++) {
        if (!(sizes[i] >= 1 && sizes[i] <= UINT32_MAX && sizes[i] == floor(sizes[i])))
            st = header_fields_fault(h, f, ST_CORRUPT, "\"%s\": a size is a whole number from 1 on",
                                     f->value);
        else
            out[i] = (uint32_t)sizes[i];
    }
    return st;
}
