/* test_mesh_steps.c - fields and time steps of meshes: every picture of a series is that of a file
 * of that step alone, whichever way its trees come, to and fro, with little room and with much;
 * what is refit is what the file has; nothing is read twice that there is room for, and no more
 * than is needed.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "formats/mesh/mesh_refit.h"
#include "stream/loader.h"
#include "stream/mesh_resident.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/pictures.h"

enum { FIELDS = 2, STEPS = 4, SETS = FIELDS * STEPS, CELLS = 5, SEED = 17 };
static const double ISO = 0.25;

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { PAGES = 5, ALL_ISAS = 0 };
#else
enum { PAGES = 8, ALL_ISAS = 1 };
#endif

/* ---- files ---- */

typedef struct series {
    mesh_case all;
    const char *path;
} series;

static series series_make(bool moving, leaf_codec codec, int non_finite, const char *name) {
    series s = {.all = mesh_leaves_cube(CELLS, FIELDS, STEPS, SEED, non_finite)};
    if (moving)
        mesh_leaves_extend(&s.all, SEED);
    s.all.file.codec = codec;
    s.path = mesh_leaves_make(&s.all, name);
    return s;
}

/* The file of one field at one step, cut otherwise. */
static const char *single(const series *s, uint32_t set, const char *name) {
    mesh_case one = s->all;
    const uint32_t step = set % STEPS;
    one.values = s->all.values + set * s->all.points;
    one.mesh.fields = one.mesh.steps = 1;
    one.mesh.gradients = one.mesh.moving = false;
    one.mesh.names = NULL;
    one.mesh.times = NULL;
    one.mesh.treelet_tets = 200;
    if (s->all.mesh.moving && step > 0)
        one.xyz = s->all.moved + (step - 1) * s->all.points;
    return mesh_leaves_make(&one, name);
}

/* ---- refitting ---- */

typedef struct loaded {
    mem m;
    leaf_file *f;
} loaded;

static void *payload_of(loaded *x, uint32_t p) {
    char *bytes = mem_alloc(&x->m, leaf_layout_payload_bytes(&x->f->layout, p));
    assert_non_null(bytes);
    assert_int_equal(leaf_file_load(x->f, p, NULL, bytes), ST_OK);
    return bytes;
}

/* A payload whose head is lost comes back to the bit. */
static void assert_refit(loaded *x, uint32_t t, uint32_t p, uint32_t head, const void *topology,
                         uint32_t set, uint32_t step) {
    const leaf_layout *l = &x->f->layout;
    const mesh_shape s = mesh_leaf_shape(x->f->mesh->counts[t]);
    const size_t bytes = leaf_layout_payload_bytes(l, p), element = (size_t)set * l->treelets + t;
    void *want = payload_of(x, p), *got = payload_of(x, p);
    void *scratch = mem_alloc(&x->m, mesh_refit_scratch(&s));
    memset(got, 0x5A, head);
    if (step > 0)
        mesh_refit_boxes(&s, topology, x->f->mesh->bounds[leaf_layout_bounds(l, step, t)], got,
                         scratch);
    else
        mesh_refit_values(&s, topology, x->f->own[element],
                          !(x->f->flags[element] & LEAF_FLAG_NON_FINITE), got, scratch);
    assert_memory_equal(got, want, bytes);
    mem_free(&x->m, scratch);
    mem_free(&x->m, got);
    mem_free(&x->m, want);
}

static void test_refit(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        series s = series_make(true, LEAF_CODEC_RAW, kind * 40, "refit.leaf");
        loaded x;
        mem_init(&x.m, 0);
        assert_int_equal(leaf_file_open(&x.m, s.path, &x.f), ST_OK);
        const leaf_layout *l = &x.f->layout;
        for (uint32_t t = 0; t < l->treelets; t++) {
            const mesh_shape shape = mesh_leaf_shape(x.f->mesh->counts[t]);
            void *topology = payload_of(&x, t);
            for (uint32_t set = 0; set < SETS; set++)
                assert_refit(&x, t, leaf_layout_values(l, set, t), shape.values_at, topology, set,
                             0);
            for (uint32_t step = 1; step < STEPS; step++)
                assert_refit(&x, t, leaf_layout_positions(l, step, t), shape.moved_at, topology, 0,
                             step);
            mem_free(&x.m, topology);
        }
        leaf_file_close(x.f);
        assert_int_equal(mem_used(&x.m), 0);
        mesh_leaves_release(&s.all);
    }
}

