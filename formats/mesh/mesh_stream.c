#include "formats/mesh/mesh_stream.h"

#include <assert.h>
#include <endian.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/quadratic_tet.h"
#include "formats/base/text.h"
#include "formats/mesh/mesh_choice.h"
#include "formats/mesh/mesh_stream_polyhedra.h"

#define MAGIC      "LEAFCAST MESH "
#define POLYHEDRA  "polyhedra: "
#define NUMBERS    "numbers of polyhedra: "
#define MIDDLES    "middles of polyhedra: "
#define BY_CORNERS "by-corners: "
#define SKIPPED    "skipped: "

enum { HEADER_LINES_MAX = MESH_STREAM_FIELDS_MAX + 100, CHUNK = 4096 };

/* The cells, in the file's order. */
static const struct {
    const char *line; /* of the header, up to its number */
    const char *one;
    cell_shape shape;
} kinds[] = {
    {"tets: ", "tet", CELL_TET},
    {"pyramids: ", "pyramid", CELL_PYRAMID},
    {"wedges: ", "wedge", CELL_WEDGE},
    {"hexahedra: ", "hexahedron", CELL_HEXAHEDRON},
    {"quadratic tets: ", "quadratic tet", CELL_QUADRATIC_TET},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* Convert words between the file's and the machine's byte order, in place. */
static void swap_words(uint32_t *words, size_t count) {
    for (size_t i = 0; __BYTE_ORDER == __BIG_ENDIAN && i < count; i++)
        words[i] = __builtin_bswap32(words[i]);
}

/* ---- writing ---- */

struct mesh_stream_writer {
    mem *m;
    out_file *file;          /* NULL: standard output */
    uint64_t points, values; /* still to come */
    uint64_t cells[CELL_SHAPES], numbers;
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

static bool needs_version_2(const mesh_stream_header *h) {
    bool needs =
        h->bare || h->field_count > 0 || h->by_corners > 0 || h->skipped > 0 || h->polyhedra > 0;
    for (int i = 0; i < CELL_SHAPES; i++)
        needs = needs || h->cells[i] > 0;
    return needs;
}

static status write_text(mesh_stream_writer *w, const char *key, const char *value) {
    char text[MESH_NAME_MAX + 32];
    const int length = snprintf(text, sizeof text, "%s%s\n", key, value);
    return *value ? write_bytes(w, text, (size_t)length) : ST_OK;
}

static status write_number(mesh_stream_writer *w, const char *key, uint64_t value) {
    char text[24];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    return write_text(w, key, text);
}

static status write_header(mesh_stream_writer *w, const mesh_stream_header *h) {
    status st = write_text(w, MAGIC, needs_version_2(h) ? "2" : "1");
    if (st == ST_OK)
        st = write_text(w, "name: ", h->name);
    if (st == ST_OK)
        st = write_text(w, "field: ", h->field);
    for (uint32_t i = 0; i < h->field_count && st == ST_OK; i++)
        st = write_text(w, "field: ", h->fields[i]);
    if (st == ST_OK)
        st = write_number(w, "points: ", h->points);
    for (int i = 0; i < KINDS && st == ST_OK; i++)
        if (kinds[i].shape == CELL_TET || w->cells[kinds[i].shape])
            st = write_number(w, kinds[i].line, w->cells[kinds[i].shape]);
    if (st == ST_OK && h->polyhedra > 0)
        st = write_number(w, POLYHEDRA, h->polyhedra);
    if (st == ST_OK && h->polyhedra > 0)
        st = write_number(w, NUMBERS, h->numbers);
    if (st == ST_OK && h->polyhedra > 0)
        st = write_number(w, MIDDLES, h->middles);
    if (st == ST_OK && h->by_corners > 0)
        st = write_number(w, BY_CORNERS, h->by_corners);
    if (st == ST_OK && h->skipped > 0)
        st = write_number(w, SKIPPED, h->skipped);
    return st == ST_OK ? write_bytes(w, "\n", 1) : st;
}

status mesh_stream_create(mem *m, const char *path, bool force, const mesh_stream_header *h,
                          mesh_stream_writer **out) {
    assert(h->points <= MESH_POINTS_MAX && h->tets <= MESH_STREAM_CELLS_MAX);
    assert(h->field_count < MESH_STREAM_FIELDS_MAX && (h->field[0] || h->field_count == 0));
    assert(h->cells[CELL_VOXEL] == 0 && h->cells[CELL_TET] == 0 && !(h->bare && h->field[0]));
    mesh_stream_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->points = h->points;
    w->values = h->points * (h->field_count + (h->field[0] || !needs_version_2(h)));
    memcpy(w->cells, h->cells, sizeof h->cells);
    w->cells[CELL_TET] = h->tets;
    w->numbers = h->numbers;
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

/* Returns whether all that comes before cells of a shape has been written; CELL_SHAPES: all. */
static bool is_turn_of(const mesh_stream_writer *w, cell_shape shape) {
    uint64_t left = w->points + w->values;
    for (int i = 0; i < KINDS && kinds[i].shape != shape; i++)
        left += w->cells[kinds[i].shape];
    return left == 0;
}

status mesh_stream_cells(mesh_stream_writer *w, cell_shape shape, size_t count,
                         const uint32_t *ids) {
    assert(is_turn_of(w, shape) && count <= w->cells[shape]);
    w->cells[shape] -= count;
    return write_words(w, ids, count * (size_t)cell_shape_vertices(shape));
}

status mesh_stream_tets(mesh_stream_writer *w, size_t count, const uint32_t (*ids)[4]) {
    return mesh_stream_cells(w, CELL_TET, count, (const uint32_t *)ids);
}

status mesh_stream_numbers(mesh_stream_writer *w, size_t count, const uint32_t *numbers) {
    assert(is_turn_of(w, CELL_SHAPES) && count <= w->numbers);
    w->numbers -= count;
    return write_words(w, numbers, count);
}

status mesh_stream_commit(mesh_stream_writer *w) {
    const bool whole = is_turn_of(w, CELL_SHAPES) && w->numbers == 0;
    assert(whole);
    (void)whole;
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

typedef char field_name[MESH_NAME_MAX + 1];

typedef struct stream_state {
    mem *m;
    byte_stream *data;
    const mesh_hints *hints;
    const char *file; /* its name */
    unsigned line;    /* of the header, from 1 */
    int version;
    char name[MESH_NAME_MAX + 1];
    bool has_points, has_cells[CELL_SHAPES], has_by_corners, has_skipped;
    bool has_polyhedra, has_numbers, has_middles;
    uint64_t points, cells[CELL_SHAPES], by_corners, skipped;
    mesh_stream_polyhedra polyhedra;
    field_name *fields;
    size_t field_count, field_room;
    uint32_t *taken; /* by mesh_feed's field: which of the file's */
    uint32_t taken_count;
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
        return bad_line(s, line, "a number of points or cells in range");
    *had = true;
    *out = (uint64_t)count;
    return ST_OK;
}

static status take_cells(stream_state *s, const char *line, const char *value, bool *had,
                         uint64_t *out) {
    return take_count(s, line, value, (int64_t)MESH_STREAM_CELLS_MAX, had, out);
}

static status check_name(const stream_state *s, const char *line, const char *value) {
    return *value && strlen(value) <= MESH_NAME_MAX ? ST_OK
                                                    : bad_line(s, line, "a name of 1 to 63 bytes");
}

static status take_name(stream_state *s, const char *line, const char *value) {
    if (s->name[0])
        return bad_line(s, line, "each line once");
    status st = check_name(s, line, value);
    if (st == ST_OK)
        strcpy(s->name, value);
    return st;
}

static status take_field(stream_state *s, const char *line, const char *value) {
    if (s->version == 1 && s->field_count > 0)
        return bad_line(s, line, "each line once");
    if (s->field_count == MESH_STREAM_FIELDS_MAX)
        return bad_line(s, line, "fewer fields");
    for (size_t i = 0; i < s->field_count; i++)
        if (strcmp(s->fields[i], value) == 0)
            return bad_line(s, line, "each field once");
    status st = check_name(s, line, value);
    if (st == ST_OK)
        st = mem_grow(s->m, &s->fields, sizeof *s->fields, s->field_count, 8, &s->field_room);
    if (st == ST_OK)
        strcpy(s->fields[s->field_count++], value);
    return st;
}

/* A line's value behind its key; NULL: the line has another one. */
static const char *behind(const char *line, const char *key) {
    const size_t length = strlen(key);
    return strncmp(line, key, length) == 0 ? line + length : NULL;
}

static status take_line(stream_state *s, const char *line) {
    const char *value;
    if ((value = behind(line, "name: ")))
        return take_name(s, line, value);
    if ((value = behind(line, "field: ")))
        return take_field(s, line, value);
    if ((value = behind(line, "points: ")))
        return take_count(s, line, value, (int64_t)MESH_POINTS_MAX, &s->has_points, &s->points);
    if (s->version > 1 && (value = behind(line, POLYHEDRA)))
        return take_cells(s, line, value, &s->has_polyhedra, &s->polyhedra.count);
    if (s->version > 1 && (value = behind(line, NUMBERS)))
        return take_cells(s, line, value, &s->has_numbers, &s->polyhedra.numbers);
    if (s->version > 1 && (value = behind(line, MIDDLES)))
        return take_cells(s, line, value, &s->has_middles, &s->polyhedra.middles);
    if (s->version > 1 && (value = behind(line, BY_CORNERS)))
        return take_cells(s, line, value, &s->has_by_corners, &s->by_corners);
    if (s->version > 1 && (value = behind(line, SKIPPED)))
        return take_cells(s, line, value, &s->has_skipped, &s->skipped);
    for (int i = 0; i < (s->version == 1 ? 1 : KINDS); i++)
        if ((value = behind(line, kinds[i].line)))
            return take_cells(s, line, value, &s->has_cells[kinds[i].shape],
                              &s->cells[kinds[i].shape]);
    return bad_line(
        s, line,
        s->version == 1
            ? "name, field, points, tets or an empty line"
            : "name, field, points, tets, pyramids, wedges, hexahedra, quadratic tets, polyhedra, "
              "their numbers and middles, by-corners, skipped or an empty line");
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

static status read_version(stream_state *s, const text_line *line) {
    const char *version = behind(line->text, MAGIC);
    s->version = !version ? 0 : strcmp(version, "1") == 0 ? 1 : strcmp(version, "2") == 0 ? 2 : 0;
    if (s->version)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: \"%.40s\", expected \"" MAGIC "1\" or 2", s->file,
                           line->text);
}

static bool is_whole(const stream_state *s) {
    bool any = s->version == 2;
    for (int i = 0; i < CELL_SHAPES; i++)
        any = any || s->has_cells[i];
    return s->has_points && any;
}

static status read_header(stream_state *s, text_line *line) {
    status st = next_line(s, line);
    if (st == ST_OK)
        st = read_version(s, line);
    while (st == ST_OK && s->line < HEADER_LINES_MAX) {
        st = next_line(s, line);
        if (st == ST_OK && line->length == 0)
            break;
        if (st == ST_OK)
            st = take_line(s, line->text);
    }
    if (st == ST_OK && !is_whole(s))
        return bad_line(s, line->text,
                        s->version == 1 ? "lines \"points: N\" and \"tets: N\" before it"
                                        : "a line \"points: N\" before it");
    return st;
}

/* Arrays of values. Version 1 has one without a name, too. */
static size_t arrays_of(const stream_state *s) {
    return s->version == 1 ? 1 : s->field_count;
}

/* Check a file's length against the header. A pipe's end is checked later, behind the last cell. */
static status check_length(const stream_state *s) {
    uint64_t want = s->points * (12 + 4 * (uint64_t)arrays_of(s)) + 4 * s->polyhedra.numbers;
    uint64_t cells = s->polyhedra.count;
    const uint64_t left = byte_stream_left(s->data);
    for (int i = 0; i < KINDS; i++) {
        const uint64_t count = s->cells[kinds[i].shape];
        want += count * 4 * (uint64_t)cell_shape_vertices(kinds[i].shape);
        cells += count;
    }
    if (left == UINT64_MAX || left == want)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: %llu bytes behind the header, expected %llu for %llu points and "
                           "%llu %s",
                           s->file, (unsigned long long)left, (unsigned long long)want,
                           (unsigned long long)s->points, (unsigned long long)cells,
                           s->version == 1 ? "tets" : "cells");
}

/* Take one of the stream's fields; without a name the first one, if there is any. */
static status take_one(stream_state *s, const char *name) {
    mesh_hints asked = *s->hints;
    asked.field = name;
    name_list points = {0}, cells = {0};
    size_t i = 0;
    for (size_t k = 0; k < s->field_count; k++)
        name_list_add(&points, s->fields[k]);
    while (name && i < s->field_count && !text_same_name(name, s->fields[i], sizeof(field_name)))
        i++;
    if (asked.cells_to_points || (name && i == s->field_count))
        return mesh_choice_missing(s->file, &asked, &points, &cells);
    s->taken[s->taken_count++] = (uint32_t)i;
    return mesh_choice_component(s->file, &asked, i < s->field_count ? s->fields[i] : "", 1);
}

static status stream_take(void *state, const char *const *names, uint32_t count) {
    stream_state *s = state;
    mem_free(s->m, s->taken);
    s->taken_count = 0;
    s->taken = mem_array(s->m, count, sizeof *s->taken);
    status st = s->taken ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = take_one(s, names[i]);
    return st;
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
    if (st == ST_OK && s->name[0])
        strcpy(source->name, s->name);
    return st;
}

static void stream_close(void *state) {
    stream_state *s = state;
    if (!s)
        return;
    mem_free(s->m, s->fields);
    mem_free(s->m, s->taken);
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

static status read_points(const stream_state *s, mesh_feed *feed, void *buffer) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < s->points; i += CHUNK) {
        const size_t count = chunk_of(s->points - i);
        st = read_words(s, "point", i, count, 3, buffer);
        if (st == ST_OK)
            st = mesh_feed_points(feed, (const float(*)[3])buffer, count);
    }
    return st;
}

static bool is_taken(const stream_state *s, uint32_t array) {
    bool is = false;
    for (uint32_t k = 0; k < s->taken_count; k++)
        is = is || s->taken[k] == array;
    return is;
}

/* Read one array of values, for all fields that are it. */
static status read_values(const stream_state *s, uint32_t array, mesh_feed *feed, void *buffer) {
    status st = ST_OK;
    if (!is_taken(s, array))
        return byte_stream_skip(s->data, 4 * s->points);
    for (uint64_t i = 0; st == ST_OK && i < s->points; i += CHUNK) {
        const size_t count = chunk_of(s->points - i);
        st = read_words(s, "value", i, count, 1, buffer);
        for (uint32_t k = 0; st == ST_OK && k < s->taken_count; k++)
            if (s->taken[k] == array)
                st = mesh_feed_values(feed, k, buffer, count);
    }
    return st;
}

static status feed_cells(mesh_feed *feed, cell_shape shape, size_t count, const uint32_t *ids) {
    const int vertices = cell_shape_vertices(shape);
    status st = ST_OK;
    if (shape == CELL_TET)
        return mesh_feed_tets(feed, (const uint32_t(*)[4])ids, count);
    for (size_t c = 0; c < count && st == ST_OK; c++, ids += vertices) {
        uint64_t wide[CELL_VERTICES_MAX];
        for (int i = 0; i < vertices; i++)
            wide[i] = ids[i];
        st = mesh_feed_cell(feed, shape, wide);
    }
    return st;
}

/* Turn ids that are no point's into one that no mesh has: middles of polyhedra have the next ones.
 */
static void check_ids(const stream_state *s, uint32_t *ids, size_t count) {
    for (size_t i = 0; s->polyhedra.middles > 0 && i < count; i++)
        ids[i] = ids[i] < s->points ? ids[i] : UINT32_MAX;
}

/* Feed quadratic tets as linear ones of their corners, which come first. The ids are moved. */
static status feed_corners(mesh_feed *feed, size_t count, uint32_t *ids) {
    for (size_t c = 0; c < count; c++)
        memmove(ids + c * QUADRATIC_CORNERS, ids + c * QUADRATIC_NODES,
                QUADRATIC_CORNERS * sizeof *ids);
    return feed_cells(feed, CELL_TET, count, ids);
}

static status read_cells(const stream_state *s, int kind, mesh_feed *feed, void *buffer) {
    const cell_shape shape = kinds[kind].shape;
    const uint64_t cells = s->cells[shape];
    const size_t vertices = (size_t)cell_shape_vertices(shape);
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < cells; i += CHUNK) {
        const size_t count = chunk_of(cells - i);
        st = read_words(s, kinds[kind].one, i, count, vertices, buffer);
        if (st == ST_OK)
            check_ids(s, buffer, count * vertices);
        if (st == ST_OK)
            st = shape == CELL_QUADRATIC_TET && s->hints->by_corners
                     ? feed_corners(feed, count, buffer)
                     : feed_cells(feed, shape, count, buffer);
    }
    return st;
}

static status read_arrays(const stream_state *s, mesh_feed *feed, void *buffer) {
    const size_t arrays = arrays_of(s);
    status st = read_points(s, feed, buffer);
    for (uint32_t i = 0; i < arrays && st == ST_OK; i++)
        st = read_values(s, i, feed, buffer);
    for (int i = 0; i < KINDS && st == ST_OK; i++)
        st = read_cells(s, i, feed, buffer);
    if (st == ST_OK)
        st = mesh_stream_polyhedra_read(&s->polyhedra, feed);
    /* Behind the polyhedra: they have added as many points as the header tells of. */
    return st == ST_OK && arrays == 0 ? mesh_feed_zeros(feed) : st;
}

static status check_end(const stream_state *s) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->data, 1, &data, &size);
    if (st == ST_OK && size > 0)
        return status_describe(ST_CORRUPT,
                               "%s: expected the end behind the last cell, at byte %llu", s->file,
                               (unsigned long long)byte_stream_position(s->data));
    return st;
}

