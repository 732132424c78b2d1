#include "formats/public_grid.h"

#include <math.h>
#include <string.h>

/* Squares and quotients of numbers in this range are neither 0 nor infinite. */
#define PLACE_MOST  1e100
#define PLACE_LEAST 1e-100

static const public_field to_world_row = {
    .type = PUBLIC_DOUBLE, .values = 12, .least = -PLACE_MOST, .most = PLACE_MOST};

static const public_field grid_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_grid),
    PUBLIC_NUMBER(leafcast_grid, dims, 2, GRID_DIM_MAX, 0),
    PUBLIC_NUMBER(leafcast_grid, type, LEAFCAST_U8, LEAFCAST_F64, 0),
    PUBLIC_NUMBER(leafcast_grid, spacing, -PLACE_MOST, PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_grid, origin, -PLACE_MOST, PLACE_MOST, 0),
    {PUBLIC_MEMBER(leafcast_grid, to_world), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .number = &to_world_row},
    PUBLIC_PLACE(leafcast_grid, axis, PUBLIC_OR_NULL),
};

/* Check the columns of to_world, or the spacing: these are the cell's edges. */
static status grid_together(const void *of) {
    const leafcast_grid *g = of;
    for (int a = 0; a < 3; a++) {
        double most = fabs(g->spacing[a]);
        if (g->to_world)
            most = fmax(fabs(g->to_world[a]),
                        fmax(fabs(g->to_world[4 + a]), fabs(g->to_world[8 + a])));
        if (most < PLACE_LEAST && (g->to_world || most != 0.0))
            return status_describe(
                ST_USAGE, "leafcast_grid.%s: cells of %g along %c: %g is the least",
                g->to_world ? "to_world" : "spacing", most, "xyz"[a], PLACE_LEAST);
    }
    return ST_OK;
}

const public_fields public_grid_table =
    PUBLIC_TABLE(leafcast_grid, grid_rows, .together = grid_together);

status public_grid_check(const leafcast_grid *from) {
    return public_fields_check(&public_grid_table, from);
}

status public_grid_check_strides(const uint32_t dims[3], const ptrdiff_t strides[3]) {
    double most = 0.0;
    for (int a = 0; a < 3; a++)
        most += fabs((double)strides[a]) * (dims[a] - 1.0);
    if (most <= 0x1p62)
        return ST_OK;
    return status_describe(ST_USAGE, "strides of %td, %td and %td bytes: no array is that large",
                           strides[0], strides[1], strides[2]);
}

static void place_nodes(const leafcast_grid *from, grid *g) {
    for (int row = 0; row < 3; row++) {
        g->to_world[row][row] = from->spacing[row] == 0 ? 1 : from->spacing[row];
        g->to_world[row][3] = from->origin[row];
    }
    if (from->to_world)
        memcpy(g->to_world, from->to_world, sizeof g->to_world);
}

status public_grid_make(mem *m, const leafcast_grid *from, grid *g) {
    grid_init(g, from->dims, (sample_type)from->type);
    place_nodes(from, g);
    status st = grid_check_volume(g, "leafcast_grid");
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (from->axis[a])
            st = grid_set_axis(g, m, "leafcast_grid", a, from->axis[a]);
    /* A grid that is not valid is the caller's error here, not a malformed file's. */
    return st == ST_CORRUPT || st == ST_UNSUPPORTED ? ST_USAGE : st;
}