/* ---- pictures ---- */

typedef struct album {
    picture page[SETS];
    leafcast_camera camera;
    int hits;
} album;

static const leafcast_surface surfaces[2] = {{ISO, {0.9f, 0.5f, 0.1f}, 0.5f, 0, 0},
                                             {-0.5, {0.1f, 0.5f, 0.9f}, 1.0f, 0, 0}};

/* Of each step the picture of its own file. */
static void fill_album(const series *s, album *a) {
    leafcast *whole = fixture_open(s->path, NULL);
    a->camera = leafcast_standard_view(whole, 1.4, PICTURE_WIDTH, PICTURE_HEIGHT);
    a->hits = 0;
    leafcast_close(whole);
    for (uint32_t set = 0; set < SETS; set++) {
        leafcast *v = fixture_open(
            single(s, set, "single.leaf"),
            &(leafcast_options){.size = sizeof(leafcast_options), .isa = "scalar", .threads = 1});
        const leafcast_scene scene = leafcast_scene_default();
        leafcast_stats stats = {.size = sizeof stats};
        assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
        pictures_draw(v, &scene, &a->camera, &a->page[set], &stats);
        for (int i = 0; i < PICTURE_PIXELS; i++)
            a->hits += isfinite(a->page[set].z[i]);
        leafcast_close(v);
        for (uint32_t other = 0; other < set; other++)
            assert_memory_not_equal(a->page[set].z, a->page[other].z, sizeof a->page[set].z);
    }
}

static void assert_page(leafcast *v, const album *a, uint32_t set, leafcast_stats *stats) {
    static picture got;
    const leafcast_scene scene = leafcast_scene_default();
    assert_int_equal(leafcast_select_set(v, set / STEPS, set % STEPS), LEAFCAST_OK);
    pictures_draw(v, &scene, &a->camera, &got, stats);
    assert_memory_equal(&got, &a->page[set], sizeof got);
}

/* Sets at random, the same ones again and again among them. */
static void leaf_through(const char *path, const leafcast_options *o, const album *a, int count) {
    field_random r = {SEED};
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *v = fixture_open(path, o);
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    for (int i = 0; i < count; i++) {
        assert_page(v, a, (uint32_t)field_random_below(&r, SETS), &stats);
        assert_true(o->memory == 0 || stats.bytes_peak <= o->memory);
        assert_true(stats.bytes_resident > 0);
        assert_true(stats.bytes_resident <= stats.bytes_peak);
    }
    leafcast_close(v);
}

/* The smallest budget, to a power of two, that will do. */
static uint64_t least_memory(const char *path, const album *a) {
    for (uint64_t memory = 1 << 16;; memory *= 2) {
        static picture p;
        const leafcast_scene scene = leafcast_scene_default();
        const leafcast_options o = {
            .size = sizeof(leafcast_options), .memory = memory, .threads = 1};
        leafcast *v = NULL;
        leafcast_status st = leafcast_open(path, &o, &v);
        if (st == LEAFCAST_OK)
            st = leafcast_select(v, surfaces, 2);
        if (st == LEAFCAST_OK)
            st = leafcast_trace(v, &scene, &a->camera,
                                &(leafcast_image){.size = sizeof(leafcast_image), .z = p.z}, NULL,
                                NULL, NULL);
        leafcast_close(v);
        if (st == LEAFCAST_OK)
            return 2 * memory; /* a picture has more planes */
        assert_int_equal(st, LEAFCAST_NOMEM);
    }
}

static void test_pictures(void **state) {
    (void)state;
    static const uint32_t limits[] = {0, 1, 3};
    static album a;
    for (int kind = 0; kind < 4; kind++) {
        series s = series_make(kind % 2, kind / 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, kind * 60,
                               "series.leaf");
        fill_album(&s, &a);
        print_message("%d surfaces\n", a.hits);
        assert_true(a.hits > PICTURE_PIXELS / 40 * SETS);
        for (int schema = LEAFCAST_SCHEMA_TREES; schema <= LEAFCAST_SCHEMA_REFIT; schema++)
            for (int isa = ALL_ISAS ? CPU_SCALAR : (int)cpu_best(); isa <= (int)cpu_best(); isa++)
                for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
                    for (int backend = 1; backend < 3; backend++) {
                        const leafcast_options o = {
                            .size = sizeof(leafcast_options),
                            .isa = cpu_isa_name((cpu_isa)isa),
                            .threads = 1 + (int)i,
                            .backend = (leafcast_backend)backend,
                            .experiments = EXPERIMENTS(.schema = (leafcast_schema)schema,
                                                       .treelet_limit = limits[i])};
                        leaf_through(s.path, &o, &a, PAGES);
                    }
        const uint64_t least = least_memory(s.path, &a);
        for (int schema = LEAFCAST_SCHEMA_TREES; schema <= LEAFCAST_SCHEMA_REFIT; schema++)
            for (uint64_t memory = least; memory <= 8 * least; memory *= 2)
                leaf_through(s.path,
                             &(leafcast_options){.size = sizeof(leafcast_options),
                                                 .experiments =
                                                     EXPERIMENTS(.schema = (leafcast_schema)schema),
                                                 .memory = memory,
                                                 .threads = 1},
                             &a, 2 * PAGES);
        mesh_leaves_release(&s.all);
    }
}

