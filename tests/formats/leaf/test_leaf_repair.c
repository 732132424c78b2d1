/* test_leaf_repair.c - files damaged in each of their parts are mended from another copy, to the
 * bit; what cannot be is named, and nothing is written. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_damage.h"
#include "formats/leaf/leaf_repair.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/coarse_hexes.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_parts.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/mesh_grown.h"
#include "tests/support/scratch.h"

static mem m;
static char said[STATUS_TEXT_MAX]; /* by the last repair */

/* ---- sound files ---- */

typedef struct sound {
    const char *name;
    char *bytes;
    size_t size;
    leaf_parts parts;
} sound;

static sound sound_of(const char *name, const char *path) {
    sound s = {.name = name, .parts = leaf_parts_of(path)};
    s.bytes = scratch_read(path, &s.size);
    return s;
}

static void release(sound *s) {
    free(s->bytes);
    free(s->parts.all);
}

static sound grid_file(const char *name, leaf_codec codec, uint64_t seed) {
    leaf_case c = leaf_files_case(40, 38, 20, codec == LEAF_CODEC_RAW ? SAMPLE_U8 : SAMPLE_F32);
    void *samples = leaf_files_random(&c, seed, 200);
    c.samples = samples;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 3;
    c.options.force = true;
    const sound s = sound_of(name, leaf_files_make(&c, "sound.leaf"));
    free(samples);
    return s;
}

/* Two fields, of the same samples, at two steps; the second has payloads without bytes alone. */
static sound sets_file(void) {
    static const char *const names[] = {"speed", "heat"};
    static const double times[] = {1, 2};
    leaf_case c = leaf_files_case(20, 19, 18, SAMPLE_U8);
    uint8_t *samples = leaf_files_random(&c, 5, 0);
    const size_t size = 20 * 19 * 18;
    const char *paths[2] = {scratch_write("step0.bin", samples, size)};
    memset(samples, 7, size);
    paths[1] = scratch_write("step1.bin", samples, size);
    grid_series of = {.of = {.paths = paths, .sets = {2, 2, names, times, NULL}},
                      .hints = {.dims = {20, 19, 18}, .type = SAMPLE_U8}};
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    c.options.file.codec = LEAF_CODEC_ZSTD;
    c.options.series = &of;
    c.options.force = true;
    const char *path = scratch_path("sound.leaf");
    assert_int_equal(grid_series_open(&m, &of, 0, &v), ST_OK);
    assert_int_equal(convert_plan_make(&m, volume_grid(v), &c.options, &plan), ST_OK);
    assert_int_equal(convert_run(&m, v, path, &c.options, &plan, NULL, &result), ST_OK);
    volume_close(v);
    free(samples);
    return sound_of("several sets", path);
}

static sound mesh_file(const char *name, leaf_codec codec) {
    mesh_case c = mesh_cases_kuhn(9, 8, 7);
    mesh_result r;
    c.options.file.codec = codec;
    c.options.treelet_tets = 300;
    c.options.gradients = true;
    c.options.coarse = true;
    c.options.coarse_dims = 20;
    if (mesh_cases_convert(&m, &c, "sound.leaf", 0, &r) != ST_OK)
        fail_msg("%s", status_text());
    mesh_cases_free(&c);
    return sound_of(name, scratch_path("sound.leaf"));
}

/* Two steps of hexahedra. */
static sound hexes_file(const char *name, bool whole, uint32_t dims) {
    coarse_hexes c = coarse_hexes_of(whole, 8, dims);
    c.steps = 2;
    if (coarse_hexes_convert(&m, &c, "sound.leaf") != ST_OK)
        fail_msg("%s", status_text());
    return sound_of(name, scratch_path("sound.leaf"));
}

/* A grid of two steps and two more that were added. */
static sound grown_file(void) {
    leaf_steps s;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    grid_series of = s.of;
    convert_options o = s.c.options;
    o.grows = true;
    of.of.sets.steps = 1;
    const char *path = leaf_files_series(&of, &o, "sound.leaf");
    of.of.paths += 4;
    of.of.sets.steps = 2;
    assert_int_equal(leaf_files_add(&of, &s.c.options, path), ST_OK);
    leaf_steps_release(&s);
    return sound_of("grown grid", path);
}

