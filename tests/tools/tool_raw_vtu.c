/* tool_raw_vtu.c - raw arrays of a tetrahedral mesh as a VTU file, appended raw.
 *
 *   raw_vtu POINTS TETS OUT.vtu NAME=VALUES...
 *
 * POINTS: float64 x, y, z of each point; TETS: four int32 of each; VALUES: float32 of each point.
 * All little endian, each compressed with zstd when its name ends in .zst.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

enum {
    FIELDS_MAX = 16,
    TET = 10,
    POINT_BYTES = 3 * sizeof(double),
    TET_BYTES = 4 * sizeof(int32_t)
};

typedef struct array {
    char *bytes;
    size_t size;
} array;

_Noreturn static void stop(const char *path, const char *what) {
    fprintf(stderr, "raw_vtu: %s: %s\n", path, what);
    exit(1);
}

static void *allocate(size_t size) {
    void *bytes = malloc(size ? size : 1);
    if (!bytes)
        stop("memory", "not enough");
    return bytes;
}

static array read_file(const char *path) {
    FILE *in = fopen(path, "rb");
    if (!in || fseek(in, 0, SEEK_END) != 0)
        stop(path, "cannot be read");
    const long size = ftell(in);
    rewind(in);
    array a = {allocate((size_t)size), (size_t)size};
    if (fread(a.bytes, 1, a.size, in) != a.size)
        stop(path, "cannot be read");
    fclose(in);
    return a;
}

static array load(const char *path) {
    array a = read_file(path);
    const size_t length = strlen(path);
    if (length < 4 || strcmp(path + length - 4, ".zst") != 0)
        return a;
    const unsigned long long size = ZSTD_getFrameContentSize(a.bytes, a.size);
    if (size >= ZSTD_CONTENTSIZE_ERROR)
        stop(path, "is no zstd frame that tells its size");
    array raw = {allocate((size_t)size), (size_t)size};
    if (ZSTD_decompress(raw.bytes, raw.size, a.bytes, a.size) != raw.size)
        stop(path, "does not decompress");
    free(a.bytes);
    return raw;
}

/* A block of the appended data: its size, then its bytes. */
static void append(FILE *out, const void *bytes, size_t size) {
    const uint64_t head = size;
    fwrite(&head, sizeof head, 1, out);
    fwrite(bytes, 1, size, out);
}

/* The element that names a block; at: where that is, moved behind it. */
static void declare(FILE *out, const char *type, const char *name, int components, size_t size,
                    size_t *at) {
    fprintf(out,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%zu\"/>\n",
            type, name, components, *at);
    *at += sizeof(uint64_t) + size;
}

static void append_cells(FILE *out, const array *tets) {
    const size_t count = tets->size / TET_BYTES;
    int64_t *ends = allocate(count * sizeof *ends);
    char *types = allocate(count);
    memset(types, TET, count);
    for (size_t i = 0; i < count; i++)
        ends[i] = 4 * ((int64_t)i + 1);
    append(out, tets->bytes, tets->size);
    append(out, ends, count * sizeof *ends);
    append(out, types, count);
    free(ends);
    free(types);
}

int main(int argc, char **argv) {
    array fields[FIELDS_MAX];
    const int count = argc - 4;
    if (count < 0 || count > FIELDS_MAX) {
        fprintf(stderr, "usage: raw_vtu POINTS TETS OUT.vtu NAME=VALUES...\n");
        return 2;
    }
    const array points = load(argv[1]), tets = load(argv[2]);
    const size_t n = points.size / POINT_BYTES, cells = tets.size / TET_BYTES;
    FILE *out = fopen(argv[3], "wb");
    if (!out)
        stop(argv[3], "cannot be made");
    size_t at = 0;
    fprintf(out,
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n<UnstructuredGrid>\n"
            "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n<PointData>\n",
            n, cells);
    for (int i = 0; i < count; i++) {
        char *name = argv[4 + i], *path = strchr(name, '=');
        if (!path)
            stop(name, "expected NAME=VALUES");
        *path++ = '\0';
        fields[i] = load(path);
        if (fields[i].size != n * sizeof(float))
            stop(path, "has not a float for each point");
        declare(out, "Float32", name, 1, fields[i].size, &at);
    }
    fputs("</PointData>\n<Points>\n", out);
    declare(out, "Float64", "points", 3, points.size, &at);
    fputs("</Points>\n<Cells>\n", out);
    declare(out, "Int32", "connectivity", 1, tets.size, &at);
    declare(out, "Int64", "offsets", 1, cells * sizeof(int64_t), &at);
    declare(out, "UInt8", "types", 1, cells, &at);
    fputs("</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_", out);
    for (int i = 0; i < count; i++)
        append(out, fields[i].bytes, fields[i].size);
    append(out, points.bytes, points.size);
    append_cells(out, &tets);
    fputs("\n</AppendedData>\n</VTKFile>\n", out);
    if (fclose(out) != 0)
        stop(argv[3], "cannot be written");
    for (int i = 0; i < count; i++)
        free(fields[i].bytes);
    free(points.bytes);
    free(tets.bytes);
    return 0;
}
