#include "render/app/slice_options.h"

#include <math.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/cli_value.h"
#include "formats/base/num.h"
#include "render/app/render_job.h"

enum {
    AXIS = SLICE_OPTIONS_FIRST,
    AT,
    INDEX,
    PLANE,
    ORIGIN,
    EDGE_U,
    EDGE_V,
    LINE,
    SWEEP,
    SIZE,
    NEAREST,
    LEVEL
};
enum { LINE_POINTS_MAX = 1 << 20 };

const struct argp_option slice_options_table[SLICE_OPTIONS_COUNT] = {
    {NULL, 0, NULL, 0, "Where (across z in the middle; one of these ways):", 1},
    {"axis", AXIS, "x|y|z", CLI_BASIC, "across this axis (z)", 0},
    {"at", AT, "POS", CLI_BASIC, "at this coordinate along the axis (the middle)", 0},
    {"index", INDEX, "N", CLI_BASIC,
     "grids: through the nodes of this number along the axis, counted from 0", 0},
    {"plane", PLANE, "A,B,C,D", CLI_BASIC,
     "in the plane Ax + By + Cz + D = 0, seen from where A,B,C points", 0},
    {"origin", ORIGIN, "X,Y,Z", 0, "a rectangle's left upper corner; --u and --v are its edges", 0},
    {"u", EDGE_U, "X,Y,Z", 0, "the rectangle's upper edge, to the right", 0},
    {"v", EDGE_V, "X,Y,Z", 0, "the rectangle's left edge, downwards", 0},
    {"line", LINE, "X,Y,Z;X,Y,Z...", 0,
     "a curved slice, whose upper edge is this polyline; --sweep leads to the lower one", 0},
    {"sweep", SWEEP, "X,Y,Z", 0, "from the line to the curved slice's lower edge", 0},
    {NULL, 0, NULL, 0, "What:", 2},
    {"size", SIZE, "WxH", CLI_BASIC, "pixels (one a cell; meshes: 512 and more on the longer side)",
     0},
    {"nearest", NEAREST, NULL, CLI_BASIC, "the nearest sample instead of interpolated values", 0},
    {"level", LEVEL, "N", 0, "level of detail, each half as fine as the one before (0)", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static bool was_given(const slice_options *o, int key) {
    return o->given >> (key - SLICE_OPTIONS_FIRST) & 1u;
}

/* ---- One flag ---- */

static status set_size(slice_options *o, const char *text) {
    enum { SIDE_MAX = 65536 };
    double size[2];
    status st = num_doubles(text, "--size", strchr(text, 'x') ? "x" : ",", 2, size);
    for (int i = 0; i < 2 && st == ST_OK; i++)
        if (!(size[i] >= 1.0 && size[i] <= SIDE_MAX && size[i] == floor(size[i])))
            st = status_describe(ST_USAGE, "--size: \"%s\" is not WxH, each 1 to %d", text,
                                 SIDE_MAX);
    if (st == ST_OK) {
        o->slice.width = (uint32_t)size[0];
        o->slice.height = (uint32_t)size[1];
    }
    return st;
}

/* Read the point at the start of `text`; *end is the ';' or the end behind it. */
static status one_point(const char *text, const char **end, double point[3]) {
    char copy[256];
    const size_t length = strcspn(text, ";");
    if (length >= sizeof copy)
        return status_describe(ST_USAGE, "--line: a point is no X,Y,Z: \"%.40s...\"", text);
    memcpy(copy, text, length);
    copy[length] = 0;
    *end = text + length;
    return cli_vector(copy, "--line", 3, point);
}

static status set_line(slice_options *o, const char *text) {
    size_t points = 1;
    for (const char *c = text; *c; c++)
        points += *c == ';';
    if (points < 2 || points > LINE_POINTS_MAX)
        return status_describe(ST_USAGE, "--line: %zu points: 2 to %d are a line", points,
                               LINE_POINTS_MAX);
    mem_free(o->m, o->line);
    o->line = mem_array(o->m, points, sizeof *o->line);
    if (!o->line)
        return ST_NOMEM;
    status st = ST_OK;
    for (size_t i = 0; i < points && st == ST_OK; i++) {
        st = one_point(text, &text, o->line[i]);
        text++;
    }
    o->slice.line = (const double(*)[3])o->line;
    o->slice.line_count = (uint32_t)points;
    return st;
}

static status set_place(slice_options *o, int key, const char *text) {
    switch (key) {
    case AXIS: return cli_word(text, "--axis", "x|y|z", &o->axis);
    case AT: return cli_finite(text, "--at", -HUGE_VAL, HUGE_VAL, &o->at);
    case INDEX: return cli_uint(text, "--index", 0, UINT32_MAX, &o->index);
    case PLANE: return cli_vector(text, "--plane", 4, o->plane);
    case ORIGIN: return cli_vector(text, "--origin", 3, o->slice.origin);
    case EDGE_U: return cli_vector(text, "--u", 3, o->slice.u);
    case EDGE_V: return cli_vector(text, "--v", 3, o->slice.v);
    case LINE: return set_line(o, text);
    case SWEEP: return cli_vector(text, "--sweep", 3, o->slice.v);
    default: return ST_AGAIN;
    }
}

status slice_options_set(slice_options *o, int key, const char *text) {
    status st = ST_OK;
    switch (key) {
    case SIZE: st = set_size(o, text); break;
    case NEAREST: o->slice.interpolation = LEAFCAST_INTERPOLATION_NEAREST; break;
    case LEVEL: st = cli_uint(text, "--level", 0, 63, &o->slice.level); break;
    default: st = set_place(o, key, text);
    }
    if (st == ST_OK)
        o->given |= UINT64_C(1) << (key - SLICE_OPTIONS_FIRST);
    return st;
}

/* ---- All of them ---- */

/* The flags of each way to describe a slice. all: every one is required, else the first. */
static const struct {
    slice_way way;
    int keys[3];
    bool all;
    const char *names;
} WAYS[] = {{SLICE_LAYER, {INDEX, AXIS, AXIS}, false, "--index"},
            {SLICE_ACROSS, {AT, AXIS, AXIS}, false, "--at"},
            {SLICE_PLANE, {PLANE, PLANE, PLANE}, true, "--plane"},
            {SLICE_FRAME, {ORIGIN, EDGE_U, EDGE_V}, true, "--origin, --u and --v"},
            {SLICE_LINE, {LINE, SWEEP, SWEEP}, true, "--line and --sweep"}};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

static int keys_given(const slice_options *o, int way) {
    int count = 0;
    for (int i = 0; i < 3; i++)
        count += was_given(o, WAYS[way].keys[i]);
    return count;
}

/* Returns whether no flag of another way was given. */
static bool only(const slice_options *o, int way) {
    bool others = false;
    for (int key = AXIS; key <= SWEEP; key++) {
        bool own = false;
        for (int i = 0; i < 3; i++)
            own |= WAYS[way].keys[i] == key;
        others |= was_given(o, key) && !own;
    }
    return !others;
}

status slice_options_check(slice_options *o) {
    if (!was_given(o, AXIS))
        o->axis = 2;
    o->fit = !was_given(o, SIZE);
    o->way = SLICE_ACROSS;
    for (int i = 0; i < WAY_COUNT; i++) {
        const int count = keys_given(o, i);
        if (count == 0)
            continue;
        if (!only(o, i))
            continue;
        if (WAYS[i].all && count < 3)
            return status_describe(ST_USAGE, "where? %s go together", WAYS[i].names);
        if (!WAYS[i].all && !was_given(o, WAYS[i].keys[0]))
            continue; /* --axis alone means the middle */
        o->way = WAYS[i].way;
        return ST_OK;
    }
    for (int key = AT; key <= SWEEP; key++)
        if (was_given(o, key))
            return status_describe(ST_USAGE, "where? One of --axis with --at or --index, --plane, "
                                             "--origin with --u and --v, --line with --sweep");
    return ST_OK;
}

static status place_across(slice_options *o, const leafcast *volume) {
    const leafcast_info info = leafcast_describe(volume);
    /* Choose the side from which x, or else y, points to the right. */
    const double side = o->axis == 1 ? -1.0 : 1.0;
    const double middle = 0.5 * (info.bounds[0][o->axis] + info.bounds[1][o->axis]);
    double plane[4] = {0};
    plane[o->axis] = side;
    plane[3] = -side * (was_given(o, AT) ? o->at : middle);
    return render_status(leafcast_plane_slice(volume, plane, &o->slice));
}

static status place(slice_options *o, const leafcast *volume) {
    switch (o->way) {
    case SLICE_ACROSS: return place_across(o, volume);
    case SLICE_LAYER:
        return render_status(leafcast_layer_slice(volume, o->axis, o->index, &o->slice));
    case SLICE_PLANE: return render_status(leafcast_plane_slice(volume, o->plane, &o->slice));
    default: return o->fit ? render_status(leafcast_fit_slice(volume, &o->slice)) : ST_OK;
    }
}

/* Enlarge slices of volumes without layers of nodes: more pixels show the values inside of their
 * cells. */
static void enlarge(leafcast_slice_pixels *s) {
    enum { SIDE = 512 };
    const uint32_t longest = s->width > s->height ? s->width : s->height;
    const uint32_t times = longest < SIDE ? (SIDE + longest - 1) / longest : 1;
    s->width *= times;
    s->height *= times;
}

status slice_options_place(slice_options *o, const leafcast *volume) {
    const uint32_t width = o->slice.width, height = o->slice.height;
    o->slice.size = sizeof o->slice;
    const status st = place(o, volume);
    if (st == ST_OK && o->fit && !(leafcast_describe(volume).abilities & LEAFCAST_ABILITY_LAYERS))
        enlarge(&o->slice);
    if (!o->fit) {
        o->slice.width = width;
        o->slice.height = height;
    }
    return st;
}

void slice_options_release(slice_options *o) {
    mem_free(o->m, o->line);
    o->line = NULL;
}
