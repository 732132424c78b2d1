#include "formats/curvilinear/curvilinear_stream.h"

#include <endian.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/sample.h"
#include "formats/curvilinear/curvilinear_source.h"
#include "formats/curvilinear/curvilinear_stream_lines.h"
#include "formats/leaf/curvilinear_zones.h"

enum {
    LINES_MAX = CURVILINEAR_STREAM_FIELDS_MAX + CURVILINEAR_STREAM_ZONES_MAX + 16,
    SPOOL_BYTES = 1 << 20
};
#define NODES_MAX ((uint64_t)1 << 48)

typedef char field_name[CURVILINEAR_NAME_MAX + 1];

struct curvilinear_stream {
    mem *m;
    char *file; /* its name */
    unsigned line;
    char name[CURVILINEAR_NAME_MAX + 1];
    field_name *fields;
    const char **field_names;
    size_t field_count, field_room;
    uint32_t (*nodes)[3];
    size_t zones, zone_room;
    uint64_t *first; /* node of each zone; then the number of all */
    bool blanked;
    uint64_t begin;    /* the place of the first array */
    file *f;           /* a regular file; or NULL, and: */
    out_file *scratch; /* what was behind the header */
};

bool curvilinear_stream_known(const uint8_t *start, size_t size) {
    const size_t length = sizeof CURVILINEAR_LINE_MAGIC - 1;
    return size >= length && memcmp(start, CURVILINEAR_LINE_MAGIC, length) == 0;
}

/* ---- the header ---- */

static status bad_line(const curvilinear_stream *s, const char *text, const char *expected) {
    return status_describe(ST_CORRUPT, "%s: line %u: \"%.40s\", expected %s", s->file, s->line,
                           text, expected);
}

static status check_name(const curvilinear_stream *s, const char *line, const char *value) {
    return *value && strlen(value) <= CURVILINEAR_NAME_MAX
               ? ST_OK
               : bad_line(s, line, "a name of 1 to 63 bytes");
}

static status take_name(curvilinear_stream *s, const char *line, const char *value) {
    if (s->name[0])
        return bad_line(s, line, "each line once");
    const status st = check_name(s, line, value);
    if (st == ST_OK)
        strcpy(s->name, value);
    return st;
}

