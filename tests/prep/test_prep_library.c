/* test_prep_library.c - leafcast_prep.h: arrays, slices, files and tets become the bytes that the
 * verb makes of the same; what fails or is stopped leaves nothing; arguments are looked at.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/sample.h"
#include "formats/mesh/mesh_stream.h"
#include "prep/leafcast_prep.h"
#include "render/leafcast.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { NX = 37, NY = 21, NZ = 19, SAMPLES = NX * NY * NZ };

static const leafcast_convert_options DEFAULTS = {.size = sizeof DEFAULTS};

/* ---- Comparing with the verb ---- */

/* Paths of the scratch folder, by name. */
static const char *at(const char *name) {
    return scratch_path(name);
}

static void run_verb(const char *options, const char *in, const char *out) {
    char command[4096];
    const char *front = getenv("LEAFCAST");
    snprintf(command, sizeof command, "%s convert %s -o %s -q --force %s",
             front ? front : "build/leafcast", in, out, options);
    if (system(command) != 0)
        fail_msg("%s", command);
}

static void check(leafcast_status st) {
    if (st != LEAFCAST_OK)
        fail_msg("status %d: %s", (int)st, leafcast_error_text());
}

/* ---- Grids ---- */

static double value_at(int i) {
    return floor(60 + 40 * sin(0.05 * i) + 20 * sin(0.9 * (i % NX)) + i % 3);
}

/* NX * NY * NZ samples, malloc'ed; whole numbers that every type can hold. */
static void *samples_of(sample_type type) {
    char *samples = malloc(SAMPLES * sample_size(type));
    assert_non_null(samples);
    for (int i = 0; i < SAMPLES; i++) {
        const double v = value_at(i);
        switch (type) {
        case SAMPLE_U8:
        case SAMPLE_I8: samples[i] = (char)v; break;
        case SAMPLE_U16:
        case SAMPLE_I16: ((uint16_t *)samples)[i] = (uint16_t)v; break;
        case SAMPLE_U32:
        case SAMPLE_I32: ((uint32_t *)samples)[i] = (uint32_t)v; break;
        case SAMPLE_F32: ((float *)samples)[i] = (float)v + 0.25f; break;
        case SAMPLE_F64: ((double *)samples)[i] = v + 0.1; break;
        default: break;
        }
    }
    return samples;
}

static leafcast_grid grid_of(sample_type type) {
    return (leafcast_grid){
        .size = sizeof(leafcast_grid), .dims = {NX, NY, NZ}, .type = (leafcast_sample_type)type};
}

/* The same samples as an NRRD file; where: the lines that place them. */
static const char *nrrd_of(sample_type type, const void *samples, const char *where) {
    static const char *const names[] = {"",      "uint8",  "int8",  "uint16", "int16",
                                        "float", "uint32", "int32", "double"};
    const size_t bytes = SAMPLES * sample_size(type);
    char *text = malloc(bytes + 1000);
    assert_non_null(text);
    const int length = snprintf(text, 1000,
                                "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\n"
                                "encoding: raw\nendian: little\n%s\n",
                                names[type], NX, NY, NZ, where);
    memcpy(text + length, samples, bytes);
    const char *path = scratch_write("in.nrrd", text, (size_t)length + bytes);
    free(text);
    return path;
}

static void test_array(void **state) {
    (void)state;
    skip_under_thread();
    for (sample_type type = SAMPLE_U8; type <= SAMPLE_F64; type++) {
        void *samples = samples_of(type);
        const leafcast_grid g = grid_of(type);
        run_verb("", nrrd_of(type, samples, ""), at("verb.leaf"));
        leafcast_convert_options o = DEFAULTS;
        o.replace = type > SAMPLE_U8;
        check(leafcast_convert_array(&g, samples, NULL, at("array.leaf"), &o));
        scratch_same(sample_name(type), at("array.leaf"), at("verb.leaf"));
        free(samples);
    }
    remove(at("array.leaf"));
}

/* One row of options: of the library, of the verb. */
static void check_options(const char *what, const leafcast_grid *g, leafcast_convert_options o,
                          const char *where, const char *options) {
    void *samples = samples_of((sample_type)g->type);
    run_verb(options, nrrd_of((sample_type)g->type, samples, where), at("verb.leaf"));
    check(leafcast_convert_array(g, samples, NULL, at("array.leaf"), &o));
    scratch_same(what, at("array.leaf"), at("verb.leaf"));
    remove(at("array.leaf"));
    free(samples);
}