/* ---- what is read, and what stays ---- */

/* The first time through all sets each is read once by schema trees: its values and positions, the
 * topology with the first alone. (The second time, what the last set saw of the first may come,
 * too.) Refitting reads no codes. */
static void assert_reading(const series *s, const album *a, leafcast_schema schema, uint64_t *first,
                           uint64_t *again) {
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *v =
        fixture_open(s->path, &(leafcast_options){.size = sizeof(leafcast_options),
                                                  .threads = 2,
                                                  .experiments = EXPERIMENTS(.schema = schema)});
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    assert_page(v, a, 1, &stats); /* topologies */
    *first = *again = 0;
    for (int round = 0; round < 3; round++)
        for (uint32_t set = 0; set < SETS; set++) {
            assert_page(v, a, set, &stats);
            *(round ? again : first) += round == 1 ? 0 : stats.bytes_read;
        }
    leafcast_close(v);
}

static void test_reading(void **state) {
    (void)state;
    static album a;
    for (int moving = 0; moving < 2; moving++) {
        uint64_t trees, refit, again;
        series s = series_make(moving, LEAF_CODEC_RAW, 0, "reading.leaf");
        fill_album(&s, &a);
        assert_reading(&s, &a, LEAFCAST_SCHEMA_TREES, &trees, &again);
        assert_true(trees > 0);
        assert_int_equal(again, 0);
        assert_reading(&s, &a, LEAFCAST_SCHEMA_REFIT, &refit, &again);
        print_message("%s: trees %llu bytes, refit %llu\n", moving ? "moving" : "in place",
                      (unsigned long long)trees, (unsigned long long)refit);
        assert_true(refit < trees && refit > trees / 4);
        assert_true(again > refit / 2);
        mesh_leaves_release(&s.all);
    }
}

/* Let steps 0 and 2 of the first field have the values of step 1 at the first half of each layer's
 * points, and step 2 its positions. The surfaces are in the lower layers. */
static void make_alike(series *s, const char *name) {
    const size_t n = s->all.points, layer = (CELLS + 1) * (CELLS + 1);
    for (size_t i = 0; i < n; i++) {
        if (i % layer >= layer / 2)
            continue;
        s->all.values[2 * n + i] = s->all.values[n + i];
        s->all.values[i] = s->all.values[n + i];
        if (s->all.mesh.moving)
            memcpy(s->all.moved[n + i], s->all.moved[i], sizeof *s->all.moved);
    }
    s->all.mesh.treelet_tets = 12;
    s->path = mesh_leaves_make(&s->all, name);
}

static bool has_surface(const leaf_file *f, uint32_t set, uint32_t t) {
    const float *own = f->own[(size_t)set * f->layout.treelets + t];
    bool any = false;
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++)
        any |= (double)own[0] <= surfaces[i].isovalue && surfaces[i].isovalue <= (double)own[1];
    return any;
}

/* The bytes that one set does not have in common with another, of treelets with a surface; *same:
 * how many treelets with a surface have all. */
static uint64_t apart_bytes(const char *path, uint32_t set, uint32_t other, uint32_t *same) {
    mem m;
    leaf_file *f;
    uint64_t bytes = 0;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    *same = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        uint32_t p[2][LEAF_PARTS_MAX];
        bool alike = true;
        if (!has_surface(f, set, t))
            continue;
        const int parts = f->geometry->parts(&f->layout, other, t, p[0]);
        assert_int_equal(f->geometry->parts(&f->layout, set, t, p[1]), parts);
        for (int i = 1; i < parts; i++)
            alike = alike && leaf_file_same(f, p[0][i], p[1][i]);
        for (int i = 1; i < parts && !alike; i++)
            bytes += f->sizes[p[1][i]];
        *same += alike;
    }
    leaf_file_close(f);
    return bytes;
}

