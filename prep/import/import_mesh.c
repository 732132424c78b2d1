#include "prep/import/import_mesh.h"

#include "formats/curvilinear/curvilinear_stream.h"

enum { CHUNK = 1 << 13, ROOM = CHUNK * CELL_VERTICES_MAX }; /* ids */

_Static_assert((int)ROOM >= (int)MESH_STREAM_POLYHEDRON_MAX, "there is room for any polyhedron");

void import_mesh_close(import_mesh *x) {
    if (x->close)
        x->close(x->ctx);
    x->close = NULL;
}

typedef struct writing {
    import_mesh *x;
    mesh_stream_writer *w;
    curvilinear_stream_writer *grid; /* instead */
    void *buffer;                    /* CHUNK cells of the largest shape */
    status (*step)(const void *ctx, double fraction);
    const void *ctx;
    double done, all; /* bytes */
} writing;

static size_t chunk_of(uint64_t left) {
    return left < CHUNK ? (size_t)left : CHUNK;
}

static status went(writing *g, size_t bytes) {
    g->done += (double)bytes;
    return g->step(g->ctx, g->done / g->all);
}

static status write_points(writing *g) {
    const uint64_t points = g->x->header.points;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < points; i += CHUNK) {
        const size_t count = chunk_of(points - i);
        st = g->x->points(g->x->ctx, i, count, g->buffer);
        if (st == ST_OK)
            st = g->grid ? curvilinear_stream_places(g->grid, count, g->buffer)
                         : mesh_stream_points(g->w, count, g->buffer);
        if (st == ST_OK)
            st = went(g, count * 12);
    }
    return st;
}

static status write_values(writing *g, uint32_t field) {
    const uint64_t points = g->x->header.points;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < points; i += CHUNK) {
        const size_t count = chunk_of(points - i);
        st = g->x->values(g->x->ctx, field, i, count, g->buffer);
        if (st == ST_OK)
            st = g->grid ? curvilinear_stream_values(g->grid, count, g->buffer)
                         : mesh_stream_values(g->w, count, g->buffer);
        if (st == ST_OK)
            st = went(g, count * 4);
    }
    return st;
}

static status write_blanks(writing *g) {
    const uint64_t points = g->x->header.points;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && g->x->blanks && i < points; i += CHUNK) {
        const size_t count = chunk_of(points - i);
        st = g->x->blanks(g->x->ctx, i, count, g->buffer);
        if (st == ST_OK)
            st = curvilinear_stream_blanks(g->grid, count, g->buffer);
        if (st == ST_OK)
            st = went(g, count);
    }
    return st;
}

static status write_cells(writing *g, cell_shape shape, uint64_t cells) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < cells; i += CHUNK) {
        const size_t count = chunk_of(cells - i);
        st = g->x->cells(g->x->ctx, shape, i, count, g->buffer);
        if (st == ST_OK)
            st = mesh_stream_cells(g->w, shape, count, g->buffer);
        if (st == ST_OK)
            st = went(g, count * 4 * (size_t)cell_shape_vertices(shape));
    }
    return st;
}

static status write_polyhedra(writing *g) {
    uint64_t left = g->x->header.numbers;
    status st = ST_OK;
    while (st == ST_OK && left > 0) {
        size_t count = 0;
        st = g->x->polyhedra(g->x->ctx, ROOM, g->buffer, &count);
        if (st == ST_OK)
            st = mesh_stream_numbers(g->w, count, g->buffer);
        if (st == ST_OK)
            st = went(g, count * 4);
        left -= count;
    }
    return st;
}

static uint64_t cells_of(const mesh_stream_header *h, cell_shape shape) {
    return shape == CELL_TET ? h->tets : h->cells[shape];
}

/* In the order of mesh_stream.h. */
static const cell_shape shapes[] = {CELL_TET, CELL_PYRAMID, CELL_WEDGE, CELL_HEXAHEDRON,
                                    CELL_QUADRATIC_TET};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static status write_all(writing *g) {
    const mesh_stream_header *h = &g->x->header;
    const uint32_t fields = h->field[0] ? 1 + h->field_count : 0;
    g->all = (double)h->points * (12 + 4 * fields);
    for (int i = 0; i < SHAPES; i++)
        g->all += (double)cells_of(h, shapes[i]) * 4 * cell_shape_vertices(shapes[i]);
    g->all += (double)h->numbers * 4;
    g->all += g->x->blanks ? (double)h->points : 0;
    status st = write_points(g);
    if (st == ST_OK)
        st = write_blanks(g);
    for (uint32_t k = 0; k < fields && st == ST_OK; k++)
        st = write_values(g, k);
    for (int i = 0; i < SHAPES && st == ST_OK; i++)
        st = write_cells(g, shapes[i], cells_of(h, shapes[i]));
    return st == ST_OK ? write_polyhedra(g) : st;
}

/* ---- a file ---- */

static status begin_grid(mem *m, writing *g, const char *path, bool force) {
    const mesh_stream_header *h = &g->x->header;
    const char **fields = mem_array(m, (size_t)h->field_count + 1, sizeof *fields);
    if (!fields)
        return ST_NOMEM;
    fields[0] = h->field;
    for (uint32_t i = 0; i < h->field_count; i++)
        fields[i + 1] = h->fields[i];
    const curvilinear_stream_header head = {.name = h->name,
                                            .fields = fields,
                                            .field_count = h->field[0] ? 1 + h->field_count : 0,
                                            .nodes = g->x->zones,
                                            .zones = g->x->zone_count,
                                            .blanked = g->x->blanks != NULL};
    const status st = curvilinear_stream_create(m, path, force, &head, &g->grid);
    mem_free(m, fields);
    return st;
}

static status begin(mem *m, writing *g, const char *path, bool force) {
    g->buffer = mem_array(m, ROOM, sizeof(uint32_t));
    if (!g->buffer)
        return ST_NOMEM;
    return g->x->zone_count ? begin_grid(m, g, path, force)
                            : mesh_stream_create(m, path, force, &g->x->header, &g->w);
}

static status end(writing *g, status st) {
    if (st != ST_OK) {
        mesh_stream_discard(g->w);
        curvilinear_stream_discard(g->grid);
        return st;
    }
    return g->grid ? curvilinear_stream_commit(g->grid) : mesh_stream_commit(g->w);
}

status import_mesh_write(mem *m, import_mesh *x, const char *path, bool force,
                         status (*step)(const void *ctx, double fraction), const void *ctx) {
    writing g = {.x = x, .step = step, .ctx = ctx};
    x->header.bare = !x->header.field[0];
    status st = begin(m, &g, path, force);
    if (st == ST_OK)
        st = write_all(&g);
    st = end(&g, st);
    mem_free(m, g.buffer);
    return st;
}
