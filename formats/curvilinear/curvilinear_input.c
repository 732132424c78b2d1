#include "formats/curvilinear/curvilinear_input.h"

#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_imported.h"
#include "formats/curvilinear/curvilinear_reader.h"
#include "formats/curvilinear/curvilinear_stream.h"
#include "formats/curvilinear/curvilinear_vtk.h"
#include "formats/curvilinear/curvilinear_vtk_parts.h"
#include "formats/curvilinear/plot3d.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/foreign.h"

/* A field that is taken. */
typedef struct choice {
    uint32_t field, component;
} choice;

struct curvilinear_input {
    mem *m;
    curvilinear_opening from;
    const curvilinear_reader *reader;
    void *state;
    curvilinear_source source;
    choice *taken;
    char name[CURVILINEAR_NAME_MAX + 1]; /* of the field last asked for */
};

/* The formats. The first that recognises a file reads it. */
static const curvilinear_reader *const readers[] = {&curvilinear_stream_reader,
                                                    &curvilinear_imported_reader,
                                                    &curvilinear_vtk_xml_reader,
                                                    &curvilinear_vtk_pieces_reader,
                                                    &curvilinear_vtk_collection_reader,
                                                    &curvilinear_vtk_legacy_reader,
                                                    &plot3d_reader};

enum { READERS = sizeof readers / sizeof *readers };

/* ---- recognising ---- */

/* Few readers read pipes and packed files. */
static status find_reader(byte_stream *s, const curvilinear_reader **out) {
    const uint8_t *start;
    size_t size;
    *out = NULL;
    status st = byte_stream_peek(s, CURVILINEAR_READER_PEEK, &start, &size);
    if (st != ST_OK || dicom_mark_is_at(start, size))
        return st;
    for (int i = 0; i < READERS && !*out; i++)
        if ((readers[i]->any_stream || byte_stream_is_file(s)) &&
            readers[i]->known(byte_stream_kind(s), start, size, byte_stream_left(s)))
            *out = readers[i];
    return ST_OK;
}

status curvilinear_input_recognise(byte_stream *s, bool *known) {
    const curvilinear_reader *reader;
    status st = find_reader(s, &reader);
    *known = reader != NULL;
    return st;
}

static bool is_plot3d_asked(const curvilinear_hints *hints) {
    return hints->layout || hints->solutions.count > 0 || hints->functions.count > 0;
}

bool curvilinear_input_is_asked(const curvilinear_hints *hints) {
    return hints->to || is_plot3d_asked(hints);
}

/* ---- fields ---- */

const char *curvilinear_input_field(curvilinear_input *x, uint32_t field, uint32_t *components) {
    text_name(x->name, sizeof x->name, x->reader->field(x->state, field, components));
    return x->name;
}

uint32_t curvilinear_input_fields(const curvilinear_input *x) {
    return x->from.fields;
}

/* Returns the component that "name_x", "name_y" or "name_z" asks for of a vector "name"; 0: it is
 * not asked for. */
static uint32_t find_axis(const char *asked, const char *name, uint32_t components) {
    const size_t length = strlen(name);
    if (strncmp(asked, name, length) != 0 || asked[length] != '_')
        return 0;
    const char *axis = asked + length + 1;
    const bool is_axis = *axis >= 'x' && *axis <= 'z' && !axis[1];
    const uint32_t component = is_axis ? (uint32_t)(*axis - 'x') + 1 : 0;
    return component <= components && components > 1 ? component : 0;
}

static status refuse_field(curvilinear_input *x, const char *asked) {
    name_list names = {0};
    const char *why = x->reader->refused ? x->reader->refused(x->state, asked) : NULL;
    if (why)
        return status_describe(ST_USAGE, "%s: field \"%s\" cannot be taken: %s",
                               curvilinear_input_file(x), asked, why);
    for (uint32_t i = 0; i < x->from.fields; i++) {
        uint32_t components;
        name_list_add(&names, curvilinear_input_field(x, i, &components));
    }
    return status_describe(ST_USAGE, "%s: no field \"%s\"; it has %s", curvilinear_input_file(x),
                           asked, name_list_print(&names));
}

