/* test_mesh_leaf.c - treelet files of meshes: planes and codes, what is written is read by both
 * readers, the same bytes in any order, what info counts. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_verify.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/naive_mesh.h"
#include "tests/support/scratch.h"

static mem m;

static leaf_file *open_sound(const char *path) {
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 2, NULL);
    if (st != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

/* ---- planes ---- */

static float previous_step(float step) {
    uint32_t bits;
    memcpy(&bits, &step, sizeof bits);
    assert_true(bits >= 256 && bits % 256 == 0);
    bits -= 256;
    memcpy(&step, &bits, sizeof step);
    return step;
}

static void check_code(const mesh_frame *f, float at, int lo, int hi) {
    if (!(mesh_leaf_plane(f, 0, lo) <= at && mesh_leaf_plane(f, 0, hi) >= at && lo <= hi))
        fail_msg("lo %a step %a: codes %d %d do not hold %a", (double)f->lo[0], (double)f->step[0],
                 lo, hi, (double)at);
    const float below = mesh_leaf_plane(f, 0, lo);
    for (int code = 0; code < 256; code++) {
        const float plane = mesh_leaf_plane(f, 0, code);
        assert_false(plane <= at && (plane > below || (plane == below && code < lo)));
        assert_false(plane >= at && code < hi);
        assert_true(code == 0 || plane >= mesh_leaf_plane(f, 0, code - 1));
    }
}

static void check_frame(float lo, float hi, field_random *r) {
    const mesh_frame f = mesh_leaf_frame((const float[6]){lo, 0, 0, hi, 0, 0});
    assert_true(mesh_leaf_plane(&f, 0, 0) == lo && mesh_leaf_plane(&f, 0, 255) >= hi);
    assert_true(f.step[1] == 0 && f.step[0] >= 0 && isfinite(f.step[0]));
    if (f.step[0] > 0) {
        mesh_frame less = f;
        less.step[0] = previous_step(f.step[0]);
        assert_true(less.step[0] == 0 || mesh_leaf_plane(&less, 0, 255) < hi);
    }
    for (int i = 0; i < 20; i++) {
        float at = i == 0 ? lo : i == 1 ? hi : (float)field_random_in(r, (double)lo, (double)hi);
        at = fminf(fmaxf(at, lo), hi);
        check_code(&f, at, mesh_leaf_code_lo(&f, 0, at), mesh_leaf_code_hi(&f, 0, at));
        const float plane = fminf(mesh_leaf_plane(&f, 0, (int)field_random_below(r, 256)), hi);
        check_code(&f, plane, mesh_leaf_code_lo(&f, 0, plane), mesh_leaf_code_hi(&f, 0, plane));
    }
}

static void test_planes(void **state) {
    (void)state;
    static const float pairs[][2] = {{0, 1},
                                     {-1, 1},
                                     {0, 0},
                                     {5, 5},
                                     {1e6F, 1e6F},
                                     {1e6F, 1e6F + 0.0625F},
                                     {1e6F, 1e6F + 1},
                                     {-1e30F, 1e30F},
                                     {-3.4e38F, 3.4e38F},
                                     {0, 3.4e38F},
                                     {0, 0x1p-149F},
                                     {0x1p-149F, 0x1p-140F},
                                     {-0x1p-126F, 0},
                                     {1e-30F, 2e-30F},
                                     {16777215, 16777218},
                                     {-1e-3F, 1e-3F},
                                     {1, 1.0000001F},
                                     {-255, 0},
                                     {0, 255},
                                     {-3.4e38F, -1e38F},
                                     {0.1F, 0.1F + 0x1p-20F}};
    field_random r = {FIELD_SEED};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        check_frame(pairs[i][0], pairs[i][1], &r);
    for (int i = 0; i < 2000; i++) {
        const float lo = (float)ldexp(field_random_in(&r, -1, 1), (int)field_random_below(&r, 60));
        const float size =
            (float)ldexp(field_random_unit(&r), 20 - (int)field_random_below(&r, 60));
        check_frame(lo, lo + size, &r);
    }
}

/* ---- round trips ---- */

