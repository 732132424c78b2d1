/* test_mesh_build.c - meshes to treelet files: what is in the file is the mesh, tightly boxed;
 * nothing but mesh and parameters has a say in the bytes; a failure leaves nothing behind.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_verify.h"
#include "formats/mesh/mesh_leaf.h"
#include "formats/mesh/mesh_morton.h"
#include "prep/mesh/mesh_cut.h"
#include "prep/mesh/mesh_series.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/loaded.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/mesh_truth.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* Less where every access is watched. */
enum { FIRST_KIND = WATCHED ? 2 : 0, FAULTY = WATCHED ? 9 : 22, LATTICE = WATCHED ? 30 : 40 };

static mem m;

static leaf_file *open_verified(const char *name) {
    leaf_file *f = NULL;
    if (leaf_file_open(&m, scratch_path(name), &f) != ST_OK || leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

static void convert(const mesh_case *c, const char *name, mesh_result *r) {
    mesh_result own;
    if (mesh_cases_convert(&m, c, name, 0, r ? r : &own) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    m.limit = 0;
}

/* ---- the mesh is in the file ---- */

/* A tet without its numbers: positions and values of its vertices in order of ids. */
typedef struct plain_tet {
    uint64_t key;
    float vertex[4][4];
} plain_tet;

static int compare_plain(const void *a, const void *b) {
    return memcmp(a, b, sizeof(plain_tet));
}

static int compare_ids(const void *a, const void *b) {
    const uint32_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

static bool is_sound(const mesh_case *c, const uint32_t id[4]) {
    for (int k = 0; k < 4; k++)
        for (int other = 0; other < k; other++)
            if (id[k] == id[other])
                return false;
    return id[0] < c->point_count && id[1] < c->point_count && id[2] < c->point_count &&
           id[3] < c->point_count;
}

static mesh_lattice lattice_of(const mesh_case *c) {
    float bounds[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < c->point_count; i++)
        for (int a = 0; a < 3; a++) {
            bounds[a] = fminf(bounds[a], c->points[i][a]);
            bounds[a + 3] = fmaxf(bounds[a + 3], c->points[i][a]);
        }
    return mesh_lattice_of(bounds);
}

static plain_tet *plain_of_case(const mesh_case *c, size_t *count) {
    plain_tet *all = calloc(c->tet_count, sizeof *all);
    const mesh_lattice l = lattice_of(c);
    *count = 0;
    for (size_t t = 0; t < c->tet_count; t++) {
        if (!is_sound(c, c->tets[t]))
            continue;
        plain_tet *to = &all[(*count)++];
        float corners[4][3];
        for (int k = 0; k < 4; k++)
            memcpy(corners[k], c->points[c->tets[t][k]], sizeof corners[k]);
        to->key = mesh_morton_key(&l, (const float(*)[3])corners);
        uint32_t id[4];
        memcpy(id, c->tets[t], sizeof id);
        qsort(id, 4, sizeof id[0], compare_ids);
        for (int k = 0; k < 4; k++) {
            memcpy(to->vertex[k], c->points[id[k]], sizeof(float[3]));
            to->vertex[k][3] = c->values[id[k]];
        }
    }
    return all;
}

/* ---- a treelet, looked at plainly ---- */

typedef struct treelet_view {
    mesh_shape s;
    char *topology, *values;
    const float (*position)[3];
    const float *value;
    const uint16_t (*tets)[4];
    mesh_frame frame;
    quantizer q;
} treelet_view;

static treelet_view load_treelet(leaf_file *f, uint32_t t) {
    treelet_view v = {.s = mesh_leaf_shape(f->mesh->counts[t])};
    const uint32_t p = leaf_layout_values(&f->layout, 0, t);
    v.topology = aligned_alloc(64, v.s.topology_bytes);
    v.values = aligned_alloc(64, v.s.values_bytes);
    assert_int_equal(loaded(f, t, v.topology), ST_OK);
    assert_int_equal(loaded(f, p, v.values), ST_OK);
    v.position = mesh_leaf_positions(&v.s, v.topology);
    v.value = mesh_leaf_values(&v.s, v.values);
    v.tets = mesh_leaf_tets(&v.s, v.topology);
    v.frame = mesh_leaf_frame(f->mesh->bounds[t]);
    v.q = quantizer_of(f->own[t][0], f->own[t][1], SAMPLE_F32);
    return v;
}

static void release_treelet(treelet_view *v) {
    free(v->topology);
    free(v->values);
}

/* Box and range of some tets; no finite value: lo > hi. */
static void range_of(const treelet_view *v, uint32_t first, uint32_t end, float lo[4],
                     float hi[4]) {
    for (int a = 0; a < 4; a++) {
        lo[a] = INFINITY;
        hi[a] = -INFINITY;
    }
    for (uint32_t t = first; t < end; t++)
        for (int c = 0; c < 4; c++) {
            const uint16_t i = v->tets[t][c];
            const float x[4] = {v->position[i][0], v->position[i][1], v->position[i][2],
                                v->value[i]};
            for (int a = 0; a < (isfinite(x[3]) ? 4 : 3); a++) {
                lo[a] = fminf(lo[a], x[a]);
                hi[a] = fmaxf(hi[a], x[a]);
            }
        }
}

/* The codes of a child are those of exactly what is in it: no wider, no narrower. */
static void check_child(const treelet_view *v, uint32_t node, int child, uint32_t first,
                        uint32_t end) {
    const mesh_node *n = mesh_leaf_nodes(v->topology) + node;
    const mesh_codes *codes = mesh_leaf_codes(v->values) + node;
    float lo[4], hi[4];
    range_of(v, first, end, lo, hi);
    for (int a = 0; a < 3; a++) {
        assert_int_equal(n->lo[a][child], mesh_leaf_code_lo(&v->frame, a, lo[a]));
        assert_int_equal(n->hi[a][child], mesh_leaf_code_hi(&v->frame, a, hi[a]));
    }
    const bool any = lo[3] <= hi[3];
    assert_int_equal(codes->lo[child], any ? quantizer_floor(&v->q, (double)lo[3]) : 255);
    assert_int_equal(codes->hi[child], any ? quantizer_ceil(&v->q, (double)hi[3]) : 0);
}

/* Goes down from a node whose first tet is `first`; returns the tet behind its last. */
static uint32_t check_node(const treelet_view *v, uint32_t node, uint32_t first,
                           uint32_t leaf_tets) {
    const mesh_node *n = mesh_leaf_nodes(v->topology) + node;
    const uint16_t *leaf_first = mesh_leaf_first(&v->s, v->topology);
    uint32_t at = first;
    for (int c = 0; c < MESH_CHILDREN && n->child[c] != MESH_NO_CHILD; c++) {
        uint32_t end;
        if (n->child[c] & MESH_LEAF) {
            const uint32_t leaf = n->child[c] & ~MESH_LEAF;
            assert_int_equal(leaf_first[leaf], at);
            end = leaf_first[leaf + 1];
            assert_true(end > at && end - at <= leaf_tets);
        } else {
            end = check_node(v, n->child[c], at, leaf_tets);
        }
        check_child(v, node, c, at, end);
        at = end;
    }
    return at;
}

static void check_bounds(const leaf_file *f, uint32_t t, const treelet_view *v) {
    float lo[4], hi[4];
    range_of(v, 0, v->s.tets, lo, hi);
    for (int a = 0; a < 3; a++)
        assert_true(lo[a] == f->mesh->bounds[t][a] && hi[a] == f->mesh->bounds[t][a + 3]);
    assert_true(lo[3] == f->own[t][0] && hi[3] == f->own[t][1]);
    bool finite = true;
    for (uint32_t i = 0; i < v->s.vertices; i++)
        finite = finite && isfinite(v->value[i]);
    assert_int_equal(f->flags[t], finite ? 0 : LEAF_FLAG_NON_FINITE);
}

/* The file's tets are the case's, in order of keys, in the treelets that the keys make. */
static void check_content(const mesh_case *c, const char *name) {
    leaf_file *f = open_verified(name);
    size_t count, at = 0;
    plain_tet *expected = plain_of_case(c, &count);
    assert_int_equal(f->header.tets, count);
    plain_tet *got = calloc(count, sizeof *got);
    mesh_record *keys = calloc(count, sizeof *keys);
    const mesh_lattice l = lattice_of(c);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        treelet_view v = load_treelet(f, t);
        assert_int_equal(f->mesh->first_tet[t], at);
        for (uint32_t i = 0; i < v.s.tets; i++, at++) {
            float corners[4][3];
            for (int k = 0; k < 4; k++) {
                memcpy(corners[k], v.position[v.tets[i][k]], sizeof corners[k]);
                memcpy(got[at].vertex[k], corners[k], sizeof corners[k]);
                got[at].vertex[k][3] = v.value[v.tets[i][k]];
            }
            got[at].key = mesh_morton_key(&l, (const float(*)[3])corners);
            keys[at].key = got[at].key;
        }
        check_bounds(f, t, &v);
        assert_int_equal(check_node(&v, 0, 0, c->options.leaf_tets), v.s.tets);
        release_treelet(&v);
    }
    assert_int_equal(at, count);
    at = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint64_t *before = at > 0 ? &keys[at - 1].key : NULL;
        assert_int_equal(mesh_cut_next(keys + at, count - at, before, c->options.treelet_tets),
                         f->mesh->counts[t][0]);
        at += f->mesh->counts[t][0];
    }
    qsort(got, count, sizeof *got, compare_plain);
    qsort(expected, count, sizeof *expected, compare_plain);
    assert_memory_equal(got, expected, count * sizeof *got);
    free(got);
    free(expected);
    free(keys);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

static void test_content(void **state) {
    (void)state;
    skip_under_thread();
    static const uint32_t sizes[][2] = {{4096, 12}, {64, 8}, {1, 1}, {300, 64}, {16384, 1}};
    for (int i = 0; i < 5; i++)
        for (int kind = 0; kind < 4; kind++) {
            mesh_case c = kind < 2 ? mesh_cases_kuhn(9, 8, 11 + kind)
                                   : mesh_cases_soup(3000, 4000, FIELD_SEED + (uint64_t)i);
            if (kind % 2)
                mesh_cases_shuffle(&c, FIELD_SEED);
            c.options.treelet_tets = sizes[i][0];
            c.options.leaf_tets = sizes[i][1];
            convert(&c, "content.leaf", NULL);
            check_content(&c, "content.leaf");
            mesh_cases_free(&c);
        }
}

/* Boxes of hardly any width, far away, of a single point, of nearly the whole range of floats. */
static void test_places(void **state) {
    (void)state;
    skip_under_thread();
    static const float scales[][2] = {{1e-3F, 0},  {1, 1e6F},         {1, 1.6e7F},           {0, 5},
                                      {1e-36F, 0}, {3e37F, -1.2e38F}, {1e37F, 3e38F - 9e37F}};
    for (int i = 0; i < 7; i++) {
        mesh_case c = mesh_cases_kuhn(8, 8, 8);
        for (size_t p = 0; p < c.point_count; p++)
            for (int a = 0; a < 3; a++)
                c.points[p][a] = c.points[p][a] * scales[i][0] + scales[i][1];
        c.options.treelet_tets = 500;
        convert(&c, "places.leaf", NULL);
        check_content(&c, "places.leaf");
        mesh_cases_free(&c);
    }
}

/* ---- gradients ---- */

/* The vertex at a place of a lattice that mesh_cases_kuhn() has made. */
static size_t vertex_at(const mesh_case *c, const float at[3]) {
    for (size_t i = 0; i < c->point_count; i++)
        if (memcmp(c->points[i], at, sizeof c->points[i]) == 0)
            return i;
    fail_msg("no vertex there");
    return 0;
}

/* Those of the whole mesh, in all treelets that have the vertex; nothing else has changed. */
static void check_gradients(const mesh_case *c, const char *name) {
    leaf_file *f = open_verified(name);
    mesh_truth *all = mesh_truth_gradients(c);
    assert_int_equal(f->header.gradients, 1);
    assert_int_equal(f->layout.gradient_sets, 1);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        treelet_view v = load_treelet(f, t);
        float(*gradients)[3] = aligned_alloc(64, v.s.gradients_bytes);
        assert_int_equal(loaded(f, leaf_layout_gradients(&f->layout, 0, t), gradients), ST_OK);
        for (uint32_t i = 0; i < v.s.vertices; i++) {
            const size_t vertex = vertex_at(c, v.position[i]);
            mesh_truth_check(&all[vertex], gradients[i], vertex);
        }
        free(gradients);
        release_treelet(&v);
    }
    free(all);
    leaf_file_close(f);
}

static void test_gradients(void **state) {
    (void)state;
    skip_under_thread();
    for (int kind = 0; kind < 4; kind++) {
        mesh_case c = mesh_cases_kuhn(9, 8, 11);
        if (kind % 2)
            mesh_cases_shuffle(&c, FIELD_SEED);
        c.options.treelet_tets = kind < 2 ? 300 : 10;
        c.options.gradients = true;
        c.values[5] = NAN;
        c.values[500] = INFINITY;
        c.tets[7][1] = c.tets[7][0];
        c.tets[70][2] = UINT32_MAX;
        c.options.file.codec = kind == 3 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        c.options.file.zstd_level = 1;
        convert(&c, "gradients.leaf", NULL);
        check_content(&c, "gradients.leaf");
        check_gradients(&c, "gradients.leaf");
        mesh_cases_free(&c);
    }
}

/* ---- counts ---- */

static void test_counts(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_kuhn(10, 10, 10);
    c.values[0] = NAN;
    c.values[7] = -INFINITY;
    /* Ten are turned, five made flat, three lose their fourth vertex, two point to nowhere. */
    for (int i = 0; i < 20; i++) {
        uint32_t *id = c.tets[i * 251];
        if (i < 10) {
            const uint32_t swap = id[0];
            id[0] = id[1];
            id[1] = swap;
        } else if (i < 15) {
            /* four corners of one face of a cell, or of the lattice's bottom */
            const uint32_t flat[4] = {0, 1, 11, (uint32_t)i + 2};
            memcpy(id, flat, sizeof flat);
        } else if (i < 18) {
            id[i % 3] = id[3];
        } else {
            id[i % 4] = i % 2 ? (uint32_t)c.point_count : UINT32_MAX;
        }
    }
    mesh_result r;
    convert(&c, "counts.leaf", &r);
    check_content(&c, "counts.leaf");
    const leaf_header *h = &r.header;
    assert_int_equal(h->tets, 6000 - 5);
    assert_int_equal(h->inverted, 10);
    assert_int_equal(h->flat, 5);
    assert_int_equal(h->repeated, 3);
    assert_int_equal(h->bad, 2);
    assert_int_equal(h->non_finite, 2);
    assert_int_equal(h->vertices, c.point_count);
    assert_string_equal(h->name, "case");
    assert_string_equal(h->field, "wavy");
    assert_null(strchr(h->provenance, '/'));
    /* All the other way round: what most are is upright. */
    for (size_t t = 0; t < c.tet_count; t++) {
        const uint32_t swap = c.tets[t][0];
        c.tets[t][0] = c.tets[t][1];
        c.tets[t][1] = swap;
    }
    convert(&c, "counts.leaf", &r);
    assert_int_equal(h->inverted, 10);
    assert_int_equal(h->flat, 5);
    /* Points of no tet are not counted, and do not widen the box. */
    mesh_case one = mesh_cases_kuhn(3, 3, 3);
    one.tet_count = 6;
    convert(&one, "one.leaf", &r);
    assert_int_equal(h->vertices, 8);
    assert_true(h->bounds[0] == 0 && h->bounds[3] == 1 && h->bounds[5] == 1);
    mesh_cases_free(&one);
    mesh_cases_free(&c);
}

static void test_nothing(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(2, 2, 2);
    mesh_result r;
    const size_t files = scratch_count();
    for (size_t t = 0; t < c.tet_count; t++)
        c.tets[t][0] = c.tets[t][1];
    assert_int_equal(mesh_cases_convert(&m, &c, "nothing.leaf", 0, &r), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "case: 0 tets with an id that is no point, 48 with"));
    c.tet_count = 0;
    assert_int_equal(mesh_cases_convert(&m, &c, "nothing.leaf", 0, &r), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "case: no tets"));
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), files);
    mesh_cases_free(&c);
}

