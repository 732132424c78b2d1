/* naive_outside.c - steps in the comments are those of section 11 of formats/FORMAT.md. */
#include "tests/support/naive_outside.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/naive_chunks.h"

typedef struct place {
    uint64_t file_bytes, offset;
    int64_t seconds;
    long nanoseconds;
    int type;
    long components, component;
    bool big, colour, has_missing, scaled;
    double slope, intercept, missing;
} place;

static const int widths[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 2, 8, 8};

static const char *read_section(const unsigned char *b, place *p) {
    const uint64_t flags = naive_number(b + 40, 4);
    *p = (place){.file_bytes = naive_number(b, 8),
                 .seconds = (int64_t)naive_number(b + 8, 8),
                 .nanoseconds = (long)naive_number(b + 16, 4),
                 .type = (int)naive_number(b + 20, 4),
                 .offset = naive_number(b + 24, 8),
                 .components = (long)naive_number(b + 32, 4),
                 .component = (long)naive_number(b + 36, 4),
                 .big = flags & 1,
                 .colour = flags >> 1 & 1,
                 .has_missing = flags >> 2 & 1,
                 .slope = naive_real64(b + 48),
                 .intercept = naive_real64(b + 56),
                 .missing = naive_real64(b + 64)};
    p->scaled = p->slope != 0 && !(p->slope == 1 && p->intercept == 0);
    if (flags > 7 || p->type < 1 || p->type > 11 || p->components < 1 || p->components > 256 ||
        p->component > p->components || p->nanoseconds > 999999999 || !isfinite(p->slope) ||
        !isfinite(p->intercept) || !naive_zeros(b, 44, 48) || !naive_zeros(b, 72, 128) ||
        !naive_text(b + 128, 3968) || !b[128])
        return "section OUTSIDE";
    return NULL;
}

static const char *read_file(const char *leaf, const char *name, const place *p, char path[8192],
                             unsigned char **bytes) {
    struct stat info;
    const char *slash = strrchr(leaf, '/');
    const int folder = name[0] == '/' || !slash ? 0 : (int)(slash + 1 - leaf);
    snprintf(path, 8192, "%.*s%s", folder, leaf, name);
    FILE *in = fopen(path, "rb");
    if (!in)
        return "the other file cannot be opened";
    const bool same = fstat(fileno(in), &info) == 0 && (uint64_t)info.st_size == p->file_bytes &&
                      info.st_mtim.tv_sec == p->seconds && info.st_mtim.tv_nsec == p->nanoseconds;
    *bytes = malloc(p->file_bytes);
    const bool read = *bytes && fread(*bytes, 1, p->file_bytes, in) == p->file_bytes;
    fclose(in);
    return !same ? "the other file has changed" : read ? NULL : "the other file cannot be read";
}

/* Read the files of all slices, one behind the other: *starts, and the end. */
static const char *read_slices(const naive_leaf *leaf, const char *path, const char *folder,
                               const unsigned char *slices, unsigned char **all,
                               uint64_t **starts) {
    const long count = leaf->dims[2];
    const char *why = NULL;
    *starts = calloc((size_t)count + 1, sizeof **starts);
    for (long z = 0; z < count && !why; z++) {
        const unsigned char *b = slices + 280 * z;
        const place p = {.file_bytes = naive_number(b, 8),
                         .seconds = (int64_t)naive_number(b + 8, 8),
                         .nanoseconds = (long)naive_number(b + 16, 4)};
        const char *own = (const char *)b + 24;
        unsigned char *bytes = NULL;
        char name[8192], file[8192];
        if (!naive_zeros(b, 20, 24) || !naive_text(b + 24, 256) || !*own || strchr(own, '/') ||
            strcmp(own, ".") == 0 || strcmp(own, "..") == 0)
            return "the file of a slice";
        snprintf(name, sizeof name, "%s/%s", folder, own);
        why = read_file(path, name, &p, file, &bytes);
        (*starts)[z + 1] = (*starts)[z] + p.file_bytes;
        *all = realloc(*all, (*starts)[z + 1] + 1);
        if (!why)
            memcpy(*all + (*starts)[z], bytes, p.file_bytes);
        free(bytes);
    }
    return why;
}

static double half_of(uint64_t bits) {
    const int exponent = (int)(bits >> 10 & 31), sign = bits >> 15 ? -1 : 1;
    const double fraction = (double)(bits & 1023);
    if (exponent == 31)
        return fraction != 0 ? (double)NAN : sign * (double)INFINITY;
    return sign * (exponent ? ldexp(1024 + fraction, exponent - 25) : ldexp(fraction, -24));
}

static double number_at(const place *p, const unsigned char *at) {
    unsigned char b[8];
    const int width = widths[p->type];
    for (int i = 0; i < width; i++)
        b[i] = at[p->big ? width - 1 - i : i];
    const uint64_t u = naive_number(b, width);
    switch (p->type) {
    case 2: return (double)(int8_t)u;
    case 4: return (double)(int16_t)u;
    case 5: return (double)naive_float_of(u);
    case 7: return (double)(int32_t)u;
    case 8: return naive_real64(b);
    case 9: return half_of(u);
    case 11: return (double)(int64_t)u;
    default: return (double)u;
    }
}