/* Choose the hints' component of a field. */
static status choose(curvilinear_input *x, uint32_t field, choice *out) {
    uint32_t components;
    const int component = x->from.hints.component;
    const char *name = curvilinear_input_field(x, field, &components);
    if (component < 0 || (uint32_t)component > components)
        return status_describe(ST_USAGE, "%s: \"%s\" has no component %d but 1 to %u",
                               curvilinear_input_file(x), name, component, components);
    *out = (choice){field, (uint32_t)component};
    return ST_OK;
}

/* A name that a field has comes before one of a vector's component. */
static status find_field(curvilinear_input *x, const char *asked, choice *out) {
    if (!asked)
        return x->from.fields ? choose(x, 0, out) : ST_OK;
    uint32_t components, component = 0, of = 0;
    for (uint32_t i = 0; i < x->from.fields; i++) {
        const char *name = curvilinear_input_field(x, i, &components);
        if (text_same_name(name, asked, sizeof x->name))
            return choose(x, i, out);
        const uint32_t axis = component ? 0 : find_axis(asked, name, components);
        component = axis ? axis : component;
        of = axis ? i : of;
    }
    *out = (choice){of, component};
    return component ? ST_OK : refuse_field(x, asked);
}

/* Tell the reader which fields are going to be read, each once. */
static status tell_taken(const curvilinear_input *x) {
    if (!x->reader->take)
        return ST_OK;
    uint32_t *fields = mem_array(x->m, (size_t)x->source.fields + 1, sizeof *fields), count = 0;
    if (!fields)
        return ST_NOMEM;
    for (uint32_t i = 0; i < x->source.fields && x->from.fields > 0; i++) {
        uint32_t k = 0;
        while (k < count && fields[k] != x->taken[i].field)
            k++;
        fields[k] = x->taken[i].field;
        count += k == count;
    }
    const status st = x->reader->take(x->state, fields, count);
    mem_free(x->m, fields);
    return st;
}

status curvilinear_input_take(curvilinear_input *x, const char *const *names, uint32_t count) {
    choice *taken = mem_array(x->m, count, sizeof *taken);
    status st = taken ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        st = find_field(x, names[i], &taken[i]);
    if (st != ST_OK) {
        mem_free(x->m, taken);
        return st;
    }
    mem_free(x->m, x->taken);
    x->taken = taken;
    x->source.fields = count;
    return tell_taken(x);
}

const char *curvilinear_input_taken(curvilinear_input *x, uint32_t field, uint32_t *component) {
    uint32_t components;
    *component = x->taken[field].component;
    return x->from.fields ? curvilinear_input_field(x, x->taken[field].field, &components) : "";
}

/* ---- planes ---- */

static status places(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    const curvilinear_input *x = own;
    return x->reader->places(x->state, zone, first, count, p);
}

static status values(void *own, uint32_t zone, uint32_t field, uint32_t first, uint32_t count,
                     float *to) {
    const curvilinear_input *x = own;
    const choice *c = &x->taken[field];
    if (x->from.fields > 0)
        return x->reader->values(x->state, zone, c->field, c->component, first, count, to);
    const uint32_t *n = x->source.nodes[zone];
    memset(to, 0, (size_t)n[0] * n[1] * count * sizeof *to);
    return ST_OK;
}

static status blanks(void *own, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node) {
    const curvilinear_input *x = own;
    return x->reader->blanks(x->state, zone, first, count, is_node);
}

const curvilinear_source *curvilinear_input_source(const curvilinear_input *x) {
    return &x->source;
}

/* ---- opening ---- */

