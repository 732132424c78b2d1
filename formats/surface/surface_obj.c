#include "formats/surface/surface_obj.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/input/text_number.h"
#include "formats/surface/obj_normals.h"
#include "formats/surface/surface_colour.h"
#include "formats/surface/surface_flow.h"

enum { NUMBERS = 7 }; /* of a vertex */

typedef struct obj {
    surface_choice choice;
    mem *m;
    byte_stream *s;
    text_line line;      /* the last one read */
    text_line statement; /* several, joined by a backslash at their ends */
    uint64_t number;     /* of the line, from 1 */
    char *held;          /* the first vertex's statement, read by open() */
    uint64_t points;
    obj_normals normals;
    uint64_t *ids;
    size_t corners, room;
    uint64_t highest, highest_line; /* of the faces' vertices: the largest number, from 1 */
} obj;

static status __attribute__((format(printf, 2, 3))) fault(const obj *o, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(ST_CORRUPT, "%s: line %llu: %s", byte_stream_name(o->s),
                           (unsigned long long)o->number, text);
}

/* ---- statements ---- */

static bool goes_on(const text_line *l) {
    return l->length > 0 && l->text[l->length - 1] == '\\';
}

/* Append the line to the statement, without its backslash. */
static status append(obj *o) {
    text_line *to = &o->statement;
    const size_t length = o->line.length - goes_on(&o->line), need = to->length + length + 2;
    if (need > TEXT_LINE_MAX)
        return fault(o, "a statement of up to %d bytes expected", TEXT_LINE_MAX);
    if (need > to->room) {
        char *larger = mem_alloc(o->m, 2 * need);
        if (!larger)
            return ST_NOMEM;
        memcpy(larger, to->text, to->length);
        mem_free(o->m, to->text);
        to->text = larger;
        to->room = 2 * need;
    }
    memcpy(to->text + to->length, o->line.text, length);
    to->length += length;
    to->text[to->length++] = ' ';
    to->text[to->length] = 0;
    return ST_OK;
}

/* Read the next statement; *text: NULL at the end. */
static status next_statement(obj *o, char **text) {
    bool got = true, more = true;
    *text = NULL;
    status st = byte_stream_line(o->s, &o->line, &got);
    o->number += got;
    if (st != ST_OK || !got)
        return st;
    *text = o->line.text;
    if (!goes_on(&o->line))
        return ST_OK;
    o->statement.length = 0;
    if (!o->statement.text) {
        o->statement.text = mem_alloc(o->m, 256);
        o->statement.room = o->statement.text ? 256 : 0;
    }
    st = o->statement.text ? ST_OK : ST_NOMEM;
    while (st == ST_OK && more) {
        st = append(o);
        more = got && goes_on(&o->line);
        if (st == ST_OK && more)
            st = byte_stream_line(o->s, &o->line, &got);
        more = more && got;
        o->number += more;
    }
    *text = o->statement.text;
    return st;
}

/* Returns the next word and ends it with a NUL; NULL: there is none. */
static char *next_word(char **at) {
    char *word = *at + strspn(*at, " \t\r\v\f");
    if (!*word || *word == '#')
        return NULL;
    char *end = word + strcspn(word, " \t\r\v\f");
    *at = end + (*end != 0);
    *end = 0;
    return word;
}

/* ---- vertices ---- */

static status read_vertex(obj *o, char *at, double numbers[NUMBERS], int *count) {
    char *word;
    for (*count = 0; (word = next_word(&at)); ++*count)
        if (*count == NUMBERS || !text_number_double(word, &numbers[*count]))
            return fault(o, "\"%.60s\", expected v and 3 numbers, 4, or 6 with a colour", word);
    if (*count < 3 || *count == 5)
        return fault(o, "%d numbers of a vertex, expected 3, 4, or 6 with a colour", *count);
    return ST_OK;
}

/* Numbers of a colour come last, behind a weight if there are seven. */
/* A vertex without a colour in a file with some is white, as a part of glTF without one. */
static status put_vertex(obj *o, surface_flow *flow, char *at) {
    double numbers[NUMBERS] = {0};
    int count = 0;
    status st = read_vertex(o, at, numbers, &count);
    if (st == ST_OK)
        st = surface_flow_point(flow, numbers);
    o->points++;
    const double colour =
        count >= 6 ? surface_colour_value(numbers + count - 3, 1) : (double)0xffffff;
    for (uint32_t k = 0; st == ST_OK && k < o->choice.taken_count; k++)
        st = surface_flow_value(flow, k, colour);
    return st == ST_OK ? obj_normals_vertex(&o->normals, numbers, colour) : st;
}

