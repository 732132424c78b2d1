#include "tests/support/surface_files.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/surface/surface_readers.h"
#include "tests/support/scratch.h"

static surface_copy copy;
static uint64_t points, triangles, values[SURFACE_FILES_FIELDS]; /* received */
static mesh_input *reading;
static double share;

static void check_share(void) {
    const double now = mesh_input_share(reading);
    if (!(now >= share && now <= 1))
        fail_msg("%g of the surface has come, %g before that", now, share);
    share = now;
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)ctx;
    if (first != points || count == 0)
        fail_msg("%zu points from %llu on, expected %llu", count, (unsigned long long)first,
                 (unsigned long long)points);
    if (count > SURFACE_FILES_ROOM - points)
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.xyz[points], xyz, count * sizeof *xyz);
    points += count;
    return ST_OK;
}

/* The k-th of several fields begins at k times the number of points. In files as small as these
 * each field comes at once, behind the one before. */
static status take_values(void *ctx, uint64_t first, size_t count, const float *v) {
    (void)ctx;
    uint32_t k = 0;
    while (copy.fields > 1 && k + 1 < copy.fields && values[k] > 0)
        k++;
    const uint64_t want = copy.fields > 1 ? k * (uint64_t)count : values[0];
    if (first != want || count == 0)
        fail_msg("%zu values from %llu on, expected %llu", count, (unsigned long long)first,
                 (unsigned long long)want);
    if (count > SURFACE_FILES_ROOM - values[k])
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.values[k] + values[k], v, count * sizeof *v);
    values[k] += count;
    return ST_OK;
}

static bool takes_normals;
static uint64_t normals; /* received */

void surface_files_take_normals(bool take) {
    takes_normals = take;
}

static status take_normals(void *ctx, uint64_t first, size_t count, const uint32_t *codes) {
    (void)ctx;
    if (first != normals || count == 0)
        fail_msg("%zu normals from %llu on, expected %llu", count, (unsigned long long)first,
                 (unsigned long long)normals);
    if (count > SURFACE_FILES_ROOM - normals)
        return status_describe(ST_FAILED, "too large for this test");
    memcpy(copy.normals + normals, codes, count * sizeof *codes);
    normals += count;
    return ST_OK;
}

static status take_triangles(void *ctx, size_t count, const uint32_t (*ids)[3]) {
    (void)ctx;
    if (count > SURFACE_FILES_ROOM - triangles)
        return status_describe(ST_FAILED, "too large for this test");
    check_share();
    memcpy(copy.triangles[triangles], ids, count * sizeof *ids);
    triangles += count;
    return ST_OK;
}

