/* naive_chunks.c - all chunks of an array, one after the other, by
 * formats/OUTSIDE.md. */
#include "tests/support/naive_chunks.h"

#include <bzlib.h>
#include <dlfcn.h>
#include <lz4.h>
#include <lzma.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/support/naive_bytes.h"

enum { BEHIND = 4096, AXES = 8, SIZE = 4608 };

typedef struct filter {
    int kind, element, type, coded;
    long row;
    bool big, big_coded;
    double scale, offset;
} filter;

typedef struct array {
    int axes, codec, filters, type;
    bool fortran, slash, big, summed, cut;
    long step, chunk[AXES], role[AXES];
    long first_number, numbers;
    filter filter[8];
    unsigned char fill[8];
} array;

static const int widths[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 2, 8, 8};

static filter read_filter(const unsigned char *b) {
    const uint64_t flags = naive_number(b + 16, 4);
    return (filter){.kind = (int)naive_number(b, 4),
                    .element = (int)naive_number(b + 4, 4),
                    .type = (int)naive_number(b + 8, 4),
                    .coded = (int)naive_number(b + 12, 4),
                    .big = flags & 1,
                    .big_coded = flags >> 1 & 1,
                    .row = (long)naive_number(b + 20, 4),
                    .scale = naive_real64(b + 24),
                    .offset = naive_real64(b + 32)};
}

static array read_array(const unsigned char *b) {
    const uint64_t flags = naive_number(b + 4104, 4);
    const long components = (long)naive_number(b + 32, 4), one = (long)naive_number(b + 36, 4);
    array a = {.axes = (int)naive_number(b + 4100, 4),
               .codec = (int)naive_number(b + 4108, 4),
               .filters = (int)naive_number(b + 4112, 4),
               .type = (int)naive_number(b + 20, 4),
               .fortran = flags & 1,
               .slash = flags >> 1 & 1,
               .summed = flags >> 3 & 1,
               .cut = flags >> 4 & 1,
               .big = naive_number(b + 40, 4) & 1,
               .step = (long)naive_number(b + 4116, 4),
               .first_number = one ? one - 1 : 0,
               .numbers = one ? 1 : components};
    memcpy(a.fill, b + 4128, 8);
    for (int i = 0; i < AXES; i++) {
        a.chunk[i] = (long)naive_number(b + 4144 + 4 * i, 4);
        a.role[i] = (long)naive_number(b + 4176 + 4 * i, 4);
        a.filter[i] = read_filter(b + 4208 + 40 * i);
    }
    return a;
}

const char *naive_chunks_check(const unsigned char *section, int *chunks) {
    const uint64_t form = naive_number(section + BEHIND, 4);
    const uint64_t flags = naive_number(section + 4104, 4);
    *chunks = form > 0;
    if (form == 0)
        return naive_zeros(section, BEHIND, SIZE) ? NULL : "section OUTSIDE behind its path";
    const array a = read_array(section);
    int of[6] = {0};
    if (form > 3 || a.axes < 3 || a.axes > AXES || a.codec < 1 || a.codec > 5 || a.filters < 0 ||
        a.filters > 8 || flags > 31 || (form >= 2 && (flags & 6)) || (form == 1 && a.cut) ||
        (form >= 2 && !naive_zeros(section, 4120, 4124)) ||
        (form >= 2 && !naive_zeros(section, 4136, 4144)) ||
        (form == 3 && !naive_zeros(section, 0, 20)) || !naive_zeros(section, 4124, 4128) ||
        !naive_zeros(section, 4528, SIZE))
        return "section OUTSIDE of chunks";
    for (int i = 0; i < AXES; i++) {
        if (a.role[i] > 5 || (i < a.axes) != (a.chunk[i] > 0) || (i >= a.axes && a.role[i]))
            return "an axis of chunks";
        of[a.role[i]] += i < a.axes;
        if (i < a.filters && (a.filter[i].kind == 6) != (a.filter[i].row > 0))
            return "a filter of rows";
        if (i >= a.filters && !naive_zeros(section, 4208 + 40 * (size_t)i, 4248 + 40 * (size_t)i))
            return "a filter too many";
    }
    return of[1] == 1 && of[2] == 1 && of[3] == 1 && of[4] <= 1 && of[5] <= 1 ? NULL
                                                                              : "roles of axes";
}

