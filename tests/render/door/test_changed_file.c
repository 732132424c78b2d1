/* test_changed_file.c - a treelet file that somebody writes to, cuts short or replaces while it is
 * drawn: the right picture, or exit status 3 with a word about it; never another end.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/bus_error.h"
#include "formats/base/clock.h"
#include "formats/base/fault.h"
#include "stream/source.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/scratch.h"

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { RUNS = 18 };
#else
enum { RUNS = 100 };
#endif

enum { SEED = 5, EXIT_INPUT = 3, STUCK_S = 120 };

extern char **environ;

/* ---- Who writes ---- */

typedef struct victim {
    const char *path, *iso;
    char *bytes; /* as it should be */
    size_t size;
} victim;

static void write_bytes(const char *path, const char *bytes, size_t size) {
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, bytes, size), (ssize_t)size);
    close(fd);
}

static void restore(const victim *v) {
    const char *fresh = scratch_path("fresh.leaf");
    write_bytes(fresh, v->bytes, v->size);
    assert_int_equal(rename(fresh, v->path), 0);
}

static void fill(char *bytes, size_t size, field_random *r) {
    const bool all_ones = field_random_below(r, 3) == 0;
    for (size_t i = 0; i < size; i++)
        bytes[i] = all_ones ? (char)0xff : (char)field_random_bits(r);
}

/* Somewhere in the file, more often than not behind its directory. */
static size_t place_in(const victim *v, field_random *r) {
    const size_t from = field_random_below(r, 4) ? v->size / 8 : 0;
    return from + (size_t)field_random_below(r, (long)(v->size - from));
}

static void overwrite(const victim *v, field_random *r) {
    char bytes[4096];
    const int fd = open(v->path, O_WRONLY | O_CLOEXEC);
    for (int i = 0; i < 8; i++) {
        const size_t at = place_in(v, r),
                     n = v->size - at < sizeof bytes ? v->size - at : sizeof bytes;
        fill(bytes, n, r);
        assert_int_equal(pwrite(fd, bytes, n, (off_t)at), (ssize_t)n);
    }
    close(fd);
}

static void overwrite_all(const victim *v, field_random *r) {
    char *bytes = malloc(v->size);
    const int fd = open(v->path, O_WRONLY | O_CLOEXEC);
    assert_non_null(bytes);
    fill(bytes, v->size, r);
    assert_int_equal(pwrite(fd, bytes, v->size, 0), (ssize_t)v->size);
    close(fd);
    free(bytes);
}

static void cut(const victim *v, field_random *r) {
    assert_int_equal(truncate(v->path, (off_t)place_in(v, r)), 0);
}

/* Its pages are zeros then. */
static void cut_and_grow(const victim *v, field_random *r) {
    cut(v, r);
    assert_int_equal(truncate(v->path, (off_t)v->size), 0);
}

static void replace(const victim *v, field_random *r) {
    char *bytes = malloc(v->size);
    assert_non_null(bytes);
    fill(bytes, v->size, r);
    const char *fresh = scratch_path("fresh.leaf");
    write_bytes(fresh, bytes, v->size);
    assert_int_equal(rename(fresh, v->path), 0);
    free(bytes);
}

static void append(const victim *v, field_random *r) {
    char bytes[64];
    const int fd = open(v->path, O_WRONLY | O_APPEND | O_CLOEXEC);
    fill(bytes, sizeof bytes, r);
    assert_int_equal(write(fd, bytes, sizeof bytes), (ssize_t)sizeof bytes);
    close(fd);
}

static void empty(const victim *v, field_random *r) {
    (void)r;
    assert_int_equal(truncate(v->path, 0), 0);
}

typedef void (*attack_fn)(const victim *v, field_random *r);
static const attack_fn attacks[] = {overwrite, overwrite_all, cut,  cut_and_grow,
                                    replace,   append,        empty};
enum { ATTACKS = sizeof attacks / sizeof *attacks };

/* ---- Who draws ---- */