static status open_reader(curvilinear_input *x) {
    byte_stream *s = x->from.data;
    status st = find_reader(s, &x->reader);
    if (st != ST_OK)
        return st;
    if (x->from.hints.to && is_plot3d_asked(&x->from.hints))
        return status_describe(ST_USAGE,
                               "%s: --to is for netCDF, and --solution, --functions and "
                               "--plot3d are for PLOT3D",
                               byte_stream_name(s));
    if (x->from.hints.to)
        x->reader = &curvilinear_imported_reader;
    if (!x->reader && !byte_stream_is_file(s))
        return status_describe(ST_UNSUPPORTED,
                               "%s: a curvilinear grid must be a regular file, not packed",
                               byte_stream_name(s));
    if (!x->reader && curvilinear_input_is_asked(&x->from.hints))
        x->reader = &plot3d_reader;
    if (!x->reader)
        return foreign_refuse(s,
                              "expected a curvilinear grid: PLOT3D, VTK (.vts, .pvts, .vtk), CGNS, "
                              "a curvilinear stream");
    return x->reader->open(&x->from, &x->state);
}

/* Hand over what open() or seek() of the reader has set. */
static status show_grid(curvilinear_input *x) {
    x->source = (curvilinear_source){.own = x,
                                     .zones = x->from.zones,
                                     .nodes = x->from.nodes,
                                     .blanked = x->from.blanked,
                                     .places = places,
                                     .values = values,
                                     .blanks = blanks};
    return curvilinear_input_take(x, (const char *const[]){x->from.hints.field}, 1);
}

static status open_grid(curvilinear_input *x) {
    const status st = open_reader(x);
    if (st != ST_OK)
        return st;
    const char *name = x->from.hints.name;
    text_name(x->from.name, sizeof x->from.name, name ? name : x->from.name);
    return show_grid(x);
}

status curvilinear_input_open_stream(mem *m, byte_stream *s, const curvilinear_hints *hints,
                                     curvilinear_input **out) {
    curvilinear_input *x = mem_zalloc(m, sizeof *x);
    if (!x) {
        byte_stream_close(s);
        return ST_NOMEM;
    }
    x->m = m;
    x->from = (curvilinear_opening){.m = m, .data = s};
    if (hints)
        x->from.hints = *hints;
    status st = open_grid(x);
    if (st != ST_OK) {
        curvilinear_input_close(x);
        return st;
    }
    *out = x;
    return ST_OK;
}

status curvilinear_input_open(mem *m, const char *path, const curvilinear_hints *hints,
                              curvilinear_input **out) {
    byte_stream *s;
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? curvilinear_input_open_stream(m, s, hints, out) : st;
}

void curvilinear_input_close(curvilinear_input *x) {
    if (!x)
        return;
    if (x->reader)
        x->reader->close(x->state);
    byte_stream_close(x->from.data);
    mem_free(x->m, x->taken);
    mem_free(x->m, x);
}

const char *curvilinear_input_format(const curvilinear_input *x) {
    return x->from.format ? x->from.format : x->reader->format;
}

const char *curvilinear_input_name(const curvilinear_input *x) {
    return x->from.name;
}

const char *curvilinear_input_file(const curvilinear_input *x) {
    return byte_stream_path(x->from.data);
}

/* ---- steps ---- */

bool curvilinear_input_names_files(const curvilinear_input *x) {
    return x->reader->names_files;
}

bool curvilinear_input_has_library(const curvilinear_input *x) {
    return x->reader->library;
}

bool curvilinear_input_is_placed(const curvilinear_input *x) {
    return x->from.hints.to != NULL;
}

bool curvilinear_input_may_have_steps(const curvilinear_input *x) {
    return x->reader->steps != NULL;
}

uint32_t curvilinear_input_steps(const curvilinear_input *x, const double **times) {
    *times = NULL;
    return x->reader->steps ? x->reader->steps(x->state, times) : 1;
}

const char *curvilinear_input_time_unit(const curvilinear_input *x) {
    return x->from.time_unit;
}

bool curvilinear_input_still(const curvilinear_input *x) {
    return x->from.still;
}

status curvilinear_input_seek(curvilinear_input *x, uint32_t step) {
    if (step == x->from.hints.step)
        return ST_OK;
    x->from.hints.step = step;
    const status st = x->reader->seek(&x->from, x->state);
    return st == ST_OK ? show_grid(x) : st;
}

const double *curvilinear_input_conditions(const curvilinear_input *x) {
    return x->reader->conditions ? x->reader->conditions(x->state) : NULL;
}
