#include "tests/support/naive_surface.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>
#include <zstd.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/naive_cells.h"

static bool wrong(naive_surface *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_surface *s, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(s->why, sizeof s->why, format, args);
    va_end(args);
    return false;
}

/* ---- the header ---- */

static bool read_numbers(naive_surface *s) {
    /* offset, lowest and highest value of 4-byte fields */
    static const uint64_t ranges[][3] = {
        {8, 4, 4},    {12, 5, 5},   {16, 5, 5},     {20, 5, 8},     {24, 0, 0},       {28, 0, 0},
        {32, 0, 0},   {36, 1, 1},   {40, 0, 0},     {44, 0, 0},     {48, 0, 0},       {52, 6, 21},
        {56, 0, 1},   {60, 0, 0},   {64, 1, 65536}, {68, 1, 65536}, {72, 1, 64},      {76, 0, 0},
        {84, 0, 0},   {1348, 0, 0}, {1356, 0, 0},   {1388, 0, 0},   {1384, 1, 16384}, {1396, 0, 0},
        {1400, 0, 0}, {1404, 0, 0}, {1488, 0, 0},   {1492, 0, 1},
    };
    const unsigned char *b = s->bytes;
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        const uint64_t value = naive_number(b + ranges[i][0], 4);
        if (value < ranges[i][1] || value > ranges[i][2])
            return wrong(s, "header field at %d is %llu", (int)ranges[i][0],
                         (unsigned long long)value);
    }
    s->run_align_log2 = (int)naive_number(b + 52, 4);
    s->codec = (int)naive_number(b + 56, 4);
    s->fields = (long)naive_number(b + 64, 4);
    s->steps = (long)naive_number(b + 68, 4);
    s->sets = s->fields * s->steps;
    s->treelets = (long)naive_number(b + 80, 4);
    s->triangles = (long)naive_number(b + 1344, 4);
    s->vertices = (long)naive_number(b + 1352, 4);
    s->treelet_triangles = (long)naive_number(b + 1384, 4);
    s->places = naive_number(b + 1492, 4) ? s->steps : 1;
    if (naive_number(b + 1492, 4) && s->steps < 2)
        return wrong(s, "one step that moves");
    if (s->sets > 65536 || s->treelets < 1 || (size_t)s->treelets > s->size)
        return wrong(s, "%ld treelets, %ld sets", s->treelets, s->sets);
    if (naive_number(b + 1392, 8) > (uint64_t)s->triangles)
        return wrong(s, "more flat triangles than triangles");
    return true;
}

static bool read_header(naive_surface *s) {
    static const unsigned char magic[8] = {0x89, 0x4c, 0x45, 0x41, 0x46, 0x0d, 0x0a, 0x1a};
    const unsigned char *b = s->bytes;
    if (s->size < 4096 || memcmp(b, magic, 8) != 0)
        return wrong(s, "no magic");
    if (!read_numbers(s))
        return false;
    for (int i = 0; i < 12; i++)
        if (naive_real64(b + 136 + 8 * i) != (i == 0 || i == 5 || i == 10 ? 1 : 0))
            return wrong(s, "to_world is not the identity");
    if (!(naive_real64(b + 128) >= 0))
        return wrong(s, "rounding error");
    if (naive_number(b + 96, 8) != s->size)
        return wrong(s, "file_bytes");
    const uint64_t sections = naive_number(b + 72, 4), directory = naive_number(b + 1504, 8),
                   table = directory ? directory : 4096;
    if (table > s->size || s->size - table < 32 * sections || !naive_zeros(b, 1496, 1504) ||
        !naive_zeros(b, 1512, 4096) || !naive_text(b + 256, 64) || !naive_text(b + 320, 1024) ||
        !naive_text(b + 1424, 64))
        return wrong(s, "section table cut off, or reserved bytes, or a text");
    return naive_hashes(b, sections) || wrong(s, "the header's checksum or id");
}

/* ---- the directory ---- */

static long payload_count(const naive_surface *s) {
    return s->treelets * (s->sets + s->places);
}

