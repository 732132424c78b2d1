/* test_mesh_active.c - which tets of a treelet hold a surface, against their values; and the tree
 * over the treelets, against their bounds. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "stream/mesh_active.h"
#include "stream/treelet_tree.h"
#include "tests/support/interests.h"
#include "tests/support/mesh_leaves.h"

/* ---- Active tets ---- */

static bool is_active(const float f[4], const interests *set) {
    double lo = INFINITY, hi = -INFINITY;
    for (int k = 0; k < 4; k++) {
        if (!isfinite(f[k]))
            return false;
        lo = fmin(lo, (double)f[k]);
        hi = fmax(hi, (double)f[k]);
    }
    return interests_meet(set, lo, hi);
}

static bool is_marked(const mesh_active *a, uint32_t tet) {
    return a->tets[tet / 64] >> tet % 64 & 1u;
}

/* Whether a child's subtree has a marked tet, by looking at all of them. */
static bool holds_marked(const mesh_shape *s, const void *topology, const mesh_active *a,
                         unsigned child) {
    if (child & MESH_LEAF) {
        const uint16_t *first = mesh_leaf_first(s, topology) + (child & ~(unsigned)MESH_LEAF);
        for (uint32_t i = first[0]; i < first[1]; i++)
            if (is_marked(a, i))
                return true;
        return false;
    }
    const mesh_node *node = &mesh_leaf_nodes(topology)[child];
    for (int c = 0; c < MESH_CHILDREN && node->child[c] != MESH_NO_CHILD; c++)
        if (holds_marked(s, topology, a, node->child[c]))
            return true;
    return false;
}

typedef struct tally {
    uint32_t active, all;
} tally;

static void assert_treelet(const mesh_shape *s, const void *topology, const void *values,
                           const mesh_active *a, const interests *set, tally *t) {
    const float *f = mesh_leaf_values(s, values);
    for (uint32_t i = 0; i < s->tets; i++) {
        const uint16_t *v = mesh_leaf_tets(s, topology)[i];
        const float of[4] = {f[v[0]], f[v[1]], f[v[2]], f[v[3]]};
        assert_int_equal(is_marked(a, i), is_active(of, set));
        t->active += is_marked(a, i);
        t->all++;
    }
    for (uint32_t n = 0; n < s->nodes; n++) {
        const mesh_node *node = &mesh_leaf_nodes(topology)[n];
        unsigned want = 0;
        for (int c = 0; c < MESH_CHILDREN && node->child[c] != MESH_NO_CHILD; c++)
            want |= (unsigned)holds_marked(s, topology, a, node->child[c]) << c;
        assert_int_equal(a->children[n], want);
    }
}

/* A treelet's topology and values, and where its masks go. */
typedef struct subject {
    leaf_file *f;
    mesh_shape shape;
    void *topology, *values, *block;
    mesh_active *active;
    bool non_finite;
} subject;

static void subject_load(subject *x, mem *m, leaf_file *f, uint32_t p) {
    *x = (subject){.f = f, .shape = mesh_leaf_shape(f->mesh->counts[p])};
    x->topology = mem_alloc(m, x->shape.topology_bytes);
    x->values = mem_alloc(m, x->shape.values_bytes);
    x->block = mem_alloc(m, mesh_active_bytes(&x->shape));
    assert_true(x->topology && x->values && x->block);
    assert_int_equal(leaf_file_load(f, p, NULL, x->topology), ST_OK);
    assert_int_equal(mesh_leaf_check_loaded(f, p, x->topology), ST_OK);
    assert_int_equal(leaf_file_load(f, leaf_layout_values(&f->layout, 0, p), NULL, x->values),
                     ST_OK);
    x->active = mesh_active_init(x->block, &x->shape);
    x->non_finite = f->flags[p] & LEAF_FLAG_NON_FINITE;
}

static void subject_release(subject *x, mem *m) {
    mem_free(m, x->block);
    mem_free(m, x->values);
    mem_free(m, x->topology);
}

static void compare(const subject *x, uint32_t p, const interests *set, tally *t) {
    mesh_active_compute(x->active, &x->shape, x->f->own[p], x->non_finite, x->topology, x->values,
                        &set->in);
    assert_treelet(&x->shape, x->topology, x->values, x->active, set, t);
}

