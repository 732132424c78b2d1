#include "formats/grid/grid.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/leaf/leaf_place.h"

void grid_init(grid *g, const uint32_t dims[3], sample_type type) {
    memset(g, 0, sizeof *g);
    memcpy(g->dims, dims, sizeof g->dims);
    g->type = type;
    for (int a = 0; a < 3; a++)
        g->to_world[a][a] = 1;
}

static status check_axis(const char *what, int a, const double *x, uint32_t count) {
    double sign = count > 1 && x[1] < x[0] ? -1 : 1;
    for (uint32_t i = 0; i < count; i++) {
        char text[NUM_TEXT_MAX];
        if (!isfinite(x[i]))
            return status_describe(ST_CORRUPT, "%s: coordinate %u along %c is %s, not finite", what,
                                   i, "xyz"[a], num_print(x[i], text));
        if (i > 0 && !(sign * x[i] > sign * x[i - 1]))
            return status_describe(ST_CORRUPT,
                                   "%s: coordinate %u along %c is %s, which does not go on %s from "
                                   "the one before",
                                   what, i, "xyz"[a], num_print(x[i], text),
                                   sign > 0 ? "upwards" : "downwards");
    }
    return ST_OK;
}

static status make_axes(grid *g, mem *m) {
    for (int a = 0; a < 3; a++) {
        if (g->axis[a])
            continue;
        g->axis[a] = mem_array(m, g->dims[a], sizeof(double));
        if (!g->axis[a])
            return ST_NOMEM;
        for (uint32_t i = 0; i < g->dims[a]; i++)
            g->axis[a][i] = i;
    }
    return ST_OK;
}

status grid_set_axis(grid *g, mem *m, const char *what, int a, const double *coordinates) {
    status st = check_axis(what, a, coordinates, g->dims[a]);
    if (st == ST_OK)
        st = make_axes(g, m);
    if (st != ST_OK)
        return st;
    bool down = g->dims[a] > 1 && coordinates[1] < coordinates[0];
    for (uint32_t i = 0; i < g->dims[a]; i++)
        g->axis[a][i] = down ? -coordinates[i] : coordinates[i];
    for (int row = 0; down && row < 3; row++)
        g->to_world[row][a] = -g->to_world[row][a];
    return ST_OK;
}

/* Check the grid's place by the same rule as readers of treelet files. */
static status check_place(const grid *g, const char *what) {
    char why[LEAF_PLACE_TEXT];
    bool sound = leaf_place_grid((const double *)g->to_world, why);
    for (int a = 0; sound && g->axis[0] && a < 3; a++)
        sound = g->dims[a] < 2 || /* nothing is apart */
                leaf_place_axis((const double *)g->to_world, a, g->axis[a], g->dims[a], why);
    return sound ? ST_OK : status_describe(ST_CORRUPT, "%s: %s", what, why);
}

static status refuse_flat(const grid *g, const char *what, int a) {
    return status_describe(
        ST_UNSUPPORTED, "%s: %u sample%s along %c; a volume needs at least 2 on every axis%s", what,
        g->dims[a], g->dims[a] == 1 ? "" : "s", "xyz"[a],
        a == 2 && g->dims[a] == 1 && !g->axis[0] ? " (convert --heights makes terrain of it)" : "");
}

status grid_check_volume(const grid *g, const char *what) {
    const status st = grid_check(g, what);
    return st == ST_OK && g->dims[2] < 2 ? refuse_flat(g, what, 2) : st;
}

/* The axis along which a single sample may do. */
static int thin_axis(const grid *g) {
    return g->heights ? 1 : 2;
}

status grid_check(const grid *g, const char *what) {
    for (int a = 0; a < 3; a++) {
        if (g->dims[a] < 2 && !(g->dims[a] == 1 && a == thin_axis(g)))
            return refuse_flat(g, what, a);
        if (g->dims[a] > GRID_DIM_MAX)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: %u samples along %c; at most %d are supported", what,
                                   g->dims[a], "xyz"[a], GRID_DIM_MAX);
    }
    if (!sample_size(g->type) || sample_widened(g->type) != g->type)
        return status_describe(ST_UNSUPPORTED, "%s: unknown sample type %d", what, (int)g->type);
    return check_place(g, what);
}

bool grid_is_rectilinear(const grid *g) {
    return g->axis[0] != NULL;
}

sample_type grid_source(const grid *g) {
    return g->source ? g->source : g->type;
}

uint64_t grid_samples(const grid *g) {
    return (uint64_t)g->dims[0] * g->dims[1] * g->dims[2];
}

uint64_t grid_slice_bytes(const grid *g) {
    return (uint64_t)g->dims[0] * g->dims[1] * sample_size(g->type);
}

void grid_release(grid *g, mem *m) {
    for (int a = 0; a < 3; a++) {
        mem_free(m, g->axis[a]);
        g->axis[a] = NULL;
    }
}

static status parse_coordinates(const char *what, const char *text, uint32_t count, double *out) {
    static const char gaps[] = " \t\r\n,";
    for (uint32_t i = 0;; i++) {
        text += strspn(text, gaps);
        size_t length = strcspn(text, gaps);
        if (length == 0 && i == count)
            return ST_OK;
        char token[64];
        if (length == 0 || i == count)
            return status_describe(ST_CORRUPT, "%s: %s than %u coordinates", what,
                                   length == 0 ? "fewer" : "more", count);
        size_t kept = length < sizeof token ? length : sizeof token - 1;
        memcpy(token, text, kept);
        token[kept] = 0;
        if (num_double(token, what, &out[i]) != ST_OK)
            return ST_CORRUPT;
        text += length;
    }
}

status grid_set_axis_text(grid *g, mem *m, const char *what, int a, const char *text) {
    uint32_t count = g->dims[a];
    double *coordinates = mem_array(m, count, sizeof *coordinates);
    if (!coordinates)
        return ST_NOMEM;
    status st = parse_coordinates(what, text, count, coordinates);
    if (st == ST_OK)
        st = grid_set_axis(g, m, what, a, coordinates);
    mem_free(m, coordinates);
    return st;
}