enum { KINDS = 10, COARSE = 3, GROWN = 8 }; /* from COARSE to GROWN: with coarse grids */
static sound make(int kind) {
    switch (kind) {
    case 0: return grid_file("raw grid", LEAF_CODEC_RAW, 1);
    case 1: return grid_file("compressed grid", LEAF_CODEC_ZSTD, 1);
    case 2: return sets_file();
    case 3: return mesh_file("raw mesh", LEAF_CODEC_RAW);
    case 4: return mesh_file("compressed mesh", LEAF_CODEC_ZSTD);
    case 5: return hexes_file("curvilinear grid", false, 20);
    case 6: return hexes_file("curvilinear grid, thinned", false, 0);
    case 7: return hexes_file("whole cells", true, 20);
    case 8: return grown_file();
    default: return sound_of("grown mesh", mesh_grown_make(8, 2, LEAF_CODEC_RAW, "sound.leaf"));
    }
}

/* ---- damage and repair ---- */

static void write_copies(const sound *s) {
    scratch_write("bad.leaf", s->bytes, s->size);
    scratch_write("from.leaf", s->bytes, s->size);
}

static void flip(const char *name, uint64_t at) {
    FILE *f = fopen(scratch_path(name), "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    const int was = fgetc(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    assert_true(was != EOF && fputc(was ^ 0x41, f) != EOF);
    assert_int_equal(fclose(f), 0);
}

static void flip_part(const char *name, leaf_range r, uint64_t byte) {
    flip(name, r.at + byte % r.bytes);
}

static status repair_with(mem *with, bool in_place, const progress *p, leaf_repair_result *result) {
    const leaf_repair_job job = {.bad = scratch_path("bad.leaf"),
                                 .from = scratch_path("from.leaf"),
                                 .output = in_place ? NULL : scratch_path("made.leaf"),
                                 .threads = 2,
                                 .progress = p};
    const status st = leaf_repair(with, &job, result);
    snprintf(said, sizeof said, "%s", status_text());
    if (mem_used(with))
        fail_msg("%zu bytes left in memory", mem_used(with));
    return st;
}

/* Bad is mended to the sound file, and the copies stay as they are. */
static leaf_repair_result mended(const sound *s, const char *what) {
    leaf_repair_result result;
    size_t before_size, size;
    char *before = scratch_read(scratch_path("bad.leaf"), &before_size);
    if (repair_with(&m, false, NULL, &result) != ST_OK)
        fail_msg("%s, %s: %s", s->name, what, said);
    char *made = scratch_read(scratch_path("made.leaf"), &size);
    if (size != s->size || memcmp(made, s->bytes, size) != 0)
        fail_msg("%s, %s: other bytes than the sound file's", s->name, what);
    assert_int_equal(unlink(scratch_path("made.leaf")), 0);
    free(made);
    char *after = scratch_read(scratch_path("bad.leaf"), &size);
    assert_int_equal(size, before_size);
    assert_memory_equal(before, after, size);
    free(before);
    free(after);
    return result;
}

/* Refused with this status, a message that holds this text, and nothing written. */
static void refused(status want, const char *text, bool in_place) {
    leaf_repair_result result;
    size_t before_size, size;
    const size_t files = scratch_count();
    char *before = scratch_read(scratch_path("bad.leaf"), &before_size);
    const status st = repair_with(&m, in_place, NULL, &result);
    if (st != want || !strstr(said, text))
        fail_msg("expected %d with \"%s\", found %d: %s", want, text, st, said);
    char *after = scratch_read(scratch_path("bad.leaf"), &size);
    assert_int_equal(size, before_size);
    assert_memory_equal(before, after, size);
    assert_int_equal(scratch_count(), files);
    free(before);
    free(after);
}

/* ---- tests ---- */

/* Each part, damaged in bad, and then in the other copy too where bad is sound. */
static void check_parts(const sound *s) {
    const size_t count = s->parts.count;
    for (size_t i = 0; i < count; i += i < 30 ? 1 : 5) {
        write_copies(s);
        flip_part("bad.leaf", s->parts.all[i], i * 7919);
        flip_part("from.leaf", s->parts.all[(i + 1) % count], i * 104729);
        const bool payload = s->parts.all[i].kind == PART_PAYLOAD;
        const leaf_repair_result r = mended(s, "one part");
        assert_true(r.mended);
        assert_int_equal(r.payloads[LEAF_REPAIR_FROM], payload);
        assert_int_equal(r.directory[LEAF_REPAIR_FROM], !payload);
        assert_int_equal(r.payloads[0] + r.payloads[1] + r.directory[0] + r.directory[1], count);
        assert_int_equal(r.gaps, 0);
    }
    /* Half of them in either. */
    write_copies(s);
    for (size_t i = 0; i < count; i++)
        flip_part(i % 2 ? "bad.leaf" : "from.leaf", s->parts.all[i], 3);
    mended(s, "every part in one of the copies");
}

static void test_parts(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        sound s = make(kind);
        check_parts(&s);
        release(&s);
    }
}