/* ---- nothing else has a say ---- */

static void check_same(const char *a, const char *b) {
    scratch_same(b, scratch_path(a), scratch_path(b));
}

static uint64_t said_least(void) {
    const char *at = strstr(status_text(), "is too small: this mesh needs ");
    assert_non_null(at);
    return strtoull(strstr(at, "needs ") + 6, NULL, 10) << 20;
}

static uint64_t least_memory(mesh_case *c) {
    mesh_result r;
    c->options.memory = 3 << 19;
    assert_int_equal(mesh_cases_convert(&m, c, "least.leaf", 0, &r), ST_NOMEM);
    assert_int_equal(mem_used(&m), 0);
    return said_least();
}

/* Threads and memory, from the least that is said to do; tets before points. The budget holds. */
static void test_same_bytes(void **state) {
    (void)state;
    for (int kind = FIRST_KIND; kind < 3; kind++) {
        mesh_case c = kind == 1 ? mesh_cases_soup(90000, 200000, FIELD_SEED)
                                : mesh_cases_kuhn(LATTICE, LATTICE + 1, LATTICE + 2);
        if (kind == 2)
            mesh_cases_shuffle(&c, FIELD_SEED);
        c.options.treelet_tets = 1000;
        c.options.gradients = kind > 0;
        c.options.file.codec = kind == 1 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        c.options.file.zstd_level = 1;
        convert(&c, "first.leaf", NULL);
        if (kind == 0)
            check_content(&c, "first.leaf");
        for (int threads = WATCHED_THREADS ? 3 : 1; threads <= 5; threads += 2) {
            c.options.threads = threads;
            c.options.memory = 1 << 30;
            convert(&c, "other.leaf", NULL);
            check_same("first.leaf", "other.leaf");
        }
        c.options.threads = 2;
        const uint64_t least = least_memory(&c);
        int spilled = 0, held = 0;
        for (uint64_t more = 0; more < 40; more = 2 * more + 3) {
            mesh_result r;
            mem_init(&m, 0);
            c.options.memory = least + (more << 20);
            assert_int_equal(mesh_cases_convert(&m, &c, "other.leaf", more % 2 == 1, &r), ST_OK);
            assert_int_equal(mem_used(&m), 0);
            assert_true(mem_peak(&m) <= r.plan.memory && r.plan.memory <= c.options.memory);
            assert_true(r.plan.memory_least <= least);
            spilled += r.plan.runs.block > 0;
            held += r.plan.runs.block == 0;
            m.limit = 0;
            check_same("first.leaf", "other.leaf");
        }
        assert_true(spilled > 0 && held > 0);
        mesh_cases_free(&c);
    }
}

