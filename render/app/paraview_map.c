#include "render/app/paraview_map.h"

#include <expat.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

#include "formats/base/json_text.h"
#include "formats/base/num.h"

enum { BYTES_MAX = 1 << 24, WHERE_MAX = 256 };

/* ---- What both forms share ---- */

/* Clamp a component or an opacity to [0, 1]. Returns false if it is outside by more than
 * rounding. */
static bool in_unit(double *x) {
    const bool good = *x >= -0.001 && *x <= 1.001;
    *x = fmin(fmax(*x, 0.0), 1.0);
    return good;
}

/* Check the value of a point against the one before. where: file and place of the point. */
static status check_value(double value, const double *before, const char *where) {
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    if (!(fabs(value) <= 1e300))
        return status_describe(ST_CORRUPT, "%s: expected a finite value, up to 1e300", where);
    if (before && value < *before)
        return status_describe(ST_CORRUPT, "%s: the value %s comes behind %s: expected rising ones",
                               where, num_print(value, a), num_print(*before, b));
    return ST_OK;
}

static status add_colour(paraview_map *p, colour_point c, const char *where) {
    const size_t n = p->colour_count;
    status st = check_value(c.value, n ? &p->colours[n - 1].value : NULL, where);
    if (st == ST_OK && !(in_unit(&c.rgb[0]) && in_unit(&c.rgb[1]) && in_unit(&c.rgb[2])))
        st = status_describe(ST_CORRUPT, "%s: expected red, green and blue of 0 to 1", where);
    if (st == ST_OK)
        st = mem_grow(p->m, &p->colours, sizeof *p->colours, n, 32, &p->colour_room);
    if (st == ST_OK)
        p->colours[p->colour_count++] = c;
    return st;
}

static status add_opacity(paraview_map *p, opacity_point o, const char *where) {
    const size_t n = p->opacity_count;
    status st = check_value(o.value, n ? &p->opacities[n - 1].value : NULL, where);
    if (st == ST_OK && !(in_unit(&o.opacity) && in_unit(&o.middle) && in_unit(&o.sharpness)))
        st = status_describe(ST_CORRUPT,
                             "%s: expected an opacity, a midpoint and a sharpness of 0 "
                             "to 1",
                             where);
    if (st == ST_OK)
        st = mem_grow(p->m, &p->opacities, sizeof *p->opacities, n, 32, &p->opacity_room);
    if (st == ST_OK)
        p->opacities[p->opacity_count++] = o;
    return st;
}

void paraview_map_release(paraview_map *p) {
    mem_free(p->m, p->colours);
    mem_free(p->m, p->opacities);
    *p = (paraview_map){.m = p->m};
}

/* Count a map that begins. Returns whether it is the one to read. */
static bool begin_map(paraview_map *p, const char *name) {
    p->maps++;
    name_list_add(&p->names, name);
    const bool meant = !p->found && (!p->wanted || strcmp(name, p->wanted) == 0);
    p->found |= meant;
    return meant;
}

static status set_space(paraview_map *p, const char *name, const char *where) {
    if (colour_space_find(name, &p->space))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: the colour space \"%s\" is none of RGB, HSV, Lab and Diverging",
                           where, name);
}

/* Check, after all is read, that the wanted map was found and has points. */
static status check_found(const paraview_map *p, const char *file) {
    if (p->maps == 0)
        return status_describe(ST_CORRUPT, "%s: expected a colour map", file);
    if (!p->found)
        return status_describe(ST_USAGE, "%s: there is no map \"%s\", only %s", file, p->wanted,
                               name_list_print(&p->names));
    if (!p->wanted && p->maps > 1)
        return status_describe(ST_USAGE, "%s: which of its %d maps? FILE#NAME: %s", file, p->maps,
                               name_list_print(&p->names));
    if (p->colour_count == 0)
        return status_describe(ST_CORRUPT, "%s: expected points of the map", file);
    return ST_OK;
}

/* ---- JSON ---- */

typedef struct json_bytes {
    byte_stream *s;
    uint64_t taken;
    status st;
} json_bytes;

/* The reader for json_load_callback(). */
static size_t more_bytes(void *buffer, size_t size, void *ctx) {
    json_bytes *b = ctx;
    size_t got = 0;
    b->st = byte_stream_read(b->s, buffer, size, &got);
    b->taken += got;
    if (b->st == ST_OK && b->taken > BYTES_MAX)
        b->st = status_describe(ST_UNSUPPORTED, "%s: a colour map of more than %d bytes",
                                byte_stream_name(b->s), BYTES_MAX);
    return b->st == ST_OK ? got : (size_t)-1;
}

