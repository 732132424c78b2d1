/* test_mesh_damage.c - treelet files of meshes cut short, damaged, and made to do harm: refused,
 * each of them, by both readers alike. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_verify.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_image.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/naive_mesh.h"
#include "tests/support/scratch.h"

static mem m;

/* Four treelets, two sets, some values missing; with all that a file can have. */
enum { SECTIONS = 10, BLOCKS = 1 + 2 + 2 + 1 };
/* Of a payload's bytes one in STRIDE is changed. */
#ifdef __SANITIZE_ADDRESS__
enum { STRIDE = 23 };
#else
enum { STRIDE = 5 };
#endif

static leaf_image make(leaf_codec codec) {
    mesh_case c = mesh_leaves_cube(3, 1, 2, 7, 15);
    mesh_leaves_extend(&c, 8);
    c.file.codec = codec;
    c.file.run_align_log2 = 9;
    size_t size;
    char *bytes = scratch_read(mesh_leaves_make(&c, "made.leaf"), &size);
    mesh_leaves_release(&c);
    return leaf_image_of(bytes, size);
}

static status try_open(const char *path, bool payloads) {
    leaf_file *f = NULL;
    leaf_activity levels[LEAF_LEVELS_MAX];
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK && payloads) {
        st = leaf_stats_activity(&m, f, 0, 0.5, 1, NULL, levels);
        if (st == ST_OK || st == ST_CORRUPT)
            st = leaf_verify(&m, f, 1, NULL);
    }
    leaf_file_close(f);
    if (mem_used(&m))
        fail_msg("%zu bytes left in memory", mem_used(&m));
    return st;
}

static bool refused(status st) {
    return st == ST_CORRUPT || st == ST_UNSUPPORTED;
}

/* As it lies in memory: refused by both, and the description names the file. */
static void check_refused(const leaf_image *i, bool payloads, const char *what) {
    const char *path = scratch_write("bad.leaf", i->bytes, i->size);
    status st = try_open(path, payloads);
    if (!refused(st) || !strstr(status_text(), path))
        fail_msg("%s: status %d: %s", what, st, status_text());
    naive_mesh mesh;
    if (naive_mesh_load(&mesh, path))
        fail_msg("%s: the second reader sees nothing, the first: %s", what, status_text());
    naive_mesh_release(&mesh);
}

static void test_truncated(void **state) {
    (void)state;
    leaf_image i = make(LEAF_CODEC_RAW);
    const char *path = scratch_write("short.leaf", i.bytes, i.size);
    for (size_t length = i.size; length-- > 0; length -= length > 6000 && length % 7 ? 6 : 0) {
        assert_int_equal(truncate(path, (off_t)length), 0);
        status st = try_open(path, false);
        if (st != ST_CORRUPT || !strstr(status_text(), path))
            fail_msg("%zu of %zu bytes: status %d: %s", length, i.size, st, status_text());
    }
    free(i.bytes);
}

/* Every byte of table and directory, of the header and of payloads many, with one bit changed. */
static void test_flipped(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_image i = make((leaf_codec)codec);
        const char *path = scratch_write("flip.leaf", i.bytes, i.size);
        int fd = open(path, O_WRONLY);
        assert_true(fd >= 0);
        for (size_t at = 0; at < i.size;
             at +=
             at < 320 || (at >= 1340 && at < 1520) || (at > 4090 && leaf_image_is_directory(&i, at))
                 ? 1
                 : 61) {
            char flipped = (char)(i.bytes[at] ^ (1 << (at % 8)));
            assert_int_equal(pwrite(fd, &flipped, 1, (off_t)at), 1);
            status st = try_open(path, !leaf_image_is_directory(&i, at));
            if (!refused(st))
                fail_msg("byte %zu: status %d: %s", at, st, status_text());
            assert_int_equal(pwrite(fd, i.bytes + at, 1, (off_t)at), 1);
        }
        close(fd);
        assert_int_equal(try_open(path, true), ST_OK);
        free(i.bytes);
    }
}

/* Nothing else in the file says these, or not exactly. */
static bool free_choice(size_t at, uint32_t value, const leaf_header *sound) {
    switch (at) {
    case offsetof(leaf_header, source_type): return value >= 5 && value <= 8;
    case offsetof(leaf_header, codec): return value == LEAF_CODEC_ZSTD;
    case offsetof(leaf_header, non_finite): return value > 0 && value < 200;
    case offsetof(leaf_header, vertices): return value >= 40 && value <= 4 * sound->tets;
    case offsetof(leaf_header, treelet_tets): return value >= 50 && value <= LEAF_TREELET_TETS_MAX;
    case offsetof(leaf_header, leaf_tets): return value >= 3 && value <= LEAF_LEAF_TETS_MAX;
    case offsetof(leaf_header, flat):
    case offsetof(leaf_header, inverted): return value <= sound->tets;
    default: return at >= offsetof(leaf_header, repeated) && at < offsetof(leaf_header, field);
    }
}