/* Isovalues and intervals between, at and beyond the values; more of them than a byte has bits. */
static void compare_treelet(const subject *x, uint32_t p, field_random *r, tally *t) {
    static const int counts[] = {0, 1, 2, 8, 9, 20};
    const float *known = mesh_leaf_values(&x->shape, x->values);
    double values[20];
    interests set;
    for (int i = 0; i < 20; i++) {
        const double v = (double)known[(uint32_t)i % x->shape.vertices];
        values[i] = i % 3 == 0 && isfinite(v) ? v : field_random_in(r, -3.0, 3.0);
    }
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        interests_of_isovalues(&set, values, counts[k]);
        compare(x, p, &set, t);
    }
    interests_of_all(&set);
    compare(x, p, &set, t);
    for (int k = 0; k < 30; k++) {
        interests_random(&set, r, values, 20);
        compare(x, p, &set, t);
    }
}

static void compare_mesh(int non_finite, uint32_t treelet_tets, uint32_t leaf_tets) {
    field_random r = {3};
    tally t = {0};
    mem m;
    leaf_file *f;
    mesh_case c = mesh_leaves_cube(6, 1, 1, 5, non_finite);
    c.mesh.treelet_tets = treelet_tets;
    c.mesh.leaf_tets = leaf_tets;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, mesh_leaves_make(&c, "active.leaf"), &f), ST_OK);
    for (uint32_t p = 0; p < f->layout.treelets; p++) {
        subject x;
        subject_load(&x, &m, f, p);
        compare_treelet(&x, p, &r, &t);
        subject_release(&x, &m);
    }
    leaf_file_close(f);
    mesh_leaves_release(&c);
    assert_int_equal(mem_used(&m), 0);
    assert_true(t.active > t.all / 20 && t.active < t.all);
}

static void test_active(void **state) {
    (void)state;
    compare_mesh(0, 50, 3);
    compare_mesh(0, 400, 5);
    compare_mesh(0, 400, LEAF_LEAF_TETS_MAX);
}

/* One value in 60, and in 4, is NaN or inf. */
static void test_missing(void **state) {
    (void)state;
    compare_mesh(60, 200, 7);
    compare_mesh(4, 50, 3);
}

/* ---- The tree ---- */

static void assert_node(const treelet_tree *tree, uint32_t level, uint32_t i) {
    uint32_t count, first = treelet_tree_children(tree, level, i, &count);
    bool active = false;
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    assert_true(count >= 1 && count <= TREELET_TREE_ARITY);
    for (uint32_t c = first; c < first + count; c++) {
        active |= tree->active[level - 1][c];
        for (int a = 0; a < 3; a++) {
            lo[a] = fminf(lo[a], tree->bounds[level - 1][c][a]);
            hi[a] = fmaxf(hi[a], tree->bounds[level - 1][c][a + 3]);
        }
    }
    assert_int_equal(tree->active[level][i], active);
    for (int a = 0; a < 3; a++) {
        assert_true(tree->bounds[level][i][a] == lo[a]);
        assert_true(tree->bounds[level][i][a + 3] == hi[a]);
    }
}

static void assert_tree(uint32_t count, field_random *r) {
    treelet_bounds *bounds = calloc(count, sizeof *bounds);
    uint8_t *own = calloc(count, 1);
    treelet_tree tree;
    mem m;
    mem_init(&m, 0);
    assert_true(bounds && own);
    for (uint32_t t = 0; t < count; t++) {
        own[t] = field_random_in(r, 0.0, 1.0) < 0.1;
        for (int a = 0; a < 3; a++) {
            bounds[t][a] = (float)field_random_in(r, -9.0, 9.0);
            bounds[t][a + 3] = bounds[t][a] + (float)field_random_in(r, 0.0, 2.0);
        }
    }
    assert_int_equal(treelet_tree_init(&tree, &m, (const treelet_bounds *)bounds, count), ST_OK);
    assert_int_equal(tree.count[0], count);
    assert_int_equal(tree.count[tree.levels - 1], 1);
    for (int again = 0; again < 2; again++) {
        treelet_tree_select(&tree, own);
        assert_memory_equal(tree.active[0], own, count);
        for (uint32_t level = 1; level < tree.levels; level++)
            for (uint32_t i = 0; i < tree.count[level]; i++)
                assert_node(&tree, level, i);
        for (uint32_t t = 0; t < count; t++)
            own[t] = t == count / 2;
    }
    treelet_tree_release(&tree);
    assert_int_equal(mem_used(&m), 0);
    free(own);
    free(bounds);
}

static void test_tree(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 7, 8, 9, 64, 65, 511, 513, 5000};
    field_random r = {9};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        assert_tree(counts[i], &r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_active),
        cmocka_unit_test(test_missing),
        cmocka_unit_test(test_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
