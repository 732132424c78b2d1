#include "formats/mesh/mesh_stream.h"

#include <assert.h>
#include <endian.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/mesh/mesh_choice.h"

#define MAGIC   "LEAFCAST MESH "
#define VERSION "1"

enum { HEADER_LINES_MAX = 100, CHUNK = 4096 };

/* Convert words between the file's and the machine's byte order, in place. */
static void swap_words(uint32_t *words, size_t count) {
    for (size_t i = 0; __BYTE_ORDER == __BIG_ENDIAN && i < count; i++)
        words[i] = __builtin_bswap32(words[i]);
}

/* ---- writing ---- */

struct mesh_stream_writer {
    mem *m;
    out_file *file;                /* NULL: standard output */
    uint64_t points, values, tets; /* still to come */
};

static status write_bytes(mesh_stream_writer *w, const void *data, size_t size) {
    if (w->file)
        return out_file_append(w->file, data, size);
    return file_write_all(STDOUT_FILENO, "standard output", NULL, data, size);
}

/* Write words. Where they must be swapped, a small buffer keeps the caller's words as they are. */
static status write_words(mesh_stream_writer *w, const void *words, size_t count) {
    if (__BYTE_ORDER != __BIG_ENDIAN)
        return write_bytes(w, words, count * 4);
    uint32_t buffer[1024];
    status st = ST_OK;
    for (size_t done = 0; st == ST_OK && done < count; done += 1024) {
        size_t part = count - done < 1024 ? count - done : 1024;
        memcpy(buffer, (const char *)words + done * 4, part * 4);
        swap_words(buffer, part);
        st = write_bytes(w, buffer, part * 4);
    }
    return st;
}

static status write_header(mesh_stream_writer *w, const mesh_stream_header *h) {
    char text[400];
    int length =
        snprintf(text, sizeof text, MAGIC VERSION "\n%s%s%s%s%s%spoints: %llu\ntets: %llu\n\n",
                 h->name[0] ? "name: " : "", h->name, h->name[0] ? "\n" : "",
                 h->field[0] ? "field: " : "", h->field, h->field[0] ? "\n" : "",
                 (unsigned long long)h->points, (unsigned long long)h->tets);
    return write_bytes(w, text, (size_t)length);
}

status mesh_stream_create(mem *m, const char *path, bool force, const mesh_stream_header *h,
                          mesh_stream_writer **out) {
    assert(h->points <= MESH_POINTS_MAX && h->tets <= MESH_STREAM_TETS_MAX);
    mesh_stream_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->points = w->values = h->points;
    w->tets = h->tets;
    status st = strcmp(path, "-") == 0 ? ST_OK : out_file_create(m, path, force, &w->file);
    if (st == ST_OK)
        st = write_header(w, h);
    if (st != ST_OK) {
        mesh_stream_discard(w);
        return st;
    }
    *out = w;
    return ST_OK;
}

status mesh_stream_points(mesh_stream_writer *w, size_t count, const float (*xyz)[3]) {
    assert(count <= w->points);
    w->points -= count;
    return write_words(w, xyz, count * 3);
}

status mesh_stream_values(mesh_stream_writer *w, size_t count, const float *values) {
    assert(w->points == 0 && count <= w->values);
    w->values -= count;
    return write_words(w, values, count);
}

status mesh_stream_tets(mesh_stream_writer *w, size_t count, const uint32_t (*ids)[4]) {
    assert(w->points == 0 && w->values == 0 && count <= w->tets);
    w->tets -= count;
    return write_words(w, ids, count * 4);
}

status mesh_stream_commit(mesh_stream_writer *w) {
    assert(w->points == 0 && w->values == 0 && w->tets == 0);
    status st = w->file ? out_file_commit(w->file) : ST_OK;
    w->file = NULL;
    mesh_stream_discard(w);
    return st;
}

void mesh_stream_discard(mesh_stream_writer *w) {
    if (!w)
        return;
    out_file_discard(w->file);
    mem_free(w->m, w);
}