static bool find_sections(naive_surface *s) {
    enum { OPTIONAL = 1 << NAIVE_FIELDS | 1 << NAIVE_TIMES | 1 << NAIVE_SAME };
    const uint64_t n = (uint64_t)s->treelets, sets = (uint64_t)s->sets,
                   payloads = (uint64_t)payload_count(s);
    const uint64_t want[NAIVE_KINDS] = {[NAIVE_RANGES] = 8 * n * sets,
                                        [NAIVE_OWN] = 8 * n * sets,
                                        [NAIVE_FLAGS] = n * sets,
                                        [NAIVE_OFFSETS] = 8 * payloads,
                                        [NAIVE_SIZES] = 8 * payloads,
                                        [NAIVE_CHECKSUMS] = 8 * payloads,
                                        [NAIVE_BOUNDS] = 24 * n * (uint64_t)s->places,
                                        [NAIVE_COUNTS] = 16 * n,
                                        [NAIVE_FIELDS] = 64 * (uint64_t)s->fields,
                                        [NAIVE_TIMES] = s->steps > 1 ? 8 * (uint64_t)s->steps : 0,
                                        [NAIVE_SAME] = sets > 1 ? 4 * payloads : 0};
    if (!naive_sections_find(&s->sections, s->bytes, s->size, want, OPTIONAL))
        return wrong(s, "%s", s->sections.why);
    return !s->sections.histograms || wrong(s, "there are histograms");
}

static bool read_counts(naive_surface *s) {
    const unsigned char *counts = s->sections.where[NAIVE_COUNTS];
    long triangles = 0, vertices = 0;
    for (long t = 0; t < s->treelets; t++) {
        naive_patch *p = &s->patch[t];
        p->triangles = (long)naive_number(counts + 16 * t, 4);
        p->vertices = (long)naive_number(counts + 16 * t + 4, 4);
        const long normals = (long)naive_number(counts + 16 * t + 8, 4);
        p->smooth = normals > 0;
        if (p->triangles < 1 || p->triangles > s->treelet_triangles || p->vertices < 3 ||
            p->vertices > 3 * p->triangles || (normals && normals != p->vertices) ||
            !naive_zeros(counts + 16 * t, 12, 16))
            return wrong(s, "treelet %ld: counts", t);
        triangles += p->triangles;
        vertices += p->vertices;
    }
    if (triangles != s->triangles || s->vertices < 3 || vertices < s->vertices)
        return wrong(s, "triangles or vertices do not add up");
    return true;
}

static bool check_bounds(naive_surface *s) {
    const unsigned char *bounds = s->sections.where[NAIVE_BOUNDS];
    float all[6];
    for (long n = 0; n < 6 * s->treelets * s->places; n++) {
        const float at = naive_real32(bounds + 4 * n);
        if (!isfinite(at) || naive_minus_zero(at))
            return wrong(s, "number %ld of the bounds", n);
        const bool wider = n >= 6 && (n % 6 < 3 ? at < all[n % 6] : at > all[n % 6]);
        if (n < 6 || wider)
            all[n % 6] = at;
    }
    for (int a = 0; a < 6; a++)
        if (all[a] != naive_real32(s->bytes + 1360 + 4 * a))
            return wrong(s, "bounds of the whole");
    return true;
}

/* ---- payloads ---- */

/* 0 topology, 1 values, 3 positions, as naive_cells.h has them. */
static int block_of(const naive_surface *s, long p) {
    const long block = p / s->treelets;
    return block == 0 ? 0 : block <= s->sets ? 1 : 3;
}

/* Bytes of positions and normals, without padding. */
static uint64_t place_bytes(const naive_patch *t) {
    return (t->smooth ? 16 : 12) * (uint64_t)t->vertices;
}

static uint64_t payload_bytes(const naive_surface *s, long p) {
    const naive_patch *t = &s->patch[p % s->treelets];
    const uint64_t v = (uint64_t)t->vertices, places = naive_up_to(place_bytes(t), 64);
    switch (block_of(s, p)) {
    case 0: return places + naive_up_to(6 * (uint64_t)t->triangles, 64);
    case 1: return naive_up_to(4 * v, 64);
    default: return places;
    }
}

