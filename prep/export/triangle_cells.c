#include "prep/export/triangle_cells.h"

#include "formats/leaf/triangle_geometry.h"
#include "formats/leaf/triangle_normal.h"
#include "prep/export/cell_source.h"
#include "prep/export/hex_bench.h"

typedef struct bench {
    hex_bench of;
    float *name; /* what a vertex's key is made from */
} bench;

enum { PLACE = 5 }; /* floats of a name: the coordinates, and both halves of the normal's code */

static size_t name_of(const cell_choice *c) {
    return PLACE + (size_t)c->count;
}

/* Set a vertex's normal, and what tells it from others. */
static void take_normal(const bench *b, uint32_t n, double normal[3], float name[2]) {
    const hex_treelet *tr = &b->of.tr;
    const triangle_shape s = triangle_shape_of(tr->f->layout.counts[tr->id]);
    const uint32_t *codes = triangle_place_normals(&s, tr->places);
    const uint32_t code = codes ? codes[n] : TRIANGLE_NO_NORMAL;
    (void)triangle_normal_decode(code, normal);
    name[0] = (float)(code & 0xffff);
    name[1] = (float)(code >> 16);
}

uint64_t triangle_cells_worker(const cell_choice *c) {
    return hex_bench_bytes(c) + name_of(c) * sizeof(float) + 1024;
}

/* A vertex has the same number in the piece as in the treelet. */
static status add_vertex(bench *b, uint32_t n, piece *p) {
    piece_vertex v = {.at = {0}};
    uint32_t index;
    hex_bench_at(&b->of, n, b->name);
    for (uint32_t i = 0; i < b->of.choice->count; i++)
        b->name[PLACE + i] = b->of.value[i][n];
    take_normal(b, n, v.normal, b->name + 3);
    for (int a = 0; a < 3; a++)
        v.at[a] = (double)b->name[a];
    const status st = piece_add_vertex(p, &v, &index);
    return st == ST_OK ? piece_add_share(p, index, piece_key(b->name, name_of(b->of.choice))) : st;
}

static status make(void *bench_of, uint32_t treelet, piece *p) {
    bench *b = bench_of;
    status st = hex_bench_load(&b->of, treelet);
    for (uint32_t n = 0; st == ST_OK && n < b->of.tr.nodes; n++)
        st = add_vertex(b, n, p);
    for (uint32_t i = 0; st == ST_OK && i < b->of.tr.cells; i++) {
        uint32_t row[CELL_ROW];
        hex_treelet_row(&b->of.tr, i, row);
        st = piece_add_triangle(p, row);
    }
    p->values = b->of.value;
    return st;
}

static status create(mem *m, const cell_choice *choice, void *bench_of) {
    bench *b = bench_of;
    const status st = hex_bench_create(m, choice, &b->of);
    if (st != ST_OK)
        return st;
    b->name = mem_array(m, name_of(choice), sizeof *b->name);
    return b->name ? ST_OK : ST_NOMEM;
}

static void release(void *bench_of) {
    bench *b = bench_of;
    hex_bench_release(&b->of);
    mem_free(b->of.m, b->name);
}

status triangle_cells_create(mem *m, const cell_choice *choice, int threads, piece_source *out) {
    static const cell_source_kind kind = {sizeof(bench), create, release, make, .flat = true};
    return cell_source_create(m, &kind, choice, NULL, 0, threads, out);
}