/* Of any length; more numbers than three are passed over. */
static status put_normal(obj *o, char *at) {
    double normal[3];
    for (int a = 0; a < 3; a++) {
        const char *word = next_word(&at);
        if (!word || !text_number_double(word, &normal[a]))
            return fault(o, "\"%.60s\", expected vn and 3 numbers", word ? word : "");
    }
    return obj_normals_add(&o->normals, normal);
}

/* ---- faces ---- */

/* Returns whether a word is "7", "7/8", "7/8/9" or "7//9"; *id: its first number; *normal: its
 * third one, or 0. */
static bool parse_corner(char *word, int64_t *id, int64_t *normal) {
    char *slash = strchr(word, '/'), *third = slash ? strchr(slash + 1, '/') : NULL;
    *normal = 0;
    if (slash && strspn(slash, "/-0123456789") != strlen(slash))
        return false;
    if (third && third[1] && !text_number_int(third + 1, INT64_MIN / 2, INT64_MAX / 2, normal))
        return false;
    if (slash)
        *slash = 0;
    return text_number_int(word, INT64_MIN / 2, INT64_MAX / 2, id);
}

/* Negative numbers count back from the last vertex. */
static uint64_t id_of(obj *o, int64_t number) {
    if (number < 0)
        return (uint64_t)-number <= o->points ? o->points - (uint64_t)-number : UINT64_MAX;
    if ((uint64_t)number > o->highest) {
        o->highest = (uint64_t)number;
        o->highest_line = o->number;
    }
    return number > 0 ? (uint64_t)number - 1 : UINT64_MAX;
}

/* Set the id of a corner to that of the point with its normal. */
static status take_normal(obj *o, int64_t number, uint64_t *id) {
    const uint64_t count = o->normals.count, back = (uint64_t)-number;
    uint64_t normal = UINT64_MAX;
    if (count == 0)
        return ST_OK;
    if (o->highest > o->points)
        return fault(o,
                     "a face of vertex %llu of %llu so far, expected vertices before faces, as "
                     "there are normals",
                     (unsigned long long)o->highest, (unsigned long long)o->points);
    if (number > 0)
        normal = (uint64_t)number - 1;
    else if (number < 0 && back <= count)
        normal = count - back;
    if (number != 0 && normal >= count)
        return fault(o, "normal %lld of a face, expected one of %llu before it", (long long)number,
                     (unsigned long long)count);
    return obj_normals_point(&o->normals, *id, normal, id);
}

static status put_face(obj *o, surface_flow *flow, char *at) {
    char *word;
    for (o->corners = 0; (word = next_word(&at));) {
        int64_t number, normal;
        if (!parse_corner(word, &number, &normal))
            return fault(o, "\"%.60s\", expected the number of a vertex, as 7, 7/8, 7/8/9 or 7//9",
                         word);
        if (o->corners == SURFACE_CORNERS_MAX)
            return fault(o, "a face of more than %d corners", SURFACE_CORNERS_MAX);
        status st = mem_grow(o->m, &o->ids, sizeof *o->ids, o->corners, 16, &o->room);
        if (st != ST_OK)
            return st;
        o->ids[o->corners] = id_of(o, number);
        st = take_normal(o, normal, &o->ids[o->corners++]);
        if (st != ST_OK)
            return st;
    }
    return o->corners >= 3 ? surface_flow_polygon(flow, o->ids, o->corners, NULL)
                           : fault(o, "a face of %zu corners, expected 3 or more", o->corners);
}

static status put_statement(obj *o, surface_flow *flow, char *at) {
    static const char *const skipped[] = {"p", "l", "curv", "curv2", "surf"};
    const char *word = next_word(&at);
    if (!word)
        return ST_OK;
    if (strcmp(word, "v") == 0)
        return put_vertex(o, flow, at);
    if (strcmp(word, "vn") == 0)
        return put_normal(o, at);
    if (strcmp(word, "f") == 0 || strcmp(word, "fo") == 0)
        return put_face(o, flow, at);
    for (size_t i = 0; i < sizeof skipped / sizeof *skipped; i++)
        if (strcmp(word, skipped[i]) == 0)
            surface_flow_skip(flow, 1);
    return ST_OK;
}