static uint64_t entry_of(const naive_surface *s, int kind, long p) {
    return naive_number(s->sections.where[kind] + 8 * p, 8);
}

/* The payload whose bytes p has; itself, mostly. -1: it leads nowhere. */
static long home_of(const naive_surface *s, long p) {
    const long entry = naive_sections_link(&s->sections, NAIVE_SAME, p), n = s->treelets;
    const long first = block_of(s, p) == 1 ? n : block_of(s, p) == 3 ? n * (1 + s->sets) : 0;
    if (entry < 0)
        return p;
    const long q = first + (p - first) % n + entry * n;
    return q < p && naive_sections_link(&s->sections, NAIVE_SAME, q) < 0 ? q : -1;
}

static bool check_same(naive_surface *s, long p, long q) {
    for (int kind = NAIVE_OFFSETS; q >= 0 && kind <= NAIVE_CHECKSUMS; kind++)
        if (entry_of(s, kind, p) != entry_of(s, kind, q))
            q = -1;
    return q >= 0 || wrong(s, "payload %ld: not the same as an earlier one", p);
}

/* Offsets, sizes and checksums of all payloads, and what is between them. */
static bool check_places(naive_surface *s) {
    uint64_t stored = 0, end = s->sections.payloads;
    bool begins = false; /* a run, whose first payloads may be elsewhere */
    for (long p = 0; p < payload_count(s); p++) {
        const uint64_t offset = entry_of(s, NAIVE_OFFSETS, p), size = entry_of(s, NAIVE_SIZES, p);
        const long q = home_of(s, p);
        begins = begins || p % s->treelets == 0;
        if (q != p) {
            if (!check_same(s, p, q))
                return false;
            continue;
        }
        if (offset != naive_up_to(end, begins ? UINT64_C(1) << s->run_align_log2 : 64))
            return wrong(s, "payload %ld: offset", p);
        begins = false;
        if (size < 1 || size > payload_bytes(s, p) ||
            (s->codec == 0 && size != payload_bytes(s, p)))
            return wrong(s, "payload %ld: size", p);
        if (offset > s->size || size > s->size - offset || !naive_zeros(s->bytes, end, offset))
            return wrong(s, "payload %ld: place or padding", p);
        if (XXH3_64bits(s->bytes + offset, size) != entry_of(s, NAIVE_CHECKSUMS, p))
            return wrong(s, "payload %ld: checksum", p);
        end = offset + size;
        stored += size;
    }
    if (stored != naive_number(s->bytes + 88, 8))
        return wrong(s, "payload_bytes");
    return naive_sections_hold(&s->sections, s->bytes, s->size, end) == s->size ||
           wrong(s, "what is behind the payloads");
}

/* The payload, to be freed; NULL: it cannot be decoded. */
static unsigned char *load(naive_surface *s, long p) {
    const naive_patch *t = &s->patch[p % s->treelets];
    const uint32_t counts[4] = {(uint32_t)t->triangles, (uint32_t)t->vertices,
                                t->smooth ? (uint32_t)t->vertices : 0, 0};
    const long q = home_of(s, p);
    const uint64_t size = entry_of(s, NAIVE_SIZES, q), want = payload_bytes(s, p);
    const unsigned char *stored = s->bytes + entry_of(s, NAIVE_OFFSETS, q);
    const size_t room = want + 3 * 3 * (size_t)t->triangles + 16;
    unsigned char *payload = calloc(1, want), *streams = malloc(room);
    bool good = payload && streams;
    if (good && size == want) {
        memcpy(payload, stored, want);
    } else if (good) {
        const size_t bytes = ZSTD_decompress(streams, room, stored, size);
        good = ZSTD_findFrameCompressedSize(stored, size) == size && !ZSTD_isError(bytes) &&
               naive_cells_triangles(block_of(s, p), counts, streams, bytes, payload, want);
    }
    free(streams);
    if (good)
        return payload;
    free(payload);
    (void)wrong(s, "payload %ld cannot be decoded", p);
    return NULL;
}

/* ---- a treelet ---- */

