#include "tests/support/mesh_leaves.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_coder.h"
#include "formats/mesh/mesh_leaf.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"

/* ---- meshes ---- */

static float wave(const float at[3], uint32_t set) {
    return (float)(sin(1.7 * (double)at[0] + set) + cos(2.3 * (double)at[1]) + (double)at[2]);
}

static void fill_points(mesh_case *c, uint32_t n, uint32_t sets, field_random *r, int non_finite) {
    static const float strange[] = {NAN, INFINITY, -INFINITY};
    size_t v = 0;
    for (uint32_t z = 0; z <= n; z++)
        for (uint32_t y = 0; y <= n; y++)
            for (uint32_t x = 0; x <= n; x++, v++) {
                const uint32_t node[3] = {x, y, z};
                for (int a = 0; a < 3; a++)
                    c->xyz[v][a] =
                        (float)(node[a] + field_random_in(r, -0.2, 0.2)) * (float)(a + 1) - 1.0F;
                for (uint32_t set = 0; set < sets; set++) {
                    float *value = &c->values[set * c->points + v];
                    *value = wave(c->xyz[v], set) + (float)field_random_in(r, -0.1, 0.1);
                    if (non_finite && field_random_below(r, non_finite) == 0)
                        *value = strange[field_random_below(r, 3)];
                }
            }
}

/* The path from a cell's first corner to its last, by the axes in one of their six orders. */
static void fill_tets(mesh_case *c, uint32_t n) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const uint32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
    size_t t = 0;
    for (uint32_t z = 0; z < n; z++)
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t x = 0; x < n; x++)
                for (int o = 0; o < 6; o++, t++) {
                    c->ids[t][0] = x + y * step[1] + z * step[2];
                    for (int i = 0; i < 3; i++)
                        c->ids[t][i + 1] = c->ids[t][i] + step[orders[o][i]];
                }
}

mesh_case mesh_leaves_cube(uint32_t n, uint32_t fields, uint32_t steps, uint64_t seed,
                           int non_finite) {
    const size_t edge = n + 1, sets = (size_t)fields * steps;
    mesh_case c = {.points = edge * edge * edge, .tets = (size_t)6 * n * n * n};
    field_random r = {seed};
    c.xyz = malloc(c.points * sizeof *c.xyz);
    c.values = malloc(c.points * sets * sizeof *c.values);
    c.ids = malloc(c.tets * sizeof *c.ids);
    assert_true(c.xyz && c.values && c.ids);
    fill_points(&c, n, (uint32_t)sets, &r, non_finite);
    fill_tets(&c, n);
    c.mesh = (leaf_mesh){.kind = LEAF_KIND_MESH,
                         .name = "cube",
                         .field = "waves",
                         .treelet_tets = 50,
                         .leaf_tets = 3,
                         .fields = fields,
                         .steps = steps};
    c.file = leaf_parameters_default();
    c.file.zstd_level = 3;
    return c;
}

void mesh_leaves_extend(mesh_case *c, uint64_t seed) {
    static const char *const names[] = {"waves", "ripples", "", "speed of the fourth"};
    static const double times[] = {-1.5, 0, 1e-3, 7, 1e9};
    const size_t sets = (size_t)c->mesh.fields * c->mesh.steps, moves = c->mesh.steps - 1;
    field_random r = {seed};
    assert_true(c->mesh.fields <= 4 && c->mesh.steps <= 5);
    c->mesh.names = names;
    c->mesh.times = times;
    c->mesh.gradients = true;
    c->mesh.moving = moves > 0;
    c->gradients = malloc(sets * c->points * sizeof *c->gradients);
    c->moved = malloc((moves + 1) * c->points * sizeof *c->moved);
    assert_true(c->gradients && c->moved);
    for (size_t i = 0; i < sets * c->points; i++)
        for (int a = 0; a < 3; a++)
            c->gradients[i][a] = (float)field_random_in(&r, -9, 9);
    for (size_t i = 0; i < moves * c->points; i++)
        for (int a = 0; a < 3; a++)
            c->moved[i][a] = c->xyz[i % c->points][a] * 1.25F + (float)(i / c->points) +
                             (float)field_random_in(&r, -0.2, 0.2);
}

void mesh_leaves_release(mesh_case *c) {
    free(c->xyz);
    free(c->values);
    free(c->ids);
    free(c->gradients);
    free(c->moved);
}

