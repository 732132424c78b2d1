#include "formats/leaf/mesh_facts.h"

#include <string.h>

#include "formats/base/num.h"
#include "formats/leaf/leaf_stats.h"

static unsigned long long whole(uint64_t n) {
    return n;
}

/* Bytes before compression: positions, values, indices as in mesh streams; indices once. */
static double raw_bytes(const leaf_file *f) {
    const leaf_header *h = &f->header;
    return (double)h->vertices * (12 * (double)f->layout.places + 4 * (double)f->layout.sets) +
           16 * (double)h->tets;
}

static void tell_tets(const leaf_header *h, const fact_sheet *to) {
    double bounds[6];
    for (int i = 0; i < 6; i++)
        bounds[i] = (double)h->bounds[i];
    fact_sheet_line(to, "mesh", "%llu tets, %llu vertices", whole(h->tets), whole(h->vertices));
    if (h->flat || h->inverted)
        fact_sheet_line(to, "tets", "%llu flat, %llu inverted", whole(h->flat), whole(h->inverted));
    if (h->repeated || h->bad)
        fact_sheet_line(to, "left out",
                        "%llu tets with a vertex twice, %llu with a vertex that is none",
                        whole(h->repeated), whole(h->bad));
    fact_sheet_text(to, "field", h->field);
    fact_sheet_whole(to, "tets", h->tets);
    fact_sheet_whole(to, "vertices", h->vertices);
    fact_sheet_whole(to, "flat", h->flat);
    fact_sheet_whole(to, "inverted", h->inverted);
    fact_sheet_whole(to, "repeated", h->repeated);
    fact_sheet_whole(to, "bad", h->bad);
    fact_sheet_reals(to, "bounds", bounds, 6);
}

static void print_extras(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    char a[NUM_TEXT_MAX], b[NUM_TEXT_MAX];
    if (h->gradients)
        fact_sheet_line(to, "gradients", "of every field and step");
    leaf_tell_coarse(f, to);
    for (int i = 0; i < 3; i++)
        fact_sheet_line(to, i ? "" : "bounds", "%s .. %s", num_print((double)h->bounds[i], a),
                        num_print((double)h->bounds[i + 3], b));
}

static void tell_treelets(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const double raw = raw_bytes(f), each = (double)h->file_bytes / (double)h->tets;
    fact_sheet_line(to, "treelets", "%llu of up to %u tets, leaves of up to %u, runs at %u, %s",
                    whole(h->treelets), h->treelet_tets, h->leaf_tets, 1u << h->run_align_log2,
                    leaf_tell_codec(f));
    fact_sheet_whole(to, "treelet_tets", h->treelet_tets);
    fact_sheet_whole(to, "leaf_tets", h->leaf_tets);
    fact_sheet_line(to, "file", "%llu bytes, %.2f a tet, %.3f of the mesh", whole(h->file_bytes),
                    each, (double)h->file_bytes / raw);
    leaf_tell_bytes(f, to, raw);
    fact_sheet_real(to, "bytes_per_tet", each);
}

/* ---- what payloads are made of ---- */

typedef struct mesh_part {
    const char *name, *key;
    uint64_t count, bytes;
} mesh_part;

enum { MESH_PARTS = 9 };

static void list_parts(const leaf_file *f, const leaf_mesh_parts *p, mesh_part parts[MESH_PARTS]) {
    const mesh_part all[MESH_PARTS] = {
        {"tets", "tets", f->header.tets, p->tets},
        {"positions", "positions", p->vertices, p->positions},
        {"nodes", "nodes", p->node_count, p->nodes},
        {"values", "values", p->vertices, p->values},
        {"value codes", "value_codes", p->node_count, p->codes},
        {"gradients", "gradients", p->gradients ? p->vertices : 0, p->gradients},
        {"later boxes", "moved_boxes", p->moved ? p->node_count : 0, p->moved_boxes},
        {"later places", "moved", p->moved ? p->vertices : 0, p->moved},
        {"padding", "padding", 0, p->padding}};
    memcpy(parts, all, sizeof all);
}

static json_t *parts_json(const leaf_file *f, const leaf_mesh_parts *p) {
    mesh_part parts[MESH_PARTS];
    list_parts(f, p, parts);
    json_t *json = json_pack(
        "{s:I, s:I, s:I, s:I}", "stored_topology", (json_int_t)p->stored_topology, "stored_values",
        (json_int_t)p->stored_values, "stored_gradients", (json_int_t)p->stored_gradients,
        "stored_positions", (json_int_t)p->stored_positions);
    for (int i = 0; i < MESH_PARTS; i++)
        json_object_set_new(json, parts[i].key, json_integer((json_int_t)parts[i].bytes));
    return json;
}

static void set_parts(const leaf_file *f, const fact_sheet *to) {
    const leaf_mesh_parts parts = leaf_stats_mesh(f);
    fact_sheet_whole(to, "treelet_vertices", parts.vertices);
    fact_sheet_whole(to, "nodes", parts.node_count);
    fact_sheet_whole(to, "leaves", parts.leaves);
    fact_sheet_json(to, "parts", parts_json(f, &parts));
}

static void tell(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    leaf_tell_begin(f, to);
    tell_tets(h, to);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_print_steps(f, to);
    print_extras(f, to);
    tell_treelets(f, to);
    if (to->values)
        set_parts(f, to);
    fact_sheet_flag(to, "gradients", h->gradients);
    fact_sheet_flag(to, "moving", h->moving);
    leaf_tell_set_fields(f, to);
}

static void tell_parts(const leaf_file *f, const fact_sheet *to) {
    const double tets = (double)f->header.tets;
    const leaf_mesh_parts p = leaf_stats_mesh(f);
    mesh_part parts[MESH_PARTS];
    list_parts(f, &p, parts);
    fact_sheet_row(to, "\npart                 count          bytes   a tet");
    for (int i = 0; i < MESH_PARTS; i++)
        if (parts[i].bytes || i + 1 == MESH_PARTS)
            fact_sheet_row(to, "%-12s %13llu %14llu %7.3f", parts[i].name, whole(parts[i].count),
                           whole(parts[i].bytes), (double)parts[i].bytes / tets);
    fact_sheet_row(to, "\nstored                              bytes   a tet");
    const char *const names[] = {"topology", "values", "gradients", "positions"};
    const uint64_t stored[] = {p.stored_topology, p.stored_values, p.stored_gradients,
                               p.stored_positions};
    for (int i = 0; i < 4; i++)
        if (stored[i])
            fact_sheet_row(to, "%-12s %28llu %7.3f", names[i], whole(stored[i]),
                           (double)stored[i] / tets);
}

static uint64_t cell_count(const leaf_header *h) {
    return h->tets;
}

const leaf_teller mesh_facts = {.name = "mesh",
                                .cells = "tets",
                                .drawn = "tets",
                                .cell_count = cell_count,
                                .tell = tell,
                                .tell_parts = tell_parts};