static void test_gaps(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        sound s = make(kind);
        write_copies(&s);
        const leaf_repair_result none = mended(&s, "nothing");
        assert_false(none.mended);
        flip("bad.leaf", leaf_parts_gap(&s.parts));
        flip("from.leaf", leaf_parts_gap(&s.parts));
        const leaf_repair_result r = mended(&s, "a gap in both");
        assert_int_equal(r.gaps, 1);
        assert_true(r.mended);
        release(&s);
    }
}

static void test_lengths(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        sound s = make(kind);
        const uint64_t table = leaf_parts_find(&s.parts, PART_TABLE, false, 0).at;
        const uint64_t payload = leaf_parts_find(&s.parts, PART_PAYLOAD, false, 1).at;
        const uint64_t cuts[] = {table,       table + 5,  payload - 1,
                                 payload + 5, s.size / 2, s.size - 1};
        for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
            write_copies(&s);
            scratch_write("bad.leaf", s.bytes, cuts[i]);
            mended(&s, "cut short");
            /* The other is what is cut, and bad has another header. */
            write_copies(&s);
            scratch_write("from.leaf", s.bytes, cuts[i]);
            flip("bad.leaf", 300);
            mended(&s, "the other one cut short");
        }
        char *longer = calloc(1, s.size + 5);
        memcpy(longer, s.bytes, s.size);
        scratch_write("bad.leaf", longer, s.size + 5);
        scratch_write("from.leaf", longer, s.size + 3);
        /* Behind a file that grows may be what does not count. */
        assert_int_equal(mended(&s, "longer").gaps, kind < GROWN);
        free(longer);
        release(&s);
    }
}

/* How many parts have changed bytes, or are cut, in both copies. */
static size_t count_lost(const sound *s) {
    size_t lost = 0, size[2];
    char *copy[2] = {scratch_read(scratch_path("bad.leaf"), &size[0]),
                     scratch_read(scratch_path("from.leaf"), &size[1])};
    for (size_t i = 0; i < s->parts.count; i++) {
        const leaf_range *r = &s->parts.all[i];
        bool good = false;
        for (int k = 0; k < 2; k++)
            good |= r->at + r->bytes <= size[k] &&
                    memcmp(copy[k] + r->at, s->bytes + r->at, r->bytes) == 0;
        lost += !good;
    }
    free(copy[0]);
    free(copy[1]);
    return lost;
}

/* Bytes at random, of payloads; the parts that are damaged in both are told. */
static void test_random(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    size_t refusals = 0;
    for (int kind = 0; kind < KINDS; kind++) {
        sound s = make(kind);
        const uint64_t first = leaf_parts_find(&s.parts, PART_PAYLOAD, false, 0).at;
        const uint64_t table = leaf_parts_find(&s.parts, PART_TABLE, false, 0).at;
        const uint64_t end = table > first ? table : s.size;
        for (int round = 0; round < 40; round++) {
            char text[64];
            write_copies(&s);
            for (int i = 0; i < 2 * round; i++)
                flip(i % 2 ? "bad.leaf" : "from.leaf",
                     first + (uint64_t)field_random_below(&r, (int)(end - first)));
            const size_t lost = count_lost(&s);
            /* In a coarse grid or a segment without its directory, nobody knows of payloads. */
            const bool counted = kind < COARSE;
            snprintf(text, sizeof text, "%zu parts are damaged in both", lost);
            refusals += lost > 0;
            if (!lost)
                mended(&s, "at random");
            else
                refused(ST_CORRUPT, counted ? text : "damaged in both", false);
        }
        release(&s);
    }
    assert_in_range(refusals, 5, 40 * KINDS - 5);
}