/* Header fields that lie, with checksums that do not. */
static void test_lying_header(void **state) {
    (void)state;
    leaf_image i = make(LEAF_CODEC_RAW);
    const leaf_header sound = *i.header;
    static const uint32_t values[] = {0,  1,  2,   3,    4,       5,          7,        9,
                                      33, 65, 255, 4096, 1 << 20, 0x7fc00000, 1u << 31, UINT32_MAX};
    for (size_t at = 8; at < offsetof(leaf_header, reserved); at += 4) {
        /* id and checksum are sealed; texts may be any. */
        if ((at >= 232 && at < 1344) ||
            (at >= offsetof(leaf_header, field) && at < offsetof(leaf_header, gradients)))
            continue;
        /* The rounding error may be any that is none below 0. */
        if (at >= offsetof(leaf_header, rounding_error) && at < offsetof(leaf_header, to_world))
            continue;
        for (size_t n = 0; n < sizeof values / sizeof values[0]; n++) {
            *i.header = sound;
            memcpy(i.bytes + at, &values[n], sizeof values[n]);
            if (memcmp(&sound, i.header, sizeof sound) == 0 || free_choice(at, values[n], &sound))
                continue;
            /* The second half of an 8-byte number, next to 0. */
            if (memcmp(i.header->bounds, sound.bounds, sizeof sound.bounds) != 0 && values[n] == 0)
                continue;
            char what[64];
            snprintf(what, sizeof what, "header field at %zu = %u", at, values[n]);
            leaf_image_seal(&i);
            check_refused(&i, false, what);
        }
    }
    *i.header = sound;
    memset(i.header->field, 'x', sizeof i.header->field);
    leaf_image_seal(&i);
    check_refused(&i, false, "a field's name without an end");
    *i.header = sound;
    i.header->rounding_error = NAN;
    leaf_image_seal(&i);
    check_refused(&i, false, "rounding_error");
    *i.header = sound;
    i.header->reserved[sizeof sound.reserved - 1] = 1;
    leaf_image_seal(&i);
    check_refused(&i, false, "reserved bytes");
    free(i.bytes);
}

/* Counts that no file of this size can hold ask for no memory. */
static void test_lying_sizes(void **state) {
    (void)state;
    static const uint64_t treelets[] = {0, 5, 1000, 1 << 20, 1ULL << 31, 1ULL << 32, UINT64_MAX};
    static const uint32_t sets[][2] = {{1, 1}, {1, 2}, {2, 2}, {65536, 1}, {256, 256}, {1, 65535}};
    leaf_image i = make(LEAF_CODEC_RAW);
    const leaf_header sound = *i.header;
    for (size_t n = 0; n < sizeof treelets / sizeof treelets[0]; n++)
        for (size_t k = 0; k < sizeof sets / sizeof sets[0]; k++) {
            i.header->treelets = treelets[n];
            i.header->tets = treelets[n];
            i.header->fields = sets[k][0];
            i.header->steps = sets[k][1];
            i.header->gradients = n & 1;
            i.header->moving = n >> 1 & 1;
            for (uint32_t s = 0; s < i.header->sections; s++)
                i.table[s].bytes = leaf_section_bytes(i.header, i.table[s].kind);
            leaf_image_seal(&i);
            check_refused(&i, false, "sizes");
            assert_true(mem_peak(&m) < 1 << 20);
            *i.header = sound;
        }
    free(i.bytes);
}

static void test_lying_table(void **state) {
    (void)state;
    leaf_image i = make(LEAF_CODEC_RAW);
    leaf_section sound[SECTIONS];
    memcpy(sound, i.table, sizeof sound);
    static const uint64_t values[] = {0, 1, 7, 8, 9, 63, 64, 4096, 1ULL << 32, UINT64_MAX};
    for (int n = 0; n < SECTIONS; n++)
        for (size_t k = 0; k < 5 * (sizeof values / sizeof values[0]); k++) {
            uint64_t v = values[k / 5];
            leaf_section *s = &i.table[n];
            switch (k % 5) {
            case 0: s->kind = (uint32_t)v; break;
            case 1: s->version = (uint32_t)v; break;
            case 2: s->offset = v; break;
            case 3: s->offset += v; break;
            default: s->bytes = v; break;
            }
            /* Names and times may be missing, and what is to be passed over may be anything. */
            const bool fine =
                (s->kind & LEAF_SECTION_ANCILLARY) && leaf_section_optional(sound[n].kind);
            if (!fine && memcmp(sound, i.table, sizeof sound) != 0) {
                leaf_image_seal(&i);
                check_refused(&i, false, "section table");
            }
            memcpy(i.table, sound, sizeof sound);
        }
    free(i.bytes);
}