/* ---- unpacking ---- */

/* more: whether bytes may follow that do not fit. */
static bool inflate_all(const unsigned char *in, size_t size, unsigned char *out, size_t room,
                        bool more) {
    z_stream z = {.next_in = (unsigned char *)(uintptr_t)in,
                  .avail_in = (unsigned)size,
                  .next_out = out,
                  .avail_out = (unsigned)room};
    if (inflateInit2(&z, 15 + 32) != Z_OK)
        return false;
    const bool good = (inflate(&z, Z_FINISH) == Z_STREAM_END || more) && z.avail_out == 0;
    inflateEnd(&z);
    return good;
}

static bool unpack_zstd(const unsigned char *in, size_t size, unsigned char *out, size_t room) {
    ZSTD_DStream *z = ZSTD_createDStream();
    ZSTD_inBuffer from = {in, size, 0};
    ZSTD_outBuffer to = {out, room, 0};
    for (size_t left = 1; z && left && to.pos < room && !ZSTD_isError(left);) {
        const size_t before = from.pos + to.pos;
        left = ZSTD_decompressStream(z, &to, &from);
        left = from.pos + to.pos == before ? 0 : left;
    }
    ZSTD_freeDStream(z);
    return to.pos == room;
}

static bool unpack_stream(const unsigned char *in, size_t size, unsigned char *out, size_t room,
                          bool more) {
    if (size >= 4 && memcmp(in, "\x28\xb5\x2f\xfd", 4) == 0)
        return more ? unpack_zstd(in, size, out, room)
                    : ZSTD_decompress(out, room, in, size) == room;
    if (size >= 3 && memcmp(in, "BZh", 3) == 0) {
        unsigned got = (unsigned)room;
        const int end = BZ2_bzBuffToBuffDecompress((char *)out, &got, (char *)(uintptr_t)in,
                                                   (unsigned)size, 0, 0);
        return (end == BZ_OK && got == room) || (more && end == BZ_OUTBUFF_FULL);
    }
    if (size >= 6 && memcmp(in, "\xfd\x37zXZ\0", 6) == 0) {
        uint64_t limit = UINT64_MAX;
        size_t from = 0, to = 0;
        const lzma_ret end =
            lzma_stream_buffer_decode(&limit, 0, NULL, in, &from, size, out, &to, room);
        return (end == LZMA_OK && to == room) || (more && end == LZMA_BUF_ERROR);
    }
    return inflate_all(in, size, out, room, more);
}

static bool unpack_lzf(const unsigned char *in, size_t size, unsigned char *out, size_t room) {
    size_t at = 0, to = 0;
    while (at < size) {
        const size_t c = in[at++];
        if (c < 32) {
            if (at + c + 1 > size || to + c + 1 > room)
                return false;
            memcpy(out + to, in + at, c + 1);
            at += c + 1;
            to += c + 1;
            continue;
        }
        size_t length = c >> 5;
        if (length == 7 && at < size)
            length += in[at++];
        if (at >= size)
            return false;
        const size_t back = ((c & 31) << 8) + in[at++] + 1;
        if (back > to || to + length + 2 > room)
            return false;
        for (length += 2; length > 0; length--, to++)
            out[to] = out[to - back];
    }
    return to == room;
}

typedef int blosc_unpack(const void *from, void *to, size_t room, int threads);

static bool unpack(int codec, const unsigned char *in, size_t size, unsigned char *out, size_t room,
                   bool more) {
    if (codec == 1) {
        const bool good = size == room || (more && size > room);
        memcpy(out, in, good ? room : 0);
        return good;
    }
    if (codec == 2)
        return unpack_stream(in, size, out, room, more);
    if (codec == 5)
        return unpack_lzf(in, size, out, room);
    if (codec == 4)
        return size >= 4 && naive_number(in, 4) == room &&
               LZ4_decompress_safe((const char *)in + 4, (char *)out, (int)size - 4, (int)room) ==
                   (int)room;
    void *library = dlopen("libblosc.so.1", RTLD_NOW);
    void *symbol = library ? dlsym(library, "blosc_decompress_ctx") : NULL;
    blosc_unpack *blosc;
    memcpy(&blosc, &symbol, sizeof blosc);
    return symbol && blosc(in, out, room, 1) == (int)room;
}

