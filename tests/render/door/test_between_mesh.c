/* test_between_mesh.c - times between the steps of meshes that have all that a file may have:
 * several fields, gradients, moving points, tets that turn inside out on the way. Pictures, slices
 * and probes are those of a file with the vertices that the test blends, whichever way rays go; the
 * treelets' trees hold these vertices; trouble while a moment comes in.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_between.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "stream/loader.h"
#include "stream/loader_slots.h"
#include "stream/mesh_resident.h"
#include "tests/support/fixture.h"
#include "tests/support/leaf_image.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/tet_judge.h"

enum { FIELDS = 2, STEPS = 4, CELLS = 5, SEED = 23 };
static const double ISO = 0.25;
static const double shares[] = {0.5, 0.3, 1e-300, 1 - 0x1p-53};
enum { SHARES = sizeof shares / sizeof *shares };

/* ---- Files ---- */

/* moving: points go their own ways, so far that tets turn inside out. */
static mesh_case make_case(bool moving, leaf_codec codec, int non_finite) {
    mesh_case c = mesh_leaves_cube(CELLS, FIELDS, STEPS, SEED, non_finite);
    field_random r = {SEED};
    mesh_leaves_extend(&c, SEED);
    c.mesh.moving = moving;
    c.file.codec = codec;
    for (size_t i = 0; moving && i < (STEPS - 1) * c.points; i++)
        for (int a = 0; a < 3; a++)
            c.moved[i][a] = c.xyz[i % c.points][a] * 1.25F + (float)field_random_in(&r, -1.2, 1.2);
    return c;
}

/* By volatile doubles: nothing is fused, nothing reordered. */
static float mix(float a, float b, double share) {
    const volatile double rest = 1 - share, first = rest * (double)a, second = share * (double)b;
    const volatile double sum = first + second;
    return (float)sum;
}

/* A set of the case alone, at a share of the way from its step to the next. */
static mesh_case blend(const mesh_case *c, uint32_t of, uint32_t step, double share) {
    const size_t n = c->points, a = (of * STEPS + step) * n, b = a + n;
    const float(*from)[3] = (const float(*)[3])(step ? c->moved + (step - 1) * n : c->xyz);
    const float(*until)[3] = (const float(*)[3])(c->moved + step * n);
    mesh_case one = *c;
    one.values = malloc(n * sizeof *one.values);
    one.xyz = malloc(n * sizeof *one.xyz);
    one.gradients = malloc(n * sizeof *one.gradients);
    for (size_t i = 0; i < n; i++) {
        one.values[i] = mix(c->values[a + i], c->values[b + i], share);
        for (int k = 0; k < 3; k++) {
            one.gradients[i][k] = mix(c->gradients[a + i][k], c->gradients[b + i][k], share);
            one.xyz[i][k] = c->mesh.moving ? mix(from[i][k], until[i][k], share) : c->xyz[i][k];
        }
    }
    one.mesh.fields = one.mesh.steps = 1;
    one.mesh.moving = false;
    one.mesh.names = NULL;
    one.mesh.times = NULL;
    one.mesh.treelet_tets = 70; /* other treelets */
    return one;
}

static void release_blend(mesh_case *one) {
    free(one->values);
    free(one->xyz);
    free(one->gradients);
}

/* ---- What is drawn ---- */

static leafcast_scene scene_of(int look) {
    leafcast_scene scene = leafcast_scene_default();
    scene.smooth_normals = look == 1;
    scene.shadows = look == 2;
    scene.light_count = look == 2;
    scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
    return scene;
}

static const leafcast_surface surfaces[2] = {{ISO, {0.9f, 0.5f, 0.1f}, 0.5f, 0, 0},
                                             {-0.5, {0.1f, 0.5f, 0.9f}, 1.0f, 0, 0}};

static leafcast *open_both(const char *path, const leafcast_options *o) {
    leafcast *v = fixture_open(path, o);
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    return v;
}

static void check_pictures(leafcast *v, leafcast *alone, const leafcast_camera *view) {
    static picture is, want;
    for (int look = 0; look < 3; look++) {
        const leafcast_scene scene = scene_of(look);
        int hits = 0;
        pictures_draw(v, &scene, view, &is, NULL);
        pictures_draw(alone, &scene, view, &want, NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            hits += isfinite(want.z[i]) != 0;
            if (!pictures_same_pixel(&is, &want, i))
                fail_msg("look %d, pixel %d: t %.17g, expected %.17g", look, i, is.z[i], want.z[i]);
        }
        assert_true(hits > PICTURE_PIXELS / 40);
    }
}

