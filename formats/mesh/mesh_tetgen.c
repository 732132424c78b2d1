#include "formats/mesh/mesh_tetgen.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/named_file.h"
#include "formats/input/text_tokens.h"
#include "formats/mesh/mesh_average.h"
#include "formats/mesh/mesh_choice.h"

typedef struct tetgen_state {
    mem *m;
    byte_stream *other; /* the file that was not named; ours to close */
    text_tokens nodes, tets;
    const mesh_hints *hints;
    char *other_path;
    mesh_tetgen_columns has;
    int64_t cells, cell_columns; /* columns behind a b c d */
    int64_t first;               /* id of the first point */
    /* Columns taken, from 0: of the points' attributes and marker, or of the tets' columns. */
    int *columns;
    uint32_t count;                /* 0: there is none */
    double *row;                   /* all columns of a point or tet */
    char field[MESH_NAME_MAX + 1]; /* name of the first */
} tetgen_state;

static bool tetgen_known(const char *path, const uint8_t *start, size_t size) {
    (void)start;
    (void)size;
    return text_ends_in(path, ".node") || text_ends_in(path, ".ele");
}

/* ---- headers ---- */

status mesh_tetgen_points(text_tokens *t, uint64_t most, mesh_tetgen_columns *out) {
    int64_t dimensions;
    status st = text_tokens_int(t, "the number of points", 0, (int64_t)most, &out->points);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of dimensions, 3", 0, 100, 3, &dimensions);
    if (st == ST_OK && dimensions != 3)
        return status_describe(ST_UNSUPPORTED, "%s: points of %d dimensions, expected 3",
                               byte_stream_name(t->s), (int)dimensions);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of attributes", 0, MESH_TETGEN_ATTRIBUTES_MAX, 0,
                                  &out->attributes);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of markers, 0 or 1", 0, 1, 0, &out->markers);
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_tet_header(tetgen_state *s) {
    text_tokens *t = &s->tets;
    int64_t corners;
    status st = text_tokens_int(t, "the number of tets", 0, INT64_MAX, &s->cells);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of nodes of a tet, 4", 0, 100, 4, &corners);
    if (st == ST_OK && corners != 4)
        return status_describe(ST_UNSUPPORTED, "%s: tets of %d nodes, expected 4",
                               byte_stream_name(t->s), (int)corners);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of attributes", 0, MESH_TETGEN_ATTRIBUTES_MAX, 0,
                                  &s->cell_columns);
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

/* ---- the field ---- */

/* Returns K of "attrK" or "K", from 1; 0 when the name is neither. */
static int64_t column_number(const char *field, const char *prefix) {
    size_t length = strlen(prefix);
    int64_t k = 0;
    const char *digits = strncmp(field, prefix, length) == 0 ? field + length : field;
    return num_int(digits, "", 1, MESH_TETGEN_ATTRIBUTES_MAX, &k) == ST_OK ? k : 0;
}

static void add_columns(name_list *names, const char *prefix, int64_t count) {
    for (int k = 1; k <= count; k++) {
        char name[MESH_NAME_MAX + 1];
        snprintf(name, sizeof name, "%s%d", prefix, k);
        name_list_add(names, name);
    }
}

/* Markers are taken by name alone. So a file with nothing else has no field. */
static status no_field(const tetgen_state *s, const mesh_hints *asked) {
    name_list points = {0}, cells = {0};
    add_columns(&points, "attr", s->has.attributes);
    if (s->has.markers && (asked->field || asked->cells_to_points || s->cell_columns))
        name_list_add(&points, "marker");
    add_columns(&cells, "region", s->cell_columns);
    const text_tokens *t = asked->cells_to_points ? &s->tets : &s->nodes;
    return mesh_choice_missing(byte_stream_name(t->s), asked, &points, &cells);
}

/* Returns the column asked for, and puts its name into `called`; -1: there is none. */
static int find_column(const tetgen_state *s, const mesh_hints *asked,
                       char called[MESH_NAME_MAX + 1]) {
    const bool cells = asked->cells_to_points;
    const char *prefix = cells ? "region" : "attr";
    int64_t k = 1;
    if (asked->field && !cells && strcmp(asked->field, "marker") == 0 && s->has.markers) {
        strcpy(called, "marker");
        return (int)s->has.attributes;
    }
    if (asked->field && !(cells && strcmp(asked->field, "region") == 0))
        k = column_number(asked->field, prefix);
    if (k < 1 || k > (cells ? s->cell_columns : s->has.attributes))
        return -1;
    snprintf(called, MESH_NAME_MAX + 1, "%s%d", prefix, (int)k);
    return (int)k - 1;
}