/* ---- filters ---- */

static void turn(unsigned char *numbers, long count, int width) {
    for (long i = 0; i < count; i++)
        for (int j = 0; j < width / 2; j++) {
            unsigned char *a = numbers + i * width + j, *b = numbers + (i + 1) * width - 1 - j, c;
            c = *a;
            *a = *b;
            *b = c;
        }
}

static bool is_signed(int type) {
    return type == 2 || type == 4 || type == 7 || type == 11;
}

static uint64_t whole_at(const unsigned char *at, int type) {
    const int width = widths[type];
    uint64_t v = naive_number(at, width);
    if (is_signed(type) && width < 8 && v >> (8 * width - 1))
        v |= ~(uint64_t)0 << (8 * width);
    return v;
}

static void put_whole(unsigned char *at, int width, uint64_t v) {
    for (int i = 0; i < width; i++)
        at[i] = (unsigned char)(v >> (8 * i));
}

static double real_at(const unsigned char *at, int type) {
    if (type == 5)
        return (double)naive_float_of(naive_number(at, 4));
    if (type == 8)
        return naive_real64(at);
    return is_signed(type) ? (double)(int64_t)whole_at(at, type) : (double)whole_at(at, type);
}

static void put_real(unsigned char *at, int type, double v) {
    const float f = (float)v;
    if (type == 5)
        memcpy(at, &f, 4);
    else if (type == 8)
        memcpy(at, &v, 8);
    else
        put_whole(at, widths[type], (uint64_t)(int64_t)v);
}

static void unshuffle(const filter *f, const unsigned char *in, unsigned char *out, long bytes) {
    const long size = f->element > 1 ? f->element : 1, count = bytes / size;
    for (long i = 0; i < bytes; i++)
        out[i % count * size + i / count] = in[i];
}

static void sum_up(const filter *f, const unsigned char *in, unsigned char *out, long count) {
    const int from = widths[f->coded], to = widths[f->type];
    uint64_t whole = 0;
    float single = 0;
    double real = 0;
    for (long i = 0; i < count; i++)
        if (f->type == 5) {
            const float v = naive_float_of(naive_number(in + 4 * i, 4));
            single = i ? single + v : v;
            memcpy(out + 4 * i, &single, 4);
        } else if (f->type == 8) {
            real = i ? real + naive_real64(in + 8 * i) : naive_real64(in);
            memcpy(out + 8 * i, &real, 8);
        } else {
            put_whole(out + i * to, to, whole += whole_at(in + i * from, f->coded));
        }
}

static void sum_rows(const filter *f, const unsigned char *in, unsigned char *out, long count) {
    const int width = widths[f->type];
    for (long i = 0; i < count; i++) {
        uint64_t v = naive_number(in + i * width, width);
        if (i % f->row >= f->element)
            v += naive_number(out + (i - f->element) * width, width);
        put_whole(out + i * width, width, v);
    }
}

static double unscaled(const filter *f, double v) {
    if (f->kind != 3)
        return v;
    if (f->coded != 5)
        return v / f->scale + f->offset;
    const float quotient = (float)v / (float)f->scale;
    return (double)(quotient + (float)f->offset);
}

static void undo(const filter *f, unsigned char *in, unsigned char *out, long count) {
    const int from = widths[f->coded], to = widths[f->type];
    if (f->kind == 1) {
        unshuffle(f, in, out, count * from);
        return;
    }
    if (f->big_coded)
        turn(in, count, from);
    if (f->kind == 2)
        sum_up(f, in, out, count);
    else if (f->kind == 6)
        sum_rows(f, in, out, count);
    else
        for (long i = 0; i < count; i++)
            put_real(out + i * to, f->type, unscaled(f, real_at(in + i * from, f->coded)));
    if (f->big)
        turn(out, count, to);
}

/* ---- chunks ---- */

