/* test_picture.c - pictures' bytes: encoded colours against the formula, PNG read back by libpng,
 * whatever the threads; PPM and PFM byte for byte. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "render/app/picture_png.h"
#include "render/app/picture_pnm.h"
#include "render/look/picture_bytes.h"

static mem budget;

typedef struct kept {
    unsigned char *data;
    size_t size, room, limit; /* of so many bytes the disk is full; 0: never */
} kept;

static status keep(void *ctx, const void *data, size_t size) {
    kept *k = ctx;
    if (k->limit && k->size + size > k->limit)
        return status_describe(ST_NOSPACE, "the disk is full");
    if (k->size + size > k->room) {
        k->room = 2 * (k->size + size);
        k->data = realloc(k->data, k->room);
        assert_non_null(k->data);
    }
    memcpy(k->data + k->size, data, size);
    k->size += size;
    return ST_OK;
}

/* ---- bytes ---- */

static int encoded(double x) {
    x = x > 0 ? x < 1 ? x : 1 : 0;
    x = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (int)(x * 255 + 0.5);
}

/* Every float near a border between two bytes, and a walk over all others. */
static void test_bytes(void **state) {
    (void)state;
    byte_table t;
    picture_bytes_init(&t);
    for (double x = 0x1p-20; x < 2.0; x *= 1.0001)
        assert_int_equal(picture_byte(&t, (float)x), encoded((double)(float)x));
    for (int k = 0; k < 256; k++) {
        const double at = (k + 0.5) / 255;
        float x = (float)(at <= 0.04045 ? at / 12.92 : pow((at + 0.055) / 1.055, 2.4));
        for (int i = 0; i < 5; i++)
            x = nextafterf(x, 0.0f);
        for (int i = 0; i < 11; i++, x = nextafterf(x, 2.0f))
            assert_int_equal(picture_byte(&t, x), encoded((double)x));
    }
    const float odd[] = {0.0f, -0.0f, -1.0f, -INFINITY, NAN, -NAN, 1e-40f};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        assert_int_equal(picture_byte(&t, odd[i]), 0);
    assert_int_equal(picture_byte(&t, 1.0f), 255);
    assert_int_equal(picture_byte(&t, INFINITY), 255);
}

/* ---- files ---- */

enum { WIDTH = 301, HEIGHT = 700 }; /* four bands, the last of fewer rows */

typedef struct planes {
    float r[WIDTH * HEIGHT], g[WIDTH * HEIGHT], b[WIDTH * HEIGHT], a[WIDTH * HEIGHT];
} planes;

static planes *sample(leafcast_image *image) {
    planes *p = calloc(1, sizeof *p);
    assert_non_null(p);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int x = i % WIDTH, y = i / WIDTH;
        p->a[i] = x < 100 ? 0.0f : x < 200 ? 1.0f : (float)(y % 256) / 255.0f;
        p->r[i] = p->a[i] * ((float)x / WIDTH);
        p->g[i] = p->a[i] * ((float)y / HEIGHT);
        p->b[i] = p->a[i] * (float)((x * 7 + y * 13) % 256) / 255.0f;
    }
    *image = (leafcast_image){
        .size = sizeof(leafcast_image), .r = p->r, .g = p->g, .b = p->b, .a = p->a};
    return p;
}

static kept write_png(int threads, const picture *p, size_t limit, status want) {
    kept k = {.limit = limit};
    pool *workers = NULL;
    assert_int_equal(pool_create(&budget, threads, &workers), ST_OK);
    assert_int_equal(picture_png_write(&budget, workers, p, &(byte_sink){keep, &k}), want);
    pool_destroy(workers);
    assert_int_equal(mem_used(&budget), 0);
    return k;
}

static void check_pixels(const kept *k, const picture *p) {
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_memory(&png, k->data, k->size));
    assert_int_equal(png.width, p->width);
    assert_int_equal(png.height, p->height);
    assert_int_equal((png.format & PNG_FORMAT_FLAG_ALPHA) != 0, p->image->a != NULL);
    png.format = PNG_FORMAT_RGBA;
    unsigned char *bytes = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, bytes, 0, NULL));
    for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
        const float a = p->image->a ? p->image->a[i] : 1.0f;
        const float *const colours[3] = {p->image->r, p->image->g, p->image->b};
        for (int c = 0; c < 3; c++)
            assert_int_equal(bytes[4 * i + c], a > 0 ? encoded((double)(colours[c][i] / a)) : 0);
        assert_int_equal(bytes[4 * i + 3], (int)((double)a * 255 + 0.5));
    }
    free(bytes);
}

static bool holds(const kept *k, const char *text, size_t size) {
    for (size_t i = 0; i + size <= k->size; i++)
        if (memcmp(k->data + i, text, size) == 0)
            return true;
    return false;
}

static status nowhere(void *ctx, const void *data, size_t size) {
    (void)ctx;
    (void)data;
    (void)size;
    return ST_OK;
}