static pid_t start_render(const victim *v, const char *backend, const char *out, const char *err) {
    char program[4096];
    const char *build = getenv("LEAFCAST_BUILD");
    snprintf(program, sizeof program, "%s/libexec/leafcast-render",
             build ? build : "build/release");
    const char *const args[] = {
        program, v->path,           "--iso", v->iso,        "--size",  "80x80", "--backend",
        backend, "--repeat",        "4",     "--shadows",   "--light", "1,2,3", "--threads",
        "2",     "--treelet-limit", "6",     "--depth-f64", out,       NULL};
    posix_spawn_file_actions_t files;
    pid_t pid = 0;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err, O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    assert_int_equal(posix_spawn(&pid, program, &files, NULL, (char **)(uintptr_t)args, environ),
                     0);
    posix_spawn_file_actions_destroy(&files);
    return pid;
}

static int end_of(pid_t pid) {
    int how = 0;
    assert_int_equal(waitpid(pid, &how, 0), pid);
    return how;
}

typedef struct ends {
    int right, refused, by_signal;
} ends;

static void judge(int how, const victim *v, const char *out, const char *err, const char *right,
                  size_t right_size, ends *seen) {
    char *said = scratch_read(err, NULL);
    if (WIFEXITED(how) && WEXITSTATUS(how) == 0) {
        size_t size = 0;
        char *bytes = scratch_read(out, &size);
        assert_int_equal(size, right_size);
        assert_memory_equal(bytes, right, size);
        free(bytes);
        seen->right++;
    } else {
        if (!WIFEXITED(how) || WEXITSTATUS(how) != EXIT_INPUT || !strstr(said, v->path))
            fail_msg("status 0x%x: %s", how, said);
        assert_int_equal(access(out, F_OK), -1);
        seen->refused++;
        seen->by_signal += strstr(said, "became shorter while it was in use") != NULL;
    }
    free(said);
}

static void besiege(const victim *v, const char *backend, int runs) {
    char out[4096], err[4096];
    field_random r = {SEED};
    ends seen = {0, 0, 0};
    size_t size = 0;
    snprintf(out, sizeof out, "%s", scratch_path("out.f64"));
    snprintf(err, sizeof err, "%s", scratch_path("err.txt"));
    (void)remove(out);
    double whole = STUCK_S;
    for (int i = 0; i < 3; i++) {
        (void)remove(out);
        const double begun = clock_seconds();
        assert_int_equal(end_of(start_render(v, backend, out, err)), 0);
        whole = fmin(whole, clock_seconds() - begun);
    }
    char *right = scratch_read(out, &size);
    for (int i = 0; i < runs; i++) {
        alarm(STUCK_S);
        restore(v);
        (void)remove(out);
        const pid_t pid = start_render(v, backend, out, err);
        const double wait = field_random_unit(&r) * 1.1 * whole;
        usleep((useconds_t)(1e6 * wait));
        for (long k = field_random_below(&r, 3); k >= 0; k--)
            attacks[i % ATTACKS](v, &r);
        judge(end_of(pid), v, out, err, right, size, &seen);
    }
    alarm(0);
    restore(v);
    free(right);
    print_message("# %s, %s: %d pictures, %d refused, %d of them by SIGBUS\n", v->path, backend,
                  seen.right, seen.refused, seen.by_signal);
    assert_true(seen.refused > 0);
}

/* Raw and compressed. Each load of a raw mesh or of anything compressed copies from the mapping. */
static void test_grid(void **state) {
    (void)state;
    for (int compressed = 0; compressed < 2; compressed++) {
        field f;
        assert_true(field_make(&f, "waves", 70, FIELD_SEED));
        char iso[32];
        snprintf(iso, sizeof iso, "%.17g", f.iso);
        victim v = {.path = fixture_leaf(&f, 4, 1, compressed), .iso = iso};
        v.bytes = scratch_read(v.path, &v.size);
        besiege(&v, "mapped", RUNS);
        besiege(&v, "arena", RUNS / 3);
        free(v.bytes);
        field_release(&f);
    }
}

static void test_mesh(void **state) {
    (void)state;
    for (int compressed = 0; compressed < 2; compressed++) {
        mesh_case c = mesh_leaves_cube(18, 1, 1, SEED, 0);
        c.mesh.treelet_tets = 800;
        c.file.codec = compressed ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        victim v = {.path = mesh_leaves_make(&c, "besieged.leaf"), .iso = "0.25"};
        mesh_leaves_release(&c);
        v.bytes = scratch_read(v.path, &v.size);
        besiege(&v, "mapped", RUNS);
        besiege(&v, "arena", RUNS / 3);
        free(v.bytes);
    }
}

/* ---- What an open volume says ---- */

