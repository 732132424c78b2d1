/* test_tet_generate.c - generated meshes: they fill their box, fit together and stay sound however
 * deformed; the same for any threads and memory; files and time series.
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
#include "formats/base/hash.h"
#include "prep/generate/tet_generate.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* ---- a mesh in memory ---- */

typedef struct kept {
    uint64_t points, values, tets; /* so far */
    uint64_t room_points, room_tets;
    bool ordered; /* points, then values, then tets, and as many as there is room for */
    float (*xyz)[3];
    float *value;
    uint32_t (*ids)[4];
    int calls;
} kept;

static status keep_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    kept *k = ctx;
    assert_int_equal(first, k->points);
    assert_true(count > 0 && first + count <= k->room_points);
    memcpy(k->xyz + first, xyz, count * sizeof *xyz);
    k->points += count;
    k->calls++;
    return ST_OK;
}

static status keep_values(void *ctx, uint64_t first, size_t count, const float *values) {
    kept *k = ctx;
    assert_int_equal(first, k->values);
    assert_true(!k->ordered || k->points == k->room_points);
    assert_true(count > 0 && first + count <= k->room_points);
    memcpy(k->value + first, values, count * sizeof *values);
    k->values += count;
    k->calls++;
    return ST_OK;
}

static status keep_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    kept *k = ctx;
    assert_true(!k->ordered || k->values == k->room_points);
    assert_true(count > 0 && k->tets + count <= k->room_tets);
    memcpy(k->ids + k->tets, ids, count * sizeof *ids);
    k->tets += count;
    k->calls++;
    return ST_OK;
}

static void release(kept *k) {
    free(k->xyz);
    free(k->value);
    free(k->ids);
}

static tet_generate_options make_options(const char *name, uint32_t nx, uint32_t ny, uint32_t nz) {
    return (tet_generate_options){
        .info = field_find(name),
        .seed = 1,
        .shape = {.dims = {nx, ny, nz}, .copies = {1, 1, 1}, .spacing = {1, 1, 1}},
        .threads = 2};
}

static uint32_t copies_of(const tet_lattice_shape *s) {
    return s->copies[0] * s->copies[1] * s->copies[2];
}

static kept make_room(uint64_t points, uint64_t tets, bool ordered) {
    return (kept){.room_points = points,
                  .room_tets = tets,
                  .ordered = ordered,
                  .xyz = malloc(points * sizeof(float[3])),
                  .value = malloc(points * sizeof(float)),
                  .ids = malloc(tets * sizeof(uint32_t[4]))};
}

static kept keep(const tet_generate_options *o, size_t limit) {
    const uint32_t *d = o->shape.dims;
    uint64_t copies = copies_of(&o->shape);
    kept k = make_room(copies * d[0] * d[1] * d[2],
                       copies * 6 * (d[0] - 1) * (d[1] - 1) * (d[2] - 1), true);
    const mesh_sink sink = {&k, keep_points, keep_values, keep_tets, NULL, NULL, NULL, false};
    mem m;
    mem_init(&m, limit);
    status st = tet_generate(&m, o, &sink, NULL);
    if (st != ST_OK)
        fail_msg("status %d: %s", st, status_text());
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(k.points, k.room_points);
    assert_int_equal(k.values, k.room_points);
    assert_int_equal(k.tets, k.room_tets);
    return k;
}

/* ---- what a mesh must be ---- */