static void check_slice(leafcast *v, leafcast *alone) {
    enum { SIDE = 60 };
    static double is[SIDE * SIDE], want[SIDE * SIDE];
    const leafcast_slice_pixels p = {.size = sizeof p,
                                     .width = SIDE,
                                     .height = SIDE,
                                     .origin = {0.1, 0.2, 3},
                                     .u = {5, 0.3, 0.7},
                                     .v = {-0.2, 9, 1.1}};
    int inside = 0;
    assert_int_equal(leafcast_sample_slice(v, &p, is, NULL, NULL, NULL), LEAFCAST_OK);
    assert_int_equal(leafcast_sample_slice(alone, &p, want, NULL, NULL, NULL), LEAFCAST_OK);
    for (int i = 0; i < SIDE * SIDE; i++) {
        inside += isfinite(want[i]) != 0;
        /* Where tets overlap, as some are inside out, each file has another one first. */
        assert_int_equal(isnan(is[i]), isnan(want[i]));
    }
    assert_true(inside > SIDE * SIDE / 4);
}

/* Of a mesh that does not move, to the bit. */
static void check_values(leafcast *v, leafcast *alone) {
    field_random r = {SEED};
    for (int i = 0; i < 50; i++) {
        const double at[3] = {field_random_in(&r, -1, 4), field_random_in(&r, -1, 9),
                              field_random_in(&r, -1, 14)};
        leafcast_sample is, want;
        assert_int_equal(leafcast_probe_point(v, at, &is), LEAFCAST_OK);
        assert_int_equal(leafcast_probe_point(alone, at, &want), LEAFCAST_OK);
        assert_int_equal(is.inside, want.inside);
        assert_memory_equal(is.gradient, want.gradient, sizeof is.gradient);
        assert_true(is.value == want.value || (isnan(is.value) && isnan(want.value)));
    }
}

/* What brute force sees of the blended mesh. Returns the surfaces that it judged. */
static uint64_t judge(const mesh_case *one, leafcast *v, const leafcast_camera *view) {
    static picture is;
    const tet_ref_mesh mesh = {one->points, one->tets, (const float(*)[3])one->xyz, one->values,
                               (const uint32_t(*)[4])one->ids};
    tet_ref *truth = tet_ref_create(&mesh);
    const double isos[2] = {ISO, -0.5};
    const leafcast_scene scene = scene_of(0);
    ref_camera look = {.fov = view->fov, .width = PICTURE_WIDTH, .height = PICTURE_HEIGHT};
    ref_tally tally = {0};
    memcpy(look.eye, view->eye, sizeof look.eye);
    memcpy(look.look_at, view->look_at, sizeof look.look_at);
    memcpy(look.up, view->up, sizeof look.up);
    pictures_draw(v, &scene, view, &is, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i += WATCHED ? 11 : 7) {
        const ref_ray ray = ref_primary_ray(&look, i % PICTURE_WIDTH, i / PICTURE_WIDTH);
        (void)tet_judge_pixel(&tally, truth, &ray, isos, 2, NULL, is.z[i]);
    }
    tet_ref_destroy(truth);
    assert_int_equal(ref_tally_faults(&tally), 0);
    return tally.hits;
}

/* Tets of a blend that are turned the other way round than in the first step. */
static int turned(const mesh_case *c, const mesh_case *one) {
    int count = 0;
    for (size_t t = 0; t < c->tets; t++) {
        double det[2];
        for (int k = 0; k < 2; k++) {
            const float(*p)[3] = (const float(*)[3])(k ? one->xyz : c->xyz);
            double e[3][3];
            for (int i = 0; i < 3; i++)
                for (int a = 0; a < 3; a++)
                    e[i][a] = (double)p[c->ids[t][i + 1]][a] - (double)p[c->ids[t][0]][a];
            det[k] = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                     e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                     e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
        }
        count += det[0] * det[1] < 0;
    }
    return count;
}

