/* naive_mesh.c - section numbers are those of formats/FORMAT.md. */
#include "tests/support/naive_mesh.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/naive_coded.h"
#include "tests/support/naive_mesh_places.h"

static bool wrong(naive_mesh *mesh, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_mesh *mesh, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(mesh->why, sizeof mesh->why, format, args);
    va_end(args);
    return false;
}

/* ---- the header: 2 and 6 ---- */

static bool read_header(naive_mesh *mesh) {
    static const unsigned char magic[8] = {0x89, 0x4c, 0x45, 0x41, 0x46, 0x0d, 0x0a, 0x1a};
    /* offset, lowest and highest value of 4-byte fields */
    static const uint64_t ranges[][3] = {
        {8, 4, 4},    {12, 2, 2},   {16, 5, 5},     {20, 5, 8},     {24, 0, 0},       {28, 0, 0},
        {32, 0, 0},   {36, 1, 1},   {40, 0, 0},     {44, 0, 0},     {48, 0, 0},       {52, 6, 21},
        {56, 0, 1},   {60, 0, 0},   {64, 1, 65536}, {68, 1, 65536}, {72, 1, 64},      {76, 0, 0},
        {84, 0, 0},   {1348, 0, 0}, {1356, 0, 0},   {1388, 1, 64},  {1384, 1, 16384}, {1396, 0, 0},
        {1404, 0, 0}, {1488, 0, 1}, {1492, 0, 1},
    };
    const unsigned char *b = mesh->bytes;
    if (mesh->size < 4096 || memcmp(b, magic, 8) != 0)
        return wrong(mesh, "no magic");
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        uint64_t value = naive_number(b + ranges[i][0], 4);
        if (value < ranges[i][1] || value > ranges[i][2])
            return wrong(mesh, "header field at %d is %llu", (int)ranges[i][0],
                         (unsigned long long)value);
    }
    mesh->run_align_log2 = (int)naive_number(b + 52, 4);
    mesh->codec = (int)naive_number(b + 56, 4);
    mesh->fields = (long)naive_number(b + 64, 4);
    mesh->steps = (long)naive_number(b + 68, 4);
    mesh->sets = mesh->fields * mesh->steps;
    mesh->treelets = (long)naive_number(b + 80, 4);
    mesh->tets = (long)naive_number(b + 1344, 4);
    mesh->vertices = (long)naive_number(b + 1352, 4);
    mesh->treelet_tets = (long)naive_number(b + 1384, 4);
    mesh->leaf_tets = (long)naive_number(b + 1388, 4);
    mesh->gradient_sets = naive_number(b + 1488, 4) ? mesh->sets : 0;
    mesh->places = naive_number(b + 1492, 4) ? mesh->steps : 1;
    if (naive_number(b + 1492, 4) && mesh->steps < 2)
        return wrong(mesh, "one step that moves");
    if (mesh->sets > 65536 || mesh->treelets < 1 || (size_t)mesh->treelets > mesh->size)
        return wrong(mesh, "%ld treelets, %ld sets", mesh->treelets, mesh->sets);
    if (naive_number(b + 1392, 8) > (uint64_t)mesh->tets ||
        naive_number(b + 1400, 8) > (uint64_t)mesh->tets)
        return wrong(mesh, "more flat or inverted tets than tets");
    for (int i = 0; i < 12; i++)
        if (naive_real64(b + 136 + 8 * i) != (i == 0 || i == 5 || i == 10 ? 1 : 0))
            return wrong(mesh, "to_world is not the identity");
    if (!(naive_real64(b + 128) >= 0))
        return wrong(mesh, "rounding error");
    if (naive_number(b + 96, 8) != mesh->size)
        return wrong(mesh, "file_bytes");
    uint64_t sections = naive_number(b + 72, 4);
    uint64_t table = naive_number(b + 1504, 8);
    table = table ? table : 4096;
    if (table > mesh->size || mesh->size - table < 32 * sections || !naive_zeros(b, 1496, 1504) ||
        !naive_zeros(b, 1536, 4096) || !naive_text(b + 256, 64) || !naive_text(b + 320, 1024) ||
        !naive_text(b + 1424, 64))
        return wrong(mesh, "section table cut off, or reserved bytes, or a text");
    mesh->grows = mesh->segments_before || naive_number(b + 1520, 4);
    if (mesh->segments_before ? !naive_zeros(b, 1512, 1524) || !naive_number(b + 1524, 4) ||
                                    !naive_number(b + 1504, 8)
                              : !naive_zeros(b, 1524, 1536))
        return wrong(mesh, "what the header says of segments");
    if (mesh->grows && mesh->places > 1)
        return wrong(mesh, "a segment that moves");
    return naive_hashes(b, sections) || wrong(mesh, "the header's checksum or id");
}