/* Take the column of this name; NULL: the first. */
static status take_column(tetgen_state *s, const char *name) {
    char called[MESH_NAME_MAX + 1];
    mesh_hints asked = *s->hints;
    asked.field = name;
    const int column = find_column(s, &asked, called);
    if (column < 0)
        return no_field(s, &asked);
    if (s->count == 0)
        memcpy(s->field, called, sizeof s->field);
    s->columns[s->count++] = column;
    return mesh_choice_component(byte_stream_name(s->nodes.s), &asked, called, 1);
}

static status tetgen_take(void *state, const char *const *names, uint32_t count) {
    tetgen_state *s = state;
    mem_free(s->m, s->columns);
    s->count = 0;
    s->columns = mem_array(s->m, count, sizeof *s->columns);
    status st = s->columns ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        st = take_column(s, names[i]);
    return st;
}

/* ---- opening ---- */

/* Open F.ele for F.node, or F.node for F.ele, packed alike. kind: the path without the suffix of
 * packed files. */
static status open_other(tetgen_state *s, const char *path, const char *kind) {
    const bool nodes = text_ends_in(kind, ".node");
    const size_t stem = strlen(kind) - (nodes ? 5 : 4), room = strlen(path) + 2;
    s->other_path = mem_alloc(s->m, room);
    if (!s->other_path)
        return ST_NOMEM;
    snprintf(s->other_path, room, "%.*s%s%s", (int)stem, path, nodes ? ".ele" : ".node",
             path + strlen(kind));
    status st = named_file_implied(s->other_path);
    return st == ST_OK ? byte_stream_open(s->m, s->other_path, &s->other) : st;
}

static status make_row(tetgen_state *s) {
    const int64_t columns = s->has.attributes + s->has.markers;
    s->row = mem_array(s->m, (size_t)(columns > s->cell_columns ? columns : s->cell_columns) + 1,
                       sizeof *s->row);
    return s->row ? ST_OK : ST_NOMEM;
}