static void test_lost(void **state) {
    (void)state;
    sound s = grid_file("compressed grid", LEAF_CODEC_ZSTD, 1);
    write_copies(&s);
    for (size_t i = 4; i < 6; i++) {
        flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_PAYLOAD, false, i), 7);
        flip_part("from.leaf", leaf_parts_find(&s.parts, PART_PAYLOAD, false, i), 9);
    }
    refused(ST_CORRUPT, "2 parts are damaged in both", false);
    refused(ST_CORRUPT, ": treelet 9's payload, treelet 10's payload", true);
    for (size_t i = 0; i < s.parts.count; i++)
        if (s.parts.all[i].kind == PART_PAYLOAD) {
            flip_part("bad.leaf", s.parts.all[i], 11);
            flip_part("from.leaf", s.parts.all[i], 11);
        }
    refused(ST_CORRUPT, " more", true);
    write_copies(&s);
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_SECTION, false, 3), 0);
    flip_part("from.leaf", leaf_parts_find(&s.parts, PART_SECTION, false, 3), 1);
    refused(ST_CORRUPT, "section 4", true);
    write_copies(&s);
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_TABLE, false, 0), 0);
    flip_part("from.leaf", leaf_parts_find(&s.parts, PART_TABLE, false, 0), 1);
    refused(ST_CORRUPT, "the section table", true);
    write_copies(&s);
    flip("bad.leaf", 30);
    flip("from.leaf", 40);
    refused(ST_CORRUPT, "the headers of both copies are damaged", true);
    release(&s);
}

static void test_lost_coarse(void **state) {
    (void)state;
    static const struct {
        leaf_range_kind kind;
        const char *name;
    } cases[] = {{PART_HEADER, "coarse grid of set 0: its header"},
                 {PART_TABLE, "coarse grid of set 0: the section table"},
                 {PART_SECTION, "coarse grid of set 0: section 1"},
                 {PART_PAYLOAD, "coarse grid of set 0: treelet 0's payload"}};
    sound s = mesh_file("mesh", LEAF_CODEC_RAW);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_copies(&s);
        flip_part("bad.leaf", leaf_parts_find(&s.parts, cases[i].kind, true, 0), 20);
        flip_part("from.leaf", leaf_parts_find(&s.parts, cases[i].kind, true, 0), 21);
        refused(ST_CORRUPT, cases[i].name, true);
    }
    release(&s);
}

/* Copies of different times. */
static void test_grown(void **state) {
    (void)state;
    sound s = grown_file();
    const leaf_header *h = (const leaf_header *)(const void *)s.bytes;
    const uint64_t later = h->last, payload = later + LEAF_HEADER_BYTES;
    write_copies(&s);
    flip("bad.leaf", payload);
    flip("from.leaf", payload);
    refused(ST_CORRUPT, "segment 1: treelet ", true);
    write_copies(&s);
    flip("bad.leaf", later + 20);
    flip("from.leaf", later + 20);
    refused(ST_CORRUPT, "segment 1: its header", true);
    /* The other one is from before the last steps came. */
    char *early = malloc(later);
    memcpy(early, s.bytes, later);
    leaf_header *first = (leaf_header *)(void *)early;
    first->segments = 1;
    first->last = 0;
    first->checksum = leaf_header_checksum(first);
    write_copies(&s);
    scratch_write("from.leaf", early, later);
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_PAYLOAD, false, 2), 5);
    mended(&s, "an earlier copy");
    flip("bad.leaf", 300);
    refused(ST_CORRUPT, "that may lack steps that were added since", true);
    free(early);
    release(&s);
}

static void test_other_file(void **state) {
    (void)state;
    char id[LEAF_ID_TEXT];
    sound s = grid_file("grid", LEAF_CODEC_RAW, 1), other = grid_file("other", LEAF_CODEC_RAW, 2);
    write_copies(&s);
    scratch_write("from.leaf", other.bytes, other.size);
    refused(ST_USAGE, leaf_id_text((const leaf_header *)(const void *)other.bytes, id), true);
    refused(ST_USAGE, leaf_id_text((const leaf_header *)(const void *)s.bytes, id), false);
    /* A damaged header must not make it a copy of the other. */
    flip("bad.leaf", 300);
    refused(ST_CORRUPT, "nothing else tells", true);
    scratch_text("bad.leaf", "");
    refused(ST_CORRUPT, "nothing else tells", true);
    /* Without its id, the checksums tell; without those, the payloads. */
    write_copies(&s);
    flip("bad.leaf", offsetof(leaf_header, id));
    mended(&s, "the id");
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_SECTION, false, 5), 0);
    mended(&s, "the id and the checksums");
    release(&s);
    release(&other);
}