/* ---- sections: 3 and 6 ---- */

static bool find_sections(naive_mesh *mesh) {
    enum { OPTIONAL = 1 << NAIVE_FIELDS | 1 << NAIVE_TIMES | 1 << NAIVE_COARSE | 1 << NAIVE_SAME };
    const uint64_t n = (uint64_t)mesh->treelets, sets = (uint64_t)mesh->sets;
    const uint64_t payloads = (uint64_t)naive_mesh_payloads(mesh), steps = (uint64_t)mesh->steps;
    const uint64_t want[NAIVE_KINDS] = {[NAIVE_RANGES] = 8 * n * sets,
                                        [NAIVE_OWN] = 8 * n * sets,
                                        [NAIVE_FLAGS] = n * sets,
                                        [NAIVE_OFFSETS] = 8 * payloads,
                                        [NAIVE_SIZES] = 8 * payloads,
                                        [NAIVE_CHECKSUMS] = 8 * payloads,
                                        [NAIVE_BOUNDS] = 24 * n * (uint64_t)mesh->places,
                                        [NAIVE_COUNTS] = 16 * n,
                                        [NAIVE_FIELDS] = 64 * (uint64_t)mesh->fields,
                                        [NAIVE_TIMES] = steps > 1 || mesh->grows ? 8 * steps : 0,
                                        [NAIVE_COARSE] = mesh->grows ? 0 : 32 * sets,
                                        [NAIVE_SAME] =
                                            sets > 1 || mesh->segments_before ? 4 * payloads : 0};
    return naive_sections_find(&mesh->sections, mesh->bytes, mesh->size, want, OPTIONAL) ||
           wrong(mesh, "%s", mesh->sections.why);
}

static bool read_labels(naive_mesh *mesh, const unsigned char *names, const unsigned char *times) {
    const char *why = naive_labels(mesh->bytes, names, mesh->fields, times, mesh->steps,
                                   &mesh->names, &mesh->times);
    return !why || wrong(mesh, "%s", why);
}