/* Steps 1 to 3; *computed: the value is of step 2 or 3. */
static double value_at(const place *p, const unsigned char *at, bool *computed) {
    double v[256], sum = 0;
    const bool together = p->components > 1 && p->component == 0;
    const long first = p->component ? p->component - 1 : 0, count = together ? p->components : 1;
    *computed = together || p->scaled;
    for (long i = 0; i < count; i++) {
        v[i] = number_at(p, at + (first + i) * widths[p->type]);
        if (p->scaled)
            v[i] = p->slope * v[i] + p->intercept;
        sum += v[i] * v[i];
    }
    if (!together)
        return v[0];
    if (p->colour)
        return count < 3 ? v[0] : 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
    return sqrt(sum);
}

static bool is_integer(int type) {
    return type != 5 && type != 8 && type != 9;
}

/* Steps 4 to 6. out: a sample of the file's type. */
static void put_sample(const naive_leaf *leaf, const place *p, const unsigned char *at,
                       unsigned char *out) {
    bool computed;
    double v = value_at(p, at, &computed);
    const bool is_float = computed ? p->type <= 5 || p->type == 9 : p->type == 5 || p->type == 9;
    if (is_float)
        v = (double)(float)v;
    const bool gone = p->has_missing && v == (is_float ? (double)(float)p->missing : p->missing);
    if (leaf->sample_type == 5) {
        const float f = (float)v;
        uint64_t bits;
        memcpy(&bits, &f, sizeof f);
        bits = gone ? 0x7fc00000 : bits & 0xffffffff;
        if (p->type == 5 && !computed && !gone) /* keeps its bits, a NaN's, too */
            for (int i = 0; i < 4; i++)
                out[i] = at[p->big ? 3 - i : i];
        else
            for (int i = 0; i < 4; i++)
                out[i] = (unsigned char)(bits >> (8 * i));
        return;
    }
    const long whole = (long)v;
    for (int i = 0; i < widths[leaf->sample_type]; i++)
        out[i] = (unsigned char)(whole >> (8 * i));
}

/* Take the numbers of chunks, in the place of their file's bytes. */
static const char *take_chunks(const naive_leaf *leaf, const unsigned char *section,
                               const unsigned char *table, const uint64_t *starts, const char *path,
                               place *p, unsigned char **bytes) {
    const naive_chunks_file in = {path, *bytes, p->file_bytes, table, leaf->outside_chunks, starts};
    unsigned char *numbers;
    const char *why = naive_chunks_read(section, &in, leaf->dims, &numbers);
    free(*bytes);
    *bytes = numbers;
    p->components = p->component ? 1 : p->components;
    p->component = 0;
    p->big = false;
    return why;
}

const char *naive_outside_read(const naive_leaf *leaf, const char *path,
                               const unsigned char *section, const unsigned char *table,
                               const unsigned char *slices, unsigned char **samples) {
    place p;
    uint64_t *starts = NULL;
    unsigned char *bytes = NULL;
    const char *why = read_section(section, &p);
    char file[8192];
    int chunks = 0;
    if (!why)
        why = naive_chunks_check(section, &chunks);
    const uint64_t count =
                       (uint64_t)leaf->dims[0] * (uint64_t)leaf->dims[1] * (uint64_t)leaf->dims[2],
                   size = why ? 1 : (uint64_t)widths[p.type] * (uint64_t)p.components;
    if (!why && !chunks && (p.offset > p.file_bytes || count * size > p.file_bytes - p.offset))
        why = "the samples end behind their file";
    if (!why && p.has_missing && is_integer(p.type) && leaf->sample_type != 5)
        why = "integers with missing data that are no floats";
    if (!why && (naive_number(section + 4096, 4) == 3) != (slices != NULL))
        why = "files of slices, there or not there";
    if (!why && slices)
        why = read_slices(leaf, path, (const char *)section + 128, slices, &bytes, &starts);
    else if (!why)
        why = read_file(path, (const char *)section + 128, &p, file, &bytes);
    if (!why && chunks)
        why = take_chunks(leaf, section, table, starts, slices ? "/" : file, &p, &bytes);
    free(starts);
    const size_t width = (size_t)widths[leaf->sample_type];
    const uint64_t step = why ? 0 : (uint64_t)widths[p.type] * (uint64_t)p.components;
    *samples = why ? NULL : malloc(count * width);
    for (uint64_t i = 0; *samples && i < count; i++)
        put_sample(leaf, &p, bytes + p.offset + i * step, *samples + i * width);
    free(bytes);
    return why ? why : *samples ? NULL : "no memory";
}

const char *naive_outside_hold(const naive_leaf *leaf, const naive_treelet *t,
                               unsigned char *held) {
    const size_t width = (size_t)widths[leaf->sample_type];
    long size[3], n = 0;
    if (!t->outside)
        return NULL;
    for (int a = 0; a < 3; a++)
        size[a] = t->cells[a] + 1 + 2 * leaf->halo;
    for (; n < size[0] * size[1] * size[2]; n++) {
        const long i[3] = {n % size[0], n / size[0] % size[1], n / size[0] / size[1]};
        size_t at = 0;
        for (int a = 2; a >= 0; a--) {
            const long node = (t->at[a] << leaf->cells_log2) - leaf->halo + i[a];
            const long last = leaf->dims[a] - 1;
            at = at * (size_t)leaf->dims[a] + (size_t)(node < 0 ? 0 : node > last ? last : node);
        }
        memcpy(held + (size_t)n * width, leaf->other + at * width, width);
    }
    const uint64_t sum = XXH3_64bits(held, (size_t)n * width);
    return (sum ? sum : 1) == t->checksum ? NULL : "the checksum of samples outside";
}