/* ---- a treelet ---- */

enum { NODES_MAX = 1024 };

/* Tets [first, end) of the mesh under a child. */
typedef struct span {
    size_t first, end;
} span;

typedef struct built {
    const mesh_case *c;
    span all;
    uint32_t *id;                        /* of its vertices, ascending */
    span part[NODES_MAX][MESH_CHILDREN]; /* of each node's children; empty: none */
    mesh_node node[NODES_MAX];
    uint32_t counts[4];
    float bounds[6];
    char *bytes; /* the payload in hand */
} built;

static int by_number(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static uint16_t local_of(const built *b, uint32_t id) {
    const uint32_t *at = bsearch(&id, b->id, b->counts[1], sizeof id, by_number);
    return (uint16_t)(at - b->id);
}

static void collect_vertices(built *b) {
    const size_t count = 4 * (b->all.end - b->all.first);
    b->id = malloc(count * sizeof *b->id);
    assert_non_null(b->id);
    memcpy(b->id, b->c->ids[b->all.first], count * sizeof *b->id);
    qsort(b->id, count, sizeof *b->id, by_number);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || b->id[i] != b->id[b->counts[1] - 1])
            b->id[b->counts[1]++] = b->id[i];
}

static span part_of(const built *b, span all, size_t k, size_t parts) {
    const size_t count = all.end - all.first, most = b->c->mesh.leaf_tets;
    if (b->c->chain)
        return k ? (span){all.first + most, all.end}
                 : (span){all.first, count < most ? all.end : all.first + most};
    return (span){all.first + count * k / parts, all.first + count * (k + 1) / parts};
}

/* Breadth first; a leaf is named by its first tet until all are known. */
static void split(built *b) {
    span node[NODES_MAX] = {b->all};
    const size_t most = b->c->mesh.leaf_tets;
    b->counts[2] = 1;
    for (uint32_t n = 0; n < b->counts[2]; n++) {
        const size_t count = node[n].end - node[n].first;
        size_t parts = (count + most - 1) / most;
        const size_t limit = b->c->chain ? 2 : MESH_CHILDREN;
        parts = parts > limit ? limit : parts;
        for (size_t k = 0; k < MESH_CHILDREN; k++) {
            b->node[n].child[k] = MESH_NO_CHILD;
            b->part[n][k] = (span){0, 0};
            if (k >= parts)
                continue;
            const span s = part_of(b, node[n], k, parts);
            b->part[n][k] = s;
            if (s.end - s.first <= most) {
                b->counts[3]++;
                continue;
            }
            assert_true(b->counts[2] < NODES_MAX);
            b->node[n].child[k] = (uint16_t)b->counts[2];
            node[b->counts[2]++] = s;
        }
    }
}

static bool is_leaf(const built *b, uint32_t n, int k) {
    const span s = b->part[n][k];
    return s.end > s.first && s.end - s.first <= b->c->mesh.leaf_tets;
}

static void number_leaves(built *b, uint16_t *first) {
    uint32_t leaf = 0;
    const size_t tets = b->all.end - b->all.first;
    for (size_t at = 0; at < tets; at++)
        for (uint32_t n = 0; n < b->counts[2]; n++)
            for (int k = 0; k < MESH_CHILDREN; k++)
                if (is_leaf(b, n, k) && b->part[n][k].first == b->all.first + at) {
                    b->node[n].child[k] = (uint16_t)(MESH_LEAF | leaf);
                    first[leaf++] = (uint16_t)at;
                }
    first[leaf] = (uint16_t)tets;
    assert_int_equal(leaf, b->counts[3]);
}

static void box_of(const built *b, span s, const float (*xyz)[3], float box[6]) {
    for (int a = 0; a < 3; a++) {
        box[a] = INFINITY;
        box[a + 3] = -INFINITY;
        for (size_t t = s.first; t < s.end; t++)
            for (int i = 0; i < 4; i++) {
                const float at = xyz[b->c->ids[t][i]][a];
                box[a] = fminf(box[a], at);
                box[a + 3] = fmaxf(box[a + 3], at);
            }
    }
}