/* ---- reading the header ---- */

typedef struct stream_state {
    mem *m;
    byte_stream *data;
    const mesh_hints *hints;
    const char *file; /* its name */
    unsigned line;    /* of the header, from 1 */
    bool has_points, has_tets;
    mesh_stream_header header;
} stream_state;

static bool stream_known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return size >= sizeof MAGIC - 1 && memcmp(start, MAGIC, sizeof MAGIC - 1) == 0;
}

static status bad_line(const stream_state *s, const char *text, const char *expected) {
    return status_describe(ST_CORRUPT, "%s: line %u: \"%.40s\", expected %s", s->file, s->line,
                           text, expected);
}

static status take_count(stream_state *s, const char *line, const char *value, int64_t max,
                         bool *had, uint64_t *out) {
    int64_t count = 0;
    if (*had)
        return bad_line(s, line, "each line once");
    if (num_int(value, "", 0, max, &count) != ST_OK)
        return bad_line(s, line, "a number of points or tets in range");
    *had = true;
    *out = (uint64_t)count;
    return ST_OK;
}

static status take_text(const stream_state *s, const char *line, const char *value,
                        char out[MESH_NAME_MAX + 1]) {
    if (!*value || strlen(value) > MESH_NAME_MAX)
        return bad_line(s, line, "a name of 1 to 63 bytes");
    if (*out)
        return bad_line(s, line, "each line once");
    strcpy(out, value);
    return ST_OK;
}

static status take_line(stream_state *s, const char *line) {
    mesh_stream_header *h = &s->header;
    if (strncmp(line, "name: ", 6) == 0)
        return take_text(s, line, line + 6, h->name);
    if (strncmp(line, "field: ", 7) == 0)
        return take_text(s, line, line + 7, h->field);
    if (strncmp(line, "points: ", 8) == 0)
        return take_count(s, line, line + 8, (int64_t)MESH_POINTS_MAX, &s->has_points, &h->points);
    if (strncmp(line, "tets: ", 6) == 0)
        return take_count(s, line, line + 6, (int64_t)MESH_STREAM_TETS_MAX, &s->has_tets, &h->tets);
    return bad_line(s, line, "name, field, points, tets or an empty line");
}

/* Read one line of the header. Its lines are limited in number: what follows is no text. */
static status next_line(stream_state *s, text_line *line) {
    bool got;
    status st = byte_stream_line(s->data, line, &got);
    s->line++;
    if (st == ST_OK && !got)
        return bad_line(s, "", "a line; the file ends here");
    return st;
}

static status read_header(stream_state *s, text_line *line) {
    status st = next_line(s, line);
    if (st == ST_OK && strcmp(line->text, MAGIC VERSION) != 0)
        return status_describe(ST_UNSUPPORTED, "%s: \"%.40s\", expected \"%s\"", s->file,
                               line->text, MAGIC VERSION);
    while (st == ST_OK && s->line < HEADER_LINES_MAX) {
        st = next_line(s, line);
        if (st == ST_OK && line->length == 0)
            break;
        if (st == ST_OK)
            st = take_line(s, line->text);
    }
    if (st == ST_OK && !(s->has_points && s->has_tets))
        return bad_line(s, line->text, "lines \"points: N\" and \"tets: N\" before it");
    return st;
}

/* Check a file's length against the header. A pipe's end is checked later, behind the last tet. */
static status check_length(const stream_state *s) {
    uint64_t want = 16 * (s->header.points + s->header.tets), left = byte_stream_left(s->data);
    if (left == UINT64_MAX || left == want)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: %llu bytes behind the header, expected %llu for %llu points and "
                           "%llu tets",
                           s->file, (unsigned long long)left, (unsigned long long)want,
                           (unsigned long long)s->header.points,
                           (unsigned long long)s->header.tets);
}

