/* test_render_faults.c - when something fails while a volume is opened, streamed and drawn: one
 * error with a text, nothing left behind, and the right picture from the next try on. */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/bus_error.h"
#include "formats/base/fault.h"
#include "formats/base/hash.h"
#include "formats/leaf/leaf_file.h"
#include "tests/support/fixture.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* Fewer steps where every access is watched. */
enum { SIDE = WATCHED ? 6 : 12, DENSE = WATCHED_THREADS ? 6 : WATCHED_MEMORY ? 12 : 40 };
enum { PIXELS = SIDE * SIDE, HITS = 16, SURFACES = 3, STUCK_S = 120 };

/* ---- A picture and some probes ---- */

typedef struct answers {
    float rgba[4][PIXELS];
    double z[PIXELS];
    double t[HITS];
    int hits;
    double value, slice[PIXELS];
} answers;

typedef bool (*watcher)(void *ctx, double done);

typedef struct job {
    const char *path;
    leafcast_options options;
    double iso;
    bool sweep;
    watcher watch;
    void *watch_ctx;
    leafcast_stats stats;
    answers *out;
} job;

static leafcast_scene scene_of(const job *j) {
    leafcast_scene scene = leafcast_scene_default();
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){false, {1, 0.5, 2}, {0.8f, 0.8f, 0.7f}, 0};
    scene.lights[1] = (leafcast_light){true, {90, -50, 60}, {0.3f, 0.3f, 0.4f}, 0};
    scene.shadows = true;
    scene.sweep = j->sweep;
    return scene;
}

static leafcast_status choose(leafcast *volume, double iso) {
    leafcast_surface s[SURFACES];
    for (int i = 0; i < SURFACES; i++) {
        s[i] = leafcast_surface_default(iso * (0.8 + 0.2 * i));
        s[i].opacity = 0.35f;
    }
    return leafcast_select(volume, s, SURFACES);
}

static leafcast_status draw(leafcast *volume, job *j) {
    answers *a = j->out;
    const leafcast_scene scene = scene_of(j);
    const leafcast_camera camera = leafcast_standard_view(volume, 1.1, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = a->rgba[0],
                                  .g = a->rgba[1],
                                  .b = a->rgba[2],
                                  .a = a->rgba[3],
                                  .z = a->z};
    j->stats.size = sizeof j->stats;
    return leafcast_trace(volume, &scene, &camera, &image, &j->stats, j->watch, j->watch_ctx);
}

static leafcast_status slice(leafcast *volume, double value[PIXELS]) {
    static const double line[][3] = {{2, 3, 4}, {25, 6, 8}, {11, 24, 2}};
    const leafcast_slice_pixels s = {.size = sizeof s,
                                     .line = line,
                                     .line_count = 3,
                                     .v = {1, 2, 30},
                                     .width = SIDE,
                                     .height = SIDE};
    return leafcast_sample_slice(volume, &s, value, NULL, NULL, NULL);
}

static leafcast_status probe(leafcast *volume, job *j) {
    static const double point[3] = {20.25, 5.5, 12.125};
    const leafcast_scene scene = scene_of(j);
    const leafcast_camera camera = leafcast_standard_view(volume, 1.1, SIDE, SIDE);
    leafcast_hit hits[HITS];
    leafcast_sample sample;
    double origin[3], direction[3];
    leafcast_pixel_ray(&camera, SIDE / 2.0, SIDE / 2.0, origin, direction);
    leafcast_status st =
        leafcast_probe_ray(volume, &scene, origin, direction, hits, HITS, &j->out->hits);
    for (int i = 0; i < j->out->hits && st == LEAFCAST_OK; i++)
        j->out->t[i] = hits[i].t;
    if (st == LEAFCAST_OK)
        st = leafcast_probe_point(volume, point, &sample);
    leafcast_cell cell = {.size = sizeof cell};
    if (st == LEAFCAST_OK)
        st = leafcast_get_cell(volume, 0, sample.cell, &cell);
    if (st != LEAFCAST_OK)
        return st;
    j->out->value = sample.value;
    return slice(volume, j->out->slice);
}

/* Everything a volume can be asked for, up to the first error. */
static leafcast_status use(leafcast *volume, job *j) {
    memset(j->out, 0, sizeof *j->out);
    leafcast_status st = choose(volume, j->iso);
    if (st == LEAFCAST_OK)
        st = draw(volume, j);
    if (st == LEAFCAST_OK)
        st = probe(volume, j);
    return st;
}

