#include "prep/import/cgns/cgns_mesh.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/leaf/curvilinear_zones.h"
#include "prep/import/cgns/cgns_cells.h"
#include "prep/import/cgns/cgns_fields.h"

typedef struct cgns {
    cgns_file file;
    cgns_fields fields;
    cgns_cells cells;
    cgns_walk *walk;      /* over cells of one shape */
    cgns_cell next;       /* a polyhedron that has been read, but not given */
    bool begun, held;     /* polyhedra; it */
    uint32_t (*zones)[3]; /* NULL: not all are structured, or one has no cells */
} cgns;

static void close_cgns(void *ctx) {
    cgns *x = ctx;
    mem *m = x->file.m;
    mem_free(m, x->walk);
    mem_free(m, x->zones);
    cgns_cells_release(&x->cells);
    cgns_fields_release(&x->fields);
    cgns_file_close(&x->file);
    mem_free(m, x);
}

/* Find the zones' sizes, if all are structured. */
static status find_zones(cgns *x) {
    const cgns_file *f = &x->file;
    bool all = f->zone_count > 0;
    for (int z = 0; z < f->zone_count; z++)
        for (int a = 0; a < 3; a++)
            all = all && f->zones[z].structured && f->zones[z].dims[a] >= 2 &&
                  f->zones[z].dims[a] <= CURVILINEAR_NODES_MAX;
    if (!all)
        return ST_OK;
    x->zones = mem_array(f->m, (size_t)f->zone_count, sizeof *x->zones);
    for (int z = 0; x->zones && z < f->zone_count; z++)
        for (int a = 0; a < 3; a++)
            x->zones[z][a] = (uint32_t)f->zones[z].dims[a];
    return x->zones ? ST_OK : ST_NOMEM;
}

static void set_zones(const cgns *x, import_mesh *out) {
    out->zones = (const uint32_t(*)[3])x->zones;
    out->zone_count = x->zones ? (uint32_t)x->file.zone_count : 0;
    out->still = true; /* else only the first step is read */
}

static status open_cgns(mem *m, const import_request *q, cgns **out) {
    cgns *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    status st = cgns_file_open(m, q, &x->file);
    if (st == ST_OK)
        st = cgns_fields_open(&x->file, &x->fields);
    if (st == ST_OK)
        st = find_zones(x);
    if (st != ST_OK) {
        close_cgns(x);
        return st;
    }
    *out = x;
    return ST_OK;
}

static void read_title(const cgns *x, char to[MESH_NAME_MAX + 1]) {
    char name[CGNS_NAME] = "";
    int cell_axes, axes;
    if (cg_base_read(x->file.id, x->file.base, name, &cell_axes, &axes) != CG_OK)
        name[0] = 0;
    text_name(to, MESH_NAME_MAX + 1, name);
}

/* ---- reading ---- */

static status give_points(void *ctx, uint64_t first, size_t count, float (*xyz)[3]) {
    const cgns *x = ctx;
    return cgns_file_points(&x->file, first, count, xyz);
}

static status give_values(void *ctx, uint32_t field, uint64_t first, size_t count, float *to) {
    cgns *x = ctx;
    return cgns_fields_read(&x->fields, &x->cells, field, first, count, to);
}

static status give_cells(void *ctx, cell_shape shape, uint64_t first, size_t count, uint32_t *ids) {
    cgns *x = ctx;
    const size_t corners = (size_t)cell_shape_vertices(shape);
    status st = ST_OK;
    if (first == 0)
        cgns_walk_begin(x->walk, &x->cells, (int)shape);
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        cgns_cell cell;
        bool more;
        st = cgns_walk_next(x->walk, &cell, &more);
        if (st == ST_OK && !more)
            st = status_describe(ST_CORRUPT, "%s: fewer cells than were counted", x->file.path);
        if (st == ST_OK)
            memcpy(ids + i * corners, cell.ids, corners * sizeof *ids);
    }
    return st;
}

/* Give a polyhedron's numbers. */
static void give_numbers(const mesh_polyhedron *p, uint32_t *to) {
    to[0] = (uint32_t)p->size + 1;
    to[1] = (uint32_t)p->faces;
    for (size_t i = 0; i < p->size; i++)
        to[2 + i] = (uint32_t)p->stream[i];
}

static status give_polyhedra(void *ctx, size_t room, uint32_t *to, size_t *count) {
    cgns *x = ctx;
    status st = ST_OK;
    *count = 0;
    if (!x->begun)
        cgns_walk_begin(x->walk, &x->cells, CGNS_POLYHEDRA);
    x->begun = true;
    for (bool more = true; st == ST_OK;) {
        if (!x->held)
            st = cgns_walk_next(x->walk, &x->next, &more);
        const mesh_polyhedron *p = &x->next.polyhedron;
        x->held = st == ST_OK && more && p->size + 2 > room - *count;
        if (st != ST_OK || !more || x->held)
            break;
        give_numbers(p, to + *count);
        *count += p->size + 2;
    }
    return st == ST_OK && *count == 0
               ? status_describe(ST_CORRUPT, "%s: fewer cells than were counted", x->file.path)
               : st;
}

static void describe(const cgns *x, import_mesh *out) {
    mesh_stream_header *h = &out->header;
    read_title(x, h->name);
    h->points = x->file.nodes;
    import_fields_describe(&x->fields.all, h);
    if (out->zone_count)
        return;
    h->tets = x->cells.of[CELL_TET];
    memcpy(h->cells, x->cells.of, sizeof h->cells);
    h->cells[CELL_TET] = 0; /* told apart */
    h->polyhedra = x->cells.polyhedra;
    h->numbers = x->cells.numbers;
    h->middles = x->cells.middles;
    h->by_corners = x->cells.higher;
    h->skipped = x->cells.skipped;
}

status cgns_mesh_open(mem *m, const import_request *q, import_mesh *out) {
    cgns *x = NULL;
    status st = open_cgns(m, q, &x);
    if (st != ST_OK)
        return st;
    *out = (import_mesh){.ctx = x,
                         .points = give_points,
                         .values = give_values,
                         .cells = give_cells,
                         .polyhedra = give_polyhedra,
                         .close = close_cgns};
    if (q->zones && !x->zones)
        return status_describe(ST_UNSUPPORTED,
                               "%s: --zones: expected structured zones of 2 nodes or more along "
                               "each axis",
                               x->file.path);
    if (q->zones)
        set_zones(x, out);
    x->walk = mem_alloc(m, sizeof *x->walk);
    st = x->walk ? import_fields_take(&x->fields.all, q) : ST_NOMEM;
    if (st == ST_OK)
        st = cgns_cells_open(&x->file, q->by_corners, &x->cells);
    if (st == ST_OK)
        describe(x, out);
    return st;
}

status cgns_mesh_list(mem *m, const import_request *q, const import_list *to) {
    cgns *x = NULL;
    char title[MESH_NAME_MAX + 1];
    status st = open_cgns(m, q, &x);
    if (st != ST_OK)
        return st;
    read_title(x, title);
    st = import_fields_list(&x->fields.all, q, title, x->file.nodes, to);
    import_mesh of_zones = {.close = NULL};
    set_zones(x, &of_zones);
    if (st == ST_OK && to->grid && x->zones)
        st = to->grid(to->ctx, &of_zones);
    close_cgns(x);
    return st;
}