/* Six times the signed volume. */
static double volume_of(const kept *k, const uint32_t ids[4]) {
    double e[3][3];
    for (int n = 0; n < 3; n++)
        for (int c = 0; c < 3; c++)
            e[n][c] = (double)k->xyz[ids[n + 1]][c] - k->xyz[ids[0]][c];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
           e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* All tets positive, and together as large as the box. */
static void check_volumes(const kept *k, const tet_lattice_shape *s) {
    double sum = 0, box = 6;
    for (uint64_t t = 0; t < k->tets; t++) {
        double v = volume_of(k, k->ids[t]);
        if (!(v > 0))
            fail_msg("tet %llu has the volume %g", (unsigned long long)t, v / 6);
        sum += v;
    }
    for (int a = 0; a < 3; a++)
        box *= fabs(s->spacing[a]) * (s->dims[a] - 1) * s->copies[a];
    if (!(fabs(sum - box) <= 1e-6 * box))
        fail_msg("the tets' volume is %.9g, the box's %.9g", sum / 6, box / 6);
}

/* A face: its vertices ascending, and whether it looks out of its tet in that order. */
typedef struct face {
    uint32_t v[3];
    bool even;
} face;

static void swap(face *f, int a, int b) {
    if (f->v[a] <= f->v[b])
        return;
    uint32_t v = f->v[a];
    f->v[a] = f->v[b];
    f->v[b] = v;
    f->even = !f->even;
}

static face face_of(const uint32_t ids[4], int without) {
    static const int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const int *c = corners[without];
    face f = {{ids[c[0]], ids[c[1]], ids[c[2]]}, true};
    swap(&f, 0, 1);
    swap(&f, 1, 2);
    swap(&f, 0, 1);
    return f;
}

static int compare_faces(const void *a, const void *b) {
    const face *x = a, *y = b;
    for (int n = 0; n < 3; n++)
        if (x->v[n] != y->v[n])
            return x->v[n] < y->v[n] ? -1 : 1;
    return 0;
}

/* On a side of its copy: a node's number alone says so. */
static bool on_side(const face *f, const uint32_t dims[3]) {
    uint32_t step = 1;
    for (int a = 0; a < 3; step *= dims[a++])
        for (uint32_t end = 0; end < dims[a]; end += dims[a] - 1) {
            bool all = true;
            for (int n = 0; n < 3; n++)
                all = all && f->v[n] / step % dims[a] == end;
            if (all)
                return true;
        }
    return false;
}

/* Every inner face has a tet on each of its two sides; one on a side of a copy has one. */
static void check_faces(const kept *k, const tet_lattice_shape *s) {
    const uint32_t *d = s->dims;
    const uint32_t each = d[0] * d[1] * d[2];
    size_t count = 4 * k->tets, outer = 0;
    face *faces = malloc(count * sizeof *faces);
    for (size_t n = 0; n < count; n++) {
        faces[n] = face_of(k->ids[n / 4], (int)(n % 4));
        assert_true(faces[n].v[2] < k->points);
        assert_int_equal(faces[n].v[0] / each, faces[n].v[2] / each);
    }
    qsort(faces, count, sizeof *faces, compare_faces);
    for (size_t n = 0; n < count;) {
        size_t same = 1;
        while (n + same < count && compare_faces(&faces[n], &faces[n + same]) == 0)
            same++;
        if (on_side(&faces[n], d)) {
            assert_int_equal(same, 1);
            outer++;
        } else {
            assert_int_equal(same, 2);
            assert_int_not_equal(faces[n].even, faces[n + 1].even);
        }
        n += same;
    }
    size_t sides = 0;
    for (int a = 0; a < 3; a++)
        sides += 4 * (size_t)(d[a] - 1) * (d[(a + 1) % 3] - 1);
    assert_int_equal(outer, sides * copies_of(s));
    free(faces);
}

static const tet_lattice_shape shapes[] = {
    {{2, 2, 2}, {1, 1, 1}, {1, 1, 1}, 0},
    {{5, 4, 7}, {1, 1, 1}, {1, -2, 0.1}, 0},
    {{2, 3, 9}, {3, 1, 2}, {-1, -1, 3}, 0.5},
    {{8, 8, 8}, {2, 2, 2}, {1e-3, 1e-3, 1e-3}, TET_LATTICE_DEFORM_MAX},
    {{9, 6, 7}, {1, 2, 3}, {-1, -1, -1}, -TET_LATTICE_DEFORM_MAX},
    {{17, 17, 3}, {1, 1, 5}, {1e-30, 1e15, 1e15}, 0.3},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void test_sound(void **state) {
    (void)state;
    skip_under_thread();
    for (int n = 0; n < SHAPES; n++) {
        tet_generate_options o = make_options("sphere", 2, 2, 2);
        o.shape = shapes[n];
        kept k = keep(&o, 0);
        check_volumes(&k, &o.shape);
        check_faces(&k, &o.shape);
        release(&k);
    }
}

/* W07's bucky ball. */
static void test_buckyball(void **state) {
    (void)state;
    skip_under_thread();
    tet_generate_options o = make_options("buckyball", 32, 32, 32);
    o.shape.deform = TET_LATTICE_DEFORM_MAX;
    kept k = keep(&o, 0);
    assert_int_equal(k.points, 32768);
    assert_int_equal(k.tets, 178746);
    check_volumes(&k, &o.shape);
    check_faces(&k, &o.shape);
    release(&k);
}

/* The most cells along an axis, where floats are coarsest, as deformed as can be. */
static void test_longest(void **state) {
    (void)state;
    skip_under_thread();
    for (int a = 0; a < 3; a++) {
        tet_generate_options o = make_options("sphere", 5, 5, 5);
        o.shape.deform = TET_LATTICE_DEFORM_MAX;
        o.shape.copies[a] = TET_LATTICE_CELLS_MAX / 4 / 16;
        o.shape.copies[(a + 1) % 3] = 2;
        o.shape.spacing[0] = 1.0000001;
        kept k = keep(&o, 0);
        check_volumes(&k, &o.shape);
        release(&k);
    }
    tet_generate_options o = make_options("sphere", 3, TET_LATTICE_CELLS_MAX + 1, 3);
    o.shape.deform = TET_LATTICE_DEFORM_MAX;
    o.shape.spacing[1] = 1.0000001;
    kept k = keep(&o, 0);
    check_volumes(&k, &o.shape);
    release(&k);
}

/* ---- positions and values ---- */

/* How far a node of the first copy has moved along c, in cells. */
static double moved(const kept *k, uint64_t node, uint64_t number, int c) {
    return k->xyz[node][c] - (double)number;
}

/* The sides stay, inner nodes move, and no edge changes by more than was asked for. */
static void test_deformation(void **state) {
    (void)state;
    skip_under_thread();
    tet_generate_options o = make_options("sphere", 33, 33, 33);
    o.shape.deform = 0.6;
    kept k = keep(&o, 0);
    double most = 0, furthest = 0;
    for (uint32_t n = 0; n < 33 * 33 * 33; n++) {
        const uint32_t at[3] = {n % 33, n / 33 % 33, n / 33 / 33}, step[3] = {1, 33, 33 * 33};
        for (int c = 0; c < 3; c++) {
            double by = moved(&k, n, at[c], c);
            furthest = fabs(by) > furthest ? fabs(by) : furthest;
            for (int a = 0; a < 3; a++)
                if (at[a] == 0 || at[a] == 32)
                    assert_true(by == 0);
        }
        for (int a = 0; a < 3; a++) {
            double change = 0;
            for (int c = 0; c < 3 && at[a] < 32; c++)
                change +=
                    fabs(moved(&k, n + step[a], at[c] + (c == a), c) - moved(&k, n, at[c], c));
            most = change > most ? change : most;
        }
    }
    assert_true(most <= 0.6 + 1e-5);
    assert_true(most > 0.4);
    assert_true(furthest > 1.4 && furthest < 1.6);
    release(&k);
}

/* Each copy is the first one, shifted; neighbours have the same positions where they touch. */
static void test_copies(void **state) {
    (void)state;
    skip_under_thread();
    tet_generate_options o = make_options("noise", 6, 5, 4);
    o.shape.deform = 0.25;
    kept one = keep(&o, 0);
    memcpy(o.shape.copies, (uint32_t[]){3, 2, 2}, sizeof o.shape.copies);
    kept all = keep(&o, 0);
    for (uint64_t n = 0; n < all.points; n++) {
        const uint64_t copy = n / one.points, node = n % one.points;
        const uint64_t shift[3] = {5 * (copy % 3), 4 * (copy / 3 % 2), 3 * (copy / 6)};
        assert_true(all.value[n] == one.value[node]);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(all.xyz[n][c] - (double)shift[c] - one.xyz[node][c]) < 2e-6);
    }
    for (uint64_t t = 0; t < all.tets; t++)
        for (int c = 0; c < 4; c++)
            assert_int_equal(all.ids[t][c], one.ids[t % one.tets][c] + t / one.tets * one.points);
    for (uint64_t n = 0; n < one.points; n += 6)
        assert_memory_equal(all.xyz[n + 5], all.xyz[one.points + n], sizeof *all.xyz);
    release(&one);
    release(&all);
}

/* The samples of the grid, as generate without --tets gives them. */
static void test_values(void **state) {
    (void)state;
    skip_under_thread();
    const field_info *info;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++) {
        tet_generate_options o = make_options(info->name, 20, 9, 11);
        o.shape.deform = 0.7;
        o.seed = 3;
        kept k = keep(&o, 0);
        mem m;
        mem_init(&m, 0);
        pool *p;
        field *f;
        float *want = malloc(k.points * sizeof *want);
        const field_block all = {.slices = 11, .rows = 9};
        assert_int_equal(pool_create(&m, 1, &p), ST_OK);
        const field_choice which = {info, 3, 0};
        assert_int_equal(field_create(&m, &which, o.shape.dims, k.points, &f), ST_OK);
        assert_int_equal(field_fill(f, p, &all, SAMPLE_F32, want), ST_OK);
        assert_memory_equal(k.value, want, k.points * sizeof *want);
        field_destroy(f);
        pool_destroy(p);
        free(want);
        release(&k);
    }
}