static void check_same(const mesh_case *c, const naive_mesh *mesh) {
    size_t tet = 0;
    assert_int_equal(mesh->tets, c->tets);
    for (long t = 0; t < mesh->treelets; t++) {
        const naive_part *p = &mesh->part[t];
        for (long i = 0; i < p->tets; i++, tet++) {
            int found = 0;
            for (int k = 0; k < 4; k++)
                for (int corner = 0; corner < 4; corner++) {
                    const uint32_t id = c->ids[tet][corner];
                    const long v = p->tet[i][k];
                    bool same = memcmp(p->positions[v], c->xyz[id], sizeof c->xyz[id]) == 0;
                    for (long set = 0; same && set < mesh->sets; set++)
                        same = memcmp(&p->values[set * p->vertices + v],
                                      &c->values[(size_t)set * c->points + id], 4) == 0;
                    for (long set = 0; same && set < mesh->gradient_sets; set++)
                        same = memcmp(p->gradients[set * p->vertices + v],
                                      c->gradients[(size_t)set * c->points + id], 12) == 0;
                    for (long step = 1; same && step < mesh->places; step++)
                        same = memcmp(p->positions[step * p->vertices + v],
                                      c->moved[((size_t)step - 1) * c->points + id], 12) == 0;
                    found += same;
                }
            assert_int_equal(found, 4);
        }
    }
}

static void check_case(const mesh_case *c) {
    naive_mesh mesh;
    const char *path = mesh_leaves_make(c, "sound.leaf");
    leaf_file_close(open_sound(path));
    if (!naive_mesh_load(&mesh, path))
        fail_msg("%zu tets: %s", c->tets, mesh.why);
    check_same(c, &mesh);
    assert_int_equal(mesh.gradient_sets, c->mesh.gradients ? mesh.sets : 0);
    assert_int_equal(mesh.places, c->mesh.moving ? mesh.steps : 1);
    assert_int_equal(mesh.names != NULL, c->mesh.names != NULL);
    assert_int_equal(mesh.times != NULL, c->mesh.times && mesh.steps > 1);
    naive_mesh_release(&mesh);
    assert_int_equal(mem_used(&m), 0);
}

static void test_round_trips(void **state) {
    (void)state;
    for (uint32_t n = 1; n < 6; n++)
        for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
            mesh_case c = mesh_leaves_cube(n, n > 3 ? 2 : 1, n > 2 ? 3 : 1, n, n > 4 ? 20 : 0);
            c.file.codec = (leaf_codec)codec;
            c.file.run_align_log2 = n % 2 ? 6 : 12;
            check_case(&c);
            mesh_leaves_extend(&c, n);
            check_case(&c);
            c.mesh.gradients = n % 2;
            c.mesh.moving = c.mesh.moving && !c.mesh.gradients;
            check_case(&c);
            mesh_leaves_release(&c);
        }
}

/* One tet a treelet, one a leaf; all in one leaf, all in one treelet. */
static void test_sizes(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {1, 64}, {6, 64}, {9, 8}, {648, 1}, {16384, 5}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        mesh_case c = mesh_leaves_cube(i < 2 ? 2 : 3, 1, 1, i, 0);
        c.mesh.treelet_tets = sizes[i][0];
        c.mesh.leaf_tets = sizes[i][1];
        check_case(&c);
        mesh_leaves_release(&c);
    }
}

/* Values without any number, and -0, of which ranges and bounds make +0; constant ones. */
static void test_strange_values(void **state) {
    (void)state;
    static const float values[] = {NAN, INFINITY, -0.0F, 7, 1e30F, 0x1p-149F};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        mesh_case c = mesh_leaves_cube(2, 1, 1, i, 0);
        for (size_t v = 0; v < c.points; v++) {
            c.values[v] = values[i];
            for (int a = 0; a < 3; a++)
                c.xyz[v][a] = v == 0 && i == 2 ? -0.0F : fabsf(c.xyz[v][a]);
        }
        check_case(&c);
        mesh_leaves_release(&c);
    }
}

/* A chain of nodes may be as long as MESH_DEPTH_MAX, and no longer. */
static void test_depth(void **state) {
    (void)state;
    for (uint32_t longer = 0; longer < 2; longer++) {
        mesh_case c = mesh_leaves_cube(3, 1, 1, 1, 0);
        c.chain = 1;
        c.mesh.leaf_tets = 1;
        c.mesh.treelet_tets = MESH_DEPTH_MAX + 1 + longer;
        if (!longer) {
            check_case(&c);
        } else {
            leaf_file *f = NULL;
            naive_mesh mesh;
            const char *path = mesh_leaves_make(&c, "deep.leaf");
            assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
            assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_CORRUPT);
            assert_non_null(strstr(status_text(), "at most 64 nodes"));
            leaf_file_close(f);
            assert_false(naive_mesh_load(&mesh, path));
            naive_mesh_release(&mesh);
        }
        mesh_leaves_release(&c);
    }
}

/* ---- writing ---- */