static void test_options(void **state) {
    (void)state;
    skip_under_thread();
    leafcast_grid g = grid_of(SAMPLE_U8);
    leafcast_convert_options o = DEFAULTS;
    o.zstd_level = 4;
    check_options("zstd", &g, o, "", "--compress zstd:4");
    o = DEFAULTS;
    o.treelet_cells = 16;
    o.without_halo = true;
    o.threads = 1;
    check_options("treelets", &g, o, "", "--treelet 16 --halo 0");
    o.without_levels = true;
    check_options("levels", &g, o, "", "--treelet 16 --halo 0 --levels 1");
    o = DEFAULTS;
    o.name = "a\nname";
    check_options("name", &g, o, "", "--name 'a\nname'");
    o = DEFAULTS;
    o.has_missing = true;
    o.missing = 77;
    check_options("missing", &g, o, "", "--missing 77");
    o = DEFAULTS;
    o.exaggerate = 2.5;
    check_options("exaggerate", &g, o, "", "--exaggerate 2.5");
    o = DEFAULTS;
    o.memory = 3 << 20;
    o.threads = 2;
    check_options("memory", &g, o, "", "");
}

static void test_places(void **state) {
    (void)state;
    skip_under_thread();
    leafcast_grid g = grid_of(SAMPLE_U16);
    g.spacing[0] = 0.1;
    g.spacing[1] = -0.3;
    g.origin[0] = 1e3;
    g.origin[2] = -7;
    check_options("spacing", &g, DEFAULTS,
                  "space dimension: 3\nspace directions: (0.1,0,0) (0,-0.3,0) (0,0,1)\n"
                  "space origin: (1000,0,-7)\n",
                  "");
    static const double tilted[12] = {0.5, 0.1, 0, 4, -0.1, 0.5, 0.2, 5, 0, 0, 2, 6};
    g = grid_of(SAMPLE_I16);
    g.to_world = tilted;
    check_options("to_world", &g, DEFAULTS,
                  "space dimension: 3\nspace directions: (0.5,-0.1,0) (0.1,0.5,0) (0,0.2,2)\n"
                  "space origin: (4,5,6)\n",
                  "");
    char options[1000], text[1000] = "";
    double axis[NY];
    for (int i = 0; i < NY; i++) {
        axis[i] = -0.5 * i * i;
        snprintf(text + strlen(text), sizeof text - strlen(text), "%g\n", axis[i]);
    }
    snprintf(options, sizeof options, "--axis-y %s", scratch_text("y.txt", text));
    g = grid_of(SAMPLE_U8);
    g.axis[1] = axis;
    check_options("axis", &g, DEFAULTS, "", options);
}

/* The same samples, laid out z fastest, y backwards, with gaps. */
static void test_strides(void **state) {
    (void)state;
    skip_under_thread();
    enum { GAP = 3 };
    const uint16_t *samples = samples_of(SAMPLE_U16);
    uint16_t *other = calloc(SAMPLES * GAP, sizeof *other);
    const ptrdiff_t strides[3] = {2 * GAP * NZ, -2 * GAP * NZ * NX, 2 * GAP};
    const leafcast_grid g = grid_of(SAMPLE_U16);
    char *first = (char *)other - strides[1] * (NY - 1);
    for (int i = 0; i < SAMPLES; i++)
        memcpy(first + i % NX * strides[0] + i / NX % NY * strides[1] + i / NX / NY * strides[2],
               samples + i, 2);
    check(leafcast_convert_array(&g, samples, NULL, at("tight.leaf"), NULL));
    check(leafcast_convert_array(&g, first, strides, at("strides.leaf"), NULL));
    scratch_same("strides", at("tight.leaf"), at("strides.leaf"));
    remove(at("tight.leaf"));
    remove(at("strides.leaf"));
    free(other);
    free((void *)(uintptr_t)samples);
}

typedef struct deliverer {
    const char *samples;
    size_t bytes; /* of a slice */
    uint32_t next;
    uint32_t fail_at;
    leafcast_status with;
} deliverer;