/* So many points that files are worth it: gradients, too, go through one, in bands. */
static void test_gradients_apart(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_soup(600000, 200000, FIELD_SEED);
    mesh_result r;
    c.options.treelet_tets = 1000;
    c.options.gradients = true;
    convert(&c, "first.leaf", &r);
    assert_false(r.plan.spill_gradients);
    c.options.memory = least_memory(&c);
    mem_init(&m, 0);
    assert_int_equal(mesh_cases_convert(&m, &c, "other.leaf", 0, &r), ST_OK);
    assert_true(r.plan.spill_gradients && r.plan.gradients.band < c.point_count);
    assert_true(mem_peak(&m) <= r.plan.memory && r.plan.memory <= c.options.memory);
    m.limit = 0;
    check_same("first.leaf", "other.leaf");
    mesh_cases_free(&c);
}

/* ---- failures ---- */

static status try(const mesh_case *c, const char *name) {
    mesh_result r;
    return mesh_cases_convert(&m, c, name, 0, &r);
}

/* Each allocation, read, write and thread fails in turn: an error, said; nothing left anywhere. */
static void sweep(const mesh_case *c, fault_kind kind) {
    const size_t files = scratch_count();
    long k = 0, step = 1;
    for (bool fired = true; fired; step = k / (WATCHED_THREADS ? 2 : 16) + 1) {
        mem_init(&m, 0);
        fault_arm(kind, k += step);
        const status st = try(c, "fault.leaf");
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        /* A fault may also hit what is only tried, such as the folder's fsync. */
        if (st == ST_OK)
            assert_int_equal(remove(scratch_path("fault.leaf")), 0);
        else if (!fired || !*status_text())
            fail_msg("fault %d of kind %d: status %d: %s", (int)k, kind, st, status_text());
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(scratch_count(), files);
    }
    assert_true(k > 1);
}