/* A treelet that has the same in another step stays, and is read for neither; its pictures are
 * those of the step's own file, there and back. */
static void test_alike(void **state) {
    (void)state;
    static album a;
    for (int kind = 0; kind < 8; kind++) {
        series s = series_make(kind & 1, kind & 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, 0, "apart");
        uint32_t same;
        make_alike(&s, "alike.leaf");
        fill_album(&s, &a);
        const uint64_t back = apart_bytes(s.path, 1, 2, &same),
                       apart = apart_bytes(s.path, 2, 1, &same);
        assert_true(same > 1 && apart > 0);
        const leafcast_options o = {
            .size = sizeof(leafcast_options),
            .threads = 2,
            .experiments =
                EXPERIMENTS(.schema = kind & 4 ? LEAFCAST_SCHEMA_REFIT : LEAFCAST_SCHEMA_TREES)};
        leafcast_stats stats = {.size = sizeof stats};
        leafcast *v = fixture_open(s.path, &o);
        assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
        assert_page(v, &a, 1, &stats);
        assert_page(v, &a, 2, &stats);
        assert_true(stats.bytes_read > 0 && stats.bytes_read <= apart);
        assert_page(v, &a, 1, &stats);
        assert_true(stats.bytes_read <= back);
        assert_page(v, &a, 0, &stats);
        assert_page(v, &a, 2, &stats);
        assert_page(v, &a, SETS - 1, &stats);
        assert_page(v, &a, 2, &stats);
        leafcast_close(v);
        mesh_leaves_release(&s.all);
    }
}

/* ---- the loader by itself ---- */

/* Each treelet that is READY is sound as `verify` would have it, its tree holds its tets, and its
 * set is the selected one. Returns how many there are. */
static uint32_t assert_sound(mem *m, const loader *l, uint32_t set) {
    const leaf_layout *layout = &l->file->layout;
    uint32_t count = 0;
    for (uint32_t t = 0; t < layout->treelets; t++) {
        const resident_mesh *tr = resident_mesh_of(loader_lookup(l, t));
        assert_int_equal(tr != NULL, l->own[t]);
        if (!tr)
            continue;
        const uint32_t step = set % layout->steps;
        void *scratch = mem_alloc(m, mesh_leaf_check_scratch(&tr->mesh));
        count++;
        assert_int_equal(tr->head.set, set);
        assert_int_equal(mesh_leaf_check_topology(l->file, t, tr->head.payload, scratch), ST_OK);
        assert_int_equal(
            mesh_leaf_check_values(l->file, set, t, tr->head.payload, tr->values, scratch), ST_OK);
        assert_int_equal(tr->moved != NULL, leaf_layout_place(layout, step) > 0);
        if (tr->moved)
            assert_int_equal(
                mesh_leaf_check_positions(l->file, step, t, tr->head.payload, tr->moved, scratch),
                ST_OK);
        for (uint32_t n = 0; n < tr->mesh.nodes; n++) {
            const mesh_node *stored = &mesh_leaf_nodes(tr->head.payload)[n];
            const mesh_boxes *boxes = tr->moved ? &mesh_leaf_moved_boxes(tr->moved)[n]
                                                : (const mesh_boxes *)(const void *)stored;
            assert_memory_equal(tr->nodes[n].lo, boxes->lo, sizeof boxes->lo);
            assert_memory_equal(tr->nodes[n].hi, boxes->hi, sizeof boxes->hi);
            assert_memory_equal(tr->nodes[n].child, stored->child, sizeof stored->child);
        }
        mem_free(m, scratch);
    }
    return count;
}