static status load_json(byte_stream *s, json_t **root) {
    json_error_t error;
    json_bytes bytes = {.s = s};
    *root = json_load_callback(more_bytes, &bytes, 0, &error);
    if (bytes.st != ST_OK || *root)
        return bytes.st;
    return status_describe(json_text_status(&error, ST_CORRUPT), "%s: line %d: expected JSON: %s",
                           byte_stream_name(s), error.line, error.text);
}

/* Call `add` for each point of an array that holds four numbers per point. */
static status each_row(paraview_map *p, const json_t *map, const char *key, const char *file,
                       status (*add)(paraview_map *p, const double x[4], const char *where)) {
    char where[WHERE_MAX];
    const json_t *list = json_object_get(map, key);
    const size_t count = json_array_size(list);
    if (!list)
        return ST_OK;
    if (!json_is_array(list) || count % 4 != 0)
        return status_describe(ST_CORRUPT, "%s: \"%s\": expected an array of four numbers a point",
                               file, key);
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i += 4) {
        double x[4];
        bool numbers = true;
        for (size_t k = 0; k < 4; k++) {
            const json_t *item = json_array_get(list, i + k);
            numbers &= json_is_number(item);
            x[k] = json_number_value(item);
        }
        snprintf(where, sizeof where, "%.200s: \"%s\", point %zu", file, key, i / 4 + 1);
        st = numbers ? add(p, x, where)
                     : status_describe(ST_CORRUPT, "%s: expected four numbers", where);
    }
    return st;
}

static status add_rgb_row(paraview_map *p, const double x[4], const char *where) {
    return add_colour(p, (colour_point){x[0], {x[1], x[2], x[3]}}, where);
}

static status add_opacity_row(paraview_map *p, const double x[4], const char *where) {
    return add_opacity(p, (opacity_point){x[0], x[1], x[2], x[3]}, where);
}

static bool is_set(const json_t *map, const char *key) {
    const json_t *value = json_object_get(map, key);
    return json_is_true(value) || (json_is_number(value) && json_number_value(value) != 0.0);
}

static status read_json_map(paraview_map *p, const json_t *map, const char *file) {
    const json_t *space = json_object_get(map, "ColorSpace");
    if (!json_object_get(map, "RGBPoints"))
        return status_describe(ST_UNSUPPORTED,
                               "%s: expected \"RGBPoints\": a map of categories has "
                               "none",
                               file);
    if (is_set(map, "UseLogScale"))
        return status_describe(ST_UNSUPPORTED, "%s: \"UseLogScale\": a map over logarithms", file);
    status st =
        space ? set_space(p, json_is_string(space) ? json_string_value(space) : "", file) : ST_OK;
    if (st == ST_OK && p->space == COLOUR_HSV && is_set(map, "HSVWrap"))
        p->space = COLOUR_HSV_WRAPPED;
    if (st == ST_OK)
        st = each_row(p, map, "RGBPoints", file, add_rgb_row);
    return st == ST_OK ? each_row(p, map, "Points", file, add_opacity_row) : st;
}

status paraview_map_read_json(paraview_map *p, byte_stream *s) {
    const char *file = byte_stream_name(s);
    json_t *root = NULL;
    status st = load_json(s, &root);
    const bool many = json_is_array(root);
    const size_t count = many ? json_array_size(root) : 1;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const json_t *map = many ? json_array_get(root, i) : root;
        const char *name = json_string_value(json_object_get(map, "Name"));
        if (!json_is_object(map))
            st = status_describe(ST_CORRUPT, "%s: expected an object, or an array of them", file);
        else if (begin_map(p, name ? name : "") && (p->wanted || count == 1))
            st = read_json_map(p, map, file);
    }
    json_decref(root);
    return st == ST_OK ? check_found(p, file) : st;
}

/* ---- XML ---- */

typedef struct xml_reader {
    paraview_map *map;
    byte_stream *s;
    XML_Parser parser;
    bool inside; /* inside of the map to read */
    status st;   /* error of the handler that stopped the parser */
} xml_reader;

static const char *attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

static void tell_place(const xml_reader *r, char where[WHERE_MAX]) {
    snprintf(where, WHERE_MAX, "%.200s: line %llu", byte_stream_name(r->s),
             (unsigned long long)XML_GetCurrentLineNumber(r->parser));
}