static void check_promises(void) {
    assert_int_equal(copy.report.points, points);
    assert_int_equal(copy.report.tets, triangles);
    assert_int_equal(copy.report.normals, normals);
    assert_true(normals == 0 || normals == points);
    for (uint32_t k = 0; k < copy.fields; k++)
        assert_int_equal(values[k], points);
    for (size_t i = 0; i < points; i++)
        for (int a = 0; a < 3; a++)
            assert_true(isfinite(copy.xyz[i][a]));
    for (size_t i = 0; i < triangles; i++) {
        const uint32_t *t = copy.triangles[i];
        assert_true(t[0] < points && t[1] < points && t[2] < points);
        assert_true(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    }
}

static status read_open(mesh_input *x, const char *const *names, uint32_t count) {
    const mesh_sink sink = {.points = take_points,
                            .values = take_values,
                            .triangles = take_triangles,
                            .normals = takes_normals ? take_normals : NULL};
    status st = names ? mesh_input_take(x, names, count) : ST_OK;
    if (st != ST_OK)
        return st;
    share = mesh_input_share(reading = x);
    assert_true(share == 0);
    st = mesh_input_read(x, &sink, &copy.report);
    assert_true(st != ST_OK || mesh_input_share(x) == 1);
    return st;
}

status surface_files_read(const char *path, const mesh_hints *hints, const char *const *names,
                          uint32_t count, const surface_copy **out) {
    mem m;
    mesh_input *x = NULL;
    mem_init(&m, (size_t)1 << 24);
    points = triangles = normals = 0;
    memset(values, 0, sizeof values);
    copy.fields = names ? count : 1;
    assert_true(copy.fields <= SURFACE_FILES_FIELDS);
    status_describe(ST_OK, "%s", "");
    status st = surface_input_open(&m, path, hints, &x);
    if (st == ST_OK)
        st = read_open(x, names, count);
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

const surface_copy *surface_files_good(const char *path, const mesh_hints *hints) {
    const surface_copy *a = NULL;
    if (surface_files_read(path, hints, NULL, 0, &a) != ST_OK)
        fail_msg("%s", status_text());
    return a;
}

void surface_files_refused(const char *path, const mesh_hints *hints, status st, const char *said) {
    const surface_copy *a;
    const status got = surface_files_read(path, hints, NULL, 0, &a);
    if (got != st || !strstr(status_text(), said))
        fail_msg("status %d (\"%s\"), not %d (\"...%s...\")", (int)got, status_text(), (int)st,
                 said);
}

/* ---- pipes ---- */

/* In a child: write the file in pieces. */
static void feed_pipe(const char *data, size_t size, const char *name, size_t piece) {
    const int fd = open(name, O_WRONLY);
    size_t at = 0;
    while (fd >= 0 && at < size) {
        const ssize_t done = write(fd, data + at, size - at < piece ? size - at : piece);
        if (done <= 0)
            _exit(1);
        at += (size_t)done;
    }
    _exit(fd < 0);
}

const surface_copy *surface_files_pipe(const char *path, const char *name, size_t piece) {
    size_t size;
    char *data = scratch_read(path, &size);
    const char *pipe = scratch_path(name);
    remove(pipe);
    assert_int_equal(mkfifo(pipe, 0600), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        feed_pipe(data, size, pipe, piece);
    const surface_copy *a = surface_files_good(pipe, NULL);
    int how = 1;
    assert_true(waitpid(child, &how, 0) == child && how == 0);
    remove(pipe);
    free(data);
    return a;
}

/* ---- sweeps ---- */

void surface_files_truncate(const char *path, const mesh_hints *hints, size_t spare) {
    const surface_copy *a;
    size_t size;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    for (size_t n = 0; n + spare < size; n++) {
        scratch_write(name, data, n);
        const status st = surface_files_read(path, hints, NULL, 0, &a);
        if (st != ST_CORRUPT && st != ST_UNSUPPORTED && st != ST_USAGE)
            fail_msg("%s cut to %zu of %zu bytes: status %d", path, n, size, (int)st);
    }
    scratch_write(name, data, size);
    free(data);
}

void surface_files_damage(const char *path, const mesh_hints *hints) {
    static const char masks[] = {1, 0x10, (char)0xff};
    const surface_copy *a;
    size_t size;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    for (size_t n = 0; n < size; n++) {
        data[n] ^= masks[n % 3];
        scratch_write(name, data, size);
        const status st = surface_files_read(path, hints, NULL, 0, &a);
        assert_true(st != ST_NOMEM && st != ST_FAILED);
        data[n] ^= masks[n % 3];
    }
    scratch_write(name, data, size);
    free(data);
}

static void sweep(const char *path, const mesh_hints *hints, fault_kind kind) {
    const surface_copy *a;
    long k = 0;
    for (bool fired = true; fired;) {
        fault_arm(kind, ++k);
        const status st = surface_files_read(path, hints, NULL, 0, &a);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        const status want = !fired ? ST_OK : kind == FAULT_ALLOC ? ST_NOMEM : ST_IO;
        if (st != want)
            fail_msg("%s: fault %ld of kind %d gives %d, not %d (%s)", path, k, (int)kind, (int)st,
                     (int)want, status_text());
    }
    assert_true(k > 1);
}

void surface_files_faults(const char *path, const mesh_hints *hints) {
    sweep(path, hints, FAULT_ALLOC);
    sweep(path, hints, FAULT_READ);
}