static leafcast_status deliver(void *ctx, uint32_t z, void *to) {
    deliverer *d = ctx;
    if (z != d->next++)
        return LEAFCAST_CORRUPT;
    if (z == d->fail_at)
        return d->with;
    memcpy(to, d->samples + z * d->bytes, d->bytes);
    return LEAFCAST_OK;
}

static void test_slices(void **state) {
    (void)state;
    const leafcast_grid g = grid_of(SAMPLE_F64);
    void *samples = samples_of(SAMPLE_F64);
    deliverer d = {samples, NX * NY * sizeof(double), 0, NZ, LEAFCAST_OK};
    check(leafcast_convert_array(&g, samples, NULL, at("array.leaf"), NULL));
    check(leafcast_convert_slices(&g, deliver, &d, at("slices.leaf"), NULL));
    assert_int_equal(d.next, NZ);
    scratch_same("slices", at("array.leaf"), at("slices.leaf"));
    remove(at("array.leaf"));
    remove(at("slices.leaf"));
    free(samples);
}

static void test_slice_fails(void **state) {
    (void)state;
    static const struct {
        int with, expected;
    } cases[] = {{LEAFCAST_IO, LEAFCAST_IO},
                 {LEAFCAST_STOPPED, LEAFCAST_STOPPED},
                 {LEAFCAST_FAILED, LEAFCAST_FAILED},
                 {1, LEAFCAST_FAILED},
                 {77, LEAFCAST_FAILED},
                 {-1, LEAFCAST_FAILED}};
    const leafcast_grid g = grid_of(SAMPLE_U8);
    void *samples = samples_of(SAMPLE_U8);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint32_t z = 0; z < NZ; z += WATCHED_THREADS ? 18 : 6) {
            const size_t files = scratch_count();
            char expected[32];
            deliverer d = {samples, NX * NY, 0, z, (leafcast_status)cases[i].with};
            snprintf(expected, sizeof expected, "slice %u: ", z);
            assert_int_equal(leafcast_convert_slices(&g, deliver, &d, at("fails.leaf"), NULL),
                             cases[i].expected);
            assert_non_null(strstr(leafcast_error_text(), expected));
            assert_int_equal(d.next, z + 1);
            assert_int_equal(scratch_count(), files);
        }
    free(samples);
}

/* ---- Meshes ---- */

static leafcast_tets tets_of(const mesh_case *c) {
    return (leafcast_tets){.size = sizeof(leafcast_tets),
                           .vertex_count = c->point_count,
                           .tet_count = c->tet_count,
                           .vertices = (const float(*)[3])c->points,
                           .values = c->values,
                           .tets = (const uint32_t(*)[4])c->tets,
                           .field = "wavy"};
}

static const char *mesh_file(const mesh_case *c, const char *name) {
    mem m;
    mesh_stream_writer *w = NULL;
    mesh_stream_header h = {.field = "wavy", .points = c->point_count, .tets = c->tet_count};
    mem_init(&m, 0);
    if (mesh_stream_create(&m, at(name), true, &h, &w) != ST_OK ||
        mesh_stream_points(w, c->point_count, (const float(*)[3])c->points) != ST_OK ||
        mesh_stream_values(w, c->point_count, c->values) != ST_OK ||
        mesh_stream_tets(w, c->tet_count, (const uint32_t(*)[4])c->tets) != ST_OK ||
        mesh_stream_commit(w) != ST_OK)
        fail_msg("%s", status_text());
    return at(name);
}

static void check_tets(const char *what, const mesh_case *c, leafcast_convert_options o,
                       const char *options) {
    const leafcast_tets tets = tets_of(c);
    const char *in = mesh_file(c, "in.mesh");
    run_verb(options, in, at("verb.leaf"));
    check(leafcast_convert_tets(&tets, at("tets.leaf"), &o));
    scratch_same(what, at("tets.leaf"), at("verb.leaf"));
    o.replace = true;
    check(leafcast_convert_path(in, at("tets.leaf"), &o));
    scratch_same(what, at("tets.leaf"), at("verb.leaf"));
    remove(at("tets.leaf"));
}