static void test_faults(void **state) {
    (void)state;
    for (int how = 0; how < 2; how++) {
        mesh_case c = mesh_cases_kuhn(FAULTY, FAULTY + 1, FAULTY + 2);
        c.options.threads = 3;
        c.options.treelet_tets = 200;
        if (how) {
            c.options.file.codec = LEAF_CODEC_ZSTD;
            c.options.file.zstd_level = 1;
            c.options.gradients = true;
            c.options.memory = least_memory(&c);
            mesh_cases_shuffle(&c, FIELD_SEED);
        }
        for (fault_kind kind = FAULT_ALLOC; kind < FAULT_KINDS; kind++)
            if (how || kind != FAULT_READ)
                sweep(&c, kind);
        m.limit = 0;
        mesh_cases_free(&c);
    }
}

/* Asked to stop, at any point: it stops, and nothing is left. An existing file stays. */
static bool stop_later(void *ctx) {
    return --*(int *)ctx <= 0;
}

static const char *write_stream(const mesh_case *c, const char *name) {
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "LEAFCAST MESH 1\nname: case\nfield: wavy\npoints: %zu\ntets: %zu\n\n",
            c->point_count, c->tet_count);
    assert_int_equal(fwrite(c->points, sizeof *c->points, c->point_count, f), c->point_count);
    assert_int_equal(fwrite(c->values, sizeof *c->values, c->point_count, f), c->point_count);
    assert_int_equal(fwrite(c->tets, sizeof *c->tets, c->tet_count, f), c->tet_count);
    assert_int_equal(fclose(f), 0);
    return path;
}

