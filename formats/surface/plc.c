#include "formats/surface/plc.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/text.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/foreign.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/surface/plc_off.h"
#include "formats/surface/plc_ply.h"
#include "formats/surface/plc_stl.h"
#include "formats/surface/plc_table.h"
#include "formats/surface/plc_tetgen.h"

typedef struct plc_format {
    const char *name, *suffix;
    status (*read)(plc_source *s);
} plc_format;

static const plc_format formats[] = {
    {"node", ".node", plc_tetgen_read_node},
    {"csv", ".csv", plc_table_read},
    {"csv", ".txt", plc_table_read},
    {"csv", ".xyz", plc_table_read},
    {"ply", ".ply", plc_ply_read},
    {"stl", ".stl", plc_stl_read},
    {"off", ".off", plc_off_read},
    {"poly", ".poly", plc_tetgen_read_poly},
    {"smesh", ".smesh", plc_tetgen_read_smesh},
};

enum { FORMATS = sizeof formats / sizeof *formats };

/* ---- building ---- */

status plc_add(plc *x, plc_list *list, const void *element, size_t size) {
    if (list->count == list->room && list->count >= PLC_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "more than %llu points, facets or corners: expected fewer",
                               (unsigned long long)PLC_MAX);
    status st = mem_grow(x->m, &list->data, size, list->count, 1024, &list->room);
    if (st != ST_OK)
        return st;
    memcpy((char *)list->data + list->count * size, element, size);
    list->count++;
    return ST_OK;
}

status plc_add_point(const plc_source *s, const double xyz[3], uint64_t line) {
    for (int a = 0; a < 3; a++)
        if (!isfinite((float)xyz[a])) {
            char where[40] = "";
            if (line > 0)
                snprintf(where, sizeof where, "line %llu: ", (unsigned long long)line);
            return status_describe(ST_CORRUPT,
                                   "%s: %spoint %zu (counted from 0): %c is %g, expected a finite "
                                   "number within floats",
                                   byte_stream_name(s->data), where, s->out->points.count, "xyz"[a],
                                   xyz[a]);
        }
    return plc_add(s->out, &s->out->points, xyz, 3 * sizeof *xyz);
}

status plc_add_facet(plc *x, uint64_t number) {
    const plc_facet f = {(uint32_t)number, (uint32_t)x->polygons.count,
                         (uint32_t)x->facet_holes.count};
    return plc_add(x, &x->facets, &f, sizeof f);
}

status plc_add_polygon(plc *x) {
    const uint32_t first = (uint32_t)x->corners.count;
    return plc_add(x, &x->polygons, &first, sizeof first);
}

status plc_add_corner(plc *x, uint64_t point) {
    const uint32_t id = point < UINT32_MAX ? (uint32_t)point : UINT32_MAX;
    return plc_add(x, &x->corners, &id, sizeof id);
}

void plc_release(plc *x) {
    plc_list *all[] = {&x->points,  &x->values,      &x->facets, &x->polygons,
                       &x->corners, &x->facet_holes, &x->holes,  &x->regions};
    for (size_t i = 0; x->m && i < sizeof all / sizeof *all; i++)
        mem_free(x->m, all[i]->data);
    *x = (plc){0};
}

/* ---- reading ---- */

static const plc_format *format_named(const char *name) {
    for (int i = 0; i < FORMATS; i++)
        if (strcasecmp(formats[i].name, name) == 0)
            return &formats[i];
    return NULL;
}

/* Find the format by the path's end; without a known end, as for pipes, by the first bytes. */
static status find_format(const plc_source *s, const plc_format **out) {
    const uint8_t *start;
    size_t size;
    *out = NULL;
    for (int i = 0; i < FORMATS && !s->hints.format; i++)
        if (text_ends_in(s->path, formats[i].suffix))
            *out = &formats[i];
    if (s->hints.format)
        *out = format_named(s->hints.format);
    if (s->hints.format || *out)
        return *out ? ST_OK
                    : status_describe(ST_USAGE,
                                      "no format \"%s\": there are node csv ply stl off "
                                      "poly smesh",
                                      s->hints.format);
    status st = byte_stream_peek(s->data, DICOM_MARK_END, &start, &size);
    if (st == ST_OK && dicom_mark_is_at(start, size))
        *out = NULL;
    else if (st == ST_OK && size >= 4 && memcmp(start, "ply", 3) == 0 && start[3] <= '\r')
        *out = format_named("ply");
    else if (st == ST_OK && size >= 3 && memcmp(start, "OFF", 3) == 0)
        *out = format_named("off");
    else if (st == ST_OK && size >= 6 && memcmp(start, "solid ", 6) == 0)
        *out = format_named("stl");
    if (st == ST_OK && !*out)
        return foreign_refuse(s->data, "expected points or a surface: .node .csv .ply .stl .off "
                                       ".poly .smesh, or what --format names");
    return st;
}

/* Check that every corner is a point. */
static status check_corners(const plc_source *s) {
    const plc *x = s->out;
    const uint32_t *corner = x->corners.data;
    for (size_t f = 0; f < x->facets.count; f++) {
        const size_t end = plc_corners_begin(x, plc_polygons_end(x, f));
        for (size_t c = plc_corners_begin(x, plc_facet_at(x, f)->polygon); c < end; c++)
            if (corner[c] >= x->points.count)
                return status_describe(ST_CORRUPT,
                                       "%s: facet %u (counted from %u) has a corner that is no "
                                       "point, expected one of the %zu there are",
                                       byte_stream_name(s->data),
                                       plc_facet_at(x, f)->number + x->counted_from,
                                       x->counted_from, x->points.count);
    }
    return ST_OK;
}

status plc_read(mem *m, const char *path, const plc_hints *hints, plc *out) {
    plc_source s = {.path = path, .out = out};
    const plc_format *format;
    *out = (plc){.m = m};
    if (hints)
        s.hints = *hints;
    status st = byte_stream_open(m, path, &s.data);
    if (st != ST_OK)
        return st;
    st = find_format(&s, &format);
    if (st == ST_OK)
        st = format->read(&s);
    if (st == ST_OK)
        st = check_corners(&s);
    text_name(out->field, sizeof out->field, out->field);
    byte_stream_close(s.data);
    return st;
}