static const leafcast_experiments ways[] = {
    {.size = sizeof *ways},
    {.size = sizeof *ways, .treelet_limit = 1},
    {.size = sizeof *ways, .packets = 8, .schema = LEAFCAST_SCHEMA_REFIT},
    {.size = sizeof *ways, .isopolygons = LEAFCAST_ISOPOLYGONS_PRECOMPUTE},
    {.size = sizeof *ways, .isopolygons = LEAFCAST_ISOPOLYGONS_CACHE, .treelet_limit = 3},
};
enum { WAYS = sizeof ways / sizeof *ways };

static void check_series(const mesh_case *c, const char *path) {
    leafcast *v[WAYS + 1];
    leafcast_camera view;
    uint64_t judged = 0;
    int tets = 0;
    for (int i = 0; i <= WAYS; i++) {
        const leafcast_options o = {.size = sizeof o,
                                    .threads = 1 + i % 3,
                                    .backend = (leafcast_backend)(i % 3),
                                    .neighbours = i == WAYS,
                                    .experiments = i < WAYS ? &ways[i] : NULL};
        v[i] = open_both(path, &o);
    }
    view = leafcast_standard_view(v[0], 1.4, PICTURE_WIDTH, PICTURE_HEIGHT);
    for (uint32_t k = 0; k < FIELDS * (STEPS - 1); k++) {
        const uint32_t of = k % FIELDS, step = k / FIELDS;
        const double share = shares[k % SHARES];
        mesh_case one = blend(c, of, step, share);
        leafcast *alone = open_both(mesh_leaves_make(&one, "alone.leaf"), NULL);
        tets += turned(c, &one);
        for (int i = 0; i <= WAYS; i++) {
            assert_int_equal(leafcast_select_between(v[i], of, step, share), LEAFCAST_OK);
            check_pictures(v[i], alone, &view);
        }
        check_slice(v[0], alone);
        if (!c->mesh.moving)
            check_values(v[0], alone);
        judged += judge(&one, v[0], &view);
        leafcast_close(alone);
        release_blend(&one);
    }
    assert_true((tets > 50) == c->mesh.moving);
    assert_true(judged > (WATCHED ? 10 : 100));
    for (int i = 0; i <= WAYS; i++)
        leafcast_close(v[i]);
}

static void test_pictures(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        mesh_case c = make_case(kind % 2, kind / 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, kind * 60);
        check_series(&c, mesh_leaves_make(&c, "between-mesh.leaf"));
        mesh_leaves_release(&c);
    }
}

/* ---- Treelets ---- */

/* A treelet's tree holds its tets, and these are blends of what the file has. */
static void check_treelet(const leaf_file *f, const resident_mesh *tr, uint32_t set) {
    const uint32_t t = tr->head.id;
    const mesh_node *nodes = tr->nodes;
    const mesh_codes *codes = mesh_leaf_codes(tr->values);
    const float *value = mesh_leaf_values(&tr->mesh, tr->values);
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->head.payload);
    const uint16_t(*tets)[4] = mesh_leaf_tets(&tr->mesh, tr->head.payload);
    const float *own = f->own[(size_t)set * f->layout.treelets + t];
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    const mesh_frame planes = mesh_leaf_frame(tr->bounds);
    assert_memory_equal(&planes, &tr->planes, sizeof planes);
    for (uint32_t n = 0; n < tr->mesh.nodes; n++)
        for (int c = 0; c < MESH_CHILDREN && nodes[n].child[c] != MESH_NO_CHILD; c++) {
            const uint16_t child = nodes[n].child[c];
            if (!(child & MESH_LEAF)) {
                for (int a = 0; a < 3; a++)
                    for (int k = 0; k < MESH_CHILDREN && nodes[child].child[k] != MESH_NO_CHILD;
                         k++)
                        assert_true(nodes[n].lo[a][c] <= nodes[child].lo[a][k] &&
                                    nodes[child].hi[a][k] <= nodes[n].hi[a][c]);
                continue;
            }
            const uint32_t leaf = child & ~(uint32_t)MESH_LEAF;
            for (uint32_t i = first[leaf]; i < first[leaf + 1]; i++)
                for (int k = 0; k < 4; k++) {
                    const uint16_t at = tets[i][k];
                    for (int a = 0; a < 3; a++)
                        assert_true(mesh_leaf_plane(&planes, a, nodes[n].lo[a][c]) <=
                                        tr->positions[at][a] &&
                                    tr->positions[at][a] <=
                                        mesh_leaf_plane(&planes, a, nodes[n].hi[a][c]));
                    if (isfinite(value[at]))
                        assert_in_range(quantizer_floor(&q, (double)value[at]), codes[n].lo[c],
                                        codes[n].hi[c]);
                }
        }
}