static status tetgen_open(mesh_source *source, void **state) {
    tetgen_state *s = mem_zalloc(source->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *state = s;
    s->m = source->m;
    s->hints = &source->hints;
    status st = open_other(s, source->path, byte_stream_kind(source->data));
    if (st != ST_OK)
        return st;
    bool node = text_ends_in(byte_stream_kind(source->data), ".node");
    s->nodes = (text_tokens){
        .s = node ? source->data : s->other, .line = 1, .comment = '#', .commas = true};
    s->tets = s->nodes;
    s->tets.s = node ? s->other : source->data;
    st = mesh_tetgen_points(&s->nodes, MESH_POINTS_MAX, &s->has);
    if (st == ST_OK)
        st = read_tet_header(s);
    return st == ST_OK ? make_row(s) : st;
}

static void tetgen_close(void *state) {
    tetgen_state *s = state;
    if (!s)
        return;
    byte_stream_close(s->other);
    mem_free(s->m, s->other_path);
    mem_free(s->m, s->columns);
    mem_free(s->m, s->row);
    mem_free(s->m, s);
}

/* ---- reading ---- */

/* Read a row's id. Ids must not have gaps; the first row's sets where they start. */
static status read_id(text_tokens *t, int64_t row, int64_t *first) {
    int64_t id;
    status st = text_tokens_int(t, "an id", INT64_MIN, INT64_MAX, &id);
    if (st != ST_OK)
        return st;
    if (row == 0 && *first < 0 && id != 0 && id != 1)
        return text_tokens_fault(t, "0 or 1, the first id");
    if (row == 0 && *first < 0)
        *first = id;
    if (id != row + *first)
        return text_tokens_fault(t, "id %lld, they have no gaps", (long long)(row + *first));
    return ST_OK;
}

/* Read columns up to the line's end. */
static status read_columns(text_tokens *t, int64_t count, double *row) {
    status st = ST_OK;
    for (int64_t i = 0; st == ST_OK && i < count; i++)
        st = text_tokens_double_here(t, "an attribute or marker", &row[i]);
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status feed_row(const tetgen_state *s, mesh_feed *feed) {
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < s->count; k++)
        st = mesh_feed_value(feed, k, s->row[s->columns[k]]);
    return st;
}

static status read_nodes(tetgen_state *s, mesh_feed *feed) {
    status st = ST_OK;
    s->first = -1;
    for (int64_t i = 0; st == ST_OK && i < s->has.points; i++) {
        double xyz[3] = {0};
        st = read_id(&s->nodes, i, &s->first);
        for (int a = 0; st == ST_OK && a < 3; a++)
            st = text_tokens_double_here(&s->nodes, "a coordinate", &xyz[a]);
        if (st == ST_OK)
            st = read_columns(&s->nodes, s->has.attributes + s->has.markers, s->row);
        if (st == ST_OK)
            st = mesh_feed_point(feed, xyz);
        if (st == ST_OK && !s->hints->cells_to_points)
            st = feed_row(s, feed);
    }
    return st;
}

static status read_tets(tetgen_state *s, mesh_feed *feed, mesh_average *average) {
    status st = ST_OK;
    int64_t first = -1;
    text_tokens *t = &s->tets;
    for (int64_t i = 0; st == ST_OK && i < s->cells; i++) {
        uint64_t ids[4];
        st = read_id(t, i, &first);
        for (int c = 0; st == ST_OK && c < 4; c++) {
            int64_t id = 0;
            st = text_tokens_int(t, "the id of a point", INT64_MIN, INT64_MAX, &id);
            ids[c] = (uint64_t)id - (uint64_t)s->first; /* an id below the first wraps: no point */
        }
        if (st == ST_OK)
            st = read_columns(t, s->cell_columns, s->row);
        for (uint32_t k = 0; st == ST_OK && average && k < s->count; k++)
            mesh_average_add(average, k, CELL_TET, ids, s->row[s->columns[k]]);
        if (st == ST_OK)
            st = mesh_feed_cell(feed, CELL_TET, ids);
    }
    return st;
}

static status check_end(text_tokens *t) {
    status st = text_tokens_next(t);
    return st == ST_OK && t->token[0]
               ? text_tokens_fault(t, "the end: there are no more rows by the header")
               : st;
}

static status read_both(tetgen_state *s, mesh_feed *feed, mesh_average *average) {
    status st = read_nodes(s, feed);
    if (st == ST_OK)
        st = check_end(&s->nodes);
    if (st == ST_OK)
        st = read_tets(s, feed, average);
    if (st == ST_OK)
        st = check_end(&s->tets);
    if (st == ST_OK && average)
        st = mesh_average_feed(average, feed, 0);
    else if (st == ST_OK && s->count == 0)
        st = mesh_feed_zeros(feed);
    return st;
}

static status tetgen_read(void *state, mesh_feed *feed) {
    tetgen_state *s = state;
    mesh_average average = {0};
    strcpy(feed->report->field, s->field);
    mesh_feed_expect_cells(feed, (uint64_t)s->cells);
    status st = mesh_feed_expect(feed, (uint64_t)s->has.points);
    if (st == ST_OK && s->hints->cells_to_points)
        st = mesh_average_begin(&average, s->m, (uint64_t)s->has.points, s->count);
    if (st == ST_OK)
        st = read_both(s, feed, average.m ? &average : NULL);
    mesh_average_release(&average);
    return st;
}

static void tetgen_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const tetgen_state *s = state;
    const bool cells = s->hints->cells_to_points;
    for (int k = 1; k <= (cells ? s->cell_columns : s->has.attributes); k++) {
        char name[MESH_NAME_MAX + 1];
        snprintf(name, sizeof name, "%s%d", cells ? "region" : "attr", k);
        take(ctx, name, 1);
    }
}

const mesh_reader mesh_tetgen_reader = {.format = "TetGen",
                                        .known = tetgen_known,
                                        .open = tetgen_open,
                                        .read = tetgen_read,
                                        .close = tetgen_close,
                                        .take = tetgen_take,
                                        .fields = tetgen_fields};