static void forget_text(void) {
    (void)status_describe(ST_OK, "%s", "");
}

static hash_id clean_answers(const char *path, double iso) {
    static answers a;
    job j = {.path = path, .iso = iso, .out = &a};
    leafcast *volume = fixture_open(path, NULL);
    assert_int_equal(use(volume, &j), LEAFCAST_OK);
    assert_true(a.hits > 0 && j.stats.shadow_rays > 0);
    leafcast_close(volume);
    return hash_identity(&a, sizeof a);
}

static bool answers_are(const answers *a, hash_id want) {
    const hash_id got = hash_identity(a, sizeof *a);
    return got.lo == want.lo && got.hi == want.hi;
}

static void must_answer(leafcast *volume, job *j, hash_id want) {
    if (use(volume, j) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    assert_true(answers_are(j->out, want));
}

/* ---- What may be left behind ---- */

static int entries(const char *folder) {
    DIR *d = opendir(folder);
    int count = 0;
    assert_non_null(d);
    while (readdir(d))
        count++;
    closedir(d);
    return count;
}

static bool is_mapped(const char *path) {
    char line[1024];
    bool found = false;
    FILE *maps = fopen("/proc/self/maps", "r");
    assert_non_null(maps);
    while (fgets(line, sizeof line, maps))
        found = found || strstr(line, path);
    fclose(maps);
    return found;
}

typedef struct belongings {
    int files, threads;
} belongings;

static belongings now_held(void) {
    return (belongings){entries("/proc/self/fd"), entries("/proc/self/task")};
}

/* A joined thread's entry goes a moment after the join. */
static void nothing_left(belongings before, const char *path) {
    for (int i = 0; i < 1000 && entries("/proc/self/task") > before.threads; i++)
        usleep(1000);
    assert_int_equal(entries("/proc/self/task"), before.threads);
    assert_int_equal(entries("/proc/self/fd"), before.files);
    assert_false(is_mapped(path));
}

/* ---- The files: treelets of 16 cells ---- */

typedef struct kind {
    const char *name;
    leafcast_backend backend;
    bool compressed;
} kind;

static const kind kinds[] = {{"mapped", LEAFCAST_BACKEND_MAPPED, false},
                             {"arena", LEAFCAST_BACKEND_ARENA, false},
                             {"mapped, compressed", LEAFCAST_BACKEND_MAPPED, true},
                             {"arena, compressed", LEAFCAST_BACKEND_ARENA, true}};
/* Threads meet alike in all: each backend and each codec once. */
enum { KINDS = 4, NEXT_KIND = WATCHED_THREADS ? 3 : 1 };

static const char *leaf_of(const char *field_name_of, long n, bool compressed, double *iso) {
    field f;
    assert_true(field_make(&f, field_name_of, n, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, compressed);
    *iso = f.iso;
    field_release(&f);
    return path;
}

/* ---- What is chosen ---- */

static bool is_mapped_by(const char *path, leafcast_backend backend, uint64_t memory) {
    const leafcast_options o = {
        .size = sizeof o, .threads = 1, .memory = memory, .backend = backend};
    leafcast *volume = fixture_open(path, &o);
    const bool mapped = is_mapped(path);
    leafcast_close(volume);
    assert_false(is_mapped(path));
    return mapped;
}

/* By itself a raw grid is mapped, but not within a budget, as the system may take mapped pages
 * back; nor by a program that does not handle SIGBUS. */
static void test_choice(void **state) {
    (void)state;
    enum { BUDGET = 64 << 20 };
    double iso;
    assert_false(is_mapped_by(leaf_of("waves", 30, false, &iso), LEAFCAST_BACKEND_AUTO, 0));
    bus_error_install("leafcast test"); /* for good: so this test is the last */
    for (int compressed = 0; compressed < 2; compressed++) {
        const char *path = leaf_of("waves", 30, compressed, &iso);
        assert_int_equal(is_mapped_by(path, LEAFCAST_BACKEND_AUTO, 0), !compressed);
        assert_false(is_mapped_by(path, LEAFCAST_BACKEND_AUTO, BUDGET));
        assert_false(is_mapped_by(path, LEAFCAST_BACKEND_ARENA, 0));
        assert_true(is_mapped_by(path, LEAFCAST_BACKEND_MAPPED, BUDGET));
    }
}

/* ---- The sweep: the k-th operation fails ---- */

static const char *fault_name(fault_kind what) {
    return what == FAULT_ALLOC ? "allocation" : what == FAULT_READ ? "read" : "thread";
}

static void check_error(leafcast_status st, fault_kind what, long k) {
    const leafcast_status want = what == FAULT_READ ? LEAFCAST_IO : LEAFCAST_NOMEM;
    if (st != want)
        fail_msg("%s %ld: status %d, \"%s\"", fault_name(what), k, (int)st, leafcast_error_text());
    assert_true(leafcast_error_text()[0] != 0);
}

/* Returns false when the k-th operation never came. */
static bool fail_at(job *j, fault_kind what, long k, hash_id want, int *errors) {
    const belongings before = now_held();
    leafcast *volume = NULL;
    alarm(STUCK_S);
    forget_text();
    fault_arm(what, k);
    leafcast_status st = leafcast_open(j->path, &j->options, &volume);
    if (st != LEAFCAST_OK) {
        check_error(st, what, k);
        assert_null(volume);
    } else if ((st = use(volume, j)) != LEAFCAST_OK) {
        check_error(st, what, k);
        fault_arm(what, 0);
        must_answer(volume, j, want);
        fault_arm(what, -1);
    } else {
        assert_true(answers_are(j->out, want)); /* it hit what no one waited for, or nothing */
    }
    *errors += st != LEAFCAST_OK;
    leafcast_close(volume);
    const bool fired = fault_fired(what);
    fault_arm(what, 0);
    nothing_left(before, j->path);
    return fired;
}

static void sweep_faults(const kind *how, fault_kind what, uint32_t treelet_limit) {
    static answers a;
    job j = {.out = &a,
             .options = {.size = sizeof(leafcast_options),
                         .experiments = EXPERIMENTS(.treelet_limit = treelet_limit),
                         .threads = 3,
                         .backend = how->backend}};
    j.path = leaf_of("waves", 30, how->compressed, &j.iso);
    const hash_id want = clean_answers(j.path, j.iso);
    int errors = 0, runs = 0;
    long k = 1;
    for (; fail_at(&j, what, k, want, &errors); k += k < DENSE ? 1 : 1 + k / (WATCHED ? 2 : 4))
        runs++;
    print_message("# %s, %u treelets at a time: %ss fail up to the %ldth: %d errors in %d runs\n",
                  how->name, treelet_limit, fault_name(what), k - 1, errors, runs);
    assert_true(errors > 3 && errors > runs / 2);
    leafcast *volume = fixture_open(j.path, &j.options);
    must_answer(volume, &j, want);
    leafcast_close(volume);
    alarm(0);
}

static void test_failing_allocations(void **state) {
    (void)state;
    for (int i = 0; i < KINDS; i += NEXT_KIND)
        sweep_faults(&kinds[i], FAULT_ALLOC, 3);
}

static void test_failing_reads(void **state) {
    (void)state;
    for (int i = 0; i < KINDS; i += NEXT_KIND)
        sweep_faults(&kinds[i], FAULT_READ, i == 1 ? 0 : 2);
}

static void test_failing_threads(void **state) {
    (void)state;
    for (int i = 0; i < KINDS; i += NEXT_KIND)
        sweep_faults(&kinds[i], FAULT_THREAD, 3);
}

/* ---- Damage ---- */

/* As a disk goes bad: nobody wrote, and the file's time stays. */
static void flip(const char *path, uint64_t at) {
    uint8_t byte = 0;
    struct stat s;
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    assert_true(fd >= 0);
    assert_int_equal(fstat(fd, &s), 0);
    assert_int_equal(pread(fd, &byte, 1, (off_t)at), 1);
    byte ^= 0x10;
    assert_int_equal(pwrite(fd, &byte, 1, (off_t)at), 1);
    assert_int_equal(futimens(fd, (const struct timespec[2]){s.st_atim, s.st_mtim}), 0);
    close(fd);
}

static leaf_file *directory_of(mem *m, const char *path) {
    leaf_file *f = NULL;
    mem_init(m, 0);
    assert_int_equal(leaf_file_open(m, path, &f), ST_OK);
    return f;
}

static void must_name(uint32_t t) {
    char name[32];
    snprintf(name, sizeof name, "treelet %u's", t);
    if (!strstr(leafcast_error_text(), name))
        fail_msg("\"%s\" does not name treelet %u", leafcast_error_text(), t);
}

/* Each treelet in turn has a wrong byte. Returns how many of them mattered. */
static uint64_t damage_each(job *j, const leaf_file *f, hash_id want) {
    uint64_t mattered = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint64_t at = f->offsets[t] + f->sizes[t] * (t % 5) / 5;
        flip(j->path, at);
        leafcast *volume = fixture_open(j->path, &j->options);
        assert_int_equal(choose(volume, j->iso), LEAFCAST_OK);
        memset(j->out, 0, sizeof *j->out);
        alarm(STUCK_S);
        forget_text();
        const leafcast_status st = draw(volume, j);
        if (st != LEAFCAST_OK) {
            assert_int_equal(st, LEAFCAST_CORRUPT);
            must_name(t);
            /* It stays so, and does not spoil what needs no treelet. */
            assert_int_equal(draw(volume, j), LEAFCAST_CORRUPT);
            must_name(t);
            assert_int_equal(choose(volume, 1e6), LEAFCAST_OK);
            assert_int_equal(draw(volume, j), LEAFCAST_OK);
            mattered++;
        }
        flip(j->path, at);
        must_answer(volume, j, want);
        leafcast_close(volume);
    }
    alarm(0);
    return mattered;
}

static void test_damaged_treelet_is_named_when_needed(void **state) {
    (void)state;
    static answers a;
    for (int i = 0; i < 2 * KINDS; i += WATCHED_THREADS ? 7 : 1) {
        const kind *how = &kinds[i / 2];
        job j = {
            .out = &a,
            .sweep = i % 2,
            .options = {.size = sizeof(leafcast_options), .threads = 2, .backend = how->backend}};
        mem m;
        j.path = leaf_of("sphere", 45, how->compressed, &j.iso);
        j.iso = 0.6;
        const hash_id want = clean_answers(j.path, j.iso);
        leafcast *volume = fixture_open(j.path, &j.options);
        assert_int_equal(choose(volume, j.iso), LEAFCAST_OK);
        assert_int_equal(draw(volume, &j), LEAFCAST_OK);
        const uint64_t needed = j.sweep ? j.stats.treelets_active : j.stats.treelets_loaded;
        leafcast_close(volume);
        leaf_file *f = directory_of(&m, j.path);
        const uint64_t mattered = damage_each(&j, f, want);
        print_message("# %s, %s: %d of %u treelets needed\n", how->name,
                      j.sweep ? "swept" : "on demand", (int)needed, f->layout.treelets);
        assert_int_equal(mattered, needed);
        assert_true(needed > 0 && needed < f->layout.treelets);
        leaf_file_close(f);
    }
}

/* Nothing is drawn of it any more, even when its bytes are back, until it is opened anew. */
static void test_file_truncated_after_opening(void **state) {
    (void)state;
    static answers a;
    for (int i = 0; i < KINDS; i += NEXT_KIND) {
        job j = {.out = &a,
                 .options = {
                     .size = sizeof(leafcast_options), .threads = 2, .backend = kinds[i].backend}};
        size_t size = 0;
        j.path = leaf_of("waves", 30, kinds[i].compressed, &j.iso);
        const hash_id want = clean_answers(j.path, j.iso);
        char *bytes = scratch_read(j.path, &size);
        for (int part = 0; part < 12; part += WATCHED_THREADS ? 4 : 1) {
            const size_t kept = part < 11 ? size * (size_t)part / 11 : size - 1;
            leafcast *volume = fixture_open(j.path, &j.options);
            assert_int_equal(truncate(j.path, (off_t)kept), 0);
            alarm(STUCK_S);
            forget_text();
            assert_int_equal(use(volume, &j), LEAFCAST_CORRUPT);
            assert_non_null(strstr(leafcast_error_text(), "fixture"));
            assert_non_null(strstr(leafcast_error_text(), " changed while it was open: "));
            const int fd = open(j.path, O_WRONLY | O_CLOEXEC);
            assert_int_equal(pwrite(fd, bytes, size, 0), (ssize_t)size);
            close(fd);
            assert_int_equal(use(volume, &j), LEAFCAST_CORRUPT);
            leafcast_close(volume);
            volume = fixture_open(j.path, &j.options);
            must_answer(volume, &j, want);
            leafcast_close(volume);
        }
        free(bytes);
        alarm(0);
    }
}

/* ---- Stopping ---- */

typedef struct stopper {
    atomic_int calls;
    int at; /* the call that says stop, from 1 */
} stopper;

static bool stop_at(void *ctx, double done) {
    stopper *s = ctx;
    return done >= 0 && atomic_fetch_add(&s->calls, 1) + 1 < s->at;
}

static void test_stopping(void **state) {
    (void)state;
    static answers a;
    for (int i = 0; i < 2 * KINDS; i += WATCHED_THREADS ? 7 : 1) {
        const kind *how = &kinds[i / 2];
        job j = {.out = &a,
                 .sweep = i % 2,
                 .options = {.size = sizeof(leafcast_options),
                             .experiments = EXPERIMENTS(.treelet_limit = 4),
                             .threads = 3,
                             .backend = how->backend}};
        j.path = leaf_of("waves", 30, how->compressed, &j.iso);
        const hash_id want = clean_answers(j.path, j.iso);
        leafcast *volume = fixture_open(j.path, &j.options);
        int stopped = 0;
        leafcast_status st = LEAFCAST_STOPPED;
        for (int at = 1; st == LEAFCAST_STOPPED; at += 1 + at / (WATCHED ? 1 : 4)) {
            stopper s = {.at = at};
            j.watch = stop_at;
            j.watch_ctx = &s;
            alarm(STUCK_S);
            forget_text();
            assert_int_equal(choose(volume, j.iso), LEAFCAST_OK);
            st = draw(volume, &j);
            if (st == LEAFCAST_STOPPED) {
                /* No more than what the other threads had begun. */
                assert_true(s.calls >= at && s.calls < at + j.options.threads);
                assert_true(leafcast_error_text()[0] != 0);
                stopped++;
            } else {
                assert_int_equal(st, LEAFCAST_OK);
            }
            j.watch = NULL;
            must_answer(volume, &j, want);
        }
        leafcast_close(volume);
        alarm(0);
        print_message("# %s: stopped at %d moments\n", how->name, stopped);
        assert_true(stopped > 3);
    }
}

/* Closing while treelets are on their way. */
static void test_closing_early(void **state) {
    (void)state;
    static answers a;
    for (int i = 0; i < 10 * KINDS; i += NEXT_KIND) {
        const kind *how = &kinds[i % KINDS];
        const belongings before = now_held();
        stopper s = {.at = 1 + i / KINDS};
        job j = {
            .out = &a,
            .sweep = true,
            .watch = stop_at,
            .watch_ctx = &s,
            .options = {.size = sizeof(leafcast_options), .threads = 2, .backend = how->backend}};
        j.path = leaf_of("waves", 30, how->compressed, &j.iso);
        leafcast *volume = fixture_open(j.path, &j.options);
        assert_int_equal(choose(volume, j.iso), LEAFCAST_OK);
        (void)draw(volume, &j);
        leafcast_close(volume);
        nothing_left(before, j.path);
    }
    leafcast_close(NULL);
}

/* ---- Budgets ---- */

static leafcast_status within_budget(job *j, hash_id want) {
    leafcast *volume = NULL;
    forget_text();
    leafcast_status st = leafcast_open(j->path, &j->options, &volume);
    if (st == LEAFCAST_OK)
        st = use(volume, j);
    if (st == LEAFCAST_OK) {
        assert_true(answers_are(j->out, want));
        assert_true(j->stats.bytes_peak <= j->options.memory);
    }
    leafcast_close(volume);
    return st;
}

/* From too little upwards: refused, and from some budget on right; what the refusal names does. */
static void check_budgets(const char *path, leafcast_options options, double iso) {
    static answers a;
    const hash_id want = clean_answers(path, iso);
    int refused = 0, named = 0, drawn = 0;
    job j = {.path = path, .iso = iso, .out = &a, .options = options};
    for (uint64_t memory = 1; drawn < (WATCHED ? 3 : 8);
         memory += 1 + memory / (WATCHED_THREADS ? 1 : 3)) {
        unsigned long long enough = 0;
        alarm(STUCK_S);
        j.options.memory = memory;
        const leafcast_status st = within_budget(&j, want);
        if (st == LEAFCAST_OK) {
            drawn++;
            continue;
        }
        if (st != LEAFCAST_NOMEM)
            fail_msg("%llu bytes: %s", (unsigned long long)memory, leafcast_error_text());
        assert_non_null(strstr(leafcast_error_text(), "memory budget"));
        assert_int_equal(drawn, 0);
        refused++;
        const char *text = strstr(leafcast_error_text(), "picture: ");
        if (!text)
            continue;
        assert_int_equal(sscanf(text, "picture: %llu bytes would do", &enough), 1);
        j.options.memory = enough;
        if (within_budget(&j, want) != LEAFCAST_OK)
            fail_msg("%llu bytes: %s", enough, leafcast_error_text());
        named++;
    }
    alarm(0);
    print_message("# %d budgets refused, %d named one that does\n", refused, named);
    assert_true(refused > 10 && named > 0);
}

static void test_any_memory_budget(void **state) {
    (void)state;
    for (int i = 0; i < KINDS; i += NEXT_KIND)
        for (int threads = WATCHED ? 3 : 1; threads <= 3; threads += 2) {
            double iso = 0;
            const char *path = leaf_of("waves", 30, kinds[i].compressed, &iso);
            const leafcast_options o = {
                .size = sizeof(leafcast_options), .threads = threads, .backend = kinds[i].backend};
            check_budgets(path, o, iso);
        }
}

/* One treelet outweighs all the rays. */
static void test_any_memory_budget_for_large_treelets(void **state) {
    (void)state;
    skip_under_thread();
    field f;
    assert_true(field_make(&f, "waves", 48, FIELD_SEED));
    for (int i = 0; i < KINDS; i++) {
        const leafcast_options o = {
            .size = sizeof(leafcast_options), .threads = 1, .backend = kinds[i].backend};
        check_budgets(fixture_leaf(&f, 6, 1, kinds[i].compressed), o, f.iso);
    }
    field_release(&f);
}

/* ---- Several at once ---- */

typedef struct neighbour {
    job j;
    answers a;
    hash_id want;
    bool right;
    pthread_t thread;
} neighbour;

static bool is_refused(const char *path) {
    char text[64];
    leafcast *volume = NULL;
    if (leafcast_open(path, NULL, &volume) == LEAFCAST_OK || volume)
        return false;
    snprintf(text, sizeof text, "%s", path);
    return strstr(leafcast_error_text(), text) != NULL;
}

static void *live(void *arg) {
    neighbour *n = arg;
    char nowhere[32];
    snprintf(nowhere, sizeof nowhere, "nowhere-%d.leaf", n->j.options.threads);
    n->right = true;
    for (int i = 0; i < 4; i++) {
        leafcast *volume = NULL;
        n->right = n->right && is_refused(nowhere);
        if (leafcast_open(n->j.path, &n->j.options, &volume) != LEAFCAST_OK)
            return n->right = false, NULL;
        for (int frame = 0; frame < 2; frame++)
            n->right = n->right && use(volume, &n->j) == LEAFCAST_OK && answers_are(&n->a, n->want);
        n->right = n->right && strstr(leafcast_error_text(), nowhere);
        leafcast_close(volume);
    }
    return NULL;
}

static void test_two_volumes_at_once(void **state) {
    (void)state;
    static neighbour n[2];
    const leafcast_experiments few = {.size = sizeof few, .treelet_limit = 5};
    for (int i = WATCHED_THREADS; i < KINDS; i += WATCHED_THREADS ? 2 : 1) {
        for (int k = 0; k < 2; k++) {
            n[k] = (neighbour){.j = {.out = &n[k].a,
                                     .options = {.size = sizeof(leafcast_options),
                                                 .experiments = &few,
                                                 .threads = 1 + k,
                                                 .backend = kinds[i].backend}}};
            /* Of the second kind they share a file. */
            n[k].j.path = k && i == 1 ? n[0].j.path
                                      : leaf_of(k && i != 1 ? "sphere" : "waves", 30,
                                                kinds[i].compressed, &n[k].j.iso);
            if (k && i == 1)
                n[k].j.iso = n[0].j.iso;
            n[k].want = clean_answers(n[k].j.path, n[k].j.iso);
        }
        alarm(STUCK_S);
        for (int k = 0; k < 2; k++)
            assert_int_equal(pthread_create(&n[k].thread, NULL, live, &n[k]), 0);
        for (int k = 0; k < 2; k++)
            assert_int_equal(pthread_join(n[k].thread, NULL), 0);
        alarm(0);
        assert_true(n[0].right && n[1].right);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_failing_allocations),
        cmocka_unit_test(test_failing_reads),
        cmocka_unit_test(test_failing_threads),
        cmocka_unit_test(test_damaged_treelet_is_named_when_needed),
        cmocka_unit_test(test_file_truncated_after_opening),
        cmocka_unit_test(test_stopping),
        cmocka_unit_test(test_closing_early),
        cmocka_unit_test(test_any_memory_budget),
        cmocka_unit_test(test_any_memory_budget_for_large_treelets),
        cmocka_unit_test(test_two_volumes_at_once),
        cmocka_unit_test(test_choice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