static void test_stream(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_kuhn(20, 20, 20);
    const char *path = write_stream(&c, "case.mesh"), *out = scratch_path("stream.leaf");
    convert(&c, "first.leaf", NULL);
    const size_t files = scratch_count();
    int stopped = 0;
    for (int left = 0;; left = ++stopped) {
        const progress p = {.stop = stop_later, .ctx = &left};
        mesh_input *x;
        mesh_result r;
        assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
        const status st = mesh_convert_run(&m, x, out, &c.options, &p, &r);
        mesh_input_close(x);
        assert_int_equal(mem_used(&m), 0);
        if (st == ST_OK)
            break;
        assert_int_equal(st, ST_STOPPED);
        assert_int_equal(scratch_count(), files);
    }
    assert_true(stopped > 5);
    check_same("first.leaf", "stream.leaf");
    mesh_input *x;
    mesh_result r;
    c.options.force = false;
    assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
    assert_int_equal(mesh_convert_run(&m, x, out, &c.options, NULL, &r), ST_EXISTS);
    c.options.memory = 1 << 20;
    c.options.force = true;
    assert_int_equal(mesh_convert_run(&m, x, out, &c.options, NULL, &r), ST_NOMEM);
    /* What is said to do then does. */
    const uint64_t least = said_least();
    mesh_input_close(x);
    assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
    c.options.memory = least;
    assert_int_equal(mesh_convert_run(&m, x, out, &c.options, NULL, &r), ST_OK);
    mesh_input_close(x);
    assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
    c.options.memory = 1 << 28;
    assert_int_equal(mesh_convert_dry(&m, x, &c.options, NULL, &r), ST_OK);
    assert_int_equal(r.report.tets, c.tet_count);
    assert_true(r.plan.memory > c.tet_count * 24 && r.plan.memory_least < r.plan.memory);
    mesh_input_close(x);
    check_same("first.leaf", "stream.leaf");
    mesh_cases_free(&c);
}