/* ---- the same bytes ---- */

static uint64_t hash_of(const kept *k) {
    const uint64_t parts[3] = {hash_bytes(k->xyz, k->points * sizeof *k->xyz),
                               hash_bytes(k->value, k->points * sizeof *k->value),
                               hash_bytes(k->ids, k->tets * sizeof *k->ids)};
    return hash_bytes(parts, sizeof parts);
}

/* Blocks of many rows, and of one; a copy's values at once, and row by row. */
static void test_any_threads(void **state) {
    (void)state;
    static const char *const names[] = {"marschner-lobb", "attractor"};
    for (int n = 0; n < 2; n++) {
        tet_generate_options o = make_options(names[n], 40, 30, 20);
        o.shape.deform = 0.8;
        o.shape.copies[1] = 3;
        o.threads = 1;
        kept want = keep(&o, 0);
        for (o.threads = 1; o.threads <= 5; o.threads += WATCHED_THREADS ? 2 : 1) {
            kept got = keep(&o, n ? 400000 : 30000 + 10000 * (size_t)o.threads);
            assert_int_equal(hash_of(&got), hash_of(&want));
            assert_true(got.calls > want.calls);
            release(&got);
        }
        release(&want);
    }
}

static void test_pinned(void **state) {
    (void)state;
    skip_under_thread();
    tet_generate_options o = make_options("buckyball", 32, 32, 32);
    o.shape.deform = 0.5;
    o.shape.copies[2] = 2;
    kept k = keep(&o, 0);
    assert_int_equal(hash_of(&k), 0x67e939a2b32b9e33);
    release(&k);
}