/* Of the positions of a step; one mesh_boxes for each node. */
static void code_boxes(built *b, const float (*xyz)[3], mesh_boxes *boxes) {
    box_of(b, b->all, xyz, b->bounds);
    const mesh_frame f = mesh_leaf_frame(b->bounds);
    for (uint32_t n = 0; n < b->counts[2]; n++)
        for (int k = 0; k < MESH_CHILDREN; k++) {
            float box[6];
            const bool absent = b->node[n].child[k] == MESH_NO_CHILD;
            if (!absent)
                box_of(b, b->part[n][k], xyz, box);
            for (int a = 0; a < 3; a++) {
                boxes[n].lo[a][k] = absent ? 255 : mesh_leaf_code_lo(&f, a, box[a]);
                boxes[n].hi[a][k] = absent ? 0 : mesh_leaf_code_hi(&f, a, box[a + 3]);
            }
        }
}

static void code_nodes(built *b) {
    static mesh_boxes boxes[NODES_MAX];
    code_boxes(b, (const float(*)[3])b->c->xyz, boxes);
    for (uint32_t n = 0; n < b->counts[2]; n++) {
        memcpy(b->node[n].lo, boxes[n].lo, sizeof boxes[n].lo);
        memcpy(b->node[n].hi, boxes[n].hi, sizeof boxes[n].hi);
    }
}

static void new_bytes(built *b, size_t size) {
    free(b->bytes);
    b->bytes = calloc(1, size);
    assert_non_null(b->bytes);
}

static void build_topology(built *b) {
    b->counts[0] = (uint32_t)(b->all.end - b->all.first);
    collect_vertices(b);
    split(b);
    const mesh_shape s = mesh_leaf_shape(b->counts);
    new_bytes(b, s.topology_bytes);
    number_leaves(b, (uint16_t *)(b->bytes + s.leaf_first_at));
    code_nodes(b);
    memcpy(b->bytes, b->node, s.nodes * sizeof *b->node);
    uint16_t *tet = (uint16_t *)(b->bytes + s.tets_at);
    for (uint32_t i = 0; i < s.tets; i++) {
        uint32_t id[4];
        memcpy(id, b->c->ids[b->all.first + i], sizeof id);
        qsort(id, 4, sizeof *id, by_number);
        for (int k = 0; k < 4; k++)
            *tet++ = local_of(b, id[k]);
    }
    for (uint32_t v = 0; v < s.vertices; v++)
        memcpy(b->bytes + s.positions_at + v * sizeof(float[3]), b->c->xyz[b->id[v]],
               sizeof(float[3]));
}

static leaf_entry range_of(const built *b, span s, const float *values) {
    leaf_entry e = {.own = {INFINITY, -INFINITY}};
    for (size_t t = s.first; t < s.end; t++)
        for (int i = 0; i < 4; i++) {
            const float v = values[b->c->ids[t][i]];
            if (!isfinite(v)) {
                e.flags = LEAF_FLAG_NON_FINITE;
                continue;
            }
            e.own[0] = fminf(e.own[0], v);
            e.own[1] = fmaxf(e.own[1], v);
        }
    return e;
}

static leaf_entry build_values(built *b, uint32_t set) {
    const float *values = b->c->values + set * b->c->points;
    const mesh_shape s = mesh_leaf_shape(b->counts);
    const leaf_entry own = range_of(b, b->all, values);
    const quantizer q = quantizer_of(own.own[0], own.own[1], SAMPLE_F32);
    new_bytes(b, s.values_bytes);
    for (uint32_t n = 0; n < s.nodes; n++) {
        mesh_codes *codes = (mesh_codes *)b->bytes + n;
        for (int k = 0; k < MESH_CHILDREN; k++) {
            const leaf_entry e = range_of(b, b->part[n][k], values);
            const bool empty = e.own[0] > e.own[1];
            codes->lo[k] = empty ? 255 : quantizer_floor(&q, (double)e.own[0]);
            codes->hi[k] = empty ? 0 : quantizer_ceil(&q, (double)e.own[1]);
        }
    }
    for (uint32_t v = 0; v < s.vertices; v++)
        ((float *)(b->bytes + s.values_at))[v] = values[b->id[v]];
    return own;
}

/* Three numbers a vertex, from `at` in the payload on. */
static void put_triples(built *b, uint32_t at, const float (*triples)[3]) {
    for (uint32_t v = 0; v < b->counts[1]; v++)
        memcpy(b->bytes + at + v * sizeof *triples, triples[b->id[v]], sizeof *triples);
}