static void test_tets(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case kuhn = mesh_cases_kuhn(17, 16, 15), soup = mesh_cases_soup(3000, 9000, 5);
    leafcast_convert_options o = DEFAULTS;
    check_tets("a lattice", &kuhn, o, "");
    soup.tets[5][2] = 3000; /* no vertex */
    soup.tets[7][1] = soup.tets[7][3];
    check_tets("a soup", &soup, o, "");
    o.gradients = true;
    o.zstd_level = 3;
    o.treelet_tets = 700;
    o.leaf_tets = 7;
    o.name = "lattice";
    check_tets("options", &kuhn, o,
               "--gradients --compress zstd:3 --treelet-tets 700 --leaf-tets 7 --name lattice");
    o = DEFAULTS;
    o.coarse = true;
    o.coarse_dims = 12;
    o.memory = 40 << 20;
    check_tets("a coarse grid", &kuhn, o, "--coarse=12");
    o = DEFAULTS;
    o.fields = (const char *const[]){"wavy"};
    o.field_count = 1;
    check_tets("a field by name", &kuhn, o, "--field wavy");
    o.fields = (const char *const[]){"other"};
    assert_int_equal(leafcast_convert_path(at("in.mesh"), at("other.leaf"), &o), LEAFCAST_USAGE);
    mesh_cases_free(&kuhn);
    mesh_cases_free(&soup);
}

static void test_steps(void **state) {
    (void)state;
    skip_under_thread();
    static const double times[2] = {0.5, 3};
    char both[2000];
    mesh_case c = mesh_cases_kuhn(9, 8, 7);
    const char *in[2] = {mesh_file(&c, "a.mesh"), NULL};
    for (size_t i = 0; i < c.point_count; i++)
        c.points[i][0] *= 1.5f;
    in[1] = mesh_file(&c, "b.mesh");
    snprintf(both, sizeof both, "%s %s", in[0], in[1]);
    run_verb("--times 0.5,3", both, at("verb.leaf"));
    check(leafcast_convert_steps(in, 2, times, at("steps.leaf"), NULL));
    scratch_same("steps", at("steps.leaf"), at("verb.leaf"));
    remove(at("steps.leaf"));
    const size_t files = scratch_count();
    const double back[2] = {3, 0.5};
    assert_int_equal(leafcast_convert_steps(in, 2, back, at("no.leaf"), NULL), LEAFCAST_USAGE);
    assert_int_equal(leafcast_convert_steps(in, 0, NULL, at("no.leaf"), NULL), LEAFCAST_USAGE);
    void *samples = samples_of(SAMPLE_U8);
    in[0] = nrrd_of(SAMPLE_U8, samples, "");
    free(samples);
    assert_int_equal(leafcast_convert_steps(in, 2, NULL, at("no.leaf"), NULL), LEAFCAST_USAGE);
    assert_int_equal(scratch_count(), files + 0);
    mesh_cases_free(&c);
}

/* ---- Files ---- */

static void test_path(void **state) {
    (void)state;
    skip_under_thread();
    void *samples = samples_of(SAMPLE_I16);
    const char *in = nrrd_of(SAMPLE_I16, samples, "spacings: 1 2 3\n");
    run_verb("", in, at("verb.leaf"));
    check(leafcast_convert_path(in, at("path.leaf"), NULL));
    scratch_same("a path", at("path.leaf"), at("verb.leaf"));
    remove(at("path.leaf"));
    free(samples);
    const size_t files = scratch_count();
    assert_int_equal(leafcast_convert_path(at("absent"), at("no.leaf"), NULL), LEAFCAST_IO);
    assert_int_equal(leafcast_convert_path("-", at("no.leaf"), NULL), LEAFCAST_USAGE);
    assert_int_equal(leafcast_convert_path(in, "-", NULL), LEAFCAST_USAGE);
    assert_int_equal(leafcast_convert_path(in, at("no folder/no.leaf"), NULL), LEAFCAST_IO);
    assert_int_equal(scratch_count(), files);
    in = scratch_text("short.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 9 9 9\n"
                                    "encoding: raw\n\nabc");
    assert_int_equal(leafcast_convert_path(in, at("no.leaf"), NULL), LEAFCAST_CORRUPT);
    assert_non_null(strstr(leafcast_error_text(), "short.nrrd"));
    assert_int_equal(scratch_count(), files + 1);
}