static void test_same_file(void **state) {
    (void)state;
    sound s = grid_file("grid", LEAF_CODEC_RAW, 1);
    write_copies(&s);
    assert_int_equal(unlink(scratch_path("from.leaf")), 0);
    assert_int_equal(link(scratch_path("bad.leaf"), scratch_path("from.leaf")), 0);
    refused(ST_USAGE, "is the same file as", true);
    assert_int_equal(unlink(scratch_path("from.leaf")), 0);
    refused(ST_IO, "from.leaf", true);
    release(&s);
}

static struct stat look(const char *name) {
    struct stat info;
    assert_int_equal(lstat(scratch_path(name), &info), 0);
    return info;
}

static void test_in_place(void **state) {
    (void)state;
    leaf_repair_result r;
    sound s = grid_file("grid", LEAF_CODEC_RAW, 1);
    write_copies(&s);
    assert_int_equal(chmod(scratch_path("bad.leaf"), 0640), 0);
    const struct stat before = look("bad.leaf");
    /* Nothing is damaged: it stays. */
    assert_int_equal(repair_with(&m, true, NULL, &r), ST_OK);
    assert_false(r.mended);
    assert_int_equal(look("bad.leaf").st_ino, before.st_ino);
    /* A symbolic link stays one; permissions stay. */
    flip("bad.leaf", s.size / 2);
    assert_int_equal(rename(scratch_path("bad.leaf"), scratch_path("real.leaf")), 0);
    assert_int_equal(symlink(scratch_path("real.leaf"), scratch_path("bad.leaf")), 0);
    assert_int_equal(repair_with(&m, true, NULL, &r), ST_OK);
    assert_true(r.mended);
    assert_true(S_ISLNK(look("bad.leaf").st_mode));
    assert_int_equal(look("real.leaf").st_mode & 0777, 0640);
    scratch_same("in place", scratch_path("real.leaf"), scratch_path("from.leaf"));
    assert_int_equal(unlink(scratch_path("bad.leaf")), 0);
    assert_int_equal(unlink(scratch_path("real.leaf")), 0);
    release(&s);
}

static void test_output(void **state) {
    (void)state;
    sound s = grid_file("grid", LEAF_CODEC_RAW, 1);
    write_copies(&s);
    flip("bad.leaf", s.size / 2);
    scratch_text("made.leaf", "mine");
    refused(ST_EXISTS, "made.leaf", false);
    char *bytes = scratch_read(scratch_path("made.leaf"), NULL);
    assert_string_equal(bytes, "mine");
    free(bytes);
    assert_int_equal(unlink(scratch_path("made.leaf")), 0);
    release(&s);
}

/* Whatever fails: bad is as it was or mended, and nothing else is left. */
static void check_faults(const sound *s, fault_kind kind) {
    bool fired = true;
    for (long k = 1; fired; k += 1 + k / 40) {
        leaf_repair_result r;
        write_copies(s);
        flip("bad.leaf", 300);
        flip_part("bad.leaf", leaf_parts_find(&s->parts, PART_PAYLOAD, false, 2), 5);
        size_t size;
        char *before = scratch_read(scratch_path("bad.leaf"), &size);
        const size_t files = scratch_count();
        fault_arm(kind, k);
        const status st = repair_with(&m, true, NULL, &r);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        assert_true(st == ST_OK || fired);
        if (kind == FAULT_ALLOC && fired)
            assert_int_equal(st, ST_NOMEM);
        if (kind == FAULT_WRITE && fired)
            assert_int_equal(st, ST_NOSPACE);
        char *after = scratch_read(scratch_path("bad.leaf"), &size);
        assert_int_equal(size, s->size);
        assert_memory_equal(after, st == ST_OK ? s->bytes : before, size);
        assert_int_equal(scratch_count(), files);
        free(before);
        free(after);
    }
}

static void test_faults(void **state) {
    (void)state;
    for (int kind = 1; kind < KINDS; kind += 2) {
        sound s = make(kind);
        for (fault_kind fault = FAULT_ALLOC; fault < FAULT_KINDS; fault++)
            check_faults(&s, fault);
        release(&s);
    }
}

static bool stop_now(void *ctx) {
    return --*(long *)ctx <= 0;
}

