#include "formats/surface/plc_tetgen.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/named_file.h"
#include "formats/input/text_tokens.h"
#include "formats/mesh/mesh_tetgen.h"

typedef struct nodes {
    mesh_tetgen_columns has;
    int64_t first; /* id of the first point, 0 or 1 */
    int column;    /* column of the field; -1: none */
} nodes;

static status skip_line(text_tokens *t) {
    char rest[1024];
    return text_tokens_rest(t, rest, sizeof rest);
}

/* ---- points ---- */

static status choose_field(const plc_source *s, nodes *n) {
    const char *field = s->hints.field;
    int64_t k = 1;
    n->column = -1;
    if (!field && n->has.attributes == 0)
        return ST_OK;
    if (field && strcmp(field, "marker") == 0 && n->has.markers) {
        n->column = (int)n->has.attributes;
        strcpy(s->out->field, "marker");
        return ST_OK;
    }
    const char *digits = field && strncmp(field, "attr", 4) == 0 ? field + 4 : field;
    if (field && num_int(digits, "", 1, n->has.attributes, &k) != ST_OK)
        return s->hints.optional
                   ? ST_OK
                   : status_describe(ST_UNSUPPORTED,
                                     "%s: no field \"%s\", there are %d: attr1 ..%s",
                                     byte_stream_name(s->data), field, (int)n->has.attributes,
                                     n->has.markers ? ", and marker" : "");
    n->column = (int)k - 1;
    snprintf(s->out->field, sizeof s->out->field, "attr%d", (int)k);
    return ST_OK;
}

static status read_header(const plc_source *s, text_tokens *t, nodes *n) {
    status st = mesh_tetgen_points(t, PLC_MAX, &n->has);
    /* A .poly without points takes the columns of the .node. */
    return st == ST_OK && n->has.points > 0 ? choose_field(s, n) : st;
}