/* What may give way, and what may not. */
static void test_replaced(void **state) {
    (void)state;
    skip_under_thread();
    void *samples = samples_of(SAMPLE_U8);
    const leafcast_grid g = grid_of(SAMPLE_U8);
    const char *in = nrrd_of(SAMPLE_U8, samples, "");
    leafcast_convert_options o = DEFAULTS;
    size_t size;
    char *before = scratch_read(in, &size);
    for (int replace = 0; replace < 2; replace++) {
        o.replace = replace;
        assert_int_equal(leafcast_convert_path(in, in, &o), LEAFCAST_USAGE);
        assert_int_equal(leafcast_convert_array(&g, samples, NULL, in, &o), LEAFCAST_EXISTS);
        assert_int_equal(leafcast_convert_array(&g, samples, NULL, "/dev/null", &o),
                         LEAFCAST_EXISTS);
    }
    char *after = scratch_read(in, NULL);
    assert_memory_equal(before, after, size);
    free(before);
    free(after);
    check(leafcast_convert_path(in, at("r.leaf"), NULL));
    assert_int_equal(leafcast_convert_path(in, at("r.leaf"), NULL), LEAFCAST_EXISTS);
    check(leafcast_convert_path(in, at("r.leaf"), &o));
    (void)scratch_text("r.leaf", "");
    check(leafcast_convert_path(in, at("r.leaf"), &o));
    (void)scratch_text("r.leaf", "short");
    assert_int_equal(leafcast_convert_path(in, at("r.leaf"), &o), LEAFCAST_EXISTS);
    remove(at("r.leaf"));
    free(samples);
}

/* ---- Stopping ---- */

typedef struct watcher {
    long calls, stop_at; /* 0: never */
    double done;
    bool backwards;
    char phases[200];
} watcher;

static bool watch(void *ctx, const char *phase, double done) {
    watcher *w = ctx;
    w->backwards |= !(done >= w->done && done <= 1);
    w->done = done;
    if (!strstr(w->phases, phase))
        snprintf(w->phases + strlen(w->phases), sizeof w->phases - strlen(w->phases), "%s ", phase);
    return ++w->calls != w->stop_at;
}

typedef leafcast_status (*conversion)(const leafcast_convert_options *o);

static leafcast_status convert_a_grid(const leafcast_convert_options *o) {
    leafcast_grid g = grid_of(SAMPLE_F32);
    void *samples = samples_of(SAMPLE_F32);
    const leafcast_status st = leafcast_convert_array(&g, samples, NULL, at("stop.leaf"), o);
    free(samples);
    return st;
}

static leafcast_status convert_a_mesh(const leafcast_convert_options *o) {
    mesh_case c = mesh_cases_kuhn(9, 8, 7);
    const leafcast_tets tets = tets_of(&c);
    const leafcast_status st = leafcast_convert_tets(&tets, at("stop.leaf"), o);
    mesh_cases_free(&c);
    return st;
}

static leafcast_status convert_a_path(const leafcast_convert_options *o) {
    return leafcast_convert_path(at("in.nrrd"), at("stop.leaf"), o);
}

/* Stopped at every call of watch() in turn: nothing is left. Returns how many there are. */
static long check_stops(conversion convert, leafcast_convert_options o, const char *phases) {
    watcher all = {0};
    o.watch = watch;
    o.watch_ctx = &all;
    check(convert(&o));
    remove(at("stop.leaf"));
    assert_string_equal(all.phases, phases);
    assert_false(all.backwards);
    assert_true(all.done > 0.5);
    const size_t files = scratch_count();
    const long step = all.calls / (WATCHED_THREADS ? 8 : 40) + 1;
    for (long k = 1; k <= all.calls; k += step) {
        watcher w = {.stop_at = k};
        o.watch_ctx = &w;
        assert_int_equal(convert(&o), LEAFCAST_STOPPED);
        assert_int_equal(w.calls, k);
        assert_true(*leafcast_error_text());
        assert_int_equal(scratch_count(), files);
    }
    return all.calls;
}

static void test_stop(void **state) {
    (void)state;
    leafcast_convert_options o = DEFAULTS;
    o.threads = 2;
    o.treelet_cells = 16;
    (void)check_stops(convert_a_grid, o, "convert ");
    o.gradients = true;
    o.treelet_tets = 100;
    const long plain = check_stops(convert_a_mesh, o, "read sort gradients build ");
    o.coarse = true;
    assert_true(check_stops(convert_a_mesh, o, "read sort gradients build resample convert ") >
                plain + 1);
}