/* Each element of a section with each of these values. */
static void check_numbers(const leaf_image *i, uint32_t kind, uint32_t count, bool opening) {
    static const uint32_t values[] = {0,          1,          2,        3,          4,
                                      64,         65,         4096,     16385,      0x7fc00000,
                                      0x7f800000, 0xff800000, 1u << 31, UINT32_MAX, 0x3f800000};
    uint32_t *array = leaf_image_section(i, kind);
    for (uint32_t n = 0; n < count; n++)
        for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
            const uint32_t sound = array[n];
            /* A -0 for a 0: no other value. */
            if (sound == values[k])
                continue;
            array[n] = values[k];
            leaf_image_seal(i);
            char what[64];
            snprintf(what, sizeof what, "section %u, number %u = 0x%x", kind, n, values[k]);
            check_refused(i, !opening, what);
            array[n] = sound;
        }
}

static void test_lying_directory(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_image i = make((leaf_codec)codec);
        const uint32_t n = (uint32_t)i.header->treelets;
        check_numbers(&i, LEAF_SECTION_OFFSETS, 2 * BLOCKS * n, true);
        check_numbers(&i, LEAF_SECTION_SIZES, 2 * BLOCKS * n, true);
        check_numbers(&i, LEAF_SECTION_RANGES, 2 * 2 * n, true);
        check_numbers(&i, LEAF_SECTION_OWN, 2 * 2 * n, true);
        check_numbers(&i, LEAF_SECTION_BOUNDS, 2 * 6 * n, false);
        check_numbers(&i, LEAF_SECTION_COUNTS, 4 * n, false);
        uint8_t *flags = leaf_image_section(&i, LEAF_SECTION_FLAGS);
        for (uint32_t t = 0; t < 2 * n; t++)
            for (int bit = 0; bit < 8; bit++) {
                flags[t] ^= (uint8_t)(1 << bit);
                leaf_image_seal(&i);
                check_refused(&i, bit == 0, "flags");
                flags[t] ^= (uint8_t)(1 << bit);
            }
        free(i.bytes);
    }
}

static void test_lying_labels(void **state) {
    (void)state;
    leaf_image i = make(LEAF_CODEC_RAW);
    char *name = leaf_image_section(&i, LEAF_SECTION_FIELDS), sound[64];
    double *times = leaf_image_section(&i, LEAF_SECTION_TIMES);
    memcpy(sound, name, sizeof sound);
    for (int n = 0; n < 3; n++) {
        memset(name + (n == 1 ? 8 : 0), 'x', n == 0 ? 64 : 1); /* endless, hidden, another */
        leaf_image_seal(&i);
        check_refused(&i, false, "a field's name");
        memcpy(name, sound, sizeof sound);
    }
    static const double wrong[][2] = {{1, 1}, {1, 0}, {NAN, 1}, {0, NAN}, {0, INFINITY}};
    for (size_t n = 0; n < sizeof wrong / sizeof wrong[0]; n++) {
        memcpy(times, wrong[n], sizeof wrong[n]);
        leaf_image_seal(&i);
        check_refused(&i, false, "times");
    }
    free(i.bytes);
}

/* Payloads that are wrong with checksums that are right: both readers say the same of each. */
static void test_lying_payloads(void **state) {
    (void)state;
    leaf_image i = make(LEAF_CODEC_RAW);
    const uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    const uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
    uint64_t *checksums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
    int passed = 0, found = 0;
    for (uint64_t p = 0; p < BLOCKS * i.header->treelets; p++) {
        const uint64_t checksum = checksums[p];
        for (uint64_t at = p % STRIDE; at < sizes[p]; at += p ? STRIDE : 1) {
            char *byte = i.bytes + offsets[p] + at;
            const char bit = (char)(1 << (at * 5 + p) % 8);
            *byte ^= bit;
            checksums[p] = hash_bytes(i.bytes + offsets[p], (size_t)sizes[p]);
            leaf_image_seal(&i);
            const char *path = scratch_write("bad.leaf", i.bytes, i.size);
            status st = try_open(path, true);
            naive_mesh mesh;
            const bool naive = naive_mesh_load(&mesh, path);
            if (naive != (st == ST_OK) || (st != ST_OK && st != ST_CORRUPT))
                fail_msg("payload %d byte %d: status %d: %s; the other: %s", (int)p, (int)at, st,
                         st ? status_text() : "", naive ? "sound" : mesh.why);
            naive_mesh_release(&mesh);
            passed += naive;
            found += !naive;
            *byte ^= bit;
        }
        checksums[p] = checksum;
    }
    /* Low bits of positions and values that are no extremes are just others, and any of gradients.
     */
    assert_true(passed > 4000 / STRIDE && found > 7500 / STRIDE);
    free(i.bytes);
}