static void test_png(void **state) {
    (void)state;
    leafcast_image image;
    planes *p = sample(&image);
    const image_meta meta[] = {{"isovalues", "37,80"}, {"volume", "W\303\274rfel.leaf"}};
    const picture whole = {WIDTH, HEIGHT, &image, meta, 2};
    kept first = write_png(1, &whole, 0, ST_OK);
    check_pixels(&first, &whole);
    assert_true(holds(&first, "sRGB", 4));
    assert_true(holds(&first, "tEXtleafcast:isovalues\00037,80", 28));
    assert_true(holds(&first, "iTXtleafcast:volume", 19));
    for (int threads = 2; threads <= 5; threads += 3) {
        kept again = write_png(threads, &whole, 0, ST_OK);
        assert_int_equal(again.size, first.size);
        assert_memory_equal(again.data, first.data, first.size);
        free(again.data);
    }
    /* Opaque; one pixel; wider than a band. */
    image.a = NULL;
    const picture shapes[] = {
        {1, 1, &image, NULL, 0}, {WIDTH * HEIGHT, 1, &image, NULL, 0}, {1, 3000, &image, NULL, 0}};
    for (int i = 0; i < 3; i++) {
        kept k = write_png(2, &shapes[i], 0, ST_OK);
        check_pixels(&k, &shapes[i]);
        free(k.data);
    }
    free(first.data);
    free(p);
}

/* Wherever the sink gives up, its own fault comes back, and nothing is lost. */
static void test_png_full(void **state) {
    (void)state;
    leafcast_image image;
    planes *p = sample(&image);
    const picture whole = {WIDTH, HEIGHT, &image, NULL, 0};
    kept good = write_png(2, &whole, 0, ST_OK);
    for (size_t limit = 1; limit < good.size; limit += limit / 3 + 1) {
        kept k = write_png(2, &whole, limit, ST_NOSPACE);
        assert_string_equal(status_text(), "the disk is full");
        free(k.data);
    }
    free(good.data);
    free(p);
}

/* How many allocations a PNG takes; whichever fails, that is said, and nothing is lost. */
static int allocations(const picture *p) {
    const byte_sink none = {nowhere, NULL};
    pool *workers = NULL;
    assert_int_equal(pool_create(&budget, 1, &workers), ST_OK);
    const size_t before = mem_used(&budget);
    status st = ST_NOMEM;
    int k = 0;
    while (st != ST_OK && k < 1000) {
        fault_arm(FAULT_ALLOC, ++k);
        st = picture_png_write(&budget, workers, p, &none);
        assert_true(st == ST_OK || st == ST_NOMEM);
        assert_int_equal(mem_used(&budget), before);
    }
    fault_arm(FAULT_ALLOC, 0);
    pool_destroy(workers);
    return k - 1;
}

/* Those of libpng are among them: it keeps each text. */
static void test_png_memory(void **state) {
    (void)state;
    leafcast_image image;
    planes *p = sample(&image);
    const image_meta meta[] = {{"isovalues", "37,80"}, {"volume", "a.leaf"}};
    const int bare = allocations(&(picture){WIDTH, HEIGHT, &image, NULL, 0});
    assert_in_range(bare, 1, 500);
    assert_true(allocations(&(picture){WIDTH, HEIGHT, &image, meta, 2}) > bare);
    free(p);
}

/* Metadata of any length: cut between two letters. */
static void test_png_text(void **state) {
    (void)state;
    static char value[3 * PICTURE_PNG_TEXT];
    leafcast_image image;
    planes *p = sample(&image);
    for (int letters = 0; letters < 3; letters++) {
        const int n = PICTURE_PNG_TEXT - 1 - letters;
        memset(value, 'a', sizeof value - 1);
        memcpy(value + n, "\342\202\254", 3);
        const image_meta meta[] = {{"volume", value}};
        kept k = write_png(1, &(picture){WIDTH, HEIGHT, &image, meta, 1}, 0, ST_OK);
        value[n] = 0;
        assert_true(holds(&k, value, (size_t)n));
        assert_false(holds(&k, "a\342", 2));
        free(k.data);
    }
    free(p);
}

static void test_pnm(void **state) {
    (void)state;
    float r[2] = {0.0f, 1.0f}, g[2] = {0.25f, 2.0f}, b[2] = {0.5f, -1.0f};
    const leafcast_image image = {.size = sizeof(leafcast_image), .r = r, .g = g, .b = b};
    const picture p = {1, 2, &image, NULL, 0};
    kept ppm = {0}, pfm = {0};
    assert_int_equal(picture_ppm_write(&budget, NULL, &p, &(byte_sink){keep, &ppm}), ST_OK);
    assert_int_equal(ppm.size, 17);
    assert_memory_equal(ppm.data, "P6\n1 2\n255\n\0\211\274\377\377\0", 17);
    assert_int_equal(picture_pfm_write(&budget, NULL, &p, &(byte_sink){keep, &pfm}), ST_OK);
    const float want[6] = {1.0f, 2.0f, -1.0f, 0.0f, 0.25f, 0.5f};
    assert_int_equal(pfm.size, 12 + sizeof want);
    assert_memory_equal(pfm.data, "PF\n1 2\n-1.0\n", 12);
    assert_memory_equal(pfm.data + 12, want, sizeof want);
    free(ppm.data);
    free(pfm.data);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bytes),    cmocka_unit_test(test_png),
        cmocka_unit_test(test_png_full), cmocka_unit_test(test_png_memory),
        cmocka_unit_test(test_png_text), cmocka_unit_test(test_pnm),
    };
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
