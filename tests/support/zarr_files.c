#include "tests/support/zarr_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <ftw.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/support/scratch.h"

static const struct {
    const char *dtype;
} names[] = {
    [SAMPLE_U8] = {"u1"},  [SAMPLE_I8] = {"i1"},  [SAMPLE_U16] = {"u2"}, [SAMPLE_I16] = {"i2"},
    [SAMPLE_F32] = {"f4"}, [SAMPLE_U32] = {"u4"}, [SAMPLE_I32] = {"i4"}, [SAMPLE_F64] = {"f8"},
    [SAMPLE_U64] = {"u8"}, [SAMPLE_I64] = {"i8"}};

double zarr_files_value(const zarr_files *z, const int at[ZARR_FILES_AXES]) {
    uint32_t sum = 0, noise;
    for (int a = 0; a < z->axes; a++)
        sum = 31 * sum + (uint32_t)at[a];
    noise = sum * 2654435761U >> 28;
    /* 4 .. 115: any type holds it. */
    return 4.0 + (double)((at[z->axes - 1] + 2 * at[0] + at[1]) % 96) + (double)noise;
}

static void put_number(const zarr_files *z, double v, char *to) {
    const int width = (int)sample_size(z->type);
    const float f = (float)v;
    const int64_t whole = (int64_t)v;
    if (z->type == SAMPLE_F32)
        memcpy(to, &f, 4);
    else if (z->type == SAMPLE_F64)
        memcpy(to, &v, 8);
    else
        memcpy(to, &whole, (size_t)width);
    for (int i = 0; z->big_endian && i < width / 2; i++) {
        const char c = to[i];
        to[i] = to[width - 1 - i];
        to[width - 1 - i] = c;
    }
}

/* The bytes of the chunk of these indices. */
static char *make_chunk(const zarr_files *z, const int index[ZARR_FILES_AXES], int count) {
    const size_t width = sample_size(z->type);
    char *bytes = malloc((size_t)count * width);
    assert_non_null(bytes);
    for (int n = 0; n < count; n++) {
        int at[ZARR_FILES_AXES] = {0};
        for (int i = 0, left = n; i < z->axes; i++) {
            const int a = z->fortran ? i : z->axes - 1 - i;
            at[a] = index[a] * z->chunk[a] + left % z->chunk[a];
            left /= z->chunk[a];
        }
        put_number(z, zarr_files_value(z, at), bytes + (size_t)n * width);
    }
    return bytes;
}

static char *shuffle(const zarr_files *z, char *bytes, int count) {
    const int width = (int)sample_size(z->type);
    char *out = malloc((size_t)count * (size_t)width);
    assert_non_null(out);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < width; j++)
            out[j * count + i] = bytes[i * width + j];
    free(bytes);
    return out;
}

static char *pack(const zarr_files *z, char *bytes, size_t *size) {
    if (!z->packer)
        return bytes;
    const size_t room = *size + *size / 16 + 1024;
    char *out = malloc(room);
    uLongf packed = room;
    assert_non_null(out);
    if (strcmp(z->packer, "zstd") == 0)
        packed = ZSTD_compress(out, room, bytes, *size, 1);
    else
        assert_int_equal(compress2((Bytef *)out, &packed, (Bytef *)bytes, *size, 1), Z_OK);
    *size = packed;
    free(bytes);
    return out;
}

/* There are more chunks than names that scratch_path() keeps. */
static void write_file(const char *path, const void *bytes, size_t size) {
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, size, out), size);
    assert_int_equal(fclose(out), 0);
}

static void write_chunk(const zarr_files *z, const char *folder, const int index[ZARR_FILES_AXES],
                        int count) {
    char path[512];
    size_t size = (size_t)count * sample_size(z->type);
    int length = snprintf(path, sizeof path, "%s", folder);
    for (int a = 0; a < z->axes; a++) {
        if (a == 0 || z->separator == '/')
            mkdir(path, 0755);
        length += snprintf(path + length, sizeof path - (size_t)length, "%c%d",
                           a ? z->separator : '/', index[a]);
    }
    char *bytes = make_chunk(z, index, count);
    bytes = pack(z, z->shuffled ? shuffle(z, bytes, count) : bytes, &size);
    write_file(path, bytes, size);
    free(bytes);
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *at) {
    (void)info;
    (void)kind;
    (void)at;
    return remove(path);
}

static void write_json(const zarr_files *z, const char *name) {
    char path[300], text[1024];
    int n = snprintf(text, sizeof text, "{\"zarr_format\": 2, \"shape\": [");
    for (int a = 0; a < z->axes; a++)
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%d", a ? ", " : "", z->shape[a]);
    n += snprintf(text + n, sizeof text - (size_t)n, "], \"chunks\": [");
    for (int a = 0; a < z->axes; a++)
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%d", a ? ", " : "", z->chunk[a]);
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "], \"dtype\": \"%c%s\", \"fill_value\": 9, \"order\": \"%c\", "
                  "\"dimension_separator\": \"%c\", \"compressor\": ",
                  z->big_endian ? '>' : '<', names[z->type].dtype, z->fortran ? 'F' : 'C',
                  z->separator);
    n += z->packer ? snprintf(text + n, sizeof text - (size_t)n, "{\"id\": \"%s\"}", z->packer)
                   : snprintf(text + n, sizeof text - (size_t)n, "null");
    if (z->shuffled)
        snprintf(text + n, sizeof text - (size_t)n,
                 ", \"filters\": [{\"id\": \"shuffle\", \"elementsize\": %zu}]}",
                 sample_size(z->type));
    else
        snprintf(text + n, sizeof text - (size_t)n, ", \"filters\": null}");
    snprintf(path, sizeof path, "%s/.zarray", name);
    scratch_text(path, text);
}

const char *zarr_files_make(const zarr_files *z, const char *name) {
    int index[ZARR_FILES_AXES] = {0}, count = 1, n = 0;
    (void)nftw(scratch_path(name), remove_one, 16, FTW_DEPTH | FTW_PHYS);
    assert_int_equal(mkdir(scratch_path(name), 0755), 0);
    write_json(z, name);
    for (int a = 0; a < z->axes; a++)
        count *= z->chunk[a];
    for (int a = 0; a < z->axes; n++) {
        if (!z->absent || n % z->absent)
            write_chunk(z, scratch_path(name), index, count);
        for (a = 0; a < z->axes && ++index[a] * z->chunk[a] >= z->shape[a]; a++)
            index[a] = 0;
    }
    return scratch_path(name);
}