static void test_same_bytes(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        mesh_case c = mesh_leaves_cube(4, 2, 2, 3, 10);
        mesh_leaves_extend(&c, 4);
        c.file.codec = (leaf_codec)codec;
        size_t size[2];
        char *bytes[2];
        for (int backwards = 0; backwards < 2; backwards++) {
            const char *path = scratch_path("order.leaf");
            assert_int_equal(mesh_leaves_try(&m, &c, path, backwards), ST_OK);
            bytes[backwards] = scratch_read(path, &size[backwards]);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        free(bytes[0]);
        free(bytes[1]);
        mesh_leaves_release(&c);
    }
}

/* Each allocation, each write and each read back fails in turn: an error and nothing left, or a
 * sound file (its folder's name is only needed to sync that). */
static void test_writing_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_READ};
    mesh_case c = mesh_leaves_cube(3, 1, 2, 1, 0);
    mesh_leaves_extend(&c, 2);
    const char *path = scratch_path("fault.leaf");
    const size_t before = scratch_count();
    for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++)
        for (long k = 1;; k++) {
            c.file.codec = k % 2 ? LEAF_CODEC_RAW : LEAF_CODEC_ZSTD;
            fault_arm(kinds[n], k);
            status st = mesh_leaves_try(&m, &c, path, 0);
            const bool fired = fault_fired(kinds[n]);
            fault_arm(kinds[n], 0);
            assert_true(st == ST_OK || fired);
            assert_int_equal(mem_used(&m), 0);
            if (st == ST_OK) {
                leaf_file_close(open_sound(path));
                assert_int_equal(remove(path), 0);
            }
            assert_true(fired || k > 3);
            if (!fired)
                break;
            assert_int_equal(scratch_count(), before);
        }
    mesh_leaves_release(&c);
}

static void test_reading_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ, FAULT_THREAD};
    mesh_case c = mesh_leaves_cube(2, 1, 2, 1, 0);
    mesh_leaves_extend(&c, 2);
    c.file.codec = LEAF_CODEC_ZSTD;
    const char *path = mesh_leaves_make(&c, "fault.leaf");
    for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++)
        for (long k = 1;; k++) {
            leaf_file *f = NULL;
            leaf_activity levels[LEAF_LEVELS_MAX];
            fault_arm(kinds[n], k);
            status st = leaf_file_open(&m, path, &f);
            if (st == ST_OK)
                st = leaf_verify(&m, f, 2, NULL);
            if (st == ST_OK)
                st = leaf_stats_activity(&m, f, 0, 0.5, 2, NULL, levels);
            const bool fired = fault_fired(kinds[n]);
            fault_arm(kinds[n], 0);
            leaf_file_close(f);
            assert_int_equal(st == ST_OK, !fired);
            assert_int_equal(mem_used(&m), 0);
            if (!fired)
                break;
        }
    mesh_leaves_release(&c);
}

/* ---- what the directory says ---- */

static void test_directory(void **state) {
    (void)state;
    mesh_case c = mesh_leaves_cube(4, 2, 3, 5, 0);
    leaf_file *f = open_sound(mesh_leaves_make(&c, "directory.leaf"));
    const uint32_t n = (uint32_t)((c.tets + 49) / 50);
    assert_int_equal(f->layout.treelets, n);
    assert_int_equal(f->layout.payloads, 7 * n);
    assert_int_equal(f->layout.sets, 6);
    assert_int_equal(f->header.tets, c.tets);
    assert_int_equal(f->header.vertices, c.points);
    assert_int_equal(f->layout.level[0].count, n);
    assert_int_equal(f->mesh->first_tet[n], c.tets);
    for (uint32_t t = 0; t < n; t++) {
        const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
        assert_int_equal(f->mesh->first_tet[t], 50 * t);
        assert_int_equal(f->layout.level_of[t], 0);
        assert_int_equal(leaf_layout_children(&f->layout, t), 0);
        assert_int_equal(f->sizes[t], s.topology_bytes);
        assert_int_equal(f->sizes[leaf_layout_values(&f->layout, 4, t)], s.values_bytes);
        assert_true(s.topology_bytes <= leaf_layout_payload_max(&f->layout));
    }
    leaf_file_close(f);
    mesh_leaves_release(&c);
}

/* What a file has besides: where each block is, names and times; and what stands for them in files
 * that have none. */