static status number_of(const char **attributes, const char *name, const char *where, double *out) {
    const char *text = attribute(attributes, name);
    if (!text)
        return status_describe(ST_CORRUPT, "%s: expected %s=\"...\" of a point", where, name);
    if (num_double(text, name, out) == ST_OK)
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: %s=\"%.40s\": expected a number", where, name, text);
}

static status start_map(xml_reader *r, const char **attributes, const char *where) {
    const char *name = attribute(attributes, "name"), *space = attribute(attributes, "space");
    const char *indexed = attribute(attributes, "indexedLookup");
    r->inside = begin_map(r->map, name ? name : "");
    if (!r->inside)
        return ST_OK;
    if (indexed && strcmp(indexed, "false") != 0 && strcmp(indexed, "0") != 0)
        return status_describe(ST_UNSUPPORTED, "%s: a map of categories", where);
    return space ? set_space(r->map, space, where) : ST_OK;
}

static status add_xml_point(xml_reader *r, const char **attributes, const char *where) {
    static const char *const NAMES[4] = {"x", "r", "g", "b"};
    double x[4], opacity = 0.0;
    status st = ST_OK;
    for (int i = 0; i < 4 && st == ST_OK; i++)
        st = number_of(attributes, NAMES[i], where, &x[i]);
    if (st == ST_OK)
        st = add_rgb_row(r->map, x, where);
    if (st != ST_OK || !attribute(attributes, "o"))
        return st;
    st = number_of(attributes, "o", where, &opacity);
    return st == ST_OK ? add_opacity(r->map, (opacity_point){x[0], opacity, 0.5, 0.0}, where) : st;
}

static void stop_parser(xml_reader *r, status st) {
    r->st = st;
    if (st != ST_OK)
        XML_StopParser(r->parser, XML_FALSE);
}

static void XMLCALL handle_start(void *user, const char *name, const char **attributes) {
    xml_reader *r = user;
    char where[WHERE_MAX];
    if (r->st != ST_OK)
        return;
    tell_place(r, where);
    if (strcmp(name, "ColorMap") == 0)
        stop_parser(r, start_map(r, attributes, where));
    else if (r->inside && strcmp(name, "Point") == 0)
        stop_parser(r, add_xml_point(r, attributes, where));
}

static void XMLCALL handle_end(void *user, const char *name) {
    xml_reader *r = user;
    if (strcmp(name, "ColorMap") == 0)
        r->inside = false;
}

/* Refuse document types: no colour map has one, and its entities could grow without limit. */
static void XMLCALL handle_doctype(void *user, const char *name, const char *system,
                                   const char *public, int internal) {
    xml_reader *r = user;
    char where[WHERE_MAX];
    (void)name, (void)system, (void)public, (void)internal;
    tell_place(r, where);
    stop_parser(r, status_describe(ST_UNSUPPORTED, "%s: a document type declaration", where));
}

static status xml_failed(const xml_reader *r) {
    const enum XML_Error error = XML_GetErrorCode(r->parser);
    char where[WHERE_MAX];
    if (r->st != ST_OK)
        return r->st;
    tell_place(r, where);
    if (error == XML_ERROR_NO_MEMORY)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", where);
    return status_describe(ST_CORRUPT, "%s: expected XML: %s", where, XML_ErrorString(error));
}

static status parse_xml(xml_reader *r) {
    uint64_t fed = 0;
    for (bool ended = false; !ended;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(r->s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        ended = size == 0;
        fed += size;
        if (fed > BYTES_MAX)
            return status_describe(ST_UNSUPPORTED, "%s: a colour map of more than %d bytes",
                                   byte_stream_name(r->s), BYTES_MAX);
        if (XML_Parse(r->parser, (const char *)data, (int)size, ended) != XML_STATUS_OK)
            return xml_failed(r);
        byte_stream_take(r->s, size);
    }
    return ST_OK;
}

/* Drop all opacities if only some of the points have one. */
static void drop_partial_opacities(paraview_map *p) {
    if (p->opacity_count < p->colour_count)
        p->opacity_count = 0;
}

status paraview_map_read_xml(paraview_map *p, byte_stream *s) {
    xml_reader r = {.map = p, .s = s, .parser = XML_ParserCreate(NULL)};
    if (!r.parser)
        return status_describe(ST_NOMEM, "no memory to parse XML");
    XML_SetUserData(r.parser, &r);
    XML_SetElementHandler(r.parser, handle_start, handle_end);
    XML_SetStartDoctypeDeclHandler(r.parser, handle_doctype);
    status st = parse_xml(&r);
    XML_ParserFree(r.parser);
    drop_partial_opacities(p);
    return st == ST_OK ? check_found(p, byte_stream_name(s)) : st;
}