/* Read a file; *size 0 and NULL where there is none. */
static unsigned char *read_all(const char *path, size_t *size) {
    FILE *in = fopen(path, "rb");
    *size = 0;
    if (!in)
        return NULL;
    fseek(in, 0, SEEK_END);
    *size = (size_t)ftell(in);
    rewind(in);
    unsigned char *bytes = malloc(*size + 1);
    if (bytes && fread(bytes, 1, *size, in) != *size)
        *size = 0;
    fclose(in);
    return bytes;
}

/* What an entry of section CHUNKS says was not applied. */
static array without(const array *all, uint64_t skipped) {
    array a = *all;
    a.filters = 0;
    for (int i = 0; i < all->filters; i++)
        if (!(skipped >> i & 1))
            a.filter[a.filters++] = all->filter[i];
    int bit = all->filters;
    if (all->codec != 1 && skipped >> bit++ & 1)
        a.codec = 1;
    a.summed = all->summed && !(skipped >> bit & 1);
    return a;
}

/* The packed bytes of a chunk, to be freed; NULL: it is not there. entry: NULL for a file. */
static unsigned char *packed_chunk(array *a, const naive_chunks_file *in,
                                   const unsigned char *entry, long z, const char *path,
                                   size_t *size) {
    if (!entry)
        return read_all(path, size);
    const uint64_t from = in->starts ? in->starts[z] : 0;
    const uint64_t file_size = in->starts ? in->starts[z + 1] - from : in->size;
    const uint64_t offset = naive_number(entry, 8);
    *size = (size_t)naive_number(entry + 8, 4);
    *a = without(a, naive_number(entry + 12, 4));
    if (!*size || offset > file_size || *size > file_size - offset)
        return NULL;
    unsigned char *bytes = malloc(*size);
    if (bytes)
        memcpy(bytes, in->bytes + from + offset, *size);
    *size -= a->summed ? 4 : 0;
    return bytes;
}

/* The numbers of a chunk, little endian, in one of two rooms; NULL: it cannot be read. */
static unsigned char *chunk_of(array a, const naive_chunks_file *in, const unsigned char *entry,
                               long z, const char *path, long count, unsigned char *room[2]) {
    const int width = widths[a.type];
    size_t size;
    int now = 0;
    unsigned char *bytes = packed_chunk(&a, in, entry, z, path, &size);
    if (!bytes) {
        for (long i = 0; i < count; i++)
            memcpy(room[0] + i * width, a.fill, (size_t)width);
        return room[0];
    }
    const int coded = a.filters ? a.filter[a.filters - 1].coded : a.type;
    const bool good = unpack(a.codec, bytes, size, room[0], (size_t)(count * widths[coded]), a.cut);
    free(bytes);
    for (int i = a.filters - 1; good && i >= 0; i--, now = 1 - now)
        undo(&a.filter[i], room[now], room[1 - now], count);
    if (a.big)
        turn(room[now], count, width);
    return good ? room[now] : NULL;
}

/* Put the numbers of a chunk that are asked for into the whole. index: one an axis. */
static void scatter(const array *a, const long dims[3], const long index[AXES], long count,
                    const unsigned char *chunk, unsigned char *numbers) {
    const int width = widths[a->type];
    for (long n = 0; n < count; n++) {
        long at[6] = {0, 0, 0, 0, 0, a->step}, left = n;
        for (int i = 0; i < a->axes; i++) {
            const int axis = a->fortran ? i : a->axes - 1 - i;
            at[a->role[axis]] = index[axis] * a->chunk[axis] + left % a->chunk[axis];
            left /= a->chunk[axis];
        }
        const long c = at[4] - a->first_number;
        if (at[1] >= dims[0] || at[2] >= dims[1] || at[3] >= dims[2] || at[0] || c < 0 ||
            c >= a->numbers || at[5] != a->step)
            continue;
        const long to = ((at[3] * dims[1] + at[2]) * dims[0] + at[1]) * a->numbers + c;
        memcpy(numbers + to * width, chunk + n * width, (size_t)width);
    }
}