static bool take_rows(naive_surface *s, long t, const unsigned char *rows, const uint64_t end) {
    naive_patch *p = &s->patch[t];
    long met = 0;
    for (long i = 0; i < 3 * p->triangles; i++) {
        const long v = (long)naive_number(rows + 2 * i, 2);
        if (v > met || v >= p->vertices)
            return wrong(s, "treelet %ld: corner %ld", t, i);
        met += v == met;
        p->row[i / 3][i % 3] = v;
    }
    if (met != p->vertices)
        return wrong(s, "treelet %ld: a vertex at no triangle", t);
    return naive_zeros(rows, 6 * (uint64_t)p->triangles, end) ||
           wrong(s, "treelet %ld: padding of rows", t);
}

/* Fold the octahedron's lower half back, and make the vector one of unit length. */
static bool take_normal(const unsigned char *b, float to[3]) {
    int u = (int)naive_number(b, 2), v = (int)naive_number(b + 2, 2);
    u -= u > 32767 ? 65536 : 0;
    v -= v > 32767 ? 65536 : 0;
    to[0] = to[1] = to[2] = 0;
    if (u == -32768 || v == -32768)
        return u == v;
    double x = u, y = v;
    const double z = 32767 - abs(u) - abs(v);
    if (z < 0) {
        x = (32767 - abs(v)) * (u < 0 ? -1 : 1);
        y = (32767 - abs(u)) * (v < 0 ? -1 : 1);
    }
    const double length = sqrt(x * x + y * y + z * z);
    to[0] = (float)(x / length);
    to[1] = (float)(y / length);
    to[2] = (float)(z / length);
    return true;
}

static bool take_places(naive_surface *s, long t, long place, const unsigned char *b) {
    naive_patch *p = &s->patch[t];
    float *to = p->xyz + place * 3 * p->vertices;
    const unsigned char *bounds = s->sections.where[NAIVE_BOUNDS] + 24 * (place * s->treelets + t);
    for (int a = 0; a < 3; a++) {
        float least = INFINITY, most = -INFINITY;
        for (long v = 0; v < p->vertices; v++, b += 4) {
            const float x = *to++ = naive_real32(b);
            if (!isfinite(x))
                return wrong(s, "treelet %ld: vertex %ld", t, v);
            least = x < least ? x : least;
            most = x > most ? x : most;
        }
        if (least != naive_real32(bounds + 4 * a) || most != naive_real32(bounds + 12 + 4 * a))
            return wrong(s, "treelet %ld, step %ld: bounds along axis %d", t, place, a);
    }
    for (long v = 0; p->smooth && v < p->vertices; v++, b += 4)
        if (!take_normal(b, p->normal[place * p->vertices + v]))
            return wrong(s, "treelet %ld, step %ld: normal %ld", t, place, v);
    const uint64_t bytes = place_bytes(p);
    return naive_zeros(b, 0, naive_up_to(bytes, 64) - bytes) ||
           wrong(s, "treelet %ld, step %ld: padding", t, place);
}

static bool take_values(naive_surface *s, long t, long set, const unsigned char *b) {
    naive_patch *p = &s->patch[t];
    const long element = set * s->treelets + t;
    float *to = p->values + set * p->vertices, least = INFINITY, most = -INFINITY;
    bool finite = true;
    for (long v = 0; v < p->vertices; v++) {
        const float x = *to++ = naive_real32(b + 4 * v);
        finite = finite && isfinite(x);
        least = isfinite(x) && x < least ? x : least;
        most = isfinite(x) && x > most ? x : most;
    }
    for (int kind = NAIVE_RANGES; kind <= NAIVE_OWN; kind++)
        for (int i = 0; i < 2; i++) {
            const float own = naive_real32(s->sections.where[kind] + 8 * element + 4 * i);
            if (naive_minus_zero(own) || own != (i ? most : least))
                return wrong(s, "treelet %ld, set %ld: range", t, set);
        }
    if (s->sections.where[NAIVE_FLAGS][element] != (finite ? 0 : 1))
        return wrong(s, "treelet %ld, set %ld: flags", t, set);
    const uint64_t bytes = 4 * (uint64_t)p->vertices;
    return naive_zeros(b, bytes, naive_up_to(bytes, 64)) ||
           wrong(s, "treelet %ld, set %ld: padding", t, set);
}