/* What was told of a job's progress. */
typedef struct telling {
    double last, read; /* how far: of all, at the end of reading */
    int readings;      /* different ones */
    bool falls;
} telling;

static void take_progress(void *ctx, const char *stage, double fraction) {
    telling *t = ctx;
    if (strcmp(stage, "read") == 0) {
        t->readings += fraction > t->last;
        t->read = fraction;
    }
    t->falls = t->falls || fraction < t->last;
    t->last = fraction;
}

/* Of the whole job, reading included, and of all readings of a series. */
static void test_progress(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(24, 24, 24);
    const char *path = write_stream(&c, "case.mesh"), *out = scratch_path("told.leaf");
    const char *const paths[] = {path, path, path};
    const mesh_series series = {.of = {.paths = paths, .sets = {.fields = 1, .steps = 3}}};
    for (int steps = 1; steps <= 3; steps += 2) {
        telling told = {0};
        const progress p = {.report = take_progress, .ctx = &told};
        mesh_input *x;
        mesh_result r;
        c.options.series = steps > 1 ? &series : NULL;
        assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
        if (mesh_convert_run(&m, x, out, &c.options, &p, &r) != ST_OK)
            fail_msg("%s", status_text());
        mesh_input_close(x);
        assert_false(told.falls);
        assert_true(told.last == 1);
        assert_true(told.read == 0.25);
        /* Points, values and tets come in chunks of 4096. */
        assert_true(told.readings >= steps * 20);
    }
    mesh_cases_free(&c);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_content, set_up),
        cmocka_unit_test_setup(test_places, set_up),
        cmocka_unit_test_setup(test_gradients, set_up),
        cmocka_unit_test_setup(test_counts, set_up),
        cmocka_unit_test_setup(test_nothing, set_up),
        cmocka_unit_test_setup(test_same_bytes, set_up),
        cmocka_unit_test_setup(test_gradients_apart, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
        cmocka_unit_test_setup(test_stream, set_up),
        cmocka_unit_test_setup(test_progress, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
