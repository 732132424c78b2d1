#include "formats/grid/grid.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"

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

/* The volume of the parallelepiped of the three columns, each scaled to unit length: 1 for a right
 * angle between all, near 0 for columns that nearly lie in a plane. NaN or 0 when one is not finite
 * or zero. */
static double spread(const double m[3][4]) {
    double c[3][3];
    for (int a = 0; a < 3; a++) {
        double largest = fmax(fabs(m[0][a]), fmax(fabs(m[1][a]), fabs(m[2][a])));
        double x = m[0][a] / largest, y = m[1][a] / largest, z = m[2][a] / largest;
        double length = sqrt(x * x + y * y + z * z);
        c[a][0] = x / length;
        c[a][1] = y / length;
        c[a][2] = z / length;
    }
    return fabs(c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]));
}

status grid_check(const grid *g, const char *what) {
    for (int a = 0; a < 3; a++) {
        if (g->dims[a] < 2)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: %u sample%s along %c; a volume needs at least 2 on every "
                                   "axis",
                                   what, g->dims[a], g->dims[a] == 1 ? "" : "s", "xyz"[a]);
        if (g->dims[a] > GRID_DIM_MAX)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: %u samples along %c; at most %d are supported", what,
                                   g->dims[a], "xyz"[a], GRID_DIM_MAX);
    }
    if (!sample_size(g->type))
        return status_describe(ST_UNSUPPORTED, "%s: unknown sample type %d", what, (int)g->type);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            if (!isfinite(g->to_world[row][column]))
                return status_describe(ST_CORRUPT, "%s: spacing, directions or origin not finite",
                                       what);
    if (!(spread(g->to_world) > 1e-9))
        return status_describe(ST_CORRUPT,
                               "%s: the axes do not span space (a zero spacing, or directions that "
                               "lie in a plane)",
                               what);
    return ST_OK;
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

static void make_unit(grid *g, int a) {
    double x = g->to_world[0][a], y = g->to_world[1][a], z = g->to_world[2][a];
    double length = sqrt(x * x + y * y + z * z);
    for (int row = 0; row < 3; row++)
        g->to_world[row][a] /= length;
}

status grid_set_axis_text(grid *g, mem *m, const char *what, int a, const char *text) {
    uint32_t count = g->dims[a];
    double *coordinates = mem_array(m, count, sizeof *coordinates);
    if (!coordinates)
        return ST_NOMEM;
    status st = parse_coordinates(what, text, count, coordinates);
    if (st == ST_OK) {
        make_unit(g, a);
        st = grid_set_axis(g, m, what, a, coordinates);
    }
    mem_free(m, coordinates);
    return st;
}