/* ---- memory, trouble ---- */

typedef struct counted {
    uint64_t points, values, tets;
    uint64_t stop_at; /* tets after which the sink fails; 0: never */
} counted;

static status count_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)first, (void)xyz;
    ((counted *)ctx)->points += count;
    return ST_OK;
}

static status count_values(void *ctx, uint64_t first, size_t count, const float *values) {
    (void)first, (void)values;
    ((counted *)ctx)->values += count;
    return ST_OK;
}

static status count_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ids;
    counted *c = ctx;
    c->tets += count;
    return c->stop_at && c->tets >= c->stop_at ? status_describe(ST_IO, "no more") : ST_OK;
}

static status count(mem *m, const tet_generate_options *o, counted *c, const progress *p) {
    const mesh_sink sink = {c, count_points, count_values, count_tets, NULL, NULL, NULL, false};
    return tet_generate(m, o, &sink, p);
}

/* 64 copies, 217 MB of mesh, in half a megabyte. */
static void test_memory(void **state) {
    (void)state;
    skip_under_thread();
    tet_generate_options o = make_options("sphere", 32, 32, 32);
    memcpy(o.shape.copies, (uint32_t[]){4, 4, 4}, sizeof o.shape.copies);
    mem m;
    mem_init(&m, 1 << 19);
    counted c = {0};
    assert_int_equal(count(&m, &o, &c, NULL), ST_OK);
    assert_int_equal(c.points, 64 * 32768);
    assert_int_equal(c.values, 64 * 32768);
    assert_int_equal(c.tets, 64 * 178746);
    assert_int_equal(mem_used(&m), 0);
    mem_init(&m, 0);
    o.shape.copies[2] = 1;
    assert_int_equal(count(&m, &o, &c, NULL), ST_OK);
    assert_true(mem_peak(&m) < 5 << 20);
}

