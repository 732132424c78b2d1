#include "tests/support/naive_mesh_places.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/naive_coarse.h"

static bool wrong(naive_mesh *mesh, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_mesh *mesh, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(mesh->why, sizeof mesh->why, format, args);
    va_end(args);
    return false;
}

/* ---- sizes ---- */

long naive_mesh_payloads(const naive_mesh *mesh) {
    return mesh->treelets * (mesh->sets + mesh->gradient_sets + mesh->places);
}

static uint64_t node_bytes(const naive_part *t) {
    return 64 * (uint64_t)t->nodes;
}

void naive_mesh_parts(const naive_part *t, uint64_t at[4]) {
    at[0] = node_bytes(t);
    at[1] = naive_up_to(at[0] + 2 * (uint64_t)(t->leaves + 1), 64);
    at[2] = naive_up_to(at[1] + 8 * (uint64_t)t->tets, 64);
    at[3] = naive_up_to(at[2] + 12 * (uint64_t)t->vertices, 64);
}

uint64_t naive_mesh_values_at(const naive_part *t) {
    return naive_up_to(16 * (uint64_t)t->nodes, 64);
}

uint64_t naive_mesh_moved_at(const naive_part *t) {
    return naive_up_to(48 * (uint64_t)t->nodes, 64);
}

long naive_mesh_gradients(const naive_mesh *mesh, long set) {
    return mesh->treelets * (1 + mesh->sets + set);
}

long naive_mesh_positions(const naive_mesh *mesh, long step) {
    return mesh->treelets * (mesh->sets + mesh->gradient_sets + step);
}

uint64_t naive_mesh_payload_bytes(const naive_mesh *mesh, long p) {
    const naive_part *t = &mesh->part[p % mesh->treelets];
    const uint64_t vertices = (uint64_t)t->vertices;
    uint64_t at[4];
    naive_mesh_parts(t, at);
    if (p < mesh->treelets)
        return at[3];
    if (p < naive_mesh_gradients(mesh, 0))
        return naive_up_to(naive_mesh_values_at(t) + 4 * vertices, 64);
    return naive_up_to(
        (p < naive_mesh_positions(mesh, 1) ? 0 : naive_mesh_moved_at(t)) + 12 * vertices, 64);
}

/* ---- places ---- */

/* Coarse grids from `end` on: each a sound file, nothing between or behind them. */
static bool check_coarse(naive_mesh *mesh, const unsigned char *parts, uint64_t end) {
    for (long set = 0; parts && set < mesh->sets; set++) {
        const unsigned char *part = parts + 32 * set;
        const uint64_t offset = naive_number(part, 8), bytes = naive_number(part + 8, 8);
        if (naive_zeros(part, 0, 32))
            continue;
        if (offset != end || bytes < 4096 || bytes % (UINT64_C(1) << mesh->run_align_log2) ||
            bytes > mesh->size - offset)
            return wrong(mesh, "coarse grid %ld: place", set);
        if (memcmp(part + 16, mesh->bytes + offset + 232, 16) != 0 ||
            !naive_coarse_check(mesh->bytes + offset, bytes))
            return wrong(mesh, "coarse grid %ld: not what it is to be", set);
        end = offset + bytes;
    }
    return end == mesh->size || wrong(mesh, "the end of the file");
}

/* A payload of this file, or of a segment before; without a file: none. */
typedef struct origin {
    const naive_mesh *mesh;
    long p;
} origin;

/* The first payload of the block of topologies, values, gradients or positions that p is in. */
static long block_of(const naive_mesh *mesh, long p) {
    const long blocks[] = {0, mesh->treelets, naive_mesh_gradients(mesh, 0),
                           naive_mesh_positions(mesh, 1)};
    long first = 0;
    for (int i = 0; i < 4; i++)
        first = blocks[i] <= p ? blocks[i] : first;
    return first;
}

/* Payload q, if it has bytes of its own; else none. */
static origin home(const naive_mesh *of, long q) {
    const bool same = naive_sections_link(&of->sections, NAIVE_SAME, q) >= 0;
    return (origin){same ? NULL : of, q};
}

/* The payload that an entry of SAME leads p to: of the same block, in an earlier set, step, or
 * segment; of a topology, in the first segment. */
