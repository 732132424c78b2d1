#include "tests/support/mesh_files.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "formats/base/fault.h"
#include "tests/support/scratch.h"

/* ---- reading ---- */

static mesh_copy copy;
static uint64_t points, values, tets; /* received */
static mesh_input *reading;
static double share; /* of it, told last */

static void check_share(void) {
    const double now = mesh_input_share(reading);
    if (!(now >= share && now > 0 && now <= 1))
        fail_msg("%g of the mesh has come, %g before that", now, share);
    share = now;
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)ctx;
    if (first != points || count == 0)
        fail_msg("%zu points from %llu on, expected %llu", count, (unsigned long long)first,
                 (unsigned long long)points);
    if (count > MESH_FILES_ROOM - points)
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.xyz[points], xyz, count * sizeof *xyz);
    points += count;
    return ST_OK;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *v) {
    (void)ctx;
    if (first != values || count == 0)
        fail_msg("%zu values from %llu on, expected %llu", count, (unsigned long long)first,
                 (unsigned long long)values);
    if (count > MESH_FILES_ROOM - values)
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.values + values, v, count * sizeof *v);
    values += count;
    return ST_OK;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx;
    if (count > MESH_FILES_ROOM - tets)
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.tets[tets], ids, count * sizeof *ids);
    tets += count;
    return ST_OK;
}

static void check_tet(const uint32_t t[4]) {
    for (int i = 0; i < 4; i++) {
        assert_true(t[i] < points);
        for (int j = 0; j < i; j++)
            assert_int_not_equal(t[i], t[j]);
    }
}

static void check_promises(void) {
    assert_int_equal(copy.report.points, points);
    assert_int_equal(values, points);
    assert_int_equal(copy.report.tets, tets);
    for (size_t i = 0; i < points; i++)
        for (int a = 0; a < 3; a++)
            assert_true(isfinite(copy.xyz[i][a]));
    for (size_t i = 0; i < tets; i++)
        check_tet(copy.tets[i]);
}

bool mesh_files_recognised(const char *path) {
    mem m;
    byte_stream *s = NULL;
    bool known = false;
    mem_init(&m, 0);
    assert_int_equal(byte_stream_open(&m, path, &s), ST_OK);
    assert_int_equal(mesh_input_recognise(s, &known), ST_OK);
    byte_stream_close(s);
    return known;
}

status mesh_files_read(const char *path, const mesh_hints *hints, const mesh_copy **out) {
    const mesh_sink sink = {.points = take_points, .values = take_values, .tets = take_tets};
    mem m;
    mesh_input *x = NULL;
    mem_init(&m, (size_t)1 << 24);
    points = values = tets = 0;
    status_describe(ST_OK, "%s", "");
    status st = mesh_input_open(&m, path, hints, &x);
    if (st == ST_OK) {
        strcpy(copy.name, mesh_input_name(x));
        share = mesh_input_share(reading = x);
        assert_true(share == 0);
        st = mesh_input_read(x, &sink, &copy.report);
        assert_true(st != ST_OK || mesh_input_share(x) == 1);
    }
    mesh_input_close(x);
    if (mem_used(&m) != 0)
        fail_msg("%s: %zu bytes leaked", path, mem_used(&m));
    if ((st == ST_OK) != !*status_text())
        fail_msg("%s: status %d described as \"%s\"", path, (int)st, status_text());
    if (st == ST_OK)
        check_promises();
    *out = &copy;
    return st;
}

const mesh_copy *mesh_files_good(const char *path, const mesh_hints *hints) {
    const mesh_copy *a = NULL;
    if (mesh_files_read(path, hints, &a) != ST_OK)
        fail_msg("%s", status_text());
    return a;
}

void mesh_files_refused(const char *path, const mesh_hints *hints, status st, const char *said) {
    const mesh_copy *a;
    status got = mesh_files_read(path, hints, &a);
    if (got != st || !strstr(status_text(), said))
        fail_msg("status %d (\"%s\"), not %d (\"...%s...\")", (int)got, status_text(), (int)st,
                 said);
}

const char *mesh_files_stage(const char *set, const char *name) {
    char packed[300];
    snprintf(packed, sizeof packed, "%s/%s.zst", set, name);
    bool is_packed = scratch_data(packed) != NULL;
    if (!is_packed)
        packed[strlen(packed) - 4] = 0;
    const char *path = scratch_data(packed);
    if (!path)
        return NULL;
    size_t size;
    char *bytes = scratch_read(path, &size);
    if (is_packed) {
        unsigned long long raw = ZSTD_getFrameContentSize(bytes, size);
        assert_true(raw != ZSTD_CONTENTSIZE_UNKNOWN && raw != ZSTD_CONTENTSIZE_ERROR);
        char *all = malloc((size_t)raw);
        assert_int_equal(ZSTD_decompress(all, (size_t)raw, bytes, size), raw);
        free(bytes);
        bytes = all;
        size = (size_t)raw;
    }
    const char *staged = scratch_write(name, bytes, size);
    free(bytes);
    return staged;
}

/* ---- comparing ---- */