static leafcast_status draw(leafcast *volume) {
    enum { SIDE = 32 };
    static double z[SIDE * SIDE];
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(volume, 2.2, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = z};
    return leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
}

static void touch(const victim *v, field_random *r) {
    (void)r;
    assert_int_equal(utimensat(AT_FDCWD, v->path, NULL, 0), 0);
}

/* Another file with the same bytes. */
static void same_again(const victim *v, field_random *r) {
    (void)r;
    restore(v);
}

static void check_said(const victim *v, leafcast_backend backend, attack_fn attack,
                       const char *what) {
    field_random r = {SEED};
    double point[3] = {0, 0, 0};
    leafcast_sample sample;
    restore(v);
    const leafcast_options o = {.size = sizeof(leafcast_options), .backend = backend, .threads = 2};
    leafcast *volume = fixture_open(v->path, &o);
    const leafcast_surface surface = leafcast_surface_default(atof(v->iso));
    assert_int_equal(leafcast_select(volume, &surface, 1), LEAFCAST_OK);
    assert_int_equal(draw(volume), LEAFCAST_OK);
    usleep(20000); /* a tick of the clock that files get their times from */
    attack(v, &r);
    /* All that is needed is resident: nothing but the mark can tell. */
    for (int i = 0; i < 2; i++) {
        assert_int_equal(draw(volume), LEAFCAST_CORRUPT);
        assert_non_null(strstr(leafcast_error_text(), v->path));
        assert_non_null(strstr(leafcast_error_text(), " changed while it was open: "));
        assert_non_null(strstr(leafcast_error_text(), what));
    }
    assert_int_equal(leafcast_probe_point(volume, point, &sample), LEAFCAST_CORRUPT);
    assert_int_equal(leafcast_sample_points(volume, (const double(*)[3])point, 1, &sample),
                     LEAFCAST_CORRUPT);
    leafcast_close(volume);
}

static void test_what_is_said(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "waves", 30, FIELD_SEED));
    char iso[32];
    snprintf(iso, sizeof iso, "%.17g", f.iso);
    victim v = {.path = fixture_leaf(&f, 4, 1, false), .iso = iso};
    v.bytes = scratch_read(v.path, &v.size);
    for (leafcast_backend b = LEAFCAST_BACKEND_AUTO; b <= LEAFCAST_BACKEND_ARENA; b++) {
        check_said(&v, b, touch, "it was written to");
        check_said(&v, b, append, "bytes, and has");
        check_said(&v, b, same_again, "another file has taken its place");
    }
    /* Removed: what is open stays what it is. */
    restore(&v);
    leafcast *volume = fixture_open(v.path, NULL);
    const leafcast_surface surface = leafcast_surface_default(f.iso);
    assert_int_equal(leafcast_select(volume, &surface, 1), LEAFCAST_OK);
    assert_int_equal(unlink(v.path), 0);
    assert_int_equal(draw(volume), LEAFCAST_OK);
    leafcast_close(volume);
    free(v.bytes);
    field_release(&f);
}

/* Pages that a file has lost are no failure of the disk's, whoever asks for them. */
static void test_cut_source(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "waves", 70, FIELD_SEED));
    for (int compressed = 0; compressed < 2; compressed++)
        for (int kind = SOURCE_MAPPED; kind <= SOURCE_ARENA; kind++) {
            mem m;
            leaf_file *cut = NULL;
            source *s = NULL;
            leaf_unpacker *u = NULL;
            const void *payload = NULL;
            const char *path = fixture_leaf(&f, 4, 1, compressed);
            mem_init(&m, 0);
            assert_int_equal(leaf_file_open(&m, path, &cut), ST_OK);
            assert_int_equal(source_open(&m, cut, (source_kind)kind, &s), ST_OK);
            assert_int_equal(leaf_unpacker_create(&m, cut, &u), ST_OK);
            assert_int_equal(truncate(path, 4096), 0);
            assert_int_equal(source_load(s, 1, u, &payload), ST_CORRUPT);
            assert_non_null(strstr(status_text(), path));
            leaf_unpacker_destroy(u);
            source_close(s);
            leaf_file_close(cut);
        }
    field_release(&f);
}

