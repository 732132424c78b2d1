#include "formats/surface/surface_off.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/input/text_number.h"
#include "formats/input/text_tokens.h"
#include "formats/surface/surface_colour.h"
#include "formats/surface/surface_flow.h"

typedef struct off {
    surface_choice choice;
    mem *m;
    text_tokens t;
    bool texture, colours, normals;
    int64_t vertices, faces;
    uint64_t *ids;
    size_t room;
} off;

/* ---- the header ---- */

/* Returns whether a word is OFF with letters for what vertices have; notes them in o if not NULL.
 */
static bool parse_word(const char *word, off *o) {
    const bool texture = strncmp(word, "ST", 2) == 0;
    word += 2 * texture;
    const bool colours = *word == 'C';
    word += colours;
    const bool normals = *word == 'N';
    word += normals;
    if (o) {
        o->texture = texture;
        o->colours = colours;
        o->normals = normals;
    }
    return strcmp(word, "OFF") == 0;
}

static status skip_line(text_tokens *t) {
    bool more;
    status st = text_tokens_more(t, &more);
    while (st == ST_OK && more) {
        st = text_tokens_next(t);
        if (st == ST_OK)
            st = text_tokens_more(t, &more);
    }
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status check_word(off *o) {
    const char *word = o->t.token, *file = byte_stream_name(o->t.s);
    if (parse_word(word, o))
        return ST_OK;
    const size_t length = strlen(word);
    if (length > 3 && length < 9 && strcmp(word + length - 3, "OFF") == 0 && strpbrk(word, "4n"))
        return status_describe(ST_UNSUPPORTED, "%s: %s, of other dimensions; expected OFF of three",
                               file, word);
    return text_tokens_fault(&o->t, "OFF, COFF, NOFF or STOFF");
}

static status check_counts(const off *o) {
    const uint64_t left = byte_stream_left(o->t.s),
                   least = 6 * (uint64_t)o->vertices + 2 * (uint64_t)o->faces;
    if (left == UINT64_MAX || least <= left + 2)
        return ST_OK;
    return status_describe(
        ST_CORRUPT, "%s: the header says %lld vertices and %lld faces, but only %llu bytes follow",
        byte_stream_name(o->t.s), (long long)o->vertices, (long long)o->faces,
        (unsigned long long)left);
}

static status read_header(off *o) {
    text_tokens *t = &o->t;
    status st = text_tokens_next(t);
    if (st == ST_OK)
        st = check_word(o);
    if (st == ST_OK)
        st = text_tokens_next(t);
    if (st == ST_OK && strcmp(t->token, "BINARY") == 0)
        return status_describe(ST_UNSUPPORTED, "%s: binary OFF, expected OFF in text",
                               byte_stream_name(t->s));
    if (st == ST_OK && !text_number_int(t->token, 0, (int64_t)1 << 40, &o->vertices))
        return text_tokens_fault(t, "the number of vertices");
    if (st == ST_OK)
        st = text_tokens_int(t, "the number of faces", 0, (int64_t)1 << 40, &o->faces);
    if (st == ST_OK)
        st = skip_line(t);
    return st == ST_OK ? check_counts(o) : st;
}

/* ---- vertices ---- */

static status skip_numbers(text_tokens *t, int count, const char *what) {
    double number;
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < count; i++)
        st = text_tokens_double_here(t, what, &number);
    return st;
}

static status read_colour(text_tokens *t, double *out) {
    double rgb[3] = {0};
    bool real = false;
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < 3; i++) {
        st = text_tokens_double_here(t, "a number of a colour", &rgb[i]);
        real = real || strpbrk(t->token, ".eE");
    }
    *out = surface_colour_value(rgb, real ? 1 : 255);
    return st;
}

static status put_vertex(off *o, surface_flow *flow) {
    text_tokens *t = &o->t;
    double xyz[3] = {0}, colour = 0;
    status st = text_tokens_double(t, "a coordinate", &xyz[0]);
    for (int a = 1; st == ST_OK && a < 3; a++)
        st = text_tokens_double_here(t, "a coordinate", &xyz[a]);
    if (st == ST_OK && o->normals)
        st = skip_numbers(t, 3, "a number of a normal");
    if (st == ST_OK && o->colours)
        st = read_colour(t, &colour);
    if (st == ST_OK)
        st = surface_flow_point(flow, xyz);
    for (uint32_t k = 0; st == ST_OK && k < o->choice.taken_count; k++)
        st = surface_flow_value(flow, k, colour);
    return st == ST_OK ? skip_line(t) : st;
}

/* ---- faces ---- */

static status put_face(off *o, surface_flow *flow) {
    text_tokens *t = &o->t;
    int64_t corners, id;
    status st =
        text_tokens_int(t, "the number of a face's vertices", 0, SURFACE_CORNERS_MAX, &corners);
    for (int64_t c = 0; st == ST_OK && c < corners; c++) {
        st =
            text_tokens_int(t, "the number of a vertex, counted from 0", INT64_MIN, INT64_MAX, &id);
        if (st == ST_OK)
            st = mem_grow(o->m, &o->ids, sizeof *o->ids, (size_t)c, 16, &o->room);
        if (st == ST_OK)
            o->ids[c] = (uint64_t)id;
    }
    if (st == ST_OK)
        st = surface_flow_polygon(flow, o->ids, (size_t)corners, NULL);
    return st == ST_OK ? skip_line(t) : st;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    char word[10];
    size_t length = 0;
    while (length < size && length < sizeof word - 1 && start[length] > ' ') {
        word[length] = (char)start[length];
        length++;
    }
    word[length] = 0;
    return parse_word(word, NULL) || text_ends_in(path, ".off");
}

static status open_file(mesh_source *source, void **state) {
    off *o = mem_zalloc(source->m, sizeof *o);
    if (!o)
        return ST_NOMEM;
    *state = o;
    o->m = source->m;
    o->choice.source = source;
    o->t = (text_tokens){.s = source->data, .line = 1, .comment = '#'};
    status st = read_header(o);
    const surface_field rgb = {.name = COLOUR_FIELD, .components = 1, .colour = true};
    return st == ST_OK && o->colours ? surface_choice_add(&o->choice, &rgb) : st;
}

static status pass(void *state, surface_flow *flow) {
    off *o = state;
    status st = surface_flow_piece(flow, (uint64_t)o->vertices);
    for (int64_t i = 0; st == ST_OK && i < o->vertices; i++)
        st = put_vertex(o, flow);
    for (int64_t i = 0; st == ST_OK && i < o->faces; i++)
        st = put_face(o, flow);
    return st == ST_OK ? surface_flow_end_piece(flow) : st;
}

static status read(void *state, mesh_feed *feed) {
    off *o = state;
    mesh_feed_expect_cells(feed, (uint64_t)o->faces);
    surface_flow_expect_polygons(&o->choice, feed);
    return surface_flow_run(&o->choice, feed, (uint64_t)o->vertices, false, pass, o);
}

static void counts(const void *state, uint64_t *points, uint64_t *cells) {
    const off *o = state;
    *points = (uint64_t)o->vertices;
    *cells = (uint64_t)o->faces;
}

static void close_file(void *state) {
    off *o = state;
    if (!o)
        return;
    surface_choice_release(&o->choice);
    mem_free(o->m, o->ids);
    mem_free(o->m, o);
}

const mesh_reader surface_off_reader = {.format = "OFF",
                                        .known = known,
                                        .open = open_file,
                                        .read = read,
                                        .close = close_file,
                                        .take = surface_choice_take,
                                        .fields = surface_choice_fields,
                                        .counts = counts};
