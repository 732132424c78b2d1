#include "formats/grid/heights_slices.h"

#include <math.h>
#include <string.h>

typedef struct heights_source {
    mem *m;
    slice_source of;
    size_t row;  /* bytes of a row of elevations */
    char *whole; /* the one slice, once it is read; NULL: rows are read one by one */
    bool is_read;
} heights_source;

/* The second axis becomes the third. The elevation goes along what was the third, a unit long. */
static void turn(grid *g) {
    double length = 0.0;
    for (int row = 0; row < 3; row++)
        length += g->to_world[row][2] * g->to_world[row][2];
    length = sqrt(length);
    for (int row = 0; row < 3; row++) {
        const double up = g->to_world[row][2] / length;
        g->to_world[row][2] = g->to_world[row][1];
        g->to_world[row][1] = up;
    }
    const uint32_t rows = g->dims[1];
    g->dims[1] = 1;
    g->dims[2] = rows;
    g->heights = true;
}

void heights_layout(volume_layout *l) {
    if (l->g.dims[2] != 1 || grid_is_rectilinear(&l->g))
        return;
    turn(&l->g);
    for (int i = 0; i < ORDER_AXES && l->ordered; i++)
        l->order[i] = l->order[i] == ORDER_Y   ? ORDER_Z
                      : l->order[i] == ORDER_Z ? ORDER_Y
                                               : l->order[i];
}

static status read_whole(heights_source *h, uint32_t first, uint32_t count, char *to) {
    status st = h->is_read ? ST_OK : h->of.read(h->of.ctx, 0, 1, h->whole);
    h->is_read = true;
    if (st == ST_OK)
        memcpy(to, h->whole + first * h->row, count * h->row);
    return st;
}

/* Read rows into the first half of the slices, then give each its place, twice. */
static status read_rows(void *ctx, uint32_t first, uint32_t count, void *slices) {
    heights_source *h = ctx;
    char *to = slices;
    const status st =
        h->whole ? read_whole(h, first, count, to) : h->of.read(h->of.ctx, first, count, to);
    for (uint32_t i = count; st == ST_OK && i-- > 0;) {
        memmove(to + (2 * (size_t)i + 1) * h->row, to + i * h->row, h->row);
        memmove(to + 2 * (size_t)i * h->row, to + (2 * (size_t)i + 1) * h->row, h->row);
    }
    return st;
}

static status skip_rows(void *ctx, uint32_t count) {
    heights_source *h = ctx;
    return h->of.skip(h->of.ctx, count);
}

static status finish(void *ctx, uint64_t *trailing) {
    heights_source *h = ctx;
    *trailing = 0;
    return h->of.finish ? h->of.finish(h->of.ctx, trailing) : ST_OK;
}

static void next_step(void *ctx) {
    heights_source *h = ctx;
    h->of.next_step(h->of.ctx);
    h->is_read = false;
}

static void close_source(void *ctx) {
    heights_source *h = ctx;
    mem *m = h->m;
    slice_source_close(&h->of);
    mem_free(m, h->whole);
    mem_free(m, h);
}

static status check(const slice_source *s) {
    if (!s->g.heights && s->g.dims[2] != 1)
        return status_describe(ST_USAGE,
                               "%s: --heights takes a grid of one slice, and this one has %u",
                               s->name, s->g.dims[2]);
    if (grid_is_rectilinear(&s->g))
        return status_describe(ST_UNSUPPORTED, "%s: --heights takes a grid of even spacings",
                               s->name);
    return ST_OK;
}

static status make_room(heights_source *h, const slice_source *s) {
    const size_t width = sample_size(s->g.type);
    h->m = s->m;
    h->row = s->g.dims[0] * width;
    if (!s->g.heights && !(h->whole = mem_array(s->m, s->g.dims[1], h->row)))
        return ST_NOMEM;
    return ST_OK;
}

status heights_slices(slice_source *s) {
    status st = check(s);
    heights_source *h = st == ST_OK ? mem_zalloc(s->m, sizeof *h) : NULL;
    if (st == ST_OK)
        st = h ? make_room(h, s) : ST_NOMEM;
    if (st != ST_OK) {
        if (h)
            mem_free(s->m, h);
        return st;
    }
    h->of = *s;
    if (!s->g.heights)
        turn(&s->g);
    s->g.dims[1] = 2;
    for (int a = 0; a < 3; a++)
        h->of.g.axis[a] = NULL;
    s->read = read_rows;
    s->read_tiles = NULL;
    s->skip = s->skip && !h->whole ? skip_rows : NULL;
    s->place = NULL;
    s->finish = finish;
    s->next_step = s->next_step ? next_step : NULL;
    s->close = close_source;
    s->ctx = h;
    return ST_OK;
}