static void test_blocks(void **state) {
    (void)state;
    static const char *const parts[] = {
        "topology",           "values of set 0",    "values of set 1",    "values of set 2",
        "values of set 3",    "gradients of set 0", "gradients of set 1", "gradients of set 2",
        "gradients of set 3", "positions of step 1"};
    mesh_case c = mesh_leaves_cube(3, 2, 2, 5, 0);
    leaf_file *f = open_sound(mesh_leaves_make(&c, "plain.leaf"));
    assert_string_equal(f->names[0], "waves");
    assert_string_equal(f->names[1], "");
    assert_true(f->times[0] == 0 && f->times[1] == 1 && !f->has_times);
    assert_int_equal(f->layout.gradient_sets, 0);
    assert_false(leaf_layout_moves(&f->layout));
    leaf_file_close(f);
    mesh_leaves_extend(&c, 1);
    f = open_sound(mesh_leaves_make(&c, "blocks.leaf"));
    assert_string_equal(f->names[1], "ripples");
    assert_true(f->times[0] == -1.5 && f->times[1] == 0 && f->has_times);
    const leaf_layout *l = &f->layout;
    assert_int_equal(leaf_layout_set(l, 1, 1), 3);
    assert_int_equal(l->payloads, sizeof parts / sizeof parts[0] * l->treelets);
    for (uint32_t p = 0; p < l->payloads; p++) {
        const uint32_t t = p % l->treelets;
        uint32_t index, at = t;
        char name[LEAF_NAME_MAX], expected[LEAF_NAME_MAX];
        const leaf_block block = leaf_layout_block_of(l, p, &index);
        if (block == LEAF_BLOCK_VALUES)
            at = leaf_layout_values(l, index, t);
        if (block == LEAF_BLOCK_GRADIENTS)
            at = leaf_layout_gradients(l, index, t);
        if (block == LEAF_BLOCK_POSITIONS)
            at = leaf_layout_positions(l, index, t);
        assert_int_equal(at, p);
        snprintf(expected, sizeof expected, "treelet %u's %s", t, parts[p / l->treelets]);
        assert_string_equal(leaf_layout_payload_name(l, p, name), expected);
        assert_int_equal(f->sizes[p], leaf_layout_payload_bytes(l, p));
    }
    leaf_file_close(f);
    mesh_leaves_release(&c);
}

/* Active tets by all of them; treelets by their tets. */
static void test_activity(void **state) {
    (void)state;
    mesh_case c = mesh_leaves_cube(5, 1, 2, 5, 30);
    mesh_leaves_extend(&c, 6);
    leaf_file *f = open_sound(mesh_leaves_make(&c, "active.leaf"));
    uint64_t some = 0;
    for (double iso = -3; iso < 14; iso += 0.5) {
        leaf_activity levels[LEAF_LEVELS_MAX];
        assert_int_equal(leaf_stats_activity(&m, f, 0, iso, 2, NULL, levels), ST_OK);
        uint64_t active = 0;
        for (size_t t = 0; t < c.tets; t++) {
            int in = 0, finite = 0;
            for (int k = 0; k < 4; k++) {
                const float v = c.values[c.ids[t][k]];
                finite += isfinite(v) != 0;
                in += (double)v >= iso;
            }
            active += finite == 4 && in > 0 && in < 4;
        }
        assert_int_equal(levels[0].cells, active);
        assert_true(levels[0].treelets * 50 >= active && levels[0].treelets <= f->layout.treelets);
        some += active > 0;
    }
    assert_true(some > 10);
    const leaf_mesh_parts p = leaf_stats_mesh(f);
    assert_int_equal(p.nodes + p.tets + p.positions + p.codes + p.values + p.gradients +
                         p.moved_boxes + p.moved + p.padding,
                     f->header.payload_bytes);
    assert_int_equal(p.gradients, 2 * p.positions);
    assert_int_equal(p.moved, p.positions);
    assert_int_equal(p.stored_topology + p.stored_values + p.stored_gradients + p.stored_positions,
                     f->header.payload_bytes);
    assert_int_equal(p.tets, 8 * c.tets);
    assert_true(p.padding < 64ULL * 5 * f->layout.payloads);
    leaf_file_close(f);
    mesh_leaves_release(&c);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_planes, set_up),
        cmocka_unit_test_setup(test_round_trips, set_up),
        cmocka_unit_test_setup(test_sizes, set_up),
        cmocka_unit_test_setup(test_strange_values, set_up),
        cmocka_unit_test_setup(test_depth, set_up),
        cmocka_unit_test_setup(test_same_bytes, set_up),
        cmocka_unit_test_setup(test_writing_faults, set_up),
        cmocka_unit_test_setup(test_reading_faults, set_up),
        cmocka_unit_test_setup(test_directory, set_up),
        cmocka_unit_test_setup(test_blocks, set_up),
        cmocka_unit_test_setup(test_activity, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