typedef struct stage {
    mem m;
    leaf_file *below, *f;
    loader *l;
} stage;

static void begin(stage *s, const char *path) {
    const loader_options o = {
        .source = SOURCE_ARENA, .schema = MESH_TREES, .workers = 2, .isa = cpu_best()};
    mem_init(&s->m, 0);
    assert_int_equal(leaf_file_open(&s->m, path, &s->below), ST_OK);
    assert_int_equal(leaf_between_open(&s->m, s->below, cpu_best(), &s->f), ST_OK);
    assert_int_equal(loader_create(&s->m, s->f, &o, NULL, &s->l), ST_OK);
    loader_set_capacity(s->l, s->f->layout.treelets, SIZE_MAX);
    loader_select_gradients(s->l, true);
}

static void end(stage *s) {
    loader_destroy(s->l);
    leaf_file_close(s->f);
    leaf_file_close(s->below);
    assert_int_equal(mem_used(&s->m), 0);
}

static uint32_t show(stage *s, uint32_t of, uint32_t step, double share) {
    const leaf_moment at = {of, step, share};
    const interest in = interest_of_isovalues(&ISO, 1);
    loader_rest(s->l);
    const uint32_t set = leaf_between_select(s->f, &at);
    loader_select_set(s->l, set);
    loader_select(s->l, &in);
    loader_sweep(s->l);
    return set;
}

static uint32_t check_treelets(const stage *s, uint32_t set) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < s->f->layout.treelets; t++) {
        const treelet *at = loader_lookup(s->l, t);
        assert_int_equal(at != NULL, s->l->own[t]);
        if (!at)
            continue;
        assert_int_equal(at->set, set);
        check_treelet(s->f, resident_mesh_of(at), set);
        count++;
    }
    return count;
}

static void test_treelets(void **state) {
    (void)state;
    for (int moving = 0; moving < 2; moving++) {
        mesh_case c = make_case(moving, LEAF_CODEC_ZSTD, moving ? 90 : 0);
        stage s;
        begin(&s, mesh_leaves_make(&c, "between-treelets.leaf"));
        field_random r = {SEED};
        uint32_t checked = 0;
        for (int round = 0; round < 40; round++) {
            const uint32_t step = (uint32_t)field_random_below(&r, STEPS - 1);
            const uint32_t set = show(&s, (uint32_t)field_random_below(&r, FIELDS), step,
                                      shares[field_random_below(&r, SHARES)]);
            assert_int_equal(loader_settle(s.l), ST_OK);
            checked += check_treelets(&s, set);
        }
        assert_true(checked > 120);
        end(&s);
        mesh_leaves_release(&c);
    }
}

/* The k-th operation of its kind fails while the next two steps come in: an error, and then all is
 * well. False when it never came. */
static bool fail_at(const char *path, fault_kind what, long k) {
    stage s;
    begin(&s, path);
    (void)show(&s, 0, 0, 0.5);
    assert_int_equal(loader_settle(s.l), ST_OK);
    fault_arm(what, k);
    const uint32_t set = show(&s, 0, 1, 0.25);
    const status st = loader_settle(s.l);
    const bool fired = fault_fired(what);
    fault_arm(what, 0);
    assert_int_equal(st, !fired ? ST_OK : what == FAULT_ALLOC ? ST_NOMEM : ST_IO);
    loader_forget_failures(s.l);
    loader_sweep(s.l);
    assert_int_equal(loader_settle(s.l), ST_OK);
    assert_true(check_treelets(&s, set) > 0);
    end(&s);
    return fired;
}

static void test_faults(void **state) {
    (void)state;
    mesh_case c = make_case(true, LEAF_CODEC_RAW, 0);
    const char *path = mesh_leaves_make(&c, "between-faults.leaf");
    for (int what = FAULT_ALLOC; what <= FAULT_READ; what++) {
        int fired = 0;
        for (long k = 1; fail_at(path, (fault_kind)what, k); k += k < 10 ? 1 : 13)
            fired++;
        assert_true(fired > 8);
    }
    mesh_leaves_release(&c);
}