static origin led_to(const naive_mesh *mesh, long p, long entry) {
    const origin none = {NULL, 0};
    const long n = mesh->treelets, first = block_of(mesh, p), at = (p - first) % n;
    long number = entry + 1 - (1L << 31), i = 0;
    if (number < 0)
        return entry < (p - first) / n ? home(mesh, first + at + entry * n) : none;
    for (; i < mesh->segments_before && number >= mesh->before[i].sets; i++)
        number -= mesh->before[i].sets;
    if (i == mesh->segments_before || (first == 0 && i + number > 0))
        return none;
    const naive_mesh *of = &mesh->before[i];
    return home(of, (first > n ? naive_mesh_gradients(of, 0) : first) + at + number * n);
}

static uint64_t entry_of(const naive_mesh *mesh, int kind, long p) {
    return naive_number(mesh->sections.where[kind] + 8 * p, 8);
}

/* Whether payload p has the bytes that the entry of SAME says. */
static bool is_same(const naive_mesh *mesh, long p, long entry) {
    const origin q = led_to(mesh, p, entry);
    return q.mesh &&
           entry_of(mesh, NAIVE_OFFSETS, p) ==
               (q.mesh == mesh ? entry_of(mesh, NAIVE_OFFSETS, q.p) : 0) &&
           entry_of(mesh, NAIVE_SIZES, p) == entry_of(q.mesh, NAIVE_SIZES, q.p) &&
           entry_of(mesh, NAIVE_CHECKSUMS, p) == entry_of(q.mesh, NAIVE_CHECKSUMS, q.p);
}

const unsigned char *naive_mesh_stored(const naive_mesh *mesh, long p, uint64_t *size) {
    const long same = naive_sections_link(&mesh->sections, NAIVE_SAME, p);
    const origin q = same < 0 ? (origin){mesh, p} : led_to(mesh, p, same);
    *size = entry_of(q.mesh, NAIVE_SIZES, q.p);
    return q.mesh->bytes + entry_of(q.mesh, NAIVE_OFFSETS, q.p);
}

/* Offsets, sizes and checksums of all payloads, and what is between them. */
bool naive_mesh_place(naive_mesh *mesh) {
    const unsigned char *const *where = mesh->sections.where;
    uint64_t stored = 0, end = mesh->sections.payloads;
    bool begins = false; /* a run, whose first payloads may be elsewhere */
    for (long p = 0; p < naive_mesh_payloads(mesh); p++) {
        uint64_t offset = naive_number(where[NAIVE_OFFSETS] + 8 * p, 8),
                 size = naive_number(where[NAIVE_SIZES] + 8 * p, 8);
        const long same = naive_sections_link(&mesh->sections, NAIVE_SAME, p);
        begins = begins || p % mesh->treelets == 0;
        uint64_t align = begins ? UINT64_C(1) << mesh->run_align_log2 : 64;
        if (same >= 0 && is_same(mesh, p, same))
            continue;
        if (same >= 0 || (p < mesh->treelets && mesh->segments_before))
            return wrong(mesh, "payload %ld: not the same as an earlier one", p);
        begins = false;
        if (offset != naive_up_to(end, align))
            return wrong(mesh, "payload %ld: offset", p);
        if (size < 1 || size > naive_mesh_payload_bytes(mesh, p) ||
            (mesh->codec == 0 && size != naive_mesh_payload_bytes(mesh, p)))
            return wrong(mesh, "payload %ld: size", p);
        if (offset > mesh->size || size > mesh->size - offset ||
            !naive_zeros(mesh->bytes, end, offset))
            return wrong(mesh, "payload %ld: place or padding", p);
        if (XXH3_64bits(mesh->bytes + offset, size) !=
            naive_number(where[NAIVE_CHECKSUMS] + 8 * p, 8))
            return wrong(mesh, "payload %ld: checksum", p);
        end = offset + size;
        stored += size;
    }
    if (stored != naive_number(mesh->bytes + 88, 8))
        return wrong(mesh, "payload_bytes");
    const uint64_t full = naive_sections_hold(&mesh->sections, mesh->bytes, mesh->size, end);
    if (!full)
        return wrong(mesh, "what is behind the payloads");
    return check_coarse(mesh, where[NAIVE_COARSE], full);
}