/* Each allocation, read, write and thread fails in turn: nothing is left, in the folder or in
 * memory (sanitizers look). */
static void check_faults(conversion convert, fault_kind kind, leafcast_status expected) {
    leafcast_convert_options o = DEFAULTS;
    const size_t files = scratch_count();
    leafcast_status st = expected;
    long k = 1;
    o.threads = 2;
    o.treelet_cells = 16;
    for (; st != LEAFCAST_OK; k += 1 + k / (WATCHED_THREADS ? 1 : WATCHED ? 4 : 40)) {
        fault_arm(kind, k);
        st = convert(&o);
        fault_arm(kind, 0);
        if (st != LEAFCAST_OK && (st != expected || !*leafcast_error_text()))
            fail_msg("kind %d, %ld: status %d: %s", kind, k, (int)st, leafcast_error_text());
        if (st != LEAFCAST_OK)
            assert_int_equal(scratch_count(), files);
    }
    remove(at("stop.leaf"));
    assert_true(k > 2);
}

static void test_faults(void **state) {
    (void)state;
    static const conversion all[] = {convert_a_grid, convert_a_mesh, convert_a_path};
    void *samples = samples_of(SAMPLE_F32);
    (void)nrrd_of(SAMPLE_F32, samples, "");
    for (int i = 0; i < 3; i++) {
        check_faults(all[i], FAULT_ALLOC, LEAFCAST_NOMEM);
        check_faults(all[i], FAULT_WRITE, LEAFCAST_NOSPACE);
        check_faults(all[i], FAULT_THREAD, LEAFCAST_NOMEM);
    }
    check_faults(convert_a_path, FAULT_READ, LEAFCAST_IO);
    free(samples);
}

/* ---- Arguments ---- */

static void refuse_grid(leafcast_grid g, const leafcast_convert_options *o) {
    static const char samples[8];
    const size_t files = scratch_count();
    if (leafcast_convert_array(&g, samples, NULL, at("no.leaf"), o) != LEAFCAST_USAGE)
        fail_msg("%s", leafcast_error_text());
    assert_true(*leafcast_error_text());
    assert_int_equal(scratch_count(), files);
}

static void test_grid_arguments(void **state) {
    (void)state;
    static const double flat[12] = {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}, turning[] = {0, 2, 1};
    const leafcast_grid sound = {sizeof sound, {2, 2, 2}, LEAFCAST_U8, {0}, {0}, NULL, {NULL}};
    leafcast_grid g = sound;
    g.size = 8;
    refuse_grid(g, NULL);
    for (int a = 0; a < 3; a++) {
        g = sound;
        g.dims[a] = 1;
        refuse_grid(g, NULL);
        g.dims[a] = UINT32_MAX;
        refuse_grid(g, NULL);
        g = sound;
        g.spacing[a] = NAN;
        refuse_grid(g, NULL);
        g = sound;
        g.origin[a] = INFINITY;
        refuse_grid(g, NULL);
        g = sound;
        g.dims[a] = 3;
        g.axis[a] = turning;
        refuse_grid(g, NULL);
    }
    g = sound;
    g.to_world = flat;
    refuse_grid(g, NULL);
    for (int type = -1; type < 10; type += 10) {
        g = sound;
        g.type = (leafcast_sample_type)type;
        refuse_grid(g, NULL);
    }
}

static void test_option_arguments(void **state) {
    (void)state;
    const leafcast_grid g = {sizeof g, {2, 2, 2}, LEAFCAST_U8, {0}, {0}, NULL, {NULL}};
    leafcast_convert_options o = DEFAULTS;
    o.size--;
    refuse_grid(g, &o);
#define REFUSE(member, value) \
    o = DEFAULTS;             \
    o.member = value;         \
    refuse_grid(g, &o)
    REFUSE(threads, -1);
    REFUSE(zstd_level, 23);
    REFUSE(zstd_level, -1);
    REFUSE(treelet_cells, 8);
    REFUSE(treelet_cells, 48);
    REFUSE(treelet_cells, 128);
    REFUSE(coarse_dims, 1);
    REFUSE(treelet_tets, 1 << 20);
    REFUSE(leaf_tets, 1000);
    REFUSE(field_count, 1 << 20);
    REFUSE(component, -1);
    o = DEFAULTS;
    o.has_missing = true;
    o.missing = 0.5; /* no u8 is that */
    refuse_grid(g, &o);
    o = DEFAULTS;
    o.memory = 1000;
    assert_int_equal(convert_a_grid(&o), LEAFCAST_NOMEM);
    assert_int_equal(convert_a_mesh(&o), LEAFCAST_NOMEM);
}

