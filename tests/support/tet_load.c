#include "tests/support/tet_load.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "files are read as they lie");

/* ---- bytes ---- */

/* A file's bytes and a NUL; NULL: *why says what is the matter. */
static char *read_file(const char *path, size_t *size, const char **why) {
    FILE *in = fopen(path, "rb");
    long length = -1;
    char *bytes = NULL;
    *why = "cannot be read";
    if (in && fseek(in, 0, SEEK_END) == 0)
        length = ftell(in);
    if (length >= 0 && fseek(in, 0, SEEK_SET) == 0)
        bytes = malloc((size_t)length + 1);
    if (bytes && fread(bytes, 1, (size_t)length, in) != (size_t)length) {
        free(bytes);
        bytes = NULL;
    }
    if (in)
        fclose(in);
    if (bytes)
        bytes[length] = 0;
    *size = (size_t)length;
    return bytes;
}

/* The same, unpacked where the name says so. */
static char *read_array(const char *path, size_t *size, const char **why) {
    char *bytes = read_file(path, size, why);
    const char *suffix = strrchr(path, '.');
    if (!bytes || !suffix || strcmp(suffix, ".zst") != 0)
        return bytes;
    unsigned long long raw = ZSTD_getFrameContentSize(bytes, *size);
    bool known = raw != ZSTD_CONTENTSIZE_UNKNOWN && raw != ZSTD_CONTENTSIZE_ERROR;
    char *plain = known ? malloc((size_t)raw + 1) : NULL;
    if (plain && ZSTD_decompress(plain, (size_t)raw, bytes, *size) != raw) {
        free(plain);
        plain = NULL;
    }
    *why = "is no sound zstd file";
    *size = (size_t)raw;
    free(bytes);
    return plain;
}

static void *copy_of(const char *bytes, size_t size) {
    void *copy = malloc(size + 1);
    if (copy)
        memcpy(copy, bytes, size);
    return copy;
}

static bool is_whole(const tet_ref_mesh *m, const char **why) {
    *why = "no room";
    return m->points && m->values && m->tets;
}

void tet_unload(tet_ref_mesh *m) {
    free((void *)m->points);
    free((void *)m->values);
    free((void *)m->tets);
    *m = (tet_ref_mesh){0};
}

/* ---- mesh streams ---- */

/* The header's counts; returns where the arrays begin, or NULL. */
static const char *read_header(const char *bytes, uint64_t *points, uint64_t *tets) {
    static const char magic[] = "LEAFCAST MESH 1\n";
    if (strncmp(bytes, magic, strlen(magic)) != 0)
        return NULL;
    bool has_points = false, has_tets = false;
    for (const char *line = bytes + strlen(magic);;) {
        const char *end = strchr(line, '\n');
        if (!end)
            return NULL;
        if (end == line)
            return has_points && has_tets ? end + 1 : NULL;
        unsigned long long n;
        if (sscanf(line, "points: %llu\n", &n) == 1) {
            *points = n;
            has_points = true;
        } else if (sscanf(line, "tets: %llu\n", &n) == 1) {
            *tets = n;
            has_tets = true;
        }
        line = end + 1;
    }
}

bool tet_load_stream(const char *path, tet_ref_mesh *m, const char **why) {
    size_t size;
    uint64_t points = 0, tets = 0;
    *m = (tet_ref_mesh){0};
    char *bytes = read_file(path, &size, why);
    if (!bytes)
        return false;
    const char *at = read_header(bytes, &points, &tets);
    size_t left = at ? size - (size_t)(at - bytes) : 0;
    bool fits = at && points <= left / 16 && tets <= left / 16 && 16 * (points + tets) == left;
    if (fits) {
        m->point_count = points;
        m->tet_count = tets;
        m->points = copy_of(at, 12 * points);
        m->values = copy_of(at + 12 * points, 4 * points);
        m->tets = copy_of(at + 16 * points, 16 * tets);
    }
    free(bytes);
    bool whole = fits && is_whole(m, why);
    if (!fits)
        *why = "is no mesh stream, or not as long as it says";
    if (!whole)
        tet_unload(m);
    return whole;
}

/* ---- raw arrays ---- */

/* Doubles become floats. */
static float *narrow(char *bytes, size_t *size) {
    size_t count = *size / sizeof(double);
    float *out = malloc(*size + 1);
    for (size_t i = 0; out && i < count; i++) {
        double x;
        memcpy(&x, bytes + i * sizeof x, sizeof x);
        out[i] = (float)x;
    }
    free(bytes);
    *size = count * sizeof(float);
    return out;
}

bool tet_load_arrays(const tet_arrays *from, tet_ref_mesh *m, const char **why) {
    size_t points_size = 0, values_size = 0, tets_size = 0;
    const char *why_not[3];
    *m = (tet_ref_mesh){0};
    char *points = read_array(from->points, &points_size, &why_not[0]);
    if (points && strstr(from->points, "f64"))
        m->points = (const float(*)[3])narrow(points, &points_size);
    else
        m->points = (const float(*)[3])points;
    m->values = (const float *)read_array(from->values, &values_size, &why_not[1]);
    m->tets = (const uint32_t(*)[4])read_array(from->tets, &tets_size, &why_not[2]);
    m->point_count = points_size / sizeof m->points[0];
    m->tet_count = tets_size / sizeof m->tets[0];
    *why = !m->points ? why_not[0] : !m->values ? why_not[1] : why_not[2];
    if (m->points && m->values && m->tets) {
        if (points_size == 3 * values_size && tets_size % sizeof m->tets[0] == 0)
            return true;
        *why = "sizes of the arrays do not fit together";
    }
    tet_unload(m);
    return false;
}

void tet_load_box(const tet_ref_mesh *m, double lo[3], double hi[3]) {
    for (int a = 0; a < 3; a++) {
        lo[a] = INFINITY;
        hi[a] = -INFINITY;
    }
    for (size_t i = 0; i < m->tet_count; i++)
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3 && m->tets[i][k] < m->point_count; a++) {
                lo[a] = fmin(lo[a], (double)m->points[m->tets[i][k]][a]);
                hi[a] = fmax(hi[a], (double)m->points[m->tets[i][k]][a]);
            }
}