/* Nor are pages that were lost for a moment, when no mark tells. */
static void test_pages_back(void **state) {
    (void)state;
    field f;
    mem m;
    leaf_file *whole = NULL;
    source *s = NULL;
    leaf_unpacker *u = NULL;
    const void *payload = NULL;
    assert_true(field_make(&f, "waves", 30, FIELD_SEED));
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, fixture_leaf(&f, 4, 1, false), &whole), ST_OK);
    assert_int_equal(source_open(&m, whole, SOURCE_MAPPED, &s), ST_OK);
    assert_int_equal(leaf_unpacker_create(&m, whole, &u), ST_OK);
    fault_arm(FAULT_PAGES, 1);
    assert_int_equal(source_load(s, 1, u, &payload), ST_OK);
    assert_true(fault_fired(FAULT_PAGES));
    fault_arm(FAULT_PAGES, 0);
    source_evict(s, 1, payload);
    leaf_unpacker_destroy(u);
    source_close(s);
    leaf_file_close(whole);
    field_release(&f);
}

/* ---- The handler ---- */

static void die_by_mapping(const char *path) {
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    const volatile char *map = mmap(NULL, 1, PROT_READ, MAP_SHARED, fd, 0);
    if (map != MAP_FAILED && ftruncate(fd, 0) == 0)
        (void)map[0];
}

static void die_by_signal(const char *path) {
    (void)path;
    raise(SIGBUS);
}

/* As if the disk had failed: the file's second page, mapped alone, is as long as it was. The first
 * time is forgiven: it might have been cut and have grown again. */
static void die_by_disk(const char *path) {
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    const long page = sysconf(_SC_PAGESIZE);
    if (fd < 0 || ftruncate(fd, page + 1) != 0)
        return;
    char *map = mmap(NULL, (size_t)page, PROT_READ, MAP_SHARED, fd, page);
    siginfo_t info = {.si_signo = SIGBUS, .si_code = BUS_ADRERR};
    info.si_addr = map + 5;
    for (int i = 0; i < 2 && map != MAP_FAILED; i++) {
        (void)!write(STDERR_FILENO, "+", 1);
        (void)syscall(SYS_rt_sigqueueinfo, getpid(), SIGBUS, &info);
    }
}

/* How a child ends that does this; what it says goes to the scratch file said.txt. */
static int end_of_child(void (*act)(const char *), const char *path) {
    const char *said = scratch_text("said.txt", "");
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const int fd = open(said, O_WRONLY | O_CLOEXEC);
        if (dup2(fd, STDERR_FILENO) >= 0) {
            bus_error_install("leafcast test");
            act(path);
        }
        _exit(99);
    }
    return end_of(pid);
}

static void ends_with(void (*act)(const char *), const char *path, int code, const char *expected) {
    const int how = end_of_child(act, path);
    char *said = scratch_read(scratch_path("said.txt"), NULL);
    assert_string_equal(said, expected);
    assert_true(WIFEXITED(how) && WEXITSTATUS(how) == code);
    free(said);
}

static void test_bus_error(void **state) {
    (void)state;
    char expected[4200], path[4096];
    snprintf(path, sizeof path, "%s", scratch_text("cut.txt", "something"));
    snprintf(expected, sizeof expected, "leafcast test: %s became shorter while it was in use\n",
             path);
    ends_with(die_by_mapping, path, EXIT_INPUT, expected);
    snprintf(expected, sizeof expected, "++leafcast test: %s could not be read\n", path);
    ends_with(die_by_disk, path, 1, expected);
    const int how = end_of_child(die_by_signal, path);
    assert_true(WIFSIGNALED(how) && WTERMSIG(how) == SIGBUS);
}

/* What a name says to a terminal is not said. */
static void test_bus_error_name(void **state) {
    (void)state;
    char expected[4200], path[4096];
    snprintf(path, sizeof path, "%s", scratch_text("e\033[31m\xff.leaf", "something"));
    const char *name = strrchr(path, '/') + 1;
    snprintf(expected, sizeof expected,
             "leafcast test: %.*se\\x1b[31m\\xff.leaf became shorter while it was in use\n",
             (int)(name - path), path);
    ends_with(die_by_mapping, path, EXIT_INPUT, expected);
    (void)remove(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bus_error),    cmocka_unit_test(test_bus_error_name),
        cmocka_unit_test(test_what_is_said), cmocka_unit_test(test_cut_source),
        cmocka_unit_test(test_pages_back),   cmocka_unit_test(test_grid),
        cmocka_unit_test(test_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
