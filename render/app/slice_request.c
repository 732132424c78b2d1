#include "render/app/slice_request.h"

#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/cli_value.h"
#include "render/app/colour.h"
#include "render/app/legend.h"
#include "render/app/render_job.h"

const struct argp_option slice_request_table[SLICE_REQUEST_COUNT] = {
    {"field", SLICE_FIELD, "NAME", 0,
     "volumes with several fields: this one, by name or number (the first)", 2},
    {"step", SLICE_STEP, "K", 0, "volumes with time steps: this one, counted from 0 (0)", 2},
    {"time", SLICE_TIME, "T", 0, TIME_OPTIONS_TIME, 2},
    {"interpolate", SLICE_INTERPOLATE, NULL, 0, TIME_OPTIONS_INTERPOLATE, 2},
    {NULL, 0, NULL, 0, "The picture:", 3},
    {"colour-map", MEDIUM_COLOUR_MAP, "NAME", CLI_BASIC,
     "grey, viridis, plasma, inferno, magma, cool-warm, rainbow or a file of --tf's (of several "
     "maps in it FILE#NAME) (grey)",
     0},
    {"tf", MEDIUM_TF, "FILE", 0,
     "the colours of a transfer function: auto, ct, mr or a file, as render takes it", 0},
    {"window", MEDIUM_WINDOW, "LO,HI", CLI_BASIC,
     "the values of the map's first and last colour (the field's range)", 0},
    {"legend", MEDIUM_LEGEND, NULL, 0, "draw a bar of the colours with their values", 0},
    {"iso", SLICE_ISO, "V[,V...]", CLI_BASIC, "an isoline of each value, on top. Repeatable", 0},
    {"colour", SLICE_COLOUR, "COLOUR", 0, "of the isolines: red, R,G,B (linear) or #rrggbb (sRGB)",
     0},
    {NULL, 0, NULL, 0, NULL, 0}};

void slice_request_init(slice_request *r, mem *m) {
    static const float line[3] = {1.0f, 0.35f, 0.02f};
    *r = (slice_request){.place.m = m, .look.colours.m = m};
    memcpy(r->look.line, line, sizeof line);
}

void slice_request_release(slice_request *r) {
    slice_options_release(&r->place);
    transfer_list_release(&r->look.colours);
}

/* ---- Flags ---- */

static status add_isovalues(slice_request *r, const char *text) {
    int count = 1;
    for (const char *c = text; *c; c++)
        count += *c == ',';
    if (r->look.isos + count > SLICE_ISOS_MAX)
        return status_describe(ST_USAGE, "--iso: more than %d isolines", SLICE_ISOS_MAX);
    const status st = cli_vector(text, "--iso", count, r->isovalues + r->look.isos);
    r->look.isos += st == ST_OK ? count : 0;
    return st;
}

static status set_field(slice_request *r, const char *text) {
    if (!*text || strlen(text) >= sizeof r->field)
        return status_describe(ST_USAGE, "--field: \"%s\" is no field's name", text);
    memcpy(r->field, text, strlen(text) + 1);
    return ST_OK;
}

status slice_request_set(slice_request *r, int key, const char *text) {
    switch (key) {
    case SLICE_FIELD: return set_field(r, text);
    case SLICE_STEP:
        time_options_step(&r->time);
        return cli_uint(text, "--step", 0, UINT16_MAX, &r->step);
    case SLICE_TIME: return time_options_parse(text, &r->time);
    case SLICE_INTERPOLATE: r->time.interpolate = true; return ST_OK;
    case MEDIUM_LEGEND: r->legend = true; return ST_OK;
    case SLICE_ISO: return add_isovalues(r, text);
    case SLICE_COLOUR:
        r->coloured = true;
        return colour_parse(text, "--colour", r->look.line, NULL);
    default: break;
    }
    const status st = medium_options_set(&r->medium, key, text);
    return st == ST_AGAIN ? slice_options_set(&r->place, key, text) : st;
}

int slice_request_key(const char *name, view_value *value) {
    const struct argp_option *const tables[] = {slice_options_table, slice_request_table};
    for (int t = 0; t < 2; t++)
        for (const struct argp_option *o = tables[t]; o->name || o->doc; o++) {
            if (!cli_options_same(name, o->name))
                continue;
            *value = !o->arg && !(o->flags & OPTION_ALIAS) ? VIEW_VALUE_NONE : VIEW_VALUE_NEEDED;
            return o->key;
        }
    return 0;
}

status slice_request_check(slice_request *r) {
    if (r->coloured && r->look.isos == 0)
        return status_describe(ST_USAGE, "--colour is for isolines: --iso V");
    status st = time_options_check(&r->time);
    if (st == ST_OK && r->time.interpolate && !r->time.given)
        st = status_describe(ST_USAGE, "--interpolate: at which --time?");
    if (st == ST_OK)
        st = medium_options_check(&r->medium, true);
    return st == ST_OK ? slice_options_check(&r->place) : st;
}

/* ---- In a volume ---- */

status slice_request_select(slice_request *r, leafcast *volume) {
    status st = ST_OK;
    r->field_number = 0;
    if (r->field[0])
        st = render_status(leafcast_find_field(volume, r->field, &r->field_number));
    if (st == ST_OK)
        st = time_options_find(&r->time, volume, &r->step);
    return st == ST_OK ? render_status(leafcast_select_between(volume, r->field_number, r->step,
                                                               r->time.between))
                       : st;
}

status slice_request_place(slice_request *r, const leafcast *volume, bool drawn) {
    status st = ST_OK;
    transfer_list_release(&r->look.colours);
    if (drawn)
        st = medium_options_make(&r->medium, volume, r->field_number, r->step, true,
                                 &r->look.colours);
    return st == ST_OK ? slice_options_place(&r->place, volume) : st;
}

void slice_request_draw(slice_request *r, const double *value, uint32_t width, uint32_t height,
                        const leafcast_image *image) {
    double window[2];
    r->look.isovalues = r->isovalues;
    slice_picture_fill(&r->look, value, width, height, image);
    if (!r->legend)
        return;
    medium_options_window(&r->medium, &r->look.colours, window);
    legend_draw(image, width, height, &r->look.colours, window, "", NULL);
}