/* Take the one field that a stream can have. */
static status stream_take(void *state, const char *const *names, uint32_t count) {
    const stream_state *s = state;
    const char *field = s->header.field;
    mesh_hints asked = *s->hints;
    asked.field = names[count - 1];
    name_list points = {0}, cells = {0};
    if (field[0])
        name_list_add(&points, field);
    if (asked.cells_to_points ||
        (asked.field && !text_same_name(asked.field, field, sizeof s->header.field)))
        return mesh_choice_missing(s->file, &asked, &points, &cells);
    return mesh_choice_component(s->file, &asked, field, 1);
}

static status stream_open(mesh_source *source, void **state) {
    stream_state *s = mem_zalloc(source->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *state = s;
    s->m = source->m;
    s->data = source->data;
    s->hints = &source->hints;
    s->file = byte_stream_name(s->data);
    text_line line = {.m = s->m};
    status st = read_header(s, &line);
    byte_stream_line_release(&line);
    if (st == ST_OK)
        st = check_length(s);
    if (st == ST_OK && s->header.name[0])
        strcpy(source->name, s->header.name);
    return st;
}

static void stream_close(void *state) {
    stream_state *s = state;
    if (s)
        mem_free(s->m, s);
}

/* ---- reading the arrays ---- */

/* Read the array's next `count` elements of `words` words. `done` elements were read before. */
static status read_words(const stream_state *s, const char *what, uint64_t done, size_t count,
                         size_t words, uint32_t *buffer) {
    size_t got, size = count * words * 4;
    status st = byte_stream_read(s->data, buffer, size, &got);
    if (st == ST_OK && got < size)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu, inside %s %llu (counted from 0)",
                               s->file, (unsigned long long)byte_stream_position(s->data), what,
                               (unsigned long long)(done + got / (words * 4)));
    swap_words(buffer, count * words);
    return st;
}

static size_t chunk_of(uint64_t left) {
    return left < CHUNK ? (size_t)left : CHUNK;
}

static status read_arrays(const stream_state *s, mesh_feed *feed, void *buffer) {
    const uint64_t points = s->header.points, tets = s->header.tets;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < points; i += CHUNK) {
        st = read_words(s, "point", i, chunk_of(points - i), 3, buffer);
        if (st == ST_OK)
            st = mesh_feed_points(feed, (const float(*)[3])buffer, chunk_of(points - i));
    }
    for (uint64_t i = 0; st == ST_OK && i < points; i += CHUNK) {
        st = read_words(s, "value", i, chunk_of(points - i), 1, buffer);
        if (st == ST_OK)
            st = mesh_feed_values(feed, 0, (const float *)buffer, chunk_of(points - i));
    }
    for (uint64_t i = 0; st == ST_OK && i < tets; i += CHUNK) {
        st = read_words(s, "tet", i, chunk_of(tets - i), 4, buffer);
        if (st == ST_OK)
            st = mesh_feed_tets(feed, (const uint32_t(*)[4])buffer, chunk_of(tets - i));
    }
    return st;
}

static status check_end(const stream_state *s) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->data, 1, &data, &size);
    if (st == ST_OK && size > 0)
        return status_describe(ST_CORRUPT, "%s: expected the end behind the last tet, at byte %llu",
                               s->file, (unsigned long long)byte_stream_position(s->data));
    return st;
}

static status stream_read(void *state, mesh_feed *feed) {
    const stream_state *s = state;
    void *buffer = mem_array(s->m, CHUNK, 16);
    status st = buffer ? mesh_feed_expect(feed, s->header.points) : ST_NOMEM;
    strcpy(feed->report->field, s->header.field);
    mesh_feed_expect_cells(feed, s->header.tets);
    if (st == ST_OK)
        st = read_arrays(s, feed, buffer);
    if (st == ST_OK)
        st = check_end(s);
    mem_free(s->m, buffer);
    return st;
}

static void stream_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const stream_state *s = state;
    if (s->header.field[0])
        take(ctx, s->header.field, 1);
}

const mesh_reader mesh_stream_reader = {"mesh stream", stream_known, stream_open,
                                        stream_read,   stream_close, stream_take,
                                        stream_fields, NULL,         NULL};
