/* test_grid_family.c - families of all small sizes: own boxes and shell hold each sample once, and
 * make treelets as if they had been cut out of the volume.
 */
/* marks: bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/grid_family.h"
#include "tests/support/watched.h"

enum { LOG2 = 4, B = 1 << LOG2, SIDE_MAX = 2 * B + 3 };

/* What a family holds. Sample i of it is i + 1; of the shell, one box behind the other. */
typedef struct family {
    leaf_layout l;
    uint32_t size[3]; /* samples, halo included */
    size_t samples;
    uint8_t *times; /* in how many boxes each sample is */
    uint16_t *shell;
} family;

static mem m;

static uint32_t index_of(const family *f, const uint32_t p[3]) {
    return p[0] + f->size[0] * (p[1] + f->size[1] * p[2]);
}

static void begin(family *f, const uint32_t cells[3], uint32_t halo) {
    const uint32_t dims[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
    assert_int_equal(leaf_layout_init(&f->l, &m, dims, LOG2, halo, SAMPLE_U16), ST_OK);
    f->samples = 1;
    for (int a = 0; a < 3; a++) {
        f->size[a] = cells[a] + 1 + 2 * halo;
        f->samples *= f->size[a];
    }
    memset(f->times, 0, f->samples);
}

static void end(family *f) {
    leaf_layout_release(&f->l);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- the shell ---- */

static void fill_part(family *f, const family_part *part, uint16_t **to) {
    uint32_t p[3];
    for (p[2] = part->at[2]; p[2] < part->at[2] + part->size[2]; p[2]++)
        for (p[1] = part->at[1]; p[1] < part->at[1] + part->size[1]; p[1]++)
            for (p[0] = part->at[0]; p[0] < part->at[0] + part->size[0]; p[0]++) {
                const uint32_t i = index_of(f, p);
                f->times[i]++;
                *(*to)++ = (uint16_t)(i + 1);
            }
}

/* What the coder is told of a part: the same samples, in any order. */
static void check_box(const family_part *part, const coded_box *box, const uint16_t *at) {
    const size_t samples = (size_t)part->size[0] * part->size[1] * part->size[2];
    static bool seen[SIDE_MAX * SIDE_MAX * SIDE_MAX];
    memset(seen, 0, samples * sizeof seen[0]);
    assert_ptr_equal(box->at, at);
    assert_int_equal((size_t)box->size[0] * box->size[1] * box->size[2], samples);
    assert_true(box->size[0] <= BOX_ROW_MAX);
    assert_int_equal(box->size[0], part->size[part->size[0] < part->size[1]]);
    for (uint32_t z = 0; z < box->size[2]; z++)
        for (uint32_t y = 0; y < box->size[1]; y++)
            for (uint32_t x = 0; x < box->size[0]; x++) {
                const size_t i = (size_t)x * box->stride[0] + (size_t)y * box->stride[1] +
                                 (size_t)z * box->stride[2];
                assert_true(i < samples && !seen[i]);
                seen[i] = true;
            }
}

static void make_shell(family *f) {
    family_part parts[FAMILY_PARTS_MAX];
    coded_box boxes[FAMILY_PARTS_MAX];
    const uint32_t count = grid_family_parts(&f->l, 0, parts);
    const bool one = f->l.level[0].count == 1;
    uint16_t *to = f->shell;
    assert_int_equal(count == 0, one);
    assert_int_equal(grid_family_shell_boxes(&f->l, 0, f->shell, boxes), count);
    for (uint32_t i = 0; i < count; i++) {
        check_box(&parts[i], &boxes[i], to);
        fill_part(f, &parts[i], &to);
    }
    assert_int_equal(to - f->shell, leaf_layout_shell_samples(&f->l, 0));
    assert_true(leaf_layout_shell_samples(&f->l, 0) <= leaf_layout_shell_max(&f->l));
}

/* ---- treelets ---- */

/* Count the own samples of a treelet, and put them into its payload. */
static void put_own(family *f, uint32_t t, const leaf_payload *p, char *payload) {
    const coded_box box = grid_family_own(&f->l, t, payload);
    uint16_t *samples = (uint16_t *)(void *)(payload + p->samples_at);
    assert_int_equal((size_t)box.size[0] * box.size[1] * box.size[2],
                     leaf_layout_own_samples(&f->l, t));
    for (uint32_t z = 0; z < box.size[2]; z++)
        for (uint32_t y = 0; y < box.size[1]; y++)
            for (uint32_t x = 0; x < box.size[0]; x++) {
                uint16_t *to = (uint16_t *)box.at + (size_t)x * box.stride[0] +
                               (size_t)y * box.stride[1] + (size_t)z * box.stride[2];
                const uint32_t at = (uint32_t)(to - samples);
                const uint32_t *n = p->samples, *place = f->l.place[t];
                const uint32_t i[3] = {at % n[0] + B * place[0], at / n[0] % n[1] + B * place[1],
                                       at / n[0] / n[1] + B * place[2]};
                f->times[index_of(f, i)]++;
                *to = (uint16_t)(index_of(f, i) + 1);
            }
}

static void check_treelet(const family *f, uint32_t t, const leaf_payload *p, const char *payload) {
    const uint16_t *samples = (const uint16_t *)(const void *)(payload + p->samples_at);
    uint32_t i[3];
    for (uint32_t z = 0; z < p->samples[2]; z++)
        for (uint32_t y = 0; y < p->samples[1]; y++)
            for (uint32_t x = 0; x < p->samples[0]; x++) {
                i[0] = x + B * f->l.place[t][0];
                i[1] = y + B * f->l.place[t][1];
                i[2] = z + B * f->l.place[t][2];
                if (*samples++ != index_of(f, i) + 1)
                    fail_msg("treelet %u of %ux%ux%u samples: %u %u %u", t, f->size[0], f->size[1],
                             f->size[2], x, y, z);
            }
}

/* Bytes around the samples are not touched. */
static void check_around(const leaf_payload *p, const char *payload, size_t room) {
    const size_t samples = (size_t)p->samples[0] * p->samples[1] * p->samples[2];
    for (size_t i = 0; i < p->samples_at; i++)
        assert_int_equal(payload[i], 0);
    for (size_t i = p->samples_at + samples * sizeof(uint16_t); i < room; i++)
        assert_int_equal(payload[i], 0);
}

static void check_family(family *f, const uint32_t cells[3], uint32_t halo) {
    static _Alignas(64) char payload[1 << 15];
    begin(f, cells, halo);
    if (f->l.levels > 1)
        make_shell(f);
    for (uint32_t n = 0; n < f->l.level[0].count; n++) {
        const uint32_t t = f->l.level[0].first + n;
        const leaf_payload p = leaf_layout_payload(&f->l, t);
        assert_true(p.bytes + 64 <= sizeof payload);
        memset(payload, 0, p.bytes + 64);
        put_own(f, t, &p, payload);
        if (f->l.levels > 1)
            grid_family_take(&f->l, 0, t, f->shell, payload);
        check_treelet(f, t, &p, payload);
        check_around(&p, payload, p.bytes + 64);
    }
    for (size_t i = 0; i < f->samples; i++)
        if (f->times[i] != 1)
            fail_msg("%ux%ux%u cells, halo %u: sample %zu is in %d boxes", cells[0], cells[1],
                     cells[2], halo, i, f->times[i]);
    end(f);
}

/* 1 .. 2 B cells on each axis; a few at the ends where that takes long. */
static void families_of_all_sizes(void **state) {
    (void)state;
    const size_t most = (size_t)SIDE_MAX * SIDE_MAX * SIDE_MAX;
    const uint32_t step = SLOW ? 5 : 1;
    family f = {.times = malloc(most), .shell = malloc(most * sizeof *f.shell)};
    uint32_t cells[3];
    assert_true(f.times && f.shell);
    for (uint32_t halo = 0; halo <= 1; halo++)
        for (cells[0] = 1; cells[0] <= 2 * B; cells[0] += step)
            for (cells[1] = 1; cells[1] <= 2 * B; cells[1] += step)
                for (cells[2] = 1; cells[2] <= 2 * B; cells[2] += step)
                    check_family(&f, cells, halo);
    free(f.times);
    free(f.shell);
}

/* The largest shells are those of full families. */
static void largest_shells(void **state) {
    (void)state;
    for (uint32_t log2 = 4; log2 <= 6; log2++)
        for (uint32_t halo = 0; halo <= 1; halo++) {
            const uint32_t b = 1U << log2, dims[3] = {4 * b + 1, 3 * b + 2, 2 * b + 1};
            leaf_layout l;
            size_t most = 0;
            assert_int_equal(leaf_layout_init(&l, &m, dims, log2, halo, SAMPLE_U8), ST_OK);
            for (uint32_t t = 0; l.level_of[t] > 0; t++) {
                const size_t n = leaf_layout_shell_samples(&l, t);
                most = n > most ? n : most;
            }
            assert_int_equal(most, leaf_layout_shell_max(&l));
            leaf_layout_release(&l);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(families_of_all_sizes),
                                       cmocka_unit_test(largest_shells)};
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