static bool read_counts(naive_mesh *mesh, const unsigned char *counts,
                        const unsigned char *bounds) {
    float all[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    long tets = 0, vertices = 0;
    for (long i = 0; i < mesh->treelets; i++) {
        naive_part *t = &mesh->part[i];
        t->tets = (long)naive_number(counts + 16 * i, 4);
        t->vertices = (long)naive_number(counts + 16 * i + 4, 4);
        t->nodes = (long)naive_number(counts + 16 * i + 8, 4);
        t->leaves = (long)naive_number(counts + 16 * i + 12, 4);
        if (t->tets < 1 || t->tets > mesh->treelet_tets || t->vertices < 4 ||
            t->vertices > 4 * t->tets || t->leaves > t->tets ||
            t->tets > t->leaves * mesh->leaf_tets || t->nodes < 1 ||
            (t->nodes > 1 && t->nodes >= t->leaves) || t->leaves > 7 * t->nodes + 1)
            return wrong(mesh, "treelet %ld: counts", i);
        tets += t->tets;
        vertices += t->vertices;
        if (t->vertices > mesh->vertices)
            return wrong(mesh, "treelet %ld: more vertices than the mesh", i);
        t->bounds = malloc((size_t)mesh->places * sizeof *t->bounds);
        if (!t->bounds)
            return wrong(mesh, "no memory");
        for (long n = 0; n < 6 * mesh->places; n++) {
            const int a = (int)(n % 6);
            const float at = naive_real32(bounds + 24 * (n / 6 * mesh->treelets + i) + 4 * a);
            t->bounds[n / 6][a] = at;
            if (!isfinite(at) || naive_minus_zero(at))
                return wrong(mesh, "treelet %ld: bounds", i);
            if (a < 3 ? at < all[a] : at > all[a])
                all[a] = at;
        }
    }
    if (tets != mesh->tets || vertices < mesh->vertices)
        return wrong(mesh, "tets or vertices do not add up");
    for (int a = 0; a < 6; a++)
        if (all[a] != naive_real32(mesh->bytes + 1360 + 4 * a))
            return wrong(mesh, "bounds of the whole");
    return true;
}

/* ---- topology: 6 ---- */

/* A treelet while it is read; node and child of leaf and inner node. */
typedef struct reading {
    naive_mesh *mesh;
    naive_part *t;
    long index;
    const unsigned char *topology;
    long *first;      /* of leaves */
    long (*spans)[2]; /* of nodes: their tets */
} reading;

static long child_of(const reading *r, long node, int c) {
    return (long)naive_number(r->topology + 64 * node + 48 + 2 * c, 2);
}

static bool read_parts(reading *r) {
    naive_part *t = r->t;
    uint64_t at[4];
    naive_mesh_parts(t, at);
    const unsigned char *b = r->topology;
    if (!naive_zeros(b, at[0] + 2 * (uint64_t)(t->leaves + 1), at[1]) ||
        !naive_zeros(b, at[1] + 8 * (uint64_t)t->tets, at[2]) ||
        !naive_zeros(b, at[2] + 12 * (uint64_t)t->vertices, at[3]))
        return wrong(r->mesh, "treelet %ld: padding", r->index);
    for (long l = 0; l <= t->leaves; l++) {
        r->first[l] = (long)naive_number(b + at[0] + 2 * (uint64_t)l, 2);
        long tets = l ? r->first[l] - r->first[l - 1] : 1;
        if (tets < 1 || tets > r->mesh->leaf_tets || (l == 0 && r->first[0] != 0))
            return wrong(r->mesh, "treelet %ld: leaf %ld", r->index, l);
    }
    if (r->first[t->leaves] != t->tets)
        return wrong(r->mesh, "treelet %ld: the last leaf", r->index);
    bool *used = calloc((size_t)t->vertices, sizeof *used);
    bool good = used != NULL;
    for (long i = 0; good && i < t->tets; i++)
        for (int k = 0; good && k < 4; k++) {
            long v = (long)naive_number(b + at[1] + 8 * (uint64_t)i + 2 * (uint64_t)k, 2);
            good = v < t->vertices && (k == 0 || v > t->tet[i][k - 1]);
            t->tet[i][k] = v;
            if (good)
                used[v] = true;
        }
    for (long v = 0; good && v < t->vertices; v++) {
        good = used[v];
        for (int a = 0; a < 3; a++)
            t->positions[v][a] = naive_real32(b + at[2] + 12 * (uint64_t)v + 4 * (uint64_t)a);
    }
    free(used);
    return good || wrong(r->mesh, "treelet %ld: tets or vertices", r->index);
}

/* Goes down in order of the children; false where leaves do not come in order. */
static bool descend(reading *r, long node, int depth, long *leaf) {
    if (depth > 64)
        return false;
    r->spans[node][0] = *leaf < r->t->leaves ? r->first[*leaf] : 0;
    for (int c = 0; c < 8; c++) {
        long child = child_of(r, node, c);
        if (child == 0xffff)
            continue;
        if (child >= 0x8000) {
            if (child - 0x8000 != *leaf || *leaf >= r->t->leaves)
                return false;
            ++*leaf;
        } else if (!descend(r, child, depth + 1, leaf)) {
            return false;
        }
    }
    r->spans[node][1] = r->first[*leaf];
    return true;
}

static bool check_tree(reading *r) {
    long met = 0, leaf = 0;
    for (long node = 0; node < r->t->nodes; node++) {
        int present = 0;
        for (int c = 0; c < 8; c++) {
            long child = child_of(r, node, c);
            if (child == 0xffff)
                continue;
            if (present != c)
                return wrong(r->mesh, "treelet %ld: node %ld: a gap", r->index, node);
            present++;
            if (child < 0x8000 && (child != ++met || child <= node || child >= r->t->nodes))
                return wrong(r->mesh, "treelet %ld: node %ld: child %d", r->index, node, c);
        }
        if (present < 2 && r->t->leaves > 1)
            return wrong(r->mesh, "treelet %ld: node %ld: too few children", r->index, node);
    }
    return (met == r->t->nodes - 1 && descend(r, 0, 1, &leaf) && leaf == r->t->leaves) ||
           wrong(r->mesh, "treelet %ld: the tree", r->index);
}

/* The tets of a child, [span[0], span[1]); false: no child. */
static bool child_span(const reading *r, long node, int c, long span[2]) {
    long child = child_of(r, node, c);
    if (child == 0xffff)
        return false;
    const long leaf = child - 0x8000;
    span[0] = leaf >= 0 ? r->first[leaf] : r->spans[child][0];
    span[1] = leaf >= 0 ? r->first[leaf + 1] : r->spans[child][1];
    return true;
}

static float plane(float lo, float step, int code) {
    volatile float product = (float)code * step; /* rounded by itself */
    return lo + product;
}

/* By trying one after the other, from an estimate that is surely too small. */
static float step_of(float lo, float hi) {
    if (hi <= lo)
        return 0;
    double about = ((double)hi - (double)lo) / 255;
    uint32_t bits = 256;
    for (uint32_t bit = UINT32_C(1) << 30; bit >= 256; bit >>= 1)
        if ((double)naive_float_of(bits + bit) < about / 4 && bits + bit < 0x7f800000)
            bits += bit;
    bits &= ~UINT32_C(255);
    while (!(plane(lo, naive_float_of(bits), 255) >= hi))
        bits += 256;
    return naive_float_of(bits);
}

static int code_hi(float lo, float step, float at) {
    int code = 0;
    while (plane(lo, step, code) < at)
        code++;
    return code;
}

static int code_lo(float lo, float step, float at) {
    int best = 0;
    for (int code = 0; code < 256; code++)
        if (plane(lo, step, code) <= at && plane(lo, step, code) > plane(lo, step, best))
            best = code;
    return best;
}

/* One axis of all children's boxes at a step of time; codes `stride` bytes apart. */
static bool check_planes(reading *r, long place, int a, const unsigned char *codes, long stride) {
    const naive_part *t = r->t;
    const float(*positions)[3] = (const float(*)[3])t->positions + place * t->vertices;
    const float low = t->bounds[place][a], step = step_of(low, t->bounds[place][a + 3]);
    for (long node = 0; node < t->nodes; node++)
        for (int c = 0; c < 8; c++) {
            long span[2];
            int want[2] = {255, 0};
            if (child_span(r, node, c, span)) {
                float least = INFINITY, most = -INFINITY;
                for (long i = span[0]; i < span[1]; i++)
                    for (int k = 0; k < 4; k++) {
                        float at = positions[t->tet[i][k]][a];
                        least = at < least ? at : least;
                        most = at > most ? at : most;
                    }
                want[0] = code_lo(low, step, least);
                want[1] = code_hi(low, step, most);
            }
            for (int side = 0; side < 2; side++)
                if (codes[stride * node + 24 * side + 8 * a + c] != want[side])
                    return wrong(r->mesh,
                                 "treelet %ld, step %ld: node %ld: child %d: %s code of axis %d",
                                 r->index, place, node, c, side ? "upper" : "lower", a);
        }
    return true;
}

static bool check_bounds(reading *r, long place) {
    const float(*positions)[3] = (const float(*)[3])r->t->positions + place * r->t->vertices;
    for (int a = 0; a < 3; a++) {
        float least = INFINITY, most = -INFINITY;
        for (long v = 0; v < r->t->vertices; v++) {
            float at = positions[v][a];
            if (!isfinite(at))
                return wrong(r->mesh, "treelet %ld: vertex %ld", r->index, v);
            least = at < least ? at : least;
            most = at > most ? at : most;
        }
        if (least != r->t->bounds[place][a] || most != r->t->bounds[place][a + 3])
            return wrong(r->mesh, "treelet %ld, step %ld: bounds along axis %d", r->index, place,
                         a);
    }
    return true;
}

/* Bounds and boxes of the positions of a step, which have been read. */
static bool check_place(reading *r, long place, const unsigned char *codes, long stride) {
    bool good = check_bounds(r, place);
    for (int a = 0; good && a < 3; a++)
        good = check_planes(r, place, a, codes, stride);
    return good;
}

static void read_triples(const unsigned char *b, float (*to)[3], long count) {
    for (long i = 0; i < 3 * count; i++)
        to[i / 3][i % 3] = naive_real32(b + 4 * i);
}

static bool check_moved(reading *r, long step, const unsigned char *b) {
    const uint64_t at = naive_mesh_moved_at(r->t), end = at + 12 * (uint64_t)r->t->vertices;
    if (!naive_zeros(b, 48 * (uint64_t)r->t->nodes, at) ||
        !naive_zeros(b, end, naive_up_to(end, 64)))
        return wrong(r->mesh, "treelet %ld, step %ld: padding", r->index, step);
    read_triples(b + at, r->t->positions + step * r->t->vertices, r->t->vertices);
    return check_place(r, step, b, 48);
}

static bool check_gradients(reading *r, long set, const unsigned char *b) {
    const uint64_t end = 12 * (uint64_t)r->t->vertices;
    float(*to)[3] = r->t->gradients + set * r->t->vertices;
    read_triples(b, to, r->t->vertices);
    for (long i = 0; i < 3 * r->t->vertices; i++)
        if (!isfinite(to[i / 3][i % 3]))
            return wrong(r->mesh, "treelet %ld, set %ld: gradient %ld", r->index, set, i / 3);
    return naive_zeros(b, end, naive_up_to(end, 64)) ||
           wrong(r->mesh, "treelet %ld, set %ld: padding of gradients", r->index, set);
}

/* ---- values: 6 and 4 ---- */

/* Smallest and largest finite value of tets' vertices; whether all are finite. */
static bool finite_range(const reading *r, const float *value, const long span[2], float *least,
                         float *most) {
    bool all = true;
    *least = INFINITY;
    *most = -INFINITY;
    for (long i = span[0]; i < span[1]; i++)
        for (int k = 0; k < 4; k++) {
            float v = value[r->t->tet[i][k]];
            if (!isfinite(v)) {
                all = false;
                continue;
            }
            *least = v < *least ? v : *least;
            *most = v > *most ? v : *most;
        }
    return all;
}

static double map(const float own[2], double value) {
    double lo = (double)own[0], hi = (double)own[1];
    double scale = hi <= lo ? 0 : 255 / (hi - lo), g = (value - lo) * scale;
    return g < 0 ? 0 : g > 255 ? 255 : g;
}

static bool check_values(reading *r, long set, const unsigned char *b,
                         const unsigned char *const where[NAIVE_KINDS]) {
    const long element = set * r->mesh->treelets + r->index;
    const float *value = r->t->values + set * r->t->vertices;
    const uint64_t at = naive_mesh_values_at(r->t);
    float own[2], range[2];
    for (int i = 0; i < 2; i++) {
        own[i] = naive_real32(where[NAIVE_OWN] + 8 * element + 4 * i);
        if (naive_minus_zero(own[i]) ||
            naive_number(where[NAIVE_OWN] + 8 * element + 4 * i, 4) !=
                naive_number(where[NAIVE_RANGES] + 8 * element + 4 * i, 4))
            return wrong(r->mesh, "element %ld of OWN or RANGES", element);
    }
    if (!naive_zeros(b, 16 * (uint64_t)r->t->nodes, at) ||
        !naive_zeros(b, at + 4 * (uint64_t)r->t->vertices,
                     naive_up_to(at + 4 * (uint64_t)r->t->vertices, 64)))
        return wrong(r->mesh, "treelet %ld, set %ld: padding", r->index, set);
    for (long v = 0; v < r->t->vertices; v++)
        r->t->values[set * r->t->vertices + v] = naive_real32(b + at + 4 * (uint64_t)v);
    const long all[2] = {0, r->t->tets};
    bool finite = finite_range(r, value, all, &range[0], &range[1]);
    if (range[0] != own[0] || range[1] != own[1] || where[NAIVE_FLAGS][element] != (finite ? 0 : 1))
        return wrong(r->mesh, "treelet %ld, set %ld: own range or flags", r->index, set);
    for (long node = 0; node < r->t->nodes; node++)
        for (int c = 0; c < 8; c++) {
            long span[2];
            int lo = 255, hi = 0;
            if (child_span(r, node, c, span)) {
                finite_range(r, value, span, &range[0], &range[1]);
                if (range[0] <= range[1]) {
                    lo = (int)floor(map(own, (double)range[0]));
                    hi = (int)ceil(map(own, (double)range[1]));
                }
            }
            if (b[16 * node + c] != lo || b[16 * node + 8 + c] != hi)
                return wrong(r->mesh, "treelet %ld, set %ld: codes of node %ld", r->index, set,
                             node);
        }
    return true;
}

/* ---- loading ---- */

/* implied: out, the boxes of a topology are not there. */
static unsigned char *payload_of(const naive_mesh *mesh, long p, bool *implied) {
    const naive_part *t = &mesh->part[p % mesh->treelets];
    const uint32_t counts[4] = {(uint32_t)t->tets, (uint32_t)t->vertices, (uint32_t)t->nodes,
                                (uint32_t)t->leaves};
    const int block = p < mesh->treelets                  ? 0
                      : p < naive_mesh_gradients(mesh, 0) ? 1
                      : p < naive_mesh_positions(mesh, 1) ? 2
                                                          : 3;
    uint64_t size;
    const unsigned char *stored = naive_mesh_stored(mesh, p, &size);
    const uint64_t want = naive_mesh_payload_bytes(mesh, p);
    unsigned char *payload = calloc(1, want);
    *implied = false;
    if (payload && size == want)
        memcpy(payload, stored, want);
    else if (payload && !naive_coded_unpack(block, counts, stored, size, payload, want, implied)) {
        free(payload);
        payload = NULL;
    }
    return payload;
}

/* Payload p of the treelet, but for its topology. */
static bool check_payload(reading *r, long p, const unsigned char *const where[NAIVE_KINDS]) {
    const naive_mesh *mesh = r->mesh;
    const long block = p / mesh->treelets;
    bool good, implied;
    unsigned char *payload = payload_of(mesh, p, &implied);
    if (!payload)
        return wrong(r->mesh, "payload %ld cannot be decoded", p);
    if (p < naive_mesh_gradients(mesh, 0))
        good = check_values(r, block - 1, payload, where);
    else if (p < naive_mesh_positions(mesh, 1))
        good = check_gradients(r, block - 1 - mesh->sets, payload);
    else
        good = check_moved(r, block - mesh->sets - mesh->gradient_sets, payload);
    free(payload);
    return good;
}

static bool read_treelet(naive_mesh *mesh, long index,
                         const unsigned char *const where[NAIVE_KINDS]) {
    naive_part *t = &mesh->part[index];
    bool implied;
    unsigned char *topology = payload_of(mesh, index, &implied);
    t->positions = malloc((size_t)(t->vertices * mesh->places) * sizeof *t->positions);
    t->values = malloc((size_t)(t->vertices * mesh->sets) * sizeof *t->values);
    t->gradients = malloc((size_t)(t->vertices * mesh->gradient_sets + 1) * sizeof *t->gradients);
    t->tet = malloc((size_t)t->tets * sizeof *t->tet);
    reading r = {.mesh = mesh, .t = t, .index = index, .topology = topology};
    r.first = malloc((size_t)(t->leaves + 1) * sizeof *r.first);
    r.spans = malloc((size_t)t->nodes * sizeof *r.spans);
    bool good =
        (topology && t->positions && t->values && t->gradients && t->tet && r.first && r.spans) ||
        wrong(mesh, "treelet %ld cannot be decoded", index);
    good = good && read_parts(&r) && check_tree(&r) &&
           (implied ? check_bounds(&r, 0) : check_place(&r, 0, topology, 64));
    for (long p = mesh->treelets + index; good && p < naive_mesh_payloads(mesh);
         p += mesh->treelets)
        good = check_payload(&r, p, where);
    free(r.first);
    free(r.spans);
    free(topology);
    return good;
}

/* What the header says of all values. */
static bool check_union(naive_mesh *mesh, const unsigned char *const where[NAIVE_KINDS]) {
    double least = INFINITY, most = -INFINITY;
    uint64_t strange = 0, claimed = naive_number(mesh->bytes + 104, 8);
    for (long i = 0; i < mesh->treelets * mesh->sets; i++) {
        least = fmin(least, (double)naive_real32(where[NAIVE_OWN] + 8 * i));
        most = fmax(most, (double)naive_real32(where[NAIVE_OWN] + 8 * i + 4));
    }
    for (long i = 0; i < mesh->treelets; i++)
        for (long v = 0; v < mesh->part[i].vertices * mesh->sets; v++)
            strange += !isfinite(mesh->part[i].values[v]);
    if (least != naive_real64(mesh->bytes + 112) || most != naive_real64(mesh->bytes + 120))
        return wrong(mesh, "value_min, value_max");
    return (claimed <= strange && (claimed > 0) == (strange > 0)) || wrong(mesh, "non_finite");
}

static bool read_file(naive_mesh *mesh, const char *path) {
    FILE *in = fopen(path, "rb");
    if (!in)
        return wrong(mesh, "cannot be opened");
    fseek(in, 0, SEEK_END);
    long size = ftell(in);
    rewind(in);
    mesh->size = size > 0 ? (size_t)size : 0;
    mesh->bytes = malloc(mesh->size + 1);
    bool good = mesh->bytes && fread(mesh->bytes, 1, mesh->size, in) == mesh->size;
    fclose(in);
    return good || wrong(mesh, "cannot be read");
}

bool naive_mesh_read(naive_mesh *mesh) {
    const unsigned char *const *where = mesh->sections.where;
    if (!read_header(mesh) || !find_sections(mesh))
        return false;
    mesh->part = calloc((size_t)mesh->treelets, sizeof *mesh->part);
    if (!mesh->part)
        return wrong(mesh, "no memory");
    bool good = read_labels(mesh, where[NAIVE_FIELDS], where[NAIVE_TIMES]) &&
                read_counts(mesh, where[NAIVE_COUNTS], where[NAIVE_BOUNDS]) &&
                naive_mesh_place(mesh);
    for (long i = 0; good && i < mesh->treelets; i++)
        good = read_treelet(mesh, i, where);
    return good && check_union(mesh, where);
}

bool naive_mesh_load(naive_mesh *mesh, const char *path) {
    memset(mesh, 0, sizeof *mesh);
    return read_file(mesh, path) && naive_mesh_read(mesh);
}

void naive_mesh_release(naive_mesh *mesh) {
    for (long i = 0; mesh->part && i < mesh->treelets; i++) {
        free(mesh->part[i].positions);
        free(mesh->part[i].values);
        free(mesh->part[i].tet);
        free(mesh->part[i].bounds);
        free(mesh->part[i].gradients);
    }
    free(mesh->names);
    free(mesh->times);
    free(mesh->part);
    naive_sections_release(&mesh->sections);
    free(mesh->bytes);
    memset(mesh, 0, sizeof *mesh);
}