static void test_loader(void **state) {
    (void)state;
    for (int kind = 0; kind < 8; kind++) {
        mem m, own;
        leaf_file *f;
        loader *l;
        series s =
            series_make(kind & 1, kind & 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, 0, "loader.leaf");
        const loader_options o = {.source = SOURCE_ARENA,
                                  .schema = kind & 4 ? MESH_REFIT : MESH_TREES,
                                  .workers = 2,
                                  .isa = cpu_best()};
        mem_init(&m, 0);
        mem_init(&own, 0);
        assert_int_equal(leaf_file_open(&m, s.path, &f), ST_OK);
        assert_int_equal(loader_create(&m, f, &o, NULL, &l), ST_OK);
        const size_t bare = mem_used(&m), n = f->layout.treelets;
        uint32_t ready = 0;
        field_random r = {SEED};
        atomic_uchar *touched = malloc(n * sizeof *touched);
        memset((void *)touched, 1, n * sizeof *touched);
        for (int round = 0; round < 60; round++) {
            const double iso = ISO + 0.5 * (round % 3 - 1);
            const interest in = interest_of_isovalues(&iso, 1);
            const uint32_t set = (uint32_t)field_random_below(&r, SETS);
            const size_t beside = (size_t)field_random_below(&r, 1 << 20);
            loader_set_capacity(l, (uint32_t)n, beside);
            loader_select_set(l, set);
            loader_select(l, &in);
            loader_sweep(l);
            assert_int_equal(loader_settle(l), ST_OK);
            ready += assert_sound(&own, l, set);
            const size_t held = loader_statistics(l).bytes_resident;
            assert_true(mem_used(&m) - bare <= held);
            assert_true(held <= n * loader_slot_bytes(l) + beside);
            /* What another set is expected for changes nothing, however much of it comes. */
            loader_expect(l, (uint32_t)field_random_below(&r, SETS));
            loader_read_expected(l, touched);
            if (round % 2)
                nanosleep(&(struct timespec){0, 2000000}, NULL);
        }
        assert_true(ready > 60);
        assert_int_equal(loader_statistics(l).early > 0, o.schema == MESH_TREES);
        free((void *)touched);
        loader_destroy(l);
        leaf_file_close(f);
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(mem_used(&own), 0);
        mesh_leaves_release(&s.all);
    }
}

/* ---- trouble ---- */

static status bring_in_all(loader *l) {
    loader_sweep(l);
    return loader_settle(l);
}

/* The k-th operation of its kind fails while another step comes in: an error, and then all is well.
 * False when it never came. */
