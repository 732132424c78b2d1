/* test_readers.c - threads that read for several loaders: who is served first, how many there are,
 * and that nothing of one loader reaches another.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "stream/loader.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_parts.h"

/* Of this process. */
static int threads_here(void) {
    int threads = 0;
    DIR *tasks = opendir("/proc/self/task");
    assert_non_null(tasks);
    while (readdir(tasks))
        threads++;
    closedir(tasks);
    return threads;
}

/* ---- Who is served first ---- */

enum { CUSTOMERS = 3, ITEMS = 8, NOTES = CUSTOMERS * ITEMS };

/* What all customers share: the order in which their items were read, behind a gate. */
typedef struct diary {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool open;
    int waiting; /* reads at the gate */
    int count;
    uint64_t priority[NOTES];
    int customer[NOTES];
} diary;

/* A customer with items that are urgent in the order in which they stand. */
typedef struct shopper {
    readers *readers;
    reader_customer customer;
    diary *diary;
    int index, count, next;
    uint64_t priority[ITEMS];
} shopper;

static void tell(shopper *s) {
    readers_tell(s->readers, &s->customer, s->next < s->count,
                 s->next < s->count ? s->priority[s->next] : 0);
}

static void read_item(void *ctx) {
    shopper *s = ctx;
    diary *d = s->diary;
    pthread_mutex_lock(&d->lock);
    if (s->next < s->count) {
        d->priority[d->count] = s->priority[s->next++];
        d->customer[d->count++] = s->index;
        d->waiting++;
        tell(s);
        pthread_cond_broadcast(&d->changed);
        while (!d->open)
            pthread_cond_wait(&d->changed, &d->lock);
        d->waiting--;
    }
    tell(s);
    pthread_cond_broadcast(&d->changed);
    pthread_mutex_unlock(&d->lock);
}

static void diary_begin(diary *d) {
    *d = (diary){.open = false};
    pthread_mutex_init(&d->lock, NULL);
    pthread_cond_init(&d->changed, NULL);
}

static void diary_end(diary *d) {
    pthread_cond_destroy(&d->changed);
    pthread_mutex_destroy(&d->lock);
}

static void shopper_add(shopper *s, uint64_t priority) {
    pthread_mutex_lock(&s->diary->lock);
    s->priority[s->count++] = priority;
    tell(s);
    pthread_mutex_unlock(&s->diary->lock);
}

static void wait_for_gate(diary *d, int readers_there) {
    pthread_mutex_lock(&d->lock);
    while (d->waiting < readers_there)
        pthread_cond_wait(&d->changed, &d->lock);
    pthread_mutex_unlock(&d->lock);
}

static void open_gate(diary *d, int until) {
    pthread_mutex_lock(&d->lock);
    d->open = true;
    pthread_cond_broadcast(&d->changed);
    while (d->count < until || d->waiting > 0)
        pthread_cond_wait(&d->changed, &d->lock);
    pthread_mutex_unlock(&d->lock);
}

static void shoppers_join(shopper s[], readers *r, diary *d, int threads) {
    for (int i = 0; i < CUSTOMERS; i++) {
        s[i] = (shopper){.readers = r, .diary = d, .index = i};
        s[i].customer = (reader_customer){.read = read_item, .ctx = &s[i]};
        assert_int_equal(readers_join(r, &s[i].customer, threads), ST_OK);
    }
}

static void shoppers_leave(shopper s[]) {
    for (int i = 0; i < CUSTOMERS; i++)
        readers_leave(s[i].readers, &s[i].customer);
}

/* One thread is held up while others' wishes come in: then the most urgent comes first, whoever's
 * it is. */
static void test_urgency(void **state) {
    (void)state;
    mem m;
    readers *r;
    diary d;
    shopper s[CUSTOMERS];
    mem_init(&m, 0);
    diary_begin(&d);
    assert_int_equal(readers_create(&m, &r), ST_OK);
    shoppers_join(s, r, &d, 1);
    shopper_add(&s[0], 50);
    wait_for_gate(&d, 1);
    for (uint64_t k = 0; k < 5; k++)
        for (int i = 0; i < CUSTOMERS; i++)
            shopper_add(&s[i], 10 * k + (uint64_t)(7 * i + 3) % 10);
    open_gate(&d, 16);
    for (int i = 2; i < d.count; i++)
        assert_true(d.priority[i - 1] < d.priority[i]);
    shoppers_leave(s);
    readers_destroy(r);
    diary_end(&d);
    assert_int_equal(mem_used(&m), 0);
}