static void refuse(const tet_generate_options *o, const char *says) {
    mem m;
    mem_init(&m, 0);
    counted c = {0};
    assert_int_equal(count(&m, o, &c, NULL), ST_USAGE);
    if (!strstr(status_text(), says))
        fail_msg("\"%s\" does not say \"%s\"", status_text(), says);
    assert_int_equal(c.points, 0);
    assert_int_equal(mem_peak(&m), 0);
}

static void test_refused(void **state) {
    (void)state;
    tet_generate_options o = make_options("sphere", 3, 4, 5);
    o.shape.copies[1] = TET_LATTICE_CELLS_MAX / 3 + 1;
    refuse(&o, "262146 cells along y");
    o = make_options("sphere", 2, 2, 2);
    for (int a = 0; a < 3; a++)
        o.shape.copies[a] = 1 << 10;
    refuse(&o, "8589934592 points");
    o = make_options("sphere", 1 << 16, 1 << 16, 2);
    refuse(&o, "8589934592 points");
    for (int n = 0; n < 4; n++) {
        o = make_options("sphere", 3, 4, 5);
        o.shape.spacing[2] = (double[]){0, 1e31, -1e-31, NAN}[n];
        refuse(&o, "along z is not within");
        o = make_options("sphere", 3, 4, 5);
        o.shape.deform = (double[]){0.91, -0.91, INFINITY, NAN}[n];
        refuse(&o, "a deformation of");
    }
}

static bool stop_late(void *ctx) {
    return ++*(int *)ctx > 5;
}

static void test_stopped(void **state) {
    (void)state;
    tet_generate_options o = make_options("gyroid", 40, 40, 40);
    mem m;
    mem_init(&m, 1 << 18);
    int asked = 0;
    counted c = {0};
    const progress p = {.stop = stop_late, .ctx = &asked};
    assert_int_equal(count(&m, &o, &c, &p), ST_STOPPED);
    assert_int_equal(mem_used(&m), 0);
    c = (counted){.stop_at = 1};
    assert_int_equal(count(&m, &o, &c, NULL), ST_IO);
    assert_string_equal(status_text(), "no more");
    assert_int_equal(mem_used(&m), 0);
}

/* ---- files ---- */