/* ---- topologies of any bytes ---- */

/* Every tet of every leaf, from the root down, as rendering would; false if it would go astray. */
static bool traverse(const mesh_shape *s, const void *topology) {
    uint16_t stack[7 * MESH_DEPTH_MAX + 1] = {0};
    const uint16_t *first = mesh_leaf_first(s, topology);
    size_t top = 1, leaves = 0, tets = 0;
    while (top) {
        const mesh_node *node = &mesh_leaf_nodes(topology)[stack[--top]];
        for (int c = MESH_CHILDREN - 1; c >= 0; c--) {
            const uint16_t child = node->child[c];
            if (child == MESH_NO_CHILD)
                continue;
            if (!(child & MESH_LEAF)) {
                if (top == sizeof stack / sizeof stack[0])
                    return false;
                stack[top++] = child;
                continue;
            }
            const uint16_t leaf = child & (uint16_t)~MESH_LEAF;
            leaves++;
            tets += (size_t)first[leaf + 1] - first[leaf];
            for (uint32_t t = first[leaf]; t < first[leaf + 1]; t++)
                for (int k = 0; k < 4; k++)
                    if (!(mesh_leaf_positions(s, topology)[mesh_leaf_tets(s, topology)[t][k]][0] <
                          100))
                        return false;
        }
    }
    return leaves == s->leaves && tets == s->tets;
}

/* Numbers such as a topology has them, at random places. */
static void spoil(char *topology, const mesh_shape *s, field_random *r) {
    const long changes = 1 + field_random_below(r, 4);
    for (long n = 0; n < changes; n++) {
        uint16_t value = (uint16_t)field_random_below(r, s->leaves + 2);
        if (field_random_below(r, 2))
            value |= MESH_LEAF;
        if (field_random_below(r, 8) == 0)
            value = (uint16_t)field_random_bits(r);
        size_t at = (size_t)field_random_below(r, s->topology_bytes / 2) * 2;
        if (field_random_below(r, 3))
            at = (size_t)field_random_below(r, s->nodes) * sizeof(mesh_node) + 48 +
                 2 * (size_t)field_random_below(r, MESH_CHILDREN);
        memcpy(topology + at, &value, sizeof value);
    }
}

static void test_any_topology(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    mesh_case c = mesh_leaves_cube(3, 1, 1, 1, 0);
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, mesh_leaves_make(&c, "any.leaf"), &f), ST_OK);
    int passed = 0, found = 0;
    for (int n = 0; n < 60000; n++) {
        const uint32_t t = (uint32_t)field_random_below(&r, f->layout.treelets);
        const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
        char *topology = aligned_alloc(64, s.topology_bytes);
        assert_int_equal(leaf_file_load(f, t, NULL, topology), ST_OK);
        if (n % 100)
            spoil(topology, &s, &r);
        else
            for (size_t i = 0; n % 200 && i < s.topology_bytes; i++)
                topology[i] = (char)field_random_bits(&r);
        status st = mesh_leaf_check_loaded(f, t, topology);
        if (st == ST_OK && !traverse(&s, topology))
            fail_msg("seed %d, case %d passes the check and goes astray", FIELD_SEED, n);
        assert_true(st == ST_OK || st == ST_CORRUPT);
        passed += st == ST_OK;
        found += st != ST_OK;
        free(topology);
    }
    assert_true(passed > 1000 && found > 1000);
    leaf_file_close(f);
    mesh_leaves_release(&c);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_truncated, set_up),
        cmocka_unit_test_setup(test_flipped, set_up),
        cmocka_unit_test_setup(test_lying_header, set_up),
        cmocka_unit_test_setup(test_lying_sizes, set_up),
        cmocka_unit_test_setup(test_lying_table, set_up),
        cmocka_unit_test_setup(test_lying_directory, set_up),
        cmocka_unit_test_setup(test_lying_labels, set_up),
        cmocka_unit_test_setup(test_lying_payloads, set_up),
        cmocka_unit_test_setup(test_any_topology, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
