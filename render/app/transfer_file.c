#include "render/app/transfer_file.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/num.h"
#include "formats/input/text_tokens.h"
#include "render/app/paraview_map.h"

/* ---- Our own form ---- */

/* Read one component or extinction of a line, 0 to `most`. */
static status take_share(text_tokens *t, const char *what, double most, double *out) {
    status st = text_tokens_double_here(t, what, out);
    if (st == ST_OK && !(*out >= 0.0 && *out <= most))
        st = text_tokens_fault(t, "%s, 0 or more and finite", what);
    return st;
}

static status take_point(text_tokens *t, leafcast_transfer_point *p) {
    static const char *const NAMES[3] = {"red", "green", "blue"};
    enum { BRIGHTEST = 1000000 };
    status st = text_tokens_double_here(t, "a value", &p->value);
    if (st == ST_OK && !(fabs(p->value) <= 1e300))
        st = text_tokens_fault(t, "a finite value, up to 1e300");
    for (int c = 0; c < 3 && st == ST_OK; c++)
        st = take_share(t, NAMES[c], BRIGHTEST, &p->rgb[c]);
    if (st == ST_OK)
        st = take_share(t, "an extinction", TRANSFER_LIST_MOST, &p->extinction);
    return st;
}

static status add_point(const text_tokens *t, transfer_list *list,
                        const leafcast_transfer_point *p) {
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    const double before = list->count ? list->points[list->count - 1].value : -INFINITY;
    if (list->count == LEAFCAST_TRANSFER_POINTS_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: line %llu: expected at most %d points",
                               byte_stream_name(t->s), (unsigned long long)t->line,
                               LEAFCAST_TRANSFER_POINTS_MAX);
    if (p->value >= before)
        return transfer_list_add(list, *p);
    return status_describe(ST_CORRUPT,
                           "%s: line %llu: the value %s comes behind %s: expected rising ones",
                           byte_stream_name(t->s), (unsigned long long)t->line,
                           num_print(p->value, a), num_print(before, b));
}

/* Read a line; an empty one or a comment gives no point. */
static status read_line(text_tokens *t, transfer_list *list) {
    leafcast_transfer_point p = {0};
    bool more = false;
    status st = text_tokens_more(t, &more);
    if (st == ST_OK && more) {
        st = take_point(t, &p);
        if (st == ST_OK)
            st = add_point(t, list, &p);
    }
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status at_end(byte_stream *s, bool *end) {
    const uint8_t *data;
    size_t size = 0;
    status st = byte_stream_peek(s, 1, &data, &size);
    *end = size == 0;
    return st;
}

static status copy_list(transfer_list *to, const transfer_list *from) {
    status st = ST_OK;
    for (size_t i = 0; i < from->count && st == ST_OK; i++)
        st = transfer_list_add(to, from->points[i]);
    return st;
}

static status read_text(transfer_file *out, byte_stream *s) {
    text_tokens t = {.s = s, .line = 1, .comment = '#', .commas = true};
    bool end = false;
    status st = at_end(s, &end);
    while (st == ST_OK && !end) {
        st = read_line(&t, &out->colours);
        if (st == ST_OK)
            st = at_end(s, &end);
    }
    if (st == ST_OK && out->colours.count == 0)
        st = status_describe(ST_CORRUPT,
                             "%s: expected points, \"value red green blue extinction\" "
                             "a line",
                             byte_stream_name(s));
    out->per_length = true;
    return st == ST_OK ? copy_list(&out->extinctions, &out->colours) : st;
}

void transfer_file_print(const leafcast_transfer_point *points, size_t count, FILE *out) {
    char text[NUM_TEXT_MAX];
    fputs("# value red green blue extinction (linear colours; per world length)\n", out);
    for (size_t i = 0; i < count; i++) {
        const leafcast_transfer_point *p = &points[i];
        fputs(num_print(p->value, text), out);
        for (int c = 0; c < 3; c++)
            fprintf(out, " %s", num_print(p->rgb[c], text));
        fprintf(out, " %s\n", num_print(p->extinction, text));
    }
}

/* ---- Any form ---- */

static status convert(transfer_file *out, const paraview_map *map, const char *file) {
    status st = colour_map_convert(map->space, map->colours, map->colour_count, &out->colours);
    if (st == ST_OK && map->opacity_count > 0)
        st = opacity_curve_convert(map->opacities, map->opacity_count, &out->extinctions);
    if (st == ST_UNSUPPORTED)
        return status_describe(st, "%s: more points than the %d that a transfer function has", file,
                               LEAFCAST_TRANSFER_POINTS_MAX);
    return st;
}

static status read_paraview(mem *m, transfer_file *out, byte_stream *s, const char *wanted,
                            status (*read)(paraview_map *p, byte_stream *s)) {
    paraview_map map = {.m = m, .wanted = wanted};
    status st = read(&map, s);
    if (st == ST_OK)
        st = convert(out, &map, byte_stream_name(s));
    paraview_map_release(&map);
    return st;
}

/* Get the first byte behind blanks and a UTF-8 byte order mark; 0: there is none. */
static status first_letter(byte_stream *s, char *letter) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s, 4, &data, &size);
    if (st == ST_OK && size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0)
        byte_stream_take(s, 3);
    if (st == ST_OK)
        st = byte_stream_peek(s, BYTE_STREAM_BUFFER, &data, &size);
    size_t i = 0;
    while (st == ST_OK && i < size && strchr(" \t\r\n", data[i]) && data[i])
        i++;
    *letter = st == ST_OK && i < size ? (char)data[i] : 0;
    return st;
}

static status read_stream(mem *m, transfer_file *out, byte_stream *s, const char *wanted) {
    char letter = 0;
    status st = first_letter(s, &letter);
    if (st != ST_OK)
        return st;
    if (letter == '[' || letter == '{')
        return read_paraview(m, out, s, wanted, paraview_map_read_json);
    if (letter == '<')
        return read_paraview(m, out, s, wanted, paraview_map_read_xml);
    if (wanted)
        return status_describe(ST_USAGE,
                               "%s: \"#%s\": text holds one transfer function, without a "
                               "name",
                               byte_stream_name(s), wanted);
    return read_text(out, s);
}

/* Cut "FILE#NAME" in two and return the NAME; NULL if there is none, or a file of the full name. */
static const char *split_name(char *path) {
    char *mark = access(path, F_OK) == 0 ? NULL : strrchr(path, '#');
    if (!mark)
        return NULL;
    *mark = 0;
    return mark + 1;
}

status transfer_file_read(mem *m, const char *path, transfer_file *out) {
    byte_stream *s = NULL;
    char *file = mem_copy_text(m, path);
    out->colours.m = out->extinctions.m = m;
    if (!file)
        return ST_NOMEM;
    const char *wanted = split_name(file);
    status st = byte_stream_open(m, file, &s);
    if (st == ST_OK)
        st = read_stream(m, out, s, wanted);
    byte_stream_close(s);
    mem_free(m, file);
    return st;
}

void transfer_file_release(transfer_file *t) {
    transfer_list_release(&t->colours);
    transfer_list_release(&t->extinctions);
    *t = (transfer_file){0};
}