/* A number of a vertex that never came is only now known to be wrong. */
static status check_faces(const obj *o) {
    if (o->highest <= o->points)
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: line %llu: a face of vertex %llu, but there are %llu",
                           byte_stream_name(o->s), (unsigned long long)o->highest_line,
                           (unsigned long long)o->highest, (unsigned long long)o->points);
}

/* ---- the reader ---- */

static bool is_statement(const char *line, size_t length) {
    static const char *const words[] = {"#",  "v ", "vt ",    "vn ",     "vp ", "f ", "g",
                                        "o ", "s ", "mtllib", "usemtl ", "l ",  "p ", "\r"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (length >= strlen(words[i]) && memcmp(line, words[i], strlen(words[i])) == 0)
            return true;
    return length == 0;
}

/* Text without a suffix: each whole line is a statement, one of them a vertex. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    bool vertex = false;
    const char *at = (const char *)start, *end = at + size, *feed;
    if (text_ends_in(path, ".obj"))
        return true;
    for (; at < end && (feed = memchr(at, '\n', (size_t)(end - at))); at = feed + 1) {
        if (!is_statement(at, (size_t)(feed - at)))
            return false;
        vertex = vertex || (at[0] == 'v' && at[1] == ' ');
    }
    return vertex;
}

/* Read up to the first vertex, which says whether there are colours. */
static status find_vertex(obj *o) {
    char *text = NULL;
    status st = next_statement(o, &text);
    for (; st == ST_OK && text && !o->held;) {
        const char *at = text + strspn(text, " \t");
        if (at[0] == 'f' && (at[1] == ' ' || at[1] == '\t'))
            return fault(o, "a face, expected a vertex before the first one");
        if (at[0] == 'v' && (at[1] == ' ' || at[1] == '\t'))
            o->held = text;
        else
            st = next_statement(o, &text);
    }
    if (st == ST_OK && !o->held)
        return status_describe(ST_CORRUPT, "%s: ends at line %llu, expected vertices",
                               byte_stream_name(o->s), (unsigned long long)o->number);
    return st;
}

static status open_file(mesh_source *source, void **state) {
    obj *o = mem_zalloc(source->m, sizeof *o);
    char *copy = NULL;
    double numbers[NUMBERS];
    int count = 0;
    if (!o)
        return ST_NOMEM;
    *state = o;
    o->m = o->line.m = o->statement.m = source->m;
    o->s = source->data;
    o->choice.source = source;
    status st = find_vertex(o);
    if (st == ST_OK)
        st = (copy = mem_copy_text(o->m, o->held)) ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = read_vertex(o, copy + strspn(copy, " \t") + 1, numbers, &count);
    mem_free(o->m, copy);
    const surface_field rgb = {.name = COLOUR_FIELD, .components = 1, .colour = true};
    return st == ST_OK && count >= 6 ? surface_choice_add(&o->choice, &rgb) : st;
}

static status pass(void *state, surface_flow *flow) {
    obj *o = state;
    char *text = o->held;
    status st = surface_flow_piece(flow, UINT64_MAX);
    obj_normals_begin(&o->normals, o->m, flow, o->choice.taken_count > 0);
    while (st == ST_OK && text) {
        st = put_statement(o, flow, text);
        if (st == ST_OK)
            st = next_statement(o, &text);
    }
    if (st == ST_OK)
        st = check_faces(o);
    if (st == ST_OK)
        st = obj_normals_end(&o->normals);
    return st == ST_OK ? surface_flow_end_piece(flow) : st;
}

static status read(void *state, mesh_feed *feed) {
    obj *o = state;
    surface_flow_expect_polygons(&o->choice, feed);
    return surface_flow_run(&o->choice, feed, UINT64_MAX, false, pass, o);
}

static void close_file(void *state) {
    obj *o = state;
    if (!o)
        return;
    surface_choice_release(&o->choice);
    byte_stream_line_release(&o->line);
    byte_stream_line_release(&o->statement);
    obj_normals_release(&o->normals);
    mem_free(o->m, o->ids);
    mem_free(o->m, o);
}

const mesh_reader surface_obj_reader = {.format = "OBJ",
                                        .known = known,
                                        .open = open_file,
                                        .read = read,
                                        .close = close_file,
                                        .take = surface_choice_take,
                                        .fields = surface_choice_fields};