/* Points with their values stay in memory if polyhedra add means of them. */
static status expect_points(const stream_state *s, mesh_feed *feed) {
    const status st = mesh_feed_expect(feed, s->points + s->polyhedra.middles);
    return st == ST_OK ? mesh_feed_keep(feed, s->polyhedra.middles > 0 ? s->points : 0) : st;
}

static status stream_read(void *state, mesh_feed *feed) {
    stream_state *s = state;
    const uint64_t quadratic = s->cells[CELL_QUADRATIC_TET];
    if (quadratic && !s->hints->by_corners && !mesh_feed_takes_quadratic(feed))
        return status_describe(ST_UNSUPPORTED,
                               "%s: %llu cells are quadratic tets (--whole-cells takes them as "
                               "they are, --by-corners as linear ones)",
                               s->file, (unsigned long long)quadratic);
    void *buffer = mem_array(s->m, CHUNK, CELL_VERTICES_MAX * sizeof(uint32_t));
    status st = buffer ? expect_points(s, feed) : ST_NOMEM;
    if (s->field_count > 0)
        strcpy(feed->report->field, s->fields[s->taken[0]]);
    for (int i = 0; i < KINDS; i++)
        mesh_feed_expect_cells(feed, s->cells[kinds[i].shape]);
    mesh_feed_expect_cells(feed, s->polyhedra.count);
    s->polyhedra.m = s->m;
    s->polyhedra.data = s->data;
    s->polyhedra.points = s->points;
    s->polyhedra.fields = arrays_of(s) ? s->taken_count : 0;
    if (st == ST_OK)
        st = read_arrays(s, feed, buffer);
    feed->report->by_corners = s->by_corners;
    feed->report->by_corners += s->hints->by_corners ? quadratic : 0;
    feed->report->skipped = s->skipped;
    if (st == ST_OK)
        st = check_end(s);
    mem_free(s->m, buffer);
    return st;
}

static void stream_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const stream_state *s = state;
    for (size_t i = 0; i < s->field_count; i++)
        take(ctx, s->fields[i], 1);
}

const mesh_reader mesh_stream_reader = {.format = "mesh stream",
                                        .known = stream_known,
                                        .open = stream_open,
                                        .read = stream_read,
                                        .close = stream_close,
                                        .take = stream_take,
                                        .fields = stream_fields};