static status write_files(const tet_generate_options *o, const char *name, bool force) {
    mem m;
    mem_init(&m, 0);
    status st = tet_generate_files(&m, o, scratch_path(name), force, NULL);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

/* The file of a mesh holds a header and the three arrays. */
static void check_file(const char *name, const kept *want) {
    char header[200];
    size_t size, length = (size_t)snprintf(
                     header, sizeof header,
                     "LEAFCAST MESH 1\nname: noise\nfield: noise\npoints: %llu\ntets: %llu\n\n",
                     (unsigned long long)want->points, (unsigned long long)want->tets);
    char *got = scratch_read(scratch_path(name), &size), *at = got + length;
    assert_int_equal(size, length + 16 * want->points + 16 * want->tets);
    assert_memory_equal(got, header, length);
    assert_memory_equal(at, want->xyz, 12 * want->points);
    assert_memory_equal(at + 12 * want->points, want->value, 4 * want->points);
    assert_memory_equal(at + 16 * want->points, want->ids, 16 * want->tets);
    free(got);
}

static kept read_back(const char *name) {
    kept k = make_room(1 << 16, 1 << 18, false);
    const mesh_sink sink = {&k, keep_points, keep_values, keep_tets, NULL, NULL, NULL, false};
    mem m;
    mem_init(&m, 0);
    mesh_input *x;
    mesh_report report;
    assert_int_equal(mesh_input_open(&m, scratch_path(name), NULL, &x), ST_OK);
    assert_string_equal(mesh_input_name(x), "noise");
    assert_int_equal(mesh_input_read(x, &sink, &report), ST_OK);
    assert_string_equal(report.field, "noise");
    assert_int_equal(report.bad_indices + report.repeated, 0);
    mesh_input_close(x);
    return k;
}

static void test_file(void **state) {
    (void)state;
    tet_generate_options o = make_options("noise", 7, 8, 9);
    o.shape.copies[0] = 4;
    o.shape.deform = 0.5;
    kept want = keep(&o, 0);
    assert_int_equal(write_files(&o, "a.mesh", false), ST_OK);
    check_file("a.mesh", &want);
    kept got = read_back("a.mesh");
    assert_int_equal(hash_of(&got), hash_of(&want));
    assert_int_equal(write_files(&o, "a.mesh", false), ST_EXISTS);
    assert_int_equal(write_files(&o, "a.mesh", true), ST_OK);
    release(&got);
    release(&want);
    remove(scratch_path("a.mesh"));
    assert_int_equal(scratch_count(), 0);
}

/* Step k is the mesh deformed by a sine of k: to and fro, and back at where it began. */
static void test_series(void **state) {
    (void)state;
    tet_generate_options o = make_options("noise", 9, 9, 9);
    o.shape.deform = 0.9;
    o.steps = 8;
    assert_int_equal(write_files(&o, "b_%04d.mesh", false), ST_OK);
    assert_int_equal(scratch_count(), 8);
    static const double sines[8] = {0, 0.70710678, 1, 0.70710678, 0, -0.70710678, -1, -0.70710678};
    kept most = keep(&o, 0);
    o.shape.deform = 0;
    kept still = keep(&o, 0);
    for (int step = 0; step < 8; step++) {
        char name[24];
        snprintf(name, sizeof name, "b_%04d.mesh", step);
        kept got = read_back(name);
        check_volumes(&got, &o.shape);
        assert_memory_equal(got.value, still.value, got.points * sizeof *got.value);
        assert_memory_equal(got.ids, still.ids, got.tets * sizeof *got.ids);
        for (uint64_t n = 0; n < got.points; n++)
            for (int c = 0; c < 3; c++) {
                double by = most.xyz[n][c] - (double)still.xyz[n][c];
                assert_true(fabs(got.xyz[n][c] - still.xyz[n][c] - sines[step] * by) < 3e-6);
            }
        release(&got);
        remove(scratch_path(name));
    }
    release(&still);
    release(&most);
}

/* Names are made for any pattern; one that is taken is told before the first file is written. */
static void test_names(void **state) {
    (void)state;
    tet_generate_options o = make_options("sphere", 3, 3, 3);
    o.shape.deform = 0.9;
    o.steps = 3;
    static const char *const names[][2] = {
        {"c.mesh", "c_0002.mesh"}, {"c", "c_0002"}, {".c", ".c_0002"}, {"%04d", "0002"}};
    for (int n = 0; n < 4; n++) {
        scratch_text(names[n][1], "there");
        assert_int_equal(write_files(&o, names[n][0], false), ST_EXISTS);
        assert_non_null(strstr(status_text(), names[n][1]));
        assert_int_equal(scratch_count(), 1);
        remove(scratch_path(names[n][1]));
    }
    char *name = malloc(5001);
    memset(name, 'x', 5000);
    name[5000] = '\0';
    mem m;
    mem_init(&m, 0);
    assert_int_equal(tet_generate_files(&m, &o, name, false, NULL), ST_USAGE);
    free(name);
}

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_THREAD};
    static const status wanted[] = {ST_NOMEM, ST_NOSPACE, ST_NOMEM};
    for (int i = 0; i < 6; i++) {
        tet_generate_options o = make_options(i % 2 ? "attractor" : "noise", 4, 5, 6);
        o.threads = 3;
        long k = 0;
        for (bool fired = true; fired;) {
            fault_arm(kinds[i / 2], k += 1 + (WATCHED ? k / (WATCHED_THREADS ? 1 : 4) : 0));
            status st = write_files(&o, "f.mesh", false);
            fired = fault_fired(kinds[i / 2]);
            fault_arm(kinds[i / 2], 0);
            if (st == ST_OK) {
                remove(scratch_path("f.mesh"));
            } else {
                assert_true(fired);
                assert_int_equal(st, wanted[i / 2]);
            }
            assert_int_equal(scratch_count(), 0);
        }
        assert_true(k > 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound),       cmocka_unit_test(test_buckyball),
        cmocka_unit_test(test_longest),     cmocka_unit_test(test_deformation),
        cmocka_unit_test(test_copies),      cmocka_unit_test(test_values),
        cmocka_unit_test(test_any_threads), cmocka_unit_test(test_pinned),
        cmocka_unit_test(test_memory),      cmocka_unit_test(test_refused),
        cmocka_unit_test(test_stopped),     cmocka_unit_test(test_file),
        cmocka_unit_test(test_series),      cmocka_unit_test(test_names),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
