/* test_convert_resume.c - conversions that end in the midst and are gone on with: whatever a crash
 * leaves on the disk is nothing, work that a later run ends with the same bytes, or the whole file.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "formats/base/fault.h"
#include "formats/base/partial.h"
#include "formats/base/work_folder.h"
#include "tests/support/disk_calls.h"
#include "tests/support/leaf_files.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* A volume of several slabs and levels, whose conversion saves all that it can. */
typedef struct subject {
    leaf_case c;
    void *samples;
    mem m;
    convert_job job;
    char *good; /* what it becomes */
    size_t size;
} subject;

static status convert(subject *s, work_found found, const char *name) {
    work_folder *w = NULL;
    mem m;
    mem_init(&m, 0);
    s->c.options.work = NULL;
    s->c.options.job = &s->job;
    status st = work_folder_open(&m, scratch_path(name), found, 0, &w);
    s->c.options.work = w;
    if (st == ST_OK && !work_folder_published(w))
        st = leaf_files_try(&s->m, &s->c, name, NULL, NULL);
    work_folder_close(w, st != ST_OK);
    s->c.options.work = NULL;
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void begin_of(subject *s, sample_type type, leaf_codec codec, bool bare) {
    *s = (subject){.c = leaf_files_case(24, 20, 110, type)};
    mem_init(&s->m, 0);
    s->c.options.file.codec = codec;
    s->c.options.file.bare = bare;
    s->c.options.file.zstd_level = 1;
    s->c.options.file.histograms = s->c.options.file.deviations = true;
    s->samples = leaf_files_random(&s->c, 11, type == SAMPLE_F32 ? 50 : 0);
    s->c.samples = s->samples;
    assert_int_equal(convert_job_init(&s->job, &s->m, "output"), ST_OK);
    s->good = scratch_read(leaf_files_make(&s->c, "good.leaf"), &s->size);
}

static void begin(subject *s, sample_type type, leaf_codec codec) {
    begin_of(s, type, codec, false);
}

static void end(subject *s) {
    convert_job_release(&s->job);
    free(s->samples);
    free(s->good);
    assert_int_equal(mem_used(&s->m), 0);
}

static void check_output(const subject *s, const char *name) {
    size_t size;
    char *made = scratch_read(scratch_path(name), &size);
    assert_int_equal(size, s->size);
    assert_memory_equal(made, s->good, size);
    free(made);
}

static bool is_there(const char *name) {
    return access(scratch_path(name), F_OK) == 0;
}

/* ---- crashes ---- */

/* What is there after a crash is as it should be; going on gives the whole file, and nothing else.
 */
static void check_crash(subject *s, size_t count, uint64_t seed) {
    uint64_t bytes;
    assert_int_equal(mkdir(scratch_path("crash"), 0777), 0);
    disk_log_replay(count, seed, scratch_path("crash"));
    const bool whole = is_there("crash/x.leaf");
    if (whole)
        check_output(s, "crash/x.leaf");
    status st = convert(s, WORK_RESUME, "crash/x.leaf");
    if (st != ST_OK && !(whole && st == ST_EXISTS))
        fail_msg("after %zu calls, seed %llu: %s", count, (unsigned long long)seed, status_text());
    check_output(s, "crash/x.leaf");
    assert_false(is_there("crash/x.leaf.unfinished/output"));
    assert_true(partial_remove_folder(scratch_path("crash"), &bytes));
    assert_int_equal(bytes, s->size);
}

static void test_crashes(void **state) {
    (void)state;
    enum { CHANCES = WATCHED ? 1 : 3 };
    static const struct {
        sample_type type;
        leaf_codec codec;
        bool bare;
    } cases[] = {{SAMPLE_U8, LEAF_CODEC_RAW, false},
                 {SAMPLE_F32, LEAF_CODEC_ZSTD, false},
                 {SAMPLE_U16, LEAF_CODEC_RAW, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        subject s;
        begin_of(&s, cases[i].type, cases[i].codec, cases[i].bare);
        assert_int_equal(mkdir(scratch_path("disk"), 0777), 0);
        disk_log_begin(scratch_path("disk"));
        assert_int_equal(convert(&s, WORK_REFUSE, "disk/x.leaf"), ST_OK);
        const size_t calls = disk_log_end();
        check_output(&s, "disk/x.leaf");
        assert_true(calls > 50);
        /* Behind each call the same is done: going on from what is there. */
        for (size_t count = WATCHED ? i : 0; count <= calls; count += WATCHED ? 5 : 1) {
            check_crash(&s, count, 0);
            for (uint64_t chance = 1; chance <= CHANCES; chance++)
                check_crash(&s, count, count * CHANCES + chance);
        }
        uint64_t bytes;
        assert_true(partial_remove_folder(scratch_path("disk"), &bytes));
        disk_log_release();
        end(&s);
    }
}

/* ---- states ---- */

/* Leave work whose last state was saved at the end of the input: the output exists meanwhile. */
static void leave_work(subject *s) {
    const bool force = s->c.options.force;
    taken = scratch_path("w.leaf");
    s->c.options.force = false;
    assert_int_equal(convert(s, WORK_REMOVE, "w.leaf"), ST_EXISTS);
    s->c.options.force = force;
    assert_null(taken);
    assert_int_equal(unlink(scratch_path("w.leaf")), 0);
}

static void flip(const char *name, size_t at) {
    size_t size;
    char *bytes = scratch_read(scratch_path(name), &size);
    assert_true(at < size);
    bytes[at] ^= 0x10;
    scratch_write(name, bytes, size);
    free(bytes);
}

/* A state that is damaged is none: the one before it is taken, or the work begins again. */
static void test_damaged_states(void **state) {
    (void)state;
    static const char *const names[] = {"w.leaf.unfinished/state-0", "w.leaf.unfinished/state-1"};
    static const size_t places[] = {0, 9, 16, 24, 33, 64, 65, 5000};
    subject s;
    begin(&s, SAMPLE_I16, LEAF_CODEC_ZSTD);
    for (size_t i = 0; i < sizeof places / sizeof *places; i += WATCHED ? 3 : 1)
        for (int which = 1; which <= 3; which++) {
            leave_work(&s);
            for (int n = 0; n < 2; n++)
                if (which >> n & 1)
                    flip(names[n], places[i]);
            assert_int_equal(convert(&s, WORK_REFUSE, "w.leaf"), which == 3 ? ST_OK : ST_EXISTS);
            if (!is_there("w.leaf"))
                assert_int_equal(convert(&s, WORK_RESUME, "w.leaf"), ST_OK);
            check_output(&s, "w.leaf");
            assert_false(is_there("w.leaf.unfinished"));
            (void)unlink(scratch_path("w.leaf"));
        }
    end(&s);
}

/* Files that are shorter than the state says are a fault, and stay as they are. */
static void test_short_output(void **state) {
    (void)state;
    subject s;
    begin(&s, SAMPLE_U8, LEAF_CODEC_RAW);
    leave_work(&s);
    assert_int_equal(truncate(scratch_path("w.leaf.unfinished/output"), 9000), 0);
    assert_int_equal(convert(&s, WORK_RESUME, "w.leaf"), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "is not what this program wrote there"));
    assert_int_equal(convert(&s, WORK_REMOVE, "w.leaf"), ST_OK);
    check_output(&s, "w.leaf");
    (void)unlink(scratch_path("w.leaf"));
    end(&s);
}

/* Any write or sync may fail, any memory be refused, also of a run that goes on. */
static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_WRITE, FAULT_ALLOC, FAULT_READ};
    subject s;
    begin(&s, SAMPLE_U16, LEAF_CODEC_ZSTD);
    s.c.options.threads = 1;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        bool fired = true;
        for (long k = 1; fired; k += 1 + k / (WATCHED ? 2 : 6)) {
            fault_arm(kinds[i], k);
            status st = convert(&s, WORK_REFUSE, "f.leaf");
            fired = fault_fired(kinds[i]);
            for (long again = 1; st != ST_OK; again *= 3) {
                fault_arm(kinds[i], again);
                st = convert(&s, WORK_RESUME, "f.leaf");
                fault_arm(kinds[i], 0);
                assert_true(again < 1 << 20);
            }
            fault_arm(kinds[i], 0);
            check_output(&s, "f.leaf");
            assert_false(is_there("f.leaf.unfinished"));
            (void)unlink(scratch_path("f.leaf"));
        }
    }
    end(&s);
}

/* The work is as much as is held in other ways: a run with little memory goes on with that of one
 * with much, and the other way round. */
static void test_other_memory(void **state) {
    (void)state;
    subject s;
    begin(&s, SAMPLE_F32, LEAF_CODEC_RAW);
    const uint64_t much = s.c.options.memory;
    s.c.options.threads = 1;
    const uint64_t little = leaf_files_least(&s.c) + (256 << 10);
    for (int which = 0; which < 2; which++)
        for (long k = 20; k < 400; k += WATCHED ? 57 : 19) {
            s.c.options.memory = which ? little : much;
            fault_arm(FAULT_WRITE, k);
            const status st = convert(&s, WORK_REFUSE, "o.leaf");
            fault_arm(FAULT_WRITE, 0);
            s.c.options.memory = which ? much : little;
            if (st != ST_OK)
                assert_int_equal(convert(&s, WORK_RESUME, "o.leaf"), ST_OK);
            check_output(&s, "o.leaf");
            (void)unlink(scratch_path("o.leaf"));
        }
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crashes), cmocka_unit_test(test_damaged_states),
        cmocka_unit_test(test_short_output), cmocka_unit_test(test_faults),
        cmocka_unit_test(test_other_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
