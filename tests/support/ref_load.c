#include "tests/support/ref_load.h"

#include <ctype.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void ref_source_set(ref_source *s, const double spacing[3], const double origin[3]) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 4; b++)
            s->to_world[a][b] = b == 3 ? origin[a] : a == b ? spacing[a] : 0;
}

/* ---- samples ---- */

static int sample_bytes(const char *type) {
    static const char *const names[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
    static const int bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    for (int i = 0; i < 8; i++)
        if (type && strcmp(type, names[i]) == 0)
            return bytes[i];
    return 0;
}

/* One sample from its bytes, least significant first. */
static float decode(const unsigned char *bytes, const char *type, int size) {
    uint64_t bits = 0;
    for (int b = size - 1; b >= 0; b--)
        bits = bits << 8 | bytes[b];
    if (strcmp(type, "f32") == 0) {
        uint32_t low = (uint32_t)bits;
        float value;
        memcpy(&value, &low, 4);
        return value;
    }
    if (strcmp(type, "f64") == 0) {
        double value;
        memcpy(&value, &bits, 8);
        return (float)value;
    }
    if (type[0] == 'i' && bits >> (8 * size - 1))
        return (float)((int64_t)bits - (INT64_C(1) << (8 * size)));
    return (float)bits;
}

static bool read_samples(FILE *in, const ref_source *s, float *out, size_t count) {
    int size = sample_bytes(s->type);
    for (size_t i = 0; i < count; i++) {
        unsigned char raw[8], bytes[8];
        if (fread(raw, (size_t)size, 1, in) != 1)
            return false;
        for (int b = 0; b < size; b++)
            bytes[b] = raw[s->big_endian ? size - 1 - b : b];
        out[i] = decode(bytes, s->type, size);
    }
    return true;
}

static double *read_axis(const char *path, long count) {
    FILE *in = fopen(path, "r");
    double *axis = malloc((size_t)count * sizeof axis[0]);
    bool good = in && axis;
    for (long i = 0; good && i < count; i++)
        good = fscanf(in, "%lf", &axis[i]) == 1;
    if (in)
        fclose(in);
    if (good)
        return axis;
    free(axis);
    return NULL;
}

/* ---- NRRD ---- */

static const char *nrrd_type(const char *text) {
    static const char *const pairs[][2] = {
        {"uchar", "u8"},         {"unsigned char", "u8"},   {"uint8", "u8"},    {"uint8_t", "u8"},
        {"char", "i8"},          {"signed char", "i8"},     {"int8", "i8"},     {"int8_t", "i8"},
        {"ushort", "u16"},       {"unsigned short", "u16"}, {"uint16", "u16"},  {"uint16_t", "u16"},
        {"short", "i16"},        {"int16", "i16"},          {"int16_t", "i16"}, {"uint", "u32"},
        {"unsigned int", "u32"}, {"uint32", "u32"},         {"int", "i32"},     {"int32", "i32"},
        {"float", "f32"},        {"double", "f64"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        if (strcmp(text, pairs[i][0]) == 0)
            return pairs[i][1];
    return NULL;
}

/* Up to `count` numbers of a text, whatever stands between them. */
static int numbers(const char *text, double *out, int count) {
    int n = 0;
    while (n < count && *text) {
        char *end;
        double value = strtod(text, &end);
        if (end == text) {
            text++;
            continue;
        }
        out[n++] = value;
        text = end;
    }
    return n;
}

static bool field_is(const char *line, const char *name, const char **value) {
    size_t length = strlen(name);
    if (strncmp(line, name, length) != 0 || line[length] != ':')
        return false;
    *value = line + length + 1;
    while (isspace((unsigned char)**value))
        ++*value;
    return true;
}

/* One header line; false when this plain reader cannot follow. */
static bool nrrd_line(ref_source *s, const char *line) {
    const char *value;
    double n[9];
    if (field_is(line, "type", &value))
        return (s->type = nrrd_type(value)) != NULL;
    if (field_is(line, "encoding", &value))
        return strcmp(value, "raw") == 0;
    if (field_is(line, "dimension", &value))
        return strcmp(value, "3") == 0;
    if (field_is(line, "data file", &value) || field_is(line, "datafile", &value))
        return false;
    if (field_is(line, "endian", &value))
        s->big_endian = strcmp(value, "big") == 0;
    if (field_is(line, "sizes", &value)) {
        int count = numbers(value, n, 3);
        for (int a = 0; a < count; a++)
            s->dims[a] = (long)n[a];
        return count == 3;
    }
    if (field_is(line, "spacings", &value) && numbers(value, n, 3) == 3)
        for (int a = 0; a < 3; a++)
            s->to_world[a][a] = n[a];
    if (field_is(line, "space origin", &value) && numbers(value, n, 3) == 3)
        for (int a = 0; a < 3; a++)
            s->to_world[a][3] = n[a];
    if (field_is(line, "space directions", &value) && numbers(value, n, 9) == 9)
        for (int a = 0; a < 9; a++)
            s->to_world[a % 3][a / 3] = n[a];
    return true;
}

static bool nrrd_header(FILE *in, ref_source *s) {
    char line[1024];
    const double one[3] = {1, 1, 1}, zero[3] = {0};
    ref_source_set(s, one, zero);
    if (!fgets(line, sizeof line, in))
        return false;
    while (fgets(line, sizeof line, in)) {
        line[strcspn(line, "\r\n")] = 0;
        if (line[0] == 0)
            return s->type && s->dims[0] > 0;
        if (line[0] != '#' && !nrrd_line(s, line))
            return false;
    }
    return false;
}

/* ---- loading ---- */

static bool is_nrrd(FILE *in) {
    char magic[4] = {0};
    bool yes = fread(magic, 1, 4, in) == 4 && memcmp(magic, "NRRD", 4) == 0;
    rewind(in);
    return yes;
}

bool ref_load(ref_source *s, ref_volume *v, const char **why) {
    memset(v, 0, sizeof *v);
    FILE *in = fopen(s->path, "rb");
    *why = "cannot be opened";
    if (!in)
        return false;
    *why = "neither plain NRRD nor raw with dims of at least 2 and a known type";
    bool good = is_nrrd(in) ? nrrd_header(in, s) : fseek(in, s->skip, SEEK_SET) == 0;
    good = good && sample_bytes(s->type) && s->dims[0] >= 2 && s->dims[1] >= 2 && s->dims[2] >= 2;
    if (good) {
        size_t count = (size_t)s->dims[0] * (size_t)s->dims[1] * (size_t)s->dims[2];
        float *samples = malloc(count * sizeof samples[0]);
        v->samples = samples;
        memcpy(v->dims, s->dims, sizeof v->dims);
        memcpy(v->to_world, s->to_world, sizeof v->to_world);
        *why = "ends before its last sample";
        good = samples && read_samples(in, s, samples, count);
    }
    fclose(in);
    for (int a = 0; good && a < 3; a++)
        if (s->axis_path[a]) {
            *why = "an axis file has too few numbers";
            v->axis[a] = read_axis(s->axis_path[a], s->dims[a]);
            good = v->axis[a] != NULL;
        }
    if (!good)
        ref_unload(v);
    return good;
}

/* The only place where what a ref_volume points to is known to be on the heap. */
void ref_unload(ref_volume *v) {
    union {
        const void *constant;
        void *plain;
    } memory;
    memory.constant = v->samples;
    free(memory.plain);
    for (int a = 0; a < 3; a++) {
        memory.constant = v->axis[a];
        free(memory.plain);
    }
    memset(v, 0, sizeof *v);
}