static bool take_payload(naive_surface *s, long p) {
    const long t = p % s->treelets, block = p / s->treelets;
    const uint64_t rows = naive_up_to(place_bytes(&s->patch[t]), 64);
    unsigned char *b = load(s, p);
    bool good = b != NULL;
    switch (block_of(s, p)) {
    case 0:
        good = good && take_places(s, t, 0, b) &&
               take_rows(s, t, b + rows, payload_bytes(s, p) - rows);
        break;
    case 1: good = good && take_values(s, t, block - 1, b); break;
    default: good = good && take_places(s, t, block - s->sets, b); break;
    }
    free(b);
    return good;
}

/* What the header says of all values. */
static bool check_union(naive_surface *s) {
    double least = (double)INFINITY, most = -(double)INFINITY;
    uint64_t strange = 0, claimed = naive_number(s->bytes + 104, 8);
    for (long i = 0; i < s->treelets * s->sets; i++) {
        least = fmin(least, (double)naive_real32(s->sections.where[NAIVE_OWN] + 8 * i));
        most = fmax(most, (double)naive_real32(s->sections.where[NAIVE_OWN] + 8 * i + 4));
    }
    for (long t = 0; t < s->treelets; t++)
        for (long i = 0; i < s->patch[t].vertices * s->sets; i++)
            strange += !isfinite(s->patch[t].values[i]);
    if (least != naive_real64(s->bytes + 112) || most != naive_real64(s->bytes + 120))
        return wrong(s, "value_min, value_max");
    return (claimed <= strange && (claimed > 0) == (strange > 0)) || wrong(s, "non_finite");
}

/* ---- loading ---- */

static bool read_labels(naive_surface *s) {
    char(*names)[64] = NULL;
    double *times = NULL;
    const char *why = naive_labels(s->bytes, s->sections.where[NAIVE_FIELDS], s->fields,
                                   s->sections.where[NAIVE_TIMES], s->steps, &names, &times);
    free(names);
    free(times);
    return !why || wrong(s, "%s", why);
}

static bool allocate(naive_surface *s) {
    for (long t = 0; t < s->treelets; t++) {
        naive_patch *p = &s->patch[t];
        p->xyz = malloc((size_t)(3 * p->vertices * s->places) * sizeof *p->xyz);
        p->values = malloc((size_t)(p->vertices * s->sets) * sizeof *p->values);
        p->row = malloc((size_t)p->triangles * sizeof *p->row);
        p->normal = malloc((size_t)(p->vertices * s->places) * sizeof *p->normal);
        if (!p->xyz || !p->values || !p->row || !p->normal)
            return wrong(s, "no memory");
    }
    return true;
}

static bool read_file(naive_surface *s, const char *path) {
    FILE *in = fopen(path, "rb");
    if (!in)
        return wrong(s, "cannot be opened");
    fseek(in, 0, SEEK_END);
    const long size = ftell(in);
    rewind(in);
    s->size = size > 0 ? (size_t)size : 0;
    s->bytes = malloc(s->size + 1);
    const bool good = s->bytes && fread(s->bytes, 1, s->size, in) == s->size;
    fclose(in);
    return good || wrong(s, "cannot be read");
}

bool naive_surface_load(naive_surface *s, const char *path) {
    memset(s, 0, sizeof *s);
    if (!read_file(s, path) || !read_header(s) || !find_sections(s))
        return false;
    s->patch = calloc((size_t)s->treelets, sizeof *s->patch);
    bool good = (s->patch || wrong(s, "no memory")) && read_labels(s) && read_counts(s) &&
                check_bounds(s) && check_places(s) && allocate(s);
    for (long p = 0; good && p < payload_count(s); p++)
        good = take_payload(s, p);
    return good && check_union(s);
}

void naive_surface_release(naive_surface *s) {
    for (long t = 0; s->patch && t < s->treelets; t++) {
        free(s->patch[t].xyz);
        free(s->patch[t].normal);
        free(s->patch[t].values);
        free(s->patch[t].row);
    }
    free(s->patch);
    naive_sections_release(&s->sections);
    free(s->bytes);
    memset(s, 0, sizeof *s);
}