static void test_stop(void **state) {
    (void)state;
    sound s = mesh_file("mesh", LEAF_CODEC_ZSTD);
    status st = ST_STOPPED;
    for (long k = 1; st == ST_STOPPED; k += 1 + k / 4) {
        leaf_repair_result r;
        long left = k;
        const progress p = {.stop = stop_now, .ctx = &left};
        write_copies(&s);
        flip("bad.leaf", s.size / 2);
        const size_t files = scratch_count();
        st = repair_with(&m, true, &p, &r);
        assert_int_equal(scratch_count(), files);
        assert_true(st == ST_OK || st == ST_STOPPED);
    }
    scratch_same("after all", scratch_path("bad.leaf"), scratch_path("from.leaf"));
    release(&s);
}

/* With a budget: memory suffices, or there is an error. */
static void test_budget(void **state) {
    (void)state;
    sound s = grid_file("grid", LEAF_CODEC_ZSTD, 1);
    status st = ST_NOMEM;
    for (size_t limit = 1000; st == ST_NOMEM; limit += limit / 4) {
        leaf_repair_result r;
        mem little;
        write_copies(&s);
        flip("bad.leaf", s.size / 2);
        mem_init(&little, limit);
        st = repair_with(&little, true, NULL, &r);
        assert_in_range(limit, 1000, 32 << 20);
    }
    assert_int_equal(st, ST_OK);
    release(&s);
}

/* ---- what verify tells ---- */

static void tells(const char *text) {
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path("bad.leaf"), &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_CORRUPT);
    assert_int_equal(leaf_damage_tell(&m, f, NULL), ST_CORRUPT);
    if (!strstr(status_text(), text))
        fail_msg("expected \"%s\", found \"%s\"", text, status_text());
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

static void test_tell(void **state) {
    (void)state;
    sound s = mesh_file("mesh", LEAF_CODEC_RAW);
    write_copies(&s);
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_PAYLOAD, false, 1), 8);
    tells("treelet 1's topology of");
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_PAYLOAD, true, 0), 8);
    tells("2 parts are damaged: treelet 1's topology, coarse grid of set 0: treelet 0's payload");
    flip_part("bad.leaf", leaf_parts_find(&s.parts, PART_HEADER, true, 0), 50);
    tells("2 parts are damaged: treelet 1's topology, coarse grid of set 0: its directory");
    release(&s);
    s = grid_file("grid", LEAF_CODEC_ZSTD, 1);
    write_copies(&s);
    size_t payloads = 0;
    for (size_t i = 0; i < s.parts.count; i++)
        if (s.parts.all[i].kind == PART_PAYLOAD && ++payloads <= 23)
            flip_part("bad.leaf", s.parts.all[i], 3);
    assert_true(payloads >= 23);
    tells("23 parts are damaged: treelet 5's payload, ");
    tells(", and 3 more");
    release(&s);
}

/* Names are whole, and the others are counted, however long they are. */
static void test_names(void **state) {
    (void)state;
    char where[LEAF_WHERE_MAX], name[LEAF_NAME_MAX], end[40];
    for (int length = 1; length < LEAF_NAME_MAX; length++)
        for (unsigned count = 1; count <= 40; count++) {
            leaf_damage d = {0};
            memset(name, 'x', sizeof name);
            name[length] = '\0';
            for (unsigned i = 0; i < count; i++)
                leaf_damage_add(&d, leaf_damage_where(UINT32_MAX, where), name);
            const char *text = leaf_damage_names(&d);
            unsigned named = 0;
            for (const char *at = text; (at = strstr(at, where)) != NULL; at += strlen(where)) {
                assert_int_equal(strspn(at + strlen(where), "x"), length);
                named++;
            }
            snprintf(end, sizeof end, ", and %u more", count - named);
            assert_true(named > 0 && named <= LEAF_DAMAGE_NAMED && named <= count);
            if (named < count)
                assert_string_equal(text + strlen(text) - strlen(end), end);
            else
                assert_null(strstr(text, "more"));
        }
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),     cmocka_unit_test(test_gaps),
        cmocka_unit_test(test_lengths),   cmocka_unit_test(test_random),
        cmocka_unit_test(test_lost),      cmocka_unit_test(test_lost_coarse),
        cmocka_unit_test(test_grown),     cmocka_unit_test(test_other_file),
        cmocka_unit_test(test_same_file), cmocka_unit_test(test_in_place),
        cmocka_unit_test(test_output),    cmocka_unit_test(test_faults),
        cmocka_unit_test(test_stop),      cmocka_unit_test(test_budget),
        cmocka_unit_test(test_tell),      cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
