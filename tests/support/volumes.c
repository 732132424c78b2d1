#include "tests/support/volumes.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "formats/base/fault.h"
#include "tests/support/scratch.h"

static int value(sample_type type, int n) {
    bool is_signed = type != SAMPLE_U8 && type != SAMPLE_U16 && type != SAMPLE_U32;
    return is_signed ? 7 * n - 50 : 7 * n;
}

#define PUT_ALL(type_name)                                        \
    for (int n = 0; n < VOLUMES_SAMPLES; n++) {                   \
        type_name v = (type_name)value(type, n);                  \
        memcpy((char *)out + (size_t)n * sizeof v, &v, sizeof v); \
    }

size_t volumes_samples(sample_type type, bool big_endian, void *out) {
    switch (type) {
    case SAMPLE_U8: PUT_ALL(uint8_t) break;
    case SAMPLE_I8: PUT_ALL(int8_t) break;
    case SAMPLE_U16: PUT_ALL(uint16_t) break;
    case SAMPLE_I16: PUT_ALL(int16_t) break;
    case SAMPLE_F32: PUT_ALL(float) break;
    case SAMPLE_U32: PUT_ALL(uint32_t) break;
    case SAMPLE_I32: PUT_ALL(int32_t) break;
    case SAMPLE_F64: PUT_ALL(double) break;
    default: break;
    }
    /* Each sample's bytes turned around by hand. */
    size_t width = sample_size(type);
    for (int n = 0; big_endian && n < VOLUMES_SAMPLES; n++)
        for (size_t b = 0; b < width / 2; b++) {
            char *low = (char *)out + (size_t)n * width + b, *high = low + width - 1 - 2 * b;
            char kept = *low;
            *low = *high;
            *high = kept;
        }
    return VOLUMES_SAMPLES * width;
}

size_t volumes_text(sample_type type, char *out) {
    size_t length = 0;
    for (int n = 0; n < VOLUMES_SAMPLES; n++)
        length += (size_t)sprintf(out + length, "%d%s", value(type, n), n % 5 == 4 ? "\n" : " ");
    return length;
}

/* One member behind what is there. */
static size_t deflate_member(const uint8_t *data, size_t size, bool gzip, uint8_t *out,
                             size_t room) {
    z_stream z = {0};
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 15 + (gzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY),
                     Z_OK);
    z.next_in = (Bytef *)(uintptr_t)data;
    z.avail_in = (uInt)size;
    z.next_out = out;
    z.avail_out = (uInt)room;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    deflateEnd(&z);
    return z.total_out;
}

uint8_t *volumes_deflate(const void *data, size_t size, bool gzip, int members,
                         size_t *compressed) {
    size_t room = 2 * size + (size_t)members * 100, part = size / (size_t)members;
    uint8_t *out = malloc(room);
    *compressed = 0;
    for (int n = 0; n < members; n++) {
        size_t from = (size_t)n * part, to = n + 1 == members ? size : from + part;
        *compressed += deflate_member((const uint8_t *)data + from, to - from, gzip,
                                      out + *compressed, room - *compressed);
    }
    return out;
}

const char *volumes_file(const char *name, const char *header, const void *data, size_t size) {
    size_t length = strlen(header);
    char *all = malloc(length + size + 1);
    memcpy(all, header, length);
    memcpy(all + length, data, size);
    const char *path = scratch_write(name, all, length + size);
    free(all);
    return path;
}

static status read_slices(volume *v, grid *g, void *samples) {
    *g = *volume_grid(v);
    if (grid_samples(g) > VOLUMES_SAMPLES)
        return status_describe(ST_FAILED, "too large for this test");
    for (uint32_t k = 0; k < g->dims[2]; k++) {
        status st = volume_read(v, 1, (char *)samples + k * grid_slice_bytes(g));
        if (st != ST_OK)
            return st;
    }
    uint64_t trailing;
    return volume_finish(v, &trailing);
}