static void test_tet_arguments(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(1, 1, 1);
    leafcast_tets tets = tets_of(&c);
    const size_t files = scratch_count();
    tets.size = 1;
    assert_int_equal(leafcast_convert_tets(&tets, at("no.leaf"), NULL), LEAFCAST_USAGE);
    tets = tets_of(&c);
    tets.values = NULL;
    assert_int_equal(leafcast_convert_tets(&tets, at("no.leaf"), NULL), LEAFCAST_USAGE);
    tets = tets_of(&c);
    tets.vertex_count = UINT32_MAX;
    assert_int_equal(leafcast_convert_tets(&tets, at("no.leaf"), NULL), LEAFCAST_USAGE);
    tets = tets_of(&c);
    tets.tet_count = 0;
    assert_int_equal(leafcast_convert_tets(&tets, at("no.leaf"), NULL), LEAFCAST_UNSUPPORTED);
    c.points[3][1] = NAN;
    tets = tets_of(&c);
    assert_int_equal(leafcast_convert_tets(&tets, at("no.leaf"), NULL), LEAFCAST_CORRUPT);
    assert_int_equal(scratch_count(), files);
    mesh_cases_free(&c);
}

/* Nothing finite is nothing to draw. */
static void test_empty(void **state) {
    (void)state;
    skip_under_thread();
    const leafcast_grid g = {sizeof g, {2, 2, 2}, LEAFCAST_F32, {0}, {0}, NULL, {NULL}};
    leafcast_convert_options o = DEFAULTS;
    float samples[8];
    for (int i = 0; i < 8; i++)
        samples[i] = NAN;
    assert_int_equal(leafcast_convert_array(&g, samples, NULL, at("nan.leaf"), &o),
                     LEAFCAST_UNSUPPORTED);
    o.allow_empty = true;
    check(leafcast_convert_array(&g, samples, NULL, at("nan.leaf"), &o));
    remove(at("nan.leaf"));
}

/* ---- Together ---- */

static void *convert_own(void *name) {
    const leafcast_grid g = grid_of(SAMPLE_U8);
    void *samples = samples_of(SAMPLE_U8);
    leafcast *volume = NULL;
    leafcast_status st = leafcast_convert_array(&g, samples, NULL, name, NULL);
    free(samples);
    if (st == LEAFCAST_OK)
        st = leafcast_open(name, NULL, &volume);
    leafcast_close(volume);
    return st == LEAFCAST_OK ? name : NULL;
}

/* Several at once. */
static void test_threads(void **state) {
    (void)state;
    enum { THREADS = 4 };
    pthread_t threads[THREADS];
    char names[THREADS][600];
    for (int i = 0; i < THREADS; i++) {
        char name[32];
        snprintf(name, sizeof name, "own-%d.leaf", i);
        snprintf(names[i], sizeof names[i], "%s", at(name));
        assert_int_equal(pthread_create(&threads[i], NULL, convert_own, names[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        void *result = NULL;
        assert_int_equal(pthread_join(threads[i], &result), 0);
        assert_ptr_equal(result, names[i]);
        if (i > 0)
            scratch_same("threads", names[0], names[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_array),          cmocka_unit_test(test_options),
        cmocka_unit_test(test_places),         cmocka_unit_test(test_strides),
        cmocka_unit_test(test_slices),         cmocka_unit_test(test_slice_fails),
        cmocka_unit_test(test_tets),           cmocka_unit_test(test_steps),
        cmocka_unit_test(test_path),           cmocka_unit_test(test_replaced),
        cmocka_unit_test(test_stop),           cmocka_unit_test(test_faults),
        cmocka_unit_test(test_grid_arguments), cmocka_unit_test(test_option_arguments),
        cmocka_unit_test(test_tet_arguments),  cmocka_unit_test(test_empty),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