/* Equally urgent: in turns. */
static void test_turns(void **state) {
    (void)state;
    mem m;
    readers *r;
    diary d;
    shopper s[CUSTOMERS];
    mem_init(&m, 0);
    diary_begin(&d);
    assert_int_equal(readers_create(&m, &r), ST_OK);
    shoppers_join(s, r, &d, 1);
    shopper_add(&s[0], 0);
    wait_for_gate(&d, 1);
    for (int i = 0; i < CUSTOMERS; i++)
        for (int k = 0; k < 6; k++)
            shopper_add(&s[i], UINT64_MAX);
    open_gate(&d, 19);
    for (int i = 1; i + CUSTOMERS <= d.count; i += CUSTOMERS) {
        unsigned seen = 0;
        for (int k = 0; k < CUSTOMERS; k++)
            seen |= 1u << d.customer[i + k];
        assert_int_equal(seen, (1u << CUSTOMERS) - 1);
    }
    shoppers_leave(s);
    readers_destroy(r);
    diary_end(&d);
    assert_int_equal(mem_used(&m), 0);
}

/* As many threads as the customer with the most asked for, all at work at once; a thread that
 * cannot be created is told of. */
static void test_threads(void **state) {
    (void)state;
    enum { THREADS = 5 };
    mem m;
    readers *r;
    diary d;
    shopper s[CUSTOMERS], more;
    mem_init(&m, 0);
    diary_begin(&d);
    assert_int_equal(readers_create(&m, &r), ST_OK);
    const int before = threads_here();
    shoppers_join(s, r, &d, 2);
    assert_int_equal(threads_here() - before, 2);
    more = (shopper){.readers = r, .diary = &d};
    more.customer = (reader_customer){.read = read_item, .ctx = &more};
    fault_arm(FAULT_THREAD, 2);
    assert_int_equal(readers_join(r, &more.customer, THREADS), ST_NOMEM);
    assert_true(fault_fired(FAULT_THREAD));
    fault_arm(FAULT_THREAD, 0);
    assert_int_equal(threads_here() - before, 3);
    assert_int_equal(readers_join(r, &more.customer, THREADS), ST_OK);
    assert_int_equal(threads_here() - before, THREADS);
    for (int i = 0; i < ITEMS; i++)
        shopper_add(&s[i % 2], 1);
    wait_for_gate(&d, THREADS);
    open_gate(&d, ITEMS);
    readers_leave(r, &more.customer);
    shoppers_leave(s);
    readers_destroy(r);
    diary_end(&d);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- Loaders ---- */

enum { WORKERS = 2 };

typedef struct stage {
    mem m;
    leaf_file *f;
    loader *l;
} stage;

static void stage_open(stage *s, const char *path, readers *r, int workers) {
    const loader_options o = {.source = SOURCE_ARENA, .workers = workers, .isa = CPU_SCALAR};
    static const double isos[] = {80.0, 120.0, 150.0};
    const interest in = interest_of_isovalues(isos, 3);
    mem_init(&s->m, 0);
    assert_int_equal(leaf_file_open(&s->m, path, &s->f), ST_OK);
    assert_int_equal(loader_create(&s->m, s->f, &o, r, &s->l), ST_OK);
    loader_set_capacity(s->l, s->f->layout.treelets, 0);
    loader_select(s->l, &in);
    assert_true(s->l->treelets_active > 50);
}

static void stage_close(stage *s) {
    loader_destroy(s->l);
    leaf_file_close(s->f);
    assert_int_equal(mem_used(&s->m), 0);
}

static const char *make_file(const char *name, uint32_t nx, uint64_t seed) {
    leaf_case c = leaf_files_case(nx, 70, 45, SAMPLE_U8);
    void *samples = leaf_files_random(&c, seed, 0);
    c.samples = samples;
    const char *path = leaf_files_make(&c, name);
    free(samples);
    return path;
}

static uint32_t ready(const stage *s) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < s->f->layout.treelets; t++)
        count += loader_lookup(s->l, t) != NULL;
    return count;
}

