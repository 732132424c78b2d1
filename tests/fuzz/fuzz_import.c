/* fuzz_import.c - what importers parse and compute without their libraries. The first byte chooses:
 * the header of a classic netCDF file, the slices of a DICOM series, names of images, packed
 * samples, a chunk that LZF packed.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/input/lzf.h"
#include "prep/import/dicom/dicom_order.h"
#include "prep/import/images/image_names.h"
#include "prep/import/netcdf/netcdf_header.h"
#include "prep/import/packed_samples.h"

enum { SLICES = 64, NAMES = 3, SAMPLES = 5000 };

/* What is left of the input; zeros behind its end. */
typedef struct bytes {
    const uint8_t *at;
    size_t left;
} bytes;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool held) {
    if (!held)
        abort();
}

static void take(bytes *b, void *to, size_t size) {
    const size_t there = b->left < size ? b->left : size;
    memset(to, 0, size);
    if (there > 0)
        memcpy(to, b->at, there);
    b->at += there;
    b->left -= there;
}

static uint8_t take_byte(bytes *b) {
    uint8_t byte;
    take(b, &byte, 1);
    return byte;
}

/* Small whole numbers, which are often equal, or any number. */
static double take_number(bytes *b) {
    const int8_t kind = (int8_t)take_byte(b);
    double number = kind;
    if (kind == INT8_MIN)
        take(b, &number, sizeof number);
    return number;
}

static void take_numbers(bytes *b, double *to, int count) {
    for (int i = 0; i < count; i++)
        to[i] = take_number(b);
}

/* ---- netCDF ---- */

static void read_header(bytes *b) {
    mem m;
    file *f = NULL;
    uint64_t begin = 0;
    const int id = take_byte(b);
    mem_init(&m, (size_t)1 << 20);
    check(file_open_memory(&m, "fuzzed", b->at, b->left, &f) == ST_OK);
    if (netcdf_header_begin(f, id, &begin) == ST_OK && begin > 0)
        check(b->left >= 4 && memcmp(b->at, "CDF", 3) == 0);
    file_close(f);
    check(mem_used(&m) == 0);
}

/* ---- DICOM ---- */

/* As dicom_image_read() tells places: what is known is finite, and directions have a length. */
static void take_place(bytes *b, dicom_place *p) {
    const uint8_t bits = take_byte(b);
    *p = (dicom_place){.known = bits & 1,
                       .between = {1, 1},
                       .across = {1, 0, 0},
                       .down = {0, 1, 0},
                       .number = (int8_t)take_byte(b)};
    take_numbers(b, p->position, 3);
    if (bits & 2)
        take_numbers(b, p->between, 2);
    if (bits & 4)
        take_numbers(b, p->across, 3);
    p->apart = bits & 8 ? take_number(b) : 0;
}

static void check_order(const dicom_slice *slices, size_t count, size_t kept, const grid *g,
                        status st) {
    check(kept <= count && (st != ST_OK || g->dims[2] == kept));
    for (size_t i = 0; i + 1 < kept && st == ST_OK; i++)
        check(!slices[0].place.known || !(slices[i].along > slices[i + 1].along));
}

static void order_slices(bytes *b) {
    static char name[] = "fuzzed";
    static char *paths[SLICES];
    static char instances[SLICES][DICOM_UID];
    static const uint32_t dims[3] = {4, 4, 1};
    dicom_slice slices[SLICES];
    mem m;
    grid g;
    size_t count = 1 + take_byte(b) % SLICES, kept = 0;
    const uint8_t how = take_byte(b);
    mem_init(&m, (size_t)1 << 20);
    for (uint32_t i = 0; i < count; i++) {
        paths[i] = name;
        snprintf(instances[i], sizeof instances[i], "%d", take_byte(b) % 80);
        slices[i] = (dicom_slice){.file = i};
        take_place(b, &slices[i].place);
    }
    const dicom_study study = {
        .m = &m, .files = {.m = &m, .path = paths, .count = count}, .instances = instances};
    grid_init(&g, dims, SAMPLE_U8);
    const status st = dicom_order(&study, slices, count, how >> 1 & 3, how & 1, &g, &kept);
    check_order(slices, count, kept, &g, st);
    grid_release(&g, &m);
    check(mem_used(&m) == 0);
}

/* ---- names ---- */

static int sign(int order) {
    return (order > 0) - (order < 0);
}

/* An order: of two, the other way round is the other order; of three, no circle. */
static void compare_names(bytes *b) {
    char name[NAMES][64];
    int order[NAMES];
    for (int i = 0; i < NAMES; i++) {
        const size_t length = take_byte(b) % sizeof name[i];
        take(b, name[i], length);
        name[i][length] = 0;
    }
    for (int i = 0; i < NAMES; i++) {
        const char *x = name[i], *y = name[(i + 1) % NAMES];
        order[i] = sign(image_names_compare(x, y));
        check(order[i] == -sign(image_names_compare(y, x)));
        check((order[i] == 0) == (strcmp(x, y) == 0));
    }
    check(abs(order[0] + order[1] + order[2]) < NAMES);
}

/* ---- samples ---- */

static void take_packing(bytes *b, packed_samples *p) {
    const uint8_t bits = take_byte(b);
    const packed_wide wide = (packed_wide)(take_byte(b) % 3);
    const sample_type type = (sample_type)(SAMPLE_U8 + take_byte(b) % SAMPLE_F64);
    packed_init(p, wide ? SAMPLE_F64 : type, wide);
    p->components = 1 + take_byte(b) % PACKED_COMPONENTS;
    p->component = bits & 1 ? 1 + take_byte(b) % p->components : 0;
    if (bits & 2) {
        p->scale = take_number(b);
        p->offset = take_number(b);
    }
    for (int i = bits >> 2 & 7; i > 0; i--)
        packed_fill(p, take_number(b));
    p->has_range = bits & 32;
    p->valid_values = bits & 64;
    p->least = take_number(b);
    p->most = take_number(b);
}

static void unpack_samples(bytes *b) {
    packed_samples p;
    take_packing(b, &p);
    uint16_t number;
    take(b, &number, sizeof number);
    const size_t count = number % SAMPLES;
    const size_t width = sample_size(packed_type(&p));
    /* To the byte, so that what reads or writes too far is seen. */
    uint8_t *in = malloc(count * packed_bytes(&p) + 1), *out = malloc(count * width + 1);
    check(in && out);
    in[count * packed_bytes(&p)] = out[count * width] = 0x5A;
    take(b, in, count * packed_bytes(&p));
    check(packed_unpack(&p, in, out, count) <= count);
    check(out[count * width] == 0x5A);
    free(in);
    free(out);
}

/* ---- LZF ---- */

static void unpack_lzf(const bytes *b) {
    size_t size;
    if (lzf_size(b->at, b->left, &size))
        return;
    check(size <= 88 * b->left);
    char *to = malloc(size + 1);
    check(to != NULL);
    lzf_unpack(b->at, b->left, to);
    free(to);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    bytes b = {data, size};
    switch (take_byte(&b) % 5) {
    case 0: read_header(&b); break;
    case 1: order_slices(&b); break;
    case 2: compare_names(&b); break;
    case 3: unpack_samples(&b); break;
    default: unpack_lzf(&b); break;
    }
    return 0;
}