static void build_gradients(built *b, uint32_t set) {
    new_bytes(b, mesh_leaf_shape(b->counts).gradients_bytes);
    put_triples(b, 0, (const float(*)[3])b->c->gradients + set * b->c->points);
}

static void build_positions(built *b, uint32_t step) {
    const float(*xyz)[3] = (const float(*)[3])b->c->moved + (step - 1) * b->c->points;
    const mesh_shape s = mesh_leaf_shape(b->counts);
    new_bytes(b, s.positions_bytes);
    code_boxes(b, xyz, (mesh_boxes *)b->bytes);
    put_triples(b, s.moved_at, xyz);
}

/* ---- the file ---- */

/* What there is behind the topology. */
static status put_sets(leaf_writer *w, leaf_packer *k, built *b, uint32_t t, char *pack) {
    const leaf_mesh *mesh = &b->c->mesh;
    status st = ST_OK;
    for (uint32_t set = 0; set < mesh->fields * mesh->steps && st == ST_OK; set++) {
        leaf_entry e = build_values(b, set);
        st = leaf_writer_put_values(w, k, set, t, &e, b->bytes, pack);
        if (st == ST_OK && mesh->gradients) {
            build_gradients(b, set);
            st = leaf_writer_put_gradients(w, k, set, t, b->bytes, pack);
        }
    }
    for (uint32_t step = 1; step < mesh->steps && mesh->moving && st == ST_OK; step++) {
        build_positions(b, step);
        st = leaf_writer_put_positions(w, k, step, t, b->bounds, b->bytes, pack);
    }
    return st;
}

static status put_treelet(leaf_writer *w, leaf_packer *k, const mesh_case *c, uint32_t t) {
    static built b;
    char *pack = malloc(1 << 20);
    const size_t size = c->mesh.treelet_tets, end = (t + 1) * size;
    memset(&b, 0, sizeof b);
    b.c = c;
    b.all = (span){t * size, end < c->tets ? end : c->tets};
    build_topology(&b);
    status st = leaf_writer_put_topology(w, k, t, b.bounds, b.counts, b.bytes, pack);
    if (st == ST_OK)
        st = put_sets(w, k, &b, t, pack);
    free(b.id);
    free(b.bytes);
    free(pack);
    return st;
}

/* Vertices that tets use, and their values that are not finite. */
static leaf_facts facts_of(const mesh_case *c) {
    leaf_facts f = {.provenance = "test"};
    char *used = calloc(c->points, 1);
    assert_non_null(used);
    for (size_t t = 0; t < c->tets; t++)
        for (int i = 0; i < 4; i++)
            used[c->ids[t][i]] = 1;
    for (size_t v = 0; v < c->points; v++) {
        f.vertices += used[v] != 0;
        for (uint32_t set = 0; set < c->mesh.fields * c->mesh.steps; set++)
            f.non_finite += used[v] && !isfinite(c->values[set * c->points + v]);
    }
    free(used);
    return f;
}

status mesh_leaves_try(mem *m, const mesh_case *c, const char *path, int backwards) {
    leaf_mesh mesh = c->mesh;
    leaf_writer *w = NULL;
    leaf_packer *k = NULL;
    mesh.treelets = (uint32_t)((c->tets + mesh.treelet_tets - 1) / mesh.treelet_tets);
    status st = leaf_writer_create_mesh(m, &(leaf_target){.path = path, .force = true}, &mesh,
                                        &c->file, &w);
    if (st != ST_OK)
        return st;
    const uint32_t tets = mesh.treelet_tets, most[4] = {tets, 4 * tets, tets, tets};
    st = leaf_packer_create(m, leaf_writer_layout(w), &mesh_coder, most, &c->file, &k);
    for (uint32_t t = 0; t < mesh.treelets && st == ST_OK; t++)
        st = put_treelet(w, k, c, backwards ? mesh.treelets - 1 - t : t);
    leaf_packer_destroy(m, k);
    if (st == ST_OK) {
        const leaf_facts facts = facts_of(c);
        return leaf_writer_finish(w, &facts, NULL);
    }
    leaf_writer_discard(w);
    return st;
}

const char *mesh_leaves_make(const mesh_case *c, const char *name) {
    mem m;
    mem_init(&m, 0);
    const char *path = scratch_path(name);
    if (mesh_leaves_try(&m, c, path, 0) != ST_OK)
        fail_msg("%s: %s", name, status_text());
    assert_int_equal(mem_used(&m), 0);
    return path;
}