static void assert_complete(stage *s) {
    assert_int_equal(loader_settle(s->l), ST_OK);
    assert_int_equal(ready(s), s->l->treelets_active);
    assert_int_equal(loader_statistics(s->l).loads, s->l->treelets_active);
}

/* Both get all that they want, by the threads of one. */
static void test_two_loaders(void **state) {
    (void)state;
    stage a, b;
    char path[2][256];
    snprintf(path[0], sizeof path[0], "%s", make_file("readers_a.leaf", 100, FIELD_SEED));
    snprintf(path[1], sizeof path[1], "%s", make_file("readers_b.leaf", 80, FIELD_SEED + 1));
    const int before = threads_here();
    stage_open(&a, path[0], NULL, WORKERS);
    readers *r = loader_readers(a.l);
    stage_open(&b, path[1], r, 1);
    assert_ptr_equal(loader_readers(b.l), r);
    assert_int_equal(threads_here() - before, WORKERS);
    loader_sweep(b.l);
    loader_sweep(a.l);
    assert_complete(&a);
    assert_complete(&b);
    stage_close(&b);
    stage_close(&a);
}

/* Damage what the file holds of a treelet. */
static uint32_t damage(const char *path) {
    mem m;
    leaf_file *f;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    uint32_t t = f->layout.treelets / 2;
    while (f->sizes[t] == 0)
        t++;
    leaf_parts_damage(path, f->offsets[t] + f->sizes[t] / 2);
    leaf_file_close(f);
    return t;
}

/* What fails of one loader is no trouble of the other, and both go on. */
static void test_failures_apart(void **state) {
    (void)state;
    stage sound, broken;
    char path[2][256];
    mem m;
    readers *r;
    snprintf(path[0], sizeof path[0], "%s", make_file("readers_a.leaf", 100, FIELD_SEED));
    snprintf(path[1], sizeof path[1], "%s", make_file("readers_b.leaf", 80, FIELD_SEED + 1));
    const uint32_t bad = damage(path[1]);
    mem_init(&m, 0);
    assert_int_equal(readers_create(&m, &r), ST_OK);
    stage_open(&sound, path[0], r, WORKERS);
    stage_open(&broken, path[1], r, WORKERS);
    for (int round = 0; round < 3; round++) {
        loader_request request = {bad, 0};
        loader_sweep(sound.l);
        assert_int_equal(loader_admit(broken.l, &request, 1), ST_CORRUPT);
        loader_sweep(broken.l);
        assert_int_equal(loader_settle(broken.l), ST_CORRUPT);
        assert_complete(&sound);
        assert_int_equal(loader_failure(sound.l), ST_OK);
        loader_forget_failures(broken.l);
        assert_int_equal(loader_failure(broken.l), ST_OK);
        assert_null(loader_lookup(broken.l, bad));
    }
    stage_close(&sound);
    stage_close(&broken);
    readers_destroy(r);
    assert_int_equal(mem_used(&m), 0);
}

/* One goes while both read: it waits for its own reads alone, and gives all its memory back. */
static void test_leave_early(void **state) {
    (void)state;
    enum { ROUNDS = 12 };
    stage stays, goes;
    char path[2][256];
    snprintf(path[0], sizeof path[0], "%s", make_file("readers_a.leaf", 100, FIELD_SEED));
    snprintf(path[1], sizeof path[1], "%s", make_file("readers_b.leaf", 80, FIELD_SEED + 1));
    for (int round = 0; round < ROUNDS; round++) {
        stage_open(&stays, path[0], NULL, WORKERS + 1);
        stage_open(&goes, path[1], loader_readers(stays.l), 1 + round % 2);
        fault_delay(FAULT_READ, 300);
        loader_sweep(stays.l);
        loader_sweep(goes.l);
        while (loader_statistics(goes.l).loads <= (uint64_t)round) {}
        stage_close(&goes);
        fault_delay(FAULT_READ, 0);
        assert_complete(&stays);
        stage_close(&stays);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_urgency),        cmocka_unit_test(test_turns),
        cmocka_unit_test(test_threads),        cmocka_unit_test(test_two_loaders),
        cmocka_unit_test(test_failures_apart), cmocka_unit_test(test_leave_early)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