status volumes_read(const char *path, const volume_hints *hints, grid *g, void *samples) {
    mem m;
    mem_init(&m, (size_t)1 << 22);
    volume *v = NULL;
    status_describe(ST_OK, "%s", "");
    status st = volume_open(&m, path, hints, &v);
    if (st == ST_OK)
        st = read_slices(v, g, samples);
    volume_close(v);
    for (int a = 0; a < 3; a++)
        g->axis[a] = NULL;
    if (mem_used(&m) != 0)
        fail_msg("%s: %zu bytes leaked", path, mem_used(&m));
    if ((st == ST_OK) != !*status_text())
        fail_msg("%s: status %d described as \"%s\"", path, (int)st, status_text());
    return st;
}

void volumes_check(const char *path, const volume_hints *hints, sample_type type,
                   const double (*to_world)[4]) {
    double want[VOLUMES_SAMPLES], got[VOLUMES_SAMPLES];
    grid g, plain;
    const uint32_t dims[3] = {VOLUMES_NX, VOLUMES_NY, VOLUMES_NZ};
    memset(got, 0x55, sizeof got);
    grid_init(&plain, dims, type);
    if (volumes_read(path, hints, &g, got) != ST_OK)
        fail_msg("%s", status_text());
    assert_memory_equal(g.dims, dims, sizeof dims);
    assert_int_equal(g.type, type);
    assert_memory_equal(got, want, volumes_samples(type, false, want));
    const double(*map)[4] = plain.to_world;
    if (to_world)
        map = to_world;
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 4; c++)
            if (!(g.to_world[row][c] == map[row][c]))
                fail_msg("%s: to_world[%d][%d] is %g, not %g", path, row, c, g.to_world[row][c],
                         map[row][c]);
}

void volumes_refused(const char *path, const volume_hints *hints, status st, const char *said) {
    double samples[VOLUMES_SAMPLES];
    grid g;
    status got = volumes_read(path, hints, &g, samples);
    if (got != st || !strstr(status_text(), said))
        fail_msg("status %d (\"%s\"), not %d (\"...%s...\")", (int)got, status_text(), (int)st,
                 said);
}

void volumes_truncate(const char *path, const volume_hints *hints, size_t spare) {
    double samples[VOLUMES_SAMPLES];
    grid g;
    size_t size;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    for (size_t n = 0; n + spare < size; n++) {
        scratch_write(name, data, n);
        status st = volumes_read(path, hints, &g, samples);
        if (st != ST_CORRUPT && st != ST_UNSUPPORTED && st != ST_IO)
            fail_msg("%s cut to %zu of %zu bytes: status %d", path, n, size, (int)st);
    }
    scratch_write(name, data, size);
    free(data);
}

size_t volumes_damage(const char *path, const volume_hints *hints) {
    double samples[VOLUMES_SAMPLES];
    grid g;
    size_t size, unnoticed = 0;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    static const char masks[] = {1, 0x10, (char)0xff};
    for (size_t n = 0; n < size; n++)
        for (size_t i = 0; i < sizeof masks; i++) {
            data[n] ^= masks[i];
            scratch_write(name, data, size);
            unnoticed += volumes_read(path, hints, &g, samples) == ST_OK;
            data[n] ^= masks[i];
        }
    scratch_write(name, data, size);
    free(data);
    return unnoticed;
}

static void sweep(const char *path, const volume_hints *hints, fault_kind kind) {
    double samples[VOLUMES_SAMPLES];
    grid g;
    long k = 0;
    for (bool fired = true; fired;) {
        fault_arm(kind, ++k);
        status st = volumes_read(path, hints, &g, samples);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        status want = !fired ? ST_OK : kind == FAULT_ALLOC ? ST_NOMEM : ST_IO;
        if (st != want)
            fail_msg("%s: fault %ld of kind %d gives %d, not %d (%s)", path, k, (int)kind, (int)st,
                     (int)want, status_text());
    }
    assert_true(k > 1);
}

void volumes_faults(const char *path, const volume_hints *hints) {
    sweep(path, hints, FAULT_ALLOC);
    sweep(path, hints, FAULT_READ);
}