static status read_point(const plc_source *s, text_tokens *t, nodes *n, int64_t i) {
    plc *x = s->out;
    double xyz[3] = {0}, value = 0, number;
    int64_t id, lo = i ? n->first + i : 0, hi = i ? n->first + i : 1;
    status st = text_tokens_int(t, "the ids of points to count up from 0 or 1", lo, hi, &id);
    if (i == 0)
        n->first = id;
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = text_tokens_double_here(t, "a coordinate", &xyz[a]);
    for (int c = 0; st == ST_OK && c < n->has.attributes + n->has.markers; c++) {
        st = text_tokens_double_here(t, "an attribute or marker", &number);
        if (c == n->column)
            value = number;
    }
    if (st == ST_OK)
        st = plc_add_point(s, xyz, t->line);
    if (st == ST_OK && n->column >= 0)
        st = plc_add(x, &x->values, &value, sizeof value);
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_points(const plc_source *s, text_tokens *t, nodes *n) {
    status st = read_header(s, t, n);
    n->first = 0;
    for (int64_t i = 0; st == ST_OK && i < n->has.points; i++)
        st = read_point(s, t, n, i);
    s->out->counted_from = (unsigned)n->first;
    return st;
}

status plc_tetgen_read_node(plc_source *s) {
    text_tokens t = {.s = s->data, .line = 1, .comment = '#', .commas = true};
    nodes n;
    status st = read_points(s, &t, &n);
    if (st == ST_OK)
        st = text_tokens_next(&t);
    return st == ST_OK && t.token[0]
               ? text_tokens_fault(&t, "the end: there are no more rows by the header")
               : st;
}

/* Read the points of F.node, for F.poly or F.smesh. */
static status read_other(const plc_source *s, nodes *n) {
    plc_source other = *s;
    const size_t stem = strlen(s->path) - (text_ends_in(s->path, ".poly") ? 5 : 6);
    const size_t room = strlen(s->path) + 2;
    if (!text_ends_in(s->path, ".poly") && !text_ends_in(s->path, ".smesh"))
        return status_describe(ST_CORRUPT,
                               "%s: has no points, and no name ending in .poly or .smesh that says "
                               "which .node has",
                               byte_stream_name(s->data));
    char *path = mem_alloc(s->out->m, room);
    if (!path)
        return ST_NOMEM;
    snprintf(path, room, "%.*s.node", (int)stem, s->path);
    status st = named_file_implied(path);
    if (st == ST_OK)
        st = byte_stream_open(s->out->m, path, &other.data);
    if (st == ST_OK) {
        text_tokens t = {.s = other.data, .line = 1, .comment = '#', .commas = true};
        st = read_points(&other, &t, n);
        byte_stream_close(other.data);
    }
    mem_free(s->out->m, path);
    return st;
}

/* ---- facets ---- */

static status read_corners(plc *x, text_tokens *t, const nodes *n, int64_t count) {
    status st = plc_add_polygon(x);
    for (int64_t c = 0; st == ST_OK && c < count; c++) {
        int64_t id = 0;
        st = text_tokens_int(t, "the id of a point", INT64_MIN, INT64_MAX, &id);
        if (st == ST_OK)
            st = plc_add_corner(x, (uint64_t)id - (uint64_t)n->first);
    }
    return st;
}

/* Read "id x y z" and skip the rest of the line. */
static status read_hole(const plc_source *s, text_tokens *t, plc_list *list) {
    double id, xyz[3];
    status st = text_tokens_double(t, "the id of a hole", &id);
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = text_tokens_double_here(t, "a coordinate of a hole", &xyz[a]);
    if (st == ST_OK)
        st = plc_add(s->out, list, xyz, sizeof xyz);
    return st == ST_OK ? skip_line(t) : st;
}

/* Read a facet: the number of polygons, then [holes] [marker]. */
static status read_poly_facet(const plc_source *s, text_tokens *t, const nodes *n) {
    plc *x = s->out;
    int64_t polygons = 0, holes = 0, corners = 0;
    status st = text_tokens_int(t, "the number of a facet's polygons", 1, INT32_MAX, &polygons);
    if (st == ST_OK)
        st = text_tokens_int_here(t, "the number of a facet's holes", 0, INT32_MAX, 0, &holes);
    if (st == ST_OK)
        st = skip_line(t);
    for (int64_t p = 0; st == ST_OK && p < polygons; p++) {
        st = text_tokens_int(t, "the number of a polygon's corners", 1, INT32_MAX, &corners);
        if (st == ST_OK)
            st = read_corners(x, t, n, corners);
        if (st == ST_OK)
            st = text_tokens_end_line(t);
    }
    for (int64_t h = 0; st == ST_OK && h < holes; h++)
        st = read_hole(s, t, &x->facet_holes);
    return st;
}

static status read_smesh_facet(const plc_source *s, text_tokens *t, const nodes *n) {
    int64_t corners = 0;
    status st = text_tokens_int(t, "the number of a facet's corners", 3, INT32_MAX, &corners);
    if (st == ST_OK)
        st = read_corners(s->out, t, n, corners);
    return st == ST_OK ? skip_line(t) : st; /* a marker */
}

static status read_facets(const plc_source *s, text_tokens *t, const nodes *n, bool poly) {
    int64_t facets = 0;
    status st = text_tokens_int(t, "the number of facets", 0, (int64_t)PLC_MAX, &facets);
    if (st == ST_OK)
        st = skip_line(t);
    for (int64_t f = 0; st == ST_OK && f < facets; f++) {
        st = plc_add_facet(s->out, (uint64_t)f);
        if (st == ST_OK)
            st = poly ? read_poly_facet(s, t, n) : read_smesh_facet(s, t, n);
    }
    return st;
}

/* ---- holes and regions ---- */

/* Read "id x y z attribute [volume]". A single number behind z is both. */
static status read_region(const plc_source *s, text_tokens *t) {
    double id, region[5];
    bool more;
    status st = text_tokens_double(t, "the id of a region", &id);
    for (int a = 0; st == ST_OK && a < 4; a++)
        st = text_tokens_double_here(t, "a coordinate or attribute of a region", &region[a]);
    region[4] = region[3];
    if (st == ST_OK)
        st = text_tokens_more(t, &more);
    if (st == ST_OK && more)
        st = text_tokens_double(t, "the largest volume of a region's tets", &region[4]);
    if (st == ST_OK)
        st = plc_add(s->out, &s->out->regions, region, sizeof region);
    return st == ST_OK ? skip_line(t) : st;
}

/* Read holes and regions. Both may be missing at the file's end. */
static status read_tail(const plc_source *s, text_tokens *t) {
    status st = text_tokens_next(t);
    for (int part = 0; st == ST_OK && part < 2 && t->token[0]; part++) {
        int64_t count = 0;
        if (num_int(t->token, "", 0, (int64_t)PLC_MAX, &count) != ST_OK)
            return text_tokens_fault(t, "the number of %s", part == 0 ? "holes" : "regions");
        st = skip_line(t);
        for (int64_t i = 0; st == ST_OK && i < count; i++)
            st = part == 0 ? read_hole(s, t, &s->out->holes) : read_region(s, t);
        if (st == ST_OK)
            st = text_tokens_next(t);
    }
    return st == ST_OK && t->token[0] ? text_tokens_fault(t, "the end") : st;
}

static status read_complex(plc_source *s, bool poly) {
    text_tokens t = {.s = s->data, .line = 1, .comment = '#', .commas = true};
    nodes n;
    s->out->loose = true;
    status st = read_points(s, &t, &n);
    if (st == ST_OK && n.has.points == 0)
        st = read_other(s, &n);
    if (st == ST_OK)
        st = read_facets(s, &t, &n, poly);
    return st == ST_OK ? read_tail(s, &t) : st;
}

status plc_tetgen_read_poly(plc_source *s) {
    return read_complex(s, true);
}

status plc_tetgen_read_smesh(plc_source *s) {
    return read_complex(s, false);
}
