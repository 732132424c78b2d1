#include "render/bench/bench_hex_grid.h"

#include <string.h>

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_file.h"

static status make(hex_lattice *l, mem *m, const leaf_file *f) {
    const curvilinear_directory *d = curvilinear_directory_of(f);
    uint32_t(*nodes)[3] = mem_array(m, f->header.zones, sizeof *nodes);
    if (!nodes)
        return ST_NOMEM;
    for (uint32_t z = 0; z < f->header.zones; z++)
        memcpy(nodes[z], d->zones[z], sizeof nodes[z]);
    const status st = hex_lattice_make(l, m, (const uint32_t(*)[3])nodes, f->header.zones);
    mem_free(m, nodes);
    return st;
}

/* The place in its zone of element i of a treelet's, size[] of them along i, j, k. */
static void place_of(const curvilinear_where *w, uint32_t i, const uint32_t size[3],
                     uint32_t at[3]) {
    at[0] = w->first[0] + i % size[0];
    at[1] = w->first[1] + i / size[0] % size[1];
    at[2] = w->first[2] + i / (size[0] * size[1]);
}

static void take(hex_lattice *l, const hex_treelet *h, const float *values) {
    const curvilinear_directory *d = curvilinear_directory_of(h->f);
    const curvilinear_where *w = &d->where[h->id];
    const hex_zone *z = &l->zone[w->zone];
    const uint32_t *cells = d->counts[h->id], nodes[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
    uint32_t at[3];
    for (uint32_t i = 0; i < h->nodes; i++) {
        place_of(w, i, nodes, at);
        float *to = l->node[hex_lattice_node(z, at)];
        for (int a = 0; a < 3; a++)
            to[a] = hex_treelet_coordinates(h, a)[i];
        to[3] = values[i];
    }
    for (uint32_t i = 0; i < h->cells; i++) {
        place_of(w, i, cells, at);
        l->there[hex_lattice_cell(z, at)] = hex_treelet_code(h, i) != HEX_NONE;
    }
}

static status load(hex_lattice *l, mem *m, leaf_file *f) {
    leaf_unpacker *u = NULL;
    void *room = NULL;
    status st = f->geometry == &curvilinear_geometry
                    ? make(l, m, f)
                    : status_describe(ST_USAGE, "%s: no curvilinear grid", file_path(f->source));
    if (st == ST_OK)
        st = leaf_unpacker_create(m, f, &u);
    if (st == ST_OK &&
        !(room = mem_array(
              m, leaf_layout_aligned(leaf_layout_payload_max(&f->layout), LEAF_ALIGN_LOG2),
              HEX_TREELET_PAYLOADS)))
        st = ST_NOMEM;
    for (uint32_t t = 0; t < f->layout.treelets && st == ST_OK; t++) {
        hex_treelet h;
        const float *values;
        st = hex_treelet_load(f, t, 0, u, room, &h, &values);
        if (st == ST_OK)
            take(l, &h, values);
    }
    mem_free(m, room);
    leaf_unpacker_destroy(u);
    return st;
}

status bench_hex_grid_load(hex_lattice *l, mem *m, const char *path) {
    leaf_file *f = NULL;
    *l = (hex_lattice){.m = m};
    status st = leaf_file_open(m, path, &f);
    if (st == ST_OK)
        st = load(l, m, f);
    if (st == ST_OK)
        hex_lattice_finish(l);
    leaf_file_close(f);
    return st;
}