static status take_field(curvilinear_stream *s, const char *line, const char *value) {
    if (s->field_count == CURVILINEAR_STREAM_FIELDS_MAX)
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

static status take_zone(curvilinear_stream *s, const char *line, const char *value) {
    double sides[3];
    if (s->zones == CURVILINEAR_STREAM_ZONES_MAX)
        return bad_line(s, line, "fewer zones");
    status st = num_doubles(value, "zone", " ", 3, sides);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (!(sides[a] >= 2 && sides[a] <= CURVILINEAR_NODES_MAX && sides[a] == floor(sides[a])))
            st = ST_CORRUPT;
    if (st != ST_OK)
        return bad_line(s, line, "nodes along i, j and k: three whole numbers from 2 on");
    st = mem_grow(s->m, &s->nodes, sizeof *s->nodes, s->zones, 8, &s->zone_room);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        s->nodes[s->zones][a] = (uint32_t)sides[a];
    s->zones += st == ST_OK;
    return st;
}

static status take_blanked(curvilinear_stream *s, const char *line, const char *value) {
    if (s->blanked || strcmp(value, "yes") != 0)
        return bad_line(s, line, "\"" CURVILINEAR_LINE_BLANKED "yes\", once");
    s->blanked = true;
    return ST_OK;
}

static status take_line(curvilinear_stream *s, const char *line) {
    static const struct {
        const char *key;
        status (*take)(curvilinear_stream *s, const char *line, const char *value);
    } keys[] = {{CURVILINEAR_LINE_NAME, take_name},
                {CURVILINEAR_LINE_FIELD, take_field},
                {CURVILINEAR_LINE_ZONE, take_zone},
                {CURVILINEAR_LINE_BLANKED, take_blanked}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const size_t length = strlen(keys[i].key);
        if (strncmp(line, keys[i].key, length) == 0)
            return keys[i].take(s, line, line + length);
    }
    return bad_line(s, line, "name, field, zone, blanked or an empty line");
}

static status next_line(curvilinear_stream *s, byte_stream *data, text_line *line) {
    bool got;
    const status st = byte_stream_line(data, line, &got);
    s->line++;
    return st == ST_OK && !got ? bad_line(s, "", "a line; the file ends here") : st;
}

static status read_lines(curvilinear_stream *s, byte_stream *data, text_line *line) {
    status st = next_line(s, data, line);
    if (st == ST_OK && strcmp(line->text, CURVILINEAR_LINE_MAGIC "1") != 0)
        return status_describe(ST_UNSUPPORTED, "%s: \"%.40s\", expected \"%s1\"", s->file,
                               line->text, CURVILINEAR_LINE_MAGIC);
    while (st == ST_OK && s->line < LINES_MAX) {
        st = next_line(s, data, line);
        if (st == ST_OK && line->length == 0)
            break;
        if (st == ST_OK)
            st = take_line(s, line->text);
    }
    if (st == ST_OK && s->zones == 0)
        st = bad_line(s, line->text, "a line \"" CURVILINEAR_LINE_ZONE "NI NJ NK\" before it");
    return st;
}

/* Count the nodes, and make a list of the names. */
static status settle(curvilinear_stream *s) {
    s->first = mem_array(s->m, s->zones + 1, sizeof *s->first);
    s->field_names = mem_array(s->m, s->field_count + 1, sizeof *s->field_names);
    if (!s->first || !s->field_names)
        return ST_NOMEM;
    for (size_t i = 0; i < s->field_count; i++)
        s->field_names[i] = s->fields[i];
    s->first[0] = 0;
    for (size_t z = 0; z < s->zones; z++) {
        const uint32_t *n = s->nodes[z];
        const uint64_t plane = (uint64_t)n[0] * n[1];
        if (plane > NODES_MAX / n[2] || plane * n[2] > NODES_MAX - s->first[z])
            return status_describe(ST_UNSUPPORTED, "%s: more than 2^48 nodes", s->file);
        s->first[z + 1] = s->first[z] + plane * n[2];
    }
    return ST_OK;
}

/* ---- the arrays ---- */

static uint64_t nodes_of(const curvilinear_stream *s) {
    return s->first[s->zones];
}

static uint64_t bytes_expected(const curvilinear_stream *s) {
    return nodes_of(s) * (12 + (s->blanked ? 1 : 0) + 4 * (uint64_t)s->field_count);
}

static status check_bytes(const curvilinear_stream *s, uint64_t bytes) {
    if (bytes == bytes_expected(s))
        return ST_OK;
    return status_describe(
        ST_CORRUPT, "%s: %llu bytes behind the header, expected %llu for %llu nodes and %zu fields",
        s->file, (unsigned long long)bytes, (unsigned long long)bytes_expected(s),
        (unsigned long long)nodes_of(s), s->field_count);
}

/* ---- what is no regular file ---- */

typedef struct first_output {
    mem *m;
    char *path;
} first_output;

static status take_first(void *ctx, const char *path) {
    first_output *x = ctx;
    if (!x->path)
        x->path = mem_copy_text(x->m, path);
    return x->path ? ST_OK : ST_NOMEM;
}

/* Make a file without a name beside the program's output: of several, the first one. */
static status make_scratch(curvilinear_stream *s) {
    first_output x = {.m = s->m};
    char *beside = NULL;
    status st = file_guard_each_output(s->m, take_first, &x);
    if (st == ST_OK)
        st = out_file_scratch_path(s->m, x.path, "leafcast", &beside);
    if (st == ST_OK)
        st = out_file_scratch(s->m, beside, &s->scratch);
    mem_free(s->m, beside);
    mem_free(s->m, x.path);
    return st;
}

/* Write all that follows to the scratch file, but not more than one byte too many. */
static status spool(curvilinear_stream *s, byte_stream *data) {
    const uint64_t most = bytes_expected(s) + 1;
    void *buffer = mem_alloc(s->m, SPOOL_BYTES);
    status st = buffer ? make_scratch(s) : ST_NOMEM;
    uint64_t done = 0;
    size_t got = 1;
    while (st == ST_OK && got > 0 && done < most) {
        const uint64_t left = most - done;
        st = byte_stream_read(data, buffer, left < SPOOL_BYTES ? (size_t)left : SPOOL_BYTES, &got);
        if (st == ST_OK)
            st = out_file_append(s->scratch, buffer, got);
        done += got;
    }
    mem_free(s->m, buffer);
    return st == ST_OK ? check_bytes(s, done) : st;
}

static status open_arrays(curvilinear_stream *s, byte_stream *data) {
    if (!byte_stream_is_file(data))
        return spool(s, data);
    s->begin = byte_stream_position(data);
    const status st = check_bytes(s, byte_stream_left(data));
    return st == ST_OK ? file_open(s->m, byte_stream_path(data), &s->f) : st;
}

status curvilinear_stream_open(mem *m, byte_stream *data, curvilinear_stream **out) {
    curvilinear_stream *s = *out = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->file = mem_copy_text(m, byte_stream_name(data));
    text_line line = {.m = m};
    status st = s->file ? read_lines(s, data, &line) : ST_NOMEM;
    byte_stream_line_release(&line);
    if (st == ST_OK)
        st = settle(s);
    return st == ST_OK ? open_arrays(s, data) : st;
}

void curvilinear_stream_close(curvilinear_stream *s) {
    if (!s)
        return;
    file_close(s->f);
    out_file_discard(s->scratch);
    mem_free(s->m, s->file);
    mem_free(s->m, s->fields);
    mem_free(s->m, s->field_names);
    mem_free(s->m, s->nodes);
    mem_free(s->m, s->first);
    mem_free(s->m, s);
}

curvilinear_stream_header curvilinear_stream_header_of(const curvilinear_stream *s) {
    return (curvilinear_stream_header){.name = s->name,
                                       .fields = s->field_names,
                                       .field_count = (uint32_t)s->field_count,
                                       .nodes = (const uint32_t(*)[3])s->nodes,
                                       .zones = (uint32_t)s->zones,
                                       .blanked = s->blanked};
}

/* ---- planes ---- */

/* Nodes of a run of planes, from the first node of all on. */
typedef struct nodes {
    uint64_t first;
    size_t count;
} nodes;

static nodes planes_of(const curvilinear_stream *s, uint32_t zone, uint32_t first, uint32_t count) {
    const uint64_t plane = (uint64_t)s->nodes[zone][0] * s->nodes[zone][1];
    return (nodes){s->first[zone] + plane * first, (size_t)(plane * count)};
}

/* Read an array's bytes. array: the bytes of those before it. */
static status read_array(curvilinear_stream *s, uint64_t array, nodes n, size_t width, void *to) {
    const uint64_t at = s->begin + array + n.first * width;
    return s->f ? file_read_at(s->f, at, to, n.count * width)
                : out_file_read_at(s->scratch, at, to, n.count * width);
}

static void from_file(float *numbers, size_t count) {
    if (__BYTE_ORDER == __BIG_ENDIAN)
        sample_swap(SAMPLE_F32, numbers, count);
}

static status bad_node(const curvilinear_stream *s, uint64_t node, const char *what) {
    return status_describe(ST_CORRUPT, "%s: node %llu (counted from 0) %s", s->file,
                           (unsigned long long)node, what);
}

status curvilinear_stream_read_places(curvilinear_stream *s, uint32_t zone, uint32_t first,
                                      uint32_t count, float (*p)[3]) {
    const nodes n = planes_of(s, zone, first, count);
    const status st = read_array(s, 0, n, sizeof *p, p);
    from_file(*p, 3 * n.count);
    for (size_t i = 0; i < n.count && st == ST_OK; i++)
        if (!isfinite(p[i][0]) || !isfinite(p[i][1]) || !isfinite(p[i][2]))
            return bad_node(s, n.first + i, "has a place that is not finite");
    return st;
}

status curvilinear_stream_read_blanks(curvilinear_stream *s, uint32_t zone, uint32_t first,
                                      uint32_t count, uint8_t *is_node) {
    const nodes n = planes_of(s, zone, first, count);
    const status st = read_array(s, 12 * nodes_of(s), n, 1, is_node);
    for (size_t i = 0; i < n.count && st == ST_OK; i++)
        if (is_node[i] > (CURVILINEAR_NODE | CURVILINEAR_HIDDEN) ||
            is_node[i] == CURVILINEAR_HIDDEN)
            return bad_node(s, n.first + i, "has a mark that is none of 0, 1 and 3");
    return st;
}

status curvilinear_stream_read_values(curvilinear_stream *s, uint32_t zone, uint32_t field,
                                      uint32_t first, uint32_t count, float *values) {
    const nodes n = planes_of(s, zone, first, count);
    const uint64_t before = nodes_of(s) * (12 + (s->blanked ? 1 : 0) + 4 * (uint64_t)field);
    const status st = read_array(s, before, n, sizeof *values, values);
    from_file(values, n.count);
    return st;
}

/* ---- the row ---- */

static bool known(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    (void)bytes;
    return curvilinear_stream_known(start, size);
}

static void take_header(curvilinear_opening *o, const curvilinear_stream *s) {
    const curvilinear_stream_header h = curvilinear_stream_header_of(s);
    o->zones = h.zones;
    o->nodes = h.nodes;
    o->blanked = h.blanked;
    o->fields = h.field_count;
    strcpy(o->name, h.name);
}

static status open_stream(curvilinear_opening *o, void **state) {
    curvilinear_stream *s = NULL;
    const status st = curvilinear_stream_open(o->m, o->data, &s);
    *state = s;
    if (st == ST_OK)
        take_header(o, s);
    return st;
}

static void close_stream(void *state) {
    curvilinear_stream_close(state);
}

static const char *field(void *state, uint32_t number, uint32_t *components) {
    const curvilinear_stream *s = state;
    *components = 1;
    return s->fields[number];
}

static status places(void *state, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    return curvilinear_stream_read_places(state, zone, first, count, p);
}

static status values(void *state, uint32_t zone, uint32_t number, uint32_t component,
                     uint32_t first, uint32_t count, float *to) {
    (void)component;
    return curvilinear_stream_read_values(state, zone, number, first, count, to);
}

static status blanks(void *state, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node) {
    return curvilinear_stream_read_blanks(state, zone, first, count, is_node);
}

const curvilinear_reader curvilinear_stream_reader = {.format = "curvilinear stream",
                                                      .any_stream = true,
                                                      .known = known,
                                                      .open = open_stream,
                                                      .close = close_stream,
                                                      .field = field,
                                                      .places = places,
                                                      .values = values,
                                                      .blanks = blanks};