static void name_chunk(const array *a, const char *json_path, const long index[AXES],
                       char path[8192]) {
    int length = (int)(strrchr(json_path, '/') + 1 - json_path);
    memcpy(path, json_path, (size_t)length);
    for (int i = 0; i < a->axes; i++)
        length += snprintf(path + length, 64, "%s%ld", i ? a->slash ? "/" : "." : "", index[i]);
}

/* The chunks that are met along each axis: first and last. */
static void find_range(const array *a, const long dims[3], long first[AXES], long last[AXES]) {
    for (int i = 0; i < a->axes; i++) {
        const long r = a->role[i];
        first[i] = r == 5 ? a->step : r == 4 ? a->first_number : 0;
        last[i] = r == 5   ? a->step
                  : r == 4 ? a->first_number + a->numbers - 1
                  : r      ? dims[r - 1] - 1
                           : 0;
        first[i] /= a->chunk[i];
        last[i] /= a->chunk[i];
    }
}

/* The entry of a chunk in the table: along x fastest, then y, z, numbers. */
static const unsigned char *entry_of(const array *a, const naive_chunks_file *in,
                                     const long index[AXES], const long first[AXES],
                                     const long last[AXES]) {
    long n = 0;
    if (!in->table)
        return NULL;
    for (long role = 4; role >= 1; role--)
        for (int i = 0; i < a->axes; i++)
            if (a->role[i] == role)
                n = n * (last[i] - first[i] + 1) + index[i] - first[i];
    return n < in->table_count ? in->table + 16 * n : NULL;
}

/* How many numbers a chunk must have: all, or those of rows in the grid. */
static long count_of(const array *a, const long dims[3], const long index[AXES], long count) {
    for (int i = 0; i < a->axes; i++) {
        const long left = dims[1] - index[i] * a->chunk[i];
        if (a->cut && a->role[i] == 2 && left < a->chunk[i])
            return count / a->chunk[i] * left;
    }
    return count;
}

/* The slice of a chunk that has one. */
static long slice_of(const array *a, const long index[AXES]) {
    long z = 0;
    for (int i = 0; i < a->axes; i++)
        z = a->role[i] == 3 ? index[i] : z;
    return z;
}

static bool read_chunks(const array *a, const naive_chunks_file *in, const long dims[3], long count,
                        unsigned char *room[2], unsigned char *numbers) {
    long index[AXES] = {0}, first[AXES] = {0}, last[AXES] = {0}, chunks = 1;
    find_range(a, dims, first, last);
    for (int i = 0; i < a->axes; i++)
        chunks *= last[i] - (index[i] = first[i]) + 1;
    if (in->table && chunks != in->table_count)
        return false;
    for (int i = 0; i < a->axes;) {
        char path[8192];
        name_chunk(a, in->path, index, path);
        const long there = count_of(a, dims, index, count);
        const unsigned char *chunk = chunk_of(*a, in, entry_of(a, in, index, first, last),
                                              slice_of(a, index), path, there, room);
        if (!chunk)
            return false;
        scatter(a, dims, index, there, chunk, numbers);
        for (i = 0; i < a->axes && ++index[i] > last[i]; i++)
            index[i] = first[i];
    }
    return true;
}

const char *naive_chunks_read(const unsigned char *section, const naive_chunks_file *in,
                              const long dims[3], unsigned char **numbers) {
    const array a = read_array(section);
    long count = 1;
    *numbers = NULL;
    if ((naive_number(section + BEHIND, 4) >= 2) != (in->table != NULL))
        return "a table of chunks, there or not there";
    if (!in->table && XXH3_64bits(in->bytes, in->size) != naive_number(section + 4136, 8))
        return "the file that describes the chunks";
    for (int i = 0; i < a.axes; i++) {
        count *= a.chunk[i];
        if (in->starts && a.role[i] == 3 && a.chunk[i] != 1)
            return "a chunk of several slices";
    }
    unsigned char *room[2] = {malloc((size_t)count * 8), malloc((size_t)count * 8)};
    *numbers = malloc((size_t)(dims[0] * dims[1] * dims[2] * a.numbers * widths[a.type]));
    const bool good =
        room[0] && room[1] && *numbers && read_chunks(&a, in, dims, count, room, *numbers);
    free(room[0]);
    free(room[1]);
    return good ? NULL : "a chunk cannot be read";
}
