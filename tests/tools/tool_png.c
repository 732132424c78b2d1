/* tool_png.c - what levels and filters of PNG cost for real pictures, beside our own bands.
 *
 *   tool_png [--runs N] PICTURE.png...
 *
 * CPU seconds of one thread, the least of N runs (5), and bytes.
 */
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render/app/colour.h"
#include "render/app/picture_png.h"
#include "render/look/picture_bytes.h"

static size_t written;

static void count_png(png_structp png, png_bytep data, size_t size) {
    (void)png;
    (void)data;
    written += size;
}

static void no_flush(png_structp png) {
    (void)png;
}

static status count(void *ctx, const void *data, size_t size) {
    (void)ctx;
    (void)data;
    written += size;
    return ST_OK;
}

static double cpu_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

typedef struct job {
    png_image png;
    unsigned char *bytes;
    picture ours;
    mem m;
    pool *one;
    int level, filter; /* level 0: our own bands */
} job;

static void write_libpng(job *j) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, NULL, count_png, no_flush);
    png_set_IHDR(png, info, j->png.width, j->png.height, 8, PNG_COLOR_TYPE_RGB_ALPHA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, j->level);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, j->filter);
    png_write_info(png, info);
    for (size_t y = 0; y < j->png.height; y++)
        png_write_row(png, j->bytes + 4 * y * j->png.width);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
}

static void row(job *j, const char *what, int runs) {
    double least = 1e9;
    for (int i = 0; i < runs; i++) {
        const double begun = cpu_seconds();
        written = 0;
        if (j->level > 0)
            write_libpng(j);
        else if (picture_png_write(&j->m, j->one, &j->ours, &(byte_sink){count, NULL}) != ST_OK)
            exit(1);
        const double took = cpu_seconds() - begun;
        least = took < least ? took : least;
    }
    printf("| %s | %.1f | %zu |\n", what, 1e3 * least, written);
}

/* The linear, premultiplied colours that these bytes came from. */
static void make_planes(job *j, leafcast_image *image) {
    const size_t pixels = (size_t)j->png.width * j->png.height;
    float *planes = malloc(4 * pixels * sizeof *planes), linear[256];
    if (!planes)
        exit(1);
    for (int k = 0; k < 256; k++)
        linear[k] = (float)picture_linear(k / 255.0);
    *image = (leafcast_image){.size = sizeof *image,
                              .r = planes,
                              .g = planes + pixels,
                              .b = planes + 2 * pixels,
                              .a = planes + 3 * pixels};
    for (size_t i = 0; i < pixels; i++) {
        const unsigned char *at = j->bytes + 4 * i;
        image->a[i] = (float)at[3] / 255.0f;
        image->r[i] = linear[at[0]] * image->a[i];
        image->g[i] = linear[at[1]] * image->a[i];
        image->b[i] = linear[at[2]] * image->a[i];
    }
}

static void table(const char *path, int runs) {
    static const struct {
        const char *name;
        int filter;
    } filters[] = {{"none", PNG_FILTER_NONE},
                   {"sub", PNG_FILTER_SUB},
                   {"up", PNG_FILTER_UP},
                   {"chosen row by row", PNG_ALL_FILTERS}};
    static const int levels[] = {1, 2, 6};
    job j = {.png = {.version = PNG_IMAGE_VERSION}};
    leafcast_image image;
    if (!png_image_begin_read_from_file(&j.png, path)) {
        fprintf(stderr, "tool_png: %s: %s\n", path, j.png.message);
        exit(1);
    }
    j.png.format = PNG_FORMAT_RGBA;
    j.bytes = malloc(PNG_IMAGE_SIZE(j.png));
    if (!j.bytes || !png_image_finish_read(&j.png, NULL, j.bytes, 0, NULL))
        exit(1);
    make_planes(&j, &image);
    j.ours = (picture){.width = j.png.width, .height = j.png.height, .image = &image};
    mem_init(&j.m, 0);
    if (pool_create(&j.m, 1, &j.one) != ST_OK)
        exit(1);
    printf("%s, %u x %u\n| | ms | bytes |\n|---|---:|---:|\n", path, j.png.width, j.png.height);
    row(&j, "ours, from floats", runs);
    for (int l = 0; l < 3; l++)
        for (int f = 0; f < 4; f++) {
            char what[64];
            snprintf(what, sizeof what, "level %d, filter %s", levels[l], filters[f].name);
            j.level = levels[l];
            j.filter = filters[f].filter;
            row(&j, what, runs);
        }
    pool_destroy(j.one);
    free(image.r);
    free(j.bytes);
}

int main(int argc, char **argv) {
    int first = 1, runs = 5;
    if (argc > 2 && strcmp(argv[1], "--runs") == 0) {
        runs = atoi(argv[2]);
        first = 3;
    }
    if (first >= argc || runs < 1) {
        fprintf(stderr, "Usage: tool_png [--runs N] PICTURE.png...\n");
        return 2;
    }
    for (int i = first; i < argc; i++)
        table(argv[i], runs);
    return 0;
}