static bool fail_at(const char *path, mesh_schema schema, fault_kind what, long k, int *errors) {
    const loader_options o = {
        .source = SOURCE_ARENA, .schema = schema, .workers = 2, .isa = cpu_best()};
    mem m, own;
    leaf_file *f;
    loader *l;
    mem_init(&m, 0);
    mem_init(&own, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    assert_int_equal(loader_create(&m, f, &o, NULL, &l), ST_OK);
    loader_set_capacity(l, f->layout.treelets, SIZE_MAX);
    const interest in = interest_of_isovalues(&ISO, 1);
    loader_select(l, &in);
    assert_int_equal(bring_in_all(l), ST_OK);
    fault_arm(what, k);
    loader_select_set(l, 2);
    const status st = bring_in_all(l);
    const bool fired = fault_fired(what);
    fault_arm(what, 0);
    assert_int_equal(st, !fired ? ST_OK : what == FAULT_ALLOC ? ST_NOMEM : ST_IO);
    *errors += st != ST_OK;
    loader_forget_failures(l);
    assert_int_equal(bring_in_all(l), ST_OK);
    assert_true(assert_sound(&own, l, 2) > 0);
    loader_destroy(l);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return fired;
}

static void test_faults(void **state) {
    (void)state;
    series s = series_make(true, LEAF_CODEC_RAW, 0, "faults.leaf");
    for (int schema = MESH_TREES; schema <= MESH_REFIT; schema++)
        for (int what = FAULT_ALLOC; what <= FAULT_READ; what++) {
            int errors = 0;
            for (long k = 1; fail_at(s.path, (mesh_schema)schema, (fault_kind)what, k, &errors);
                 k += k < 20 ? 1 : 7)
                ;
            print_message("%d errors\n", errors);
            assert_true(errors > 8);
        }
    mesh_leaves_release(&s.all);
}

/* ---- damage ---- */

/* Flip a byte of a file. */
static void flip(const char *path, uint64_t at) {
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    const int c = fgetc(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    assert_true(fputc(c ^ 0x10, f) != EOF);
    assert_int_equal(fclose(f), 0);
}

/* Draw all of a set's treelets. */
static leafcast_status draw_set(const char *path, leafcast_schema schema, const album *a,
                                uint32_t set, double *z) {
    leafcast_scene scene = leafcast_scene_default();
    leafcast *v =
        fixture_open(path, &(leafcast_options){.size = sizeof(leafcast_options),
                                               .threads = 1,
                                               .experiments = EXPERIMENTS(.schema = schema)});
    scene.sweep = true;
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    assert_int_equal(leafcast_select_set(v, set / STEPS, set % STEPS), LEAFCAST_OK);
    const leafcast_status st =
        leafcast_trace(v, &scene, &a->camera,
                       &(leafcast_image){.size = sizeof(leafcast_image), .z = z}, NULL, NULL, NULL);
    leafcast_close(v);
    return st;
}

/* A changed vertex is always found out; a changed code by those who read it, and others draw the
 * true picture. */
static void test_damage(void **state) {
    (void)state;
    static album a;
    static double z[PICTURE_PIXELS];
    enum { SET = 2 };
    series s = series_make(true, LEAF_CODEC_RAW, 0, "damage.leaf");
    mem m;
    leaf_file *f;
    fill_album(&s, &a);
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, s.path, &f), ST_OK);
    uint32_t t = 0;
    while (!((double)f->own[SET * f->layout.treelets + t][0] < ISO &&
             ISO <= (double)f->own[SET * f->layout.treelets + t][1]))
        t++;
    const mesh_shape shape = mesh_leaf_shape(f->mesh->counts[t]);
    const uint64_t values = f->offsets[leaf_layout_values(&f->layout, SET, t)];
    const uint64_t moved = f->offsets[leaf_layout_positions(&f->layout, SET, t)];
    const uint64_t heads[] = {values, moved},
                   tails[] = {values + shape.values_at + 1, moved + shape.moved_at + 2};
    leaf_file_close(f);
    for (int i = 0; i < 2; i++) {
        flip(s.path, heads[i]);
        assert_int_equal(draw_set(s.path, LEAFCAST_SCHEMA_TREES, &a, SET, z), LEAFCAST_CORRUPT);
        assert_int_equal(draw_set(s.path, LEAFCAST_SCHEMA_REFIT, &a, SET, z), LEAFCAST_OK);
        assert_memory_equal(z, a.page[SET].z, sizeof z);
        flip(s.path, heads[i]);
        flip(s.path, tails[i]);
        for (int schema = LEAFCAST_SCHEMA_TREES; schema <= LEAFCAST_SCHEMA_REFIT; schema++) {
            assert_int_equal(draw_set(s.path, (leafcast_schema)schema, &a, SET, z),
                             LEAFCAST_CORRUPT);
            assert_non_null(strstr(leafcast_error_text(), "damage.leaf: byte "));
        }
        flip(s.path, tails[i]);
    }
    for (int schema = LEAFCAST_SCHEMA_TREES; schema <= LEAFCAST_SCHEMA_REFIT; schema++)
        assert_int_equal(draw_set(s.path, (leafcast_schema)schema, &a, SET, z), LEAFCAST_OK);
    mesh_leaves_release(&s.all);
}

/* ---- names, and what is not there ---- */

static void test_names(void **state) {
    (void)state;
    series s = series_make(true, LEAF_CODEC_RAW, 0, "names.leaf");
    leafcast *v = fixture_open(s.path, NULL);
    const leafcast_info info = leafcast_describe(v);
    uint32_t found;
    assert_int_equal(info.fields, FIELDS);
    assert_int_equal(info.steps, STEPS);
    assert_true(info.moving);
    assert_string_equal(leafcast_field_name(v, 1), "ripples");
    assert_string_equal(leafcast_field_name(v, FIELDS), "");
    assert_true(leafcast_step_time(v, 3) == 7.0);
    assert_int_equal(leafcast_find_field(v, "ripples", &found), LEAFCAST_OK);
    assert_int_equal(found, 1);
    assert_int_equal(leafcast_find_field(v, "0", &found), LEAFCAST_OK);
    assert_int_equal(found, 0);
    static const char *const none[] = {"ripple", "2", "-1", "1x", ""};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        assert_int_equal(leafcast_find_field(v, none[i], &found), LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), "waves, ripples"));
    }
    assert_int_equal(leafcast_select_set(v, FIELDS, 0), LEAFCAST_USAGE);
    assert_int_equal(leafcast_select_set(v, 0, STEPS), LEAFCAST_USAGE);
    leafcast_close(v);
    mesh_leaves_release(&s.all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refit),   cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_reading), cmocka_unit_test(test_alike),
        cmocka_unit_test(test_loader),  cmocka_unit_test(test_faults),
        cmocka_unit_test(test_damage),  cmocka_unit_test(test_names)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