/* Positions outside of the boxes, with checksums that do not tell: an error where the step is
 * needed. */
static void test_lying(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = make_case(true, LEAF_CODEC_RAW, 0);
    size_t size;
    char *bytes = scratch_read(mesh_leaves_make(&c, "between-honest.leaf"), &size);
    const leaf_image image = leaf_image_of(bytes, size);
    mem m;
    leaf_file *f;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open_memory(&m, "honest", image.bytes, image.size, &f), ST_OK);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint64_t at = f->offsets[leaf_layout_positions(&f->layout, 2, t)] +
                            mesh_leaf_shape(f->mesh->counts[t]).moved_at;
        const float far = 1e20F;
        memcpy(image.bytes + at, &far, sizeof far);
    }
    leaf_file_close(f);
    leaf_image_seal_payloads(&image);
    leaf_image_seal(&image);
    stage s;
    begin(&s, scratch_write("between-lying.leaf", image.bytes, image.size));
    for (uint32_t step = 0; step < STEPS - 1; step++) {
        (void)show(&s, 0, step, 0.5);
        assert_int_equal(loader_settle(s.l), step == 0 ? ST_OK : ST_CORRUPT);
        loader_forget_failures(s.l);
    }
    end(&s);
    free(image.bytes);
    mesh_leaves_release(&c);
}

/* What sets share, read twice at once, as an early read and a late one may: one copy is shared, the
 * other goes with its treelet. */
static void test_shared(void **state) {
    (void)state;
    mesh_case c = make_case(true, LEAF_CODEC_ZSTD, 0);
    stage s;
    begin(&s, mesh_leaves_make(&c, "between-shared.leaf"));
    struct loader_private *h = s.l->hidden;
    const leaf_moment at = {0, 0, 0.5};
    const uint32_t set = leaf_between_select(s.f, &at);
    const size_t used = mem_used(&s.m), counted = h->bytes;
    resident_scratch scratch = {0};
    assert_int_equal(leaf_unpacker_create(&s.m, s.f, &scratch.unpacker), ST_OK);
    treelet *both[2] = {NULL, NULL};
    uint64_t bytes = 0;
    for (int i = 0; i < 2; i++)
        assert_null(loader_slots_share(h, 0));
    for (int i = 0; i < 2; i++) {
        assert_int_equal(h->kind->load(&h->store, 0, set, NULL, NULL, &scratch, &both[i], &bytes),
                         ST_OK);
        h->bytes += both[i]->bytes;
        loader_slots_offer(h, both[i]);
        assert_int_equal(both[i]->alone, i);
    }
    const void *payload = loader_slots_share(h, 0);
    assert_ptr_equal(payload, both[0]->payload);
    loader_slots_release(h, 0);
    for (int i = 0; i < 2; i++)
        loader_slots_discard(s.l, both[i]);
    leaf_unpacker_destroy(scratch.unpacker);
    assert_int_equal(h->bytes, counted);
    assert_int_equal(mem_used(&s.m), used);
    end(&s);
    mesh_leaves_release(&c);
}

/* Opening fails at every allocation in turn. */
static void test_opening(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = make_case(true, LEAF_CODEC_RAW, 0);
    const char *path = mesh_leaves_make(&c, "between-opening.leaf");
    mem m;
    leaf_file *below, *f = NULL;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &below), ST_OK);
    const size_t bare = mem_used(&m);
    long k = 1;
    for (bool fired = true; fired; k++) {
        fault_arm(FAULT_ALLOC, k);
        const status st = leaf_between_open(&m, below, CPU_SCALAR, &f);
        fired = fault_fired(FAULT_ALLOC);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(st, fired ? ST_NOMEM : ST_OK);
        if (fired)
            assert_int_equal(mem_used(&m), bare);
    }
    assert_true(k > 10);
    leaf_file_close(f);
    leaf_file_close(below);
    mesh_leaves_release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures), cmocka_unit_test(test_treelets),
        cmocka_unit_test(test_faults),   cmocka_unit_test(test_lying),
        cmocka_unit_test(test_opening),  cmocka_unit_test(test_shared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