mesh_copy *mesh_files_keep(const mesh_copy *a) {
    mesh_copy *kept = malloc(sizeof *kept);
    assert_non_null(kept);
    memcpy(kept, a, sizeof *kept);
    return kept;
}

void mesh_files_same(const mesh_copy *a, const mesh_copy *b) {
    assert_int_equal(a->report.points, b->report.points);
    assert_int_equal(a->report.tets, b->report.tets);
    assert_memory_equal(a->xyz, b->xyz, a->report.points * sizeof *a->xyz);
    assert_memory_equal(a->values, b->values, a->report.points * sizeof *a->values);
    assert_memory_equal(a->tets, b->tets, a->report.tets * sizeof *a->tets);
}

/* Six times the signed volume of a tet, by three corners and a fourth. */
static double volume6(const mesh_copy *a, const uint32_t t[4]) {
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)a->xyz[t[i + 1]][k] - (double)a->xyz[t[0]][k];
    return e[2][0] * (e[0][1] * e[1][2] - e[0][2] * e[1][1]) +
           e[2][1] * (e[0][2] * e[1][0] - e[0][0] * e[1][2]) +
           e[2][2] * (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
}

double mesh_files_volume(const mesh_copy *a, double *magnitude) {
    double sum = 0, all = 0;
    for (size_t i = 0; i < a->report.tets; i++) {
        double v = volume6(a, a->tets[i]) / 6;
        sum += v;
        all += fabs(v);
    }
    if (magnitude)
        *magnitude = all;
    return sum;
}

/* A face by its sorted ids, and the side of it on which its tet lies. */
typedef struct face {
    uint32_t id[3];
    int side;
} face;

static int compare_faces(const void *a, const void *b) {
    return memcmp(((const face *)a)->id, ((const face *)b)->id, sizeof((const face *)a)->id);
}

static void sort_three(uint32_t id[3]) {
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (id[j] > id[j + 1]) {
                uint32_t kept = id[j];
                id[j] = id[j + 1];
                id[j + 1] = kept;
            }
}

static face face_of(const mesh_copy *a, const uint32_t t[4], int opposite) {
    face f;
    for (int i = 0, n = 0; i < 4; i++)
        if (i != opposite)
            f.id[n++] = t[i];
    sort_three(f.id);
    const uint32_t around[4] = {f.id[0], f.id[1], f.id[2], t[opposite]};
    f.side = volume6(a, around) > 0 ? 1 : -1;
    return f;
}

bool mesh_files_closed(const mesh_copy *a) {
    size_t count = 4 * a->report.tets;
    face *f = malloc((count + 1) * sizeof *f);
    bool closed = true;
    for (size_t i = 0; i < count; i++)
        f[i] = face_of(a, a->tets[i / 4], (int)(i % 4));
    qsort(f, count, sizeof *f, compare_faces);
    for (size_t i = 0, run; i < count; i += run) {
        int sides = 0;
        for (run = 0; i + run < count && compare_faces(&f[i], &f[i + run]) == 0; run++)
            sides += f[i + run].side;
        closed = closed && (run == 1 || (run == 2 && sides == 0));
    }
    free(f);
    return closed;
}

/* ---- sweeps ---- */

void mesh_files_truncate(const char *path, const mesh_hints *hints, size_t spare) {
    const mesh_copy *a;
    size_t size;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    for (size_t n = 0; n + spare < size; n++) {
        scratch_write(name, data, n);
        status st = mesh_files_read(path, hints, &a);
        /* What is left may be a whole file of other arrays. */
        if (st != ST_CORRUPT && st != ST_UNSUPPORTED && st != ST_USAGE && st != ST_IO)
            fail_msg("%s cut to %zu of %zu bytes: status %d", path, n, size, (int)st);
    }
    scratch_write(name, data, size);
    free(data);
}

size_t mesh_files_damage(const char *path, const mesh_hints *hints) {
    const mesh_copy *a;
    size_t size, unnoticed = 0;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    static const char masks[] = {1, 0x10, (char)0xff};
    for (size_t n = 0; n < size; n++)
        for (size_t i = size < 1000 ? 0 : n % 3; i < sizeof masks; i += size < 1000 ? 1 : 3) {
            data[n] ^= masks[i];
            scratch_write(name, data, size);
            unnoticed += mesh_files_read(path, hints, &a) == ST_OK;
            data[n] ^= masks[i];
        }
    scratch_write(name, data, size);
    free(data);
    return unnoticed;
}

static void sweep(const char *path, const mesh_hints *hints, fault_kind kind) {
    const mesh_copy *a;
    long k = 0;
    for (bool fired = true; fired;) {
        fault_arm(kind, ++k);
        status st = mesh_files_read(path, hints, &a);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        status want = !fired ? ST_OK : kind == FAULT_ALLOC ? ST_NOMEM : ST_IO;
        if (st != want)
            fail_msg("%s: fault %ld of kind %d gives %d, not %d (%s)", path, k, (int)kind, (int)st,
                     (int)want, status_text());
    }
    assert_true(k > 1);
}

void mesh_files_faults(const char *path, const mesh_hints *hints) {
    sweep(path, hints, FAULT_ALLOC);
    sweep(path, hints, FAULT_READ);
}
