#include "tests/support/naive_places.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/naive_order.h"

enum { CODES_MAX = 8 }; /* that a reader may need for one payload */

static bool wrong(naive_leaf *leaf, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_leaf *leaf, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(leaf->why, sizeof leaf->why, format, args);
    va_end(args);
    return false;
}

/* Payloads in the order of the file. */
typedef struct placing {
    uint64_t end, stored; /* of the payload before; bytes of all */
    bool run;             /* a run has begun that has no bytes yet */
} placing;

/* Where payload p is kept here. */
static naive_stored *stored_of(const naive_leaf *leaf, long p) {
    const long n = leaf->treelet_count, shell = p - n * leaf->sets;
    return shell < 0
               ? &leaf->treelets[p].stored
               : &leaf->treelets[shell / leaf->shell_count * n + shell % leaf->shell_count].shell;
}

/* A payload of this file, or of a segment before; without a file: none. */
typedef struct origin {
    const naive_leaf *leaf;
    long p;
} origin;

/* The payload in the place of p of `leaf` in a set of a segment; none if it has no bytes of its
 * own. */
static origin in_set(const naive_leaf *leaf, long p, const naive_leaf *of, long set) {
    const long n = leaf->treelet_count, shells = n * leaf->sets;
    const long q = p < shells
                       ? set * n + p % n
                       : n * of->sets + set * of->shell_count + (p - shells) % leaf->shell_count;
    if (stored_of(of, q)->size == 0 || naive_sections_link(&of->sections, NAIVE_SAME, q) >= 0)
        return (origin){NULL, 0};
    return (origin){of, q};
}

/* The payload that an entry leads p to: of an earlier set, or segment. */
static origin earlier(const naive_leaf *leaf, long p, long entry) {
    const long n = leaf->treelet_count, shells = n * leaf->sets;
    const long own = p < shells ? p / n : (p - shells) / leaf->shell_count;
    long number = entry + 1 - (1L << 31);
    if (number < 0)
        return entry < own ? in_set(leaf, p, leaf, entry) : (origin){NULL, 0};
    for (long i = 0; i < leaf->segments_before; number -= leaf->before[i++].sets)
        if (number < leaf->before[i].sets)
            return in_set(leaf, p, &leaf->before[i], number);
    return (origin){NULL, 0};
}

/* A payload whose bytes are those of an earlier one. */
static bool is_same(naive_leaf *leaf, long p, origin q, uint64_t checksum, naive_stored *out) {
    const naive_stored *first = q.leaf ? stored_of(q.leaf, q.p) : NULL;
    if (!first || out->offset != (q.leaf == leaf ? first->offset : 0) || first->size != out->size ||
        naive_number(q.leaf->sections.where[NAIVE_CHECKSUMS] + 8 * q.p, 8) != checksum ||
        naive_sections_link(&leaf->sections, NAIVE_BASES, p) >= 0)
        return wrong(leaf, "payload %ld: not the same as an earlier one", p);
    out->base = first->base;
    out->at = first->at;
    return true;
}

static bool find_base(naive_leaf *leaf, long p, long entry, naive_stored *out) {
    const origin q = earlier(leaf, p, entry);
    int codes = 1;
    out->base = q.leaf ? stored_of(q.leaf, q.p) : NULL;
    for (const naive_stored *b = out->base; b; b = b->base)
        codes++;
    return (q.leaf && codes <= CODES_MAX) || wrong(leaf, "payload %ld: its base", p);
}

/* Payload p of the directory. begins: a run. */
static bool place_payload(naive_leaf *leaf, placing *x, long p, bool begins, naive_stored *out) {
    const unsigned char *const *where = leaf->sections.where;
    out->offset = naive_number(where[NAIVE_OFFSETS] + 8 * p, 8);
    out->size = naive_number(where[NAIVE_SIZES] + 8 * p, 8);
    out->at = leaf->bytes + (out->offset < leaf->size ? out->offset : 0);
    const uint64_t checksum = naive_number(where[NAIVE_CHECKSUMS] + 8 * p, 8);
    const long same = naive_sections_link(&leaf->sections, NAIVE_SAME, p),
               base = naive_sections_link(&leaf->sections, NAIVE_BASES, p);
    x->run = x->run || begins;
    if (same >= 0)
        return is_same(leaf, p, earlier(leaf, p, same), checksum, out);
    if (base >= 0 && (out->size == 0 || !find_base(leaf, p, base, out)))
        return wrong(leaf, "payload %ld: a base of nothing", p);
    const bool below = p < leaf->treelet_count && leaf->outside && leaf->treelets[p].level == 0;
    if (below)
        leaf->treelets[p].checksum = checksum;
    if (out->size == 0)
        return (out->offset == x->end && (checksum == 0 || below)) ||
               wrong(leaf, "payload %ld: place of no bytes", p);
    if (out->offset != naive_up_to(x->end, x->run             ? UINT64_C(1) << leaf->run_align_log2
                                           : leaf->codec == 1 ? 1
                                                              : 64))
        return wrong(leaf, "payload %ld: offset", p);
    if (out->offset > leaf->size || out->size > leaf->size - out->offset ||
        !naive_zeros(leaf->bytes, x->end, out->offset))
        return wrong(leaf, "payload %ld: place or padding", p);
    if (XXH3_64bits(leaf->bytes + out->offset, out->size) != checksum)
        return wrong(leaf, "payload %ld: checksum", p);
    x->run = false;
    x->end = out->offset + out->size;
    x->stored += out->size;
    return true;
}

static bool place_treelet(naive_leaf *leaf, placing *x, long i, bool begins) {
    naive_treelet *t = &leaf->treelets[i];
    const bool one = t->own[0] == t->own[1] && !t->has_non_finite;
    const bool none = t->own[0] > t->own[1] && t->has_non_finite;
    if (!place_payload(leaf, x, i, begins, &t->stored))
        return false;
    t->outside = t->checksum != 0;
    if (naive_leaf_is_bare(leaf, t))
        return (t->own[0] == INFINITY && t->own[1] == -INFINITY && !t->has_non_finite &&
                t->stored.size == 0) ||
               wrong(leaf, "treelet %ld, of a level without samples", i);
    if (leaf->outside && t->level == 0 && t->stored.size > 0)
        return wrong(leaf, "treelet %ld has bytes", i);
    if (t->stored.size == 0)
        return one || none || t->outside || wrong(leaf, "treelet %ld: a payload of no bytes", i);
    return leaf->codec == 1 || t->stored.size == t->payload_size ||
           wrong(leaf, "treelet %ld: size", i);
}

/* A family's treelets, then its shell. */
static bool place_family(naive_leaf *leaf, placing *x, const naive_family_place *f) {
    const long n = leaf->treelet_count, p = f->parent;
    bool bytes = false;
    long next = f->first;
    for (; next < n * leaf->sets && leaf->treelets[next].parent == p; next++) {
        if (!place_treelet(leaf, x, next, next == f->first))
            return false;
        bytes = bytes || leaf->treelets[next].stored.size > 0;
        if (p < 0)
            return true;
    }
    if (leaf->codec == 0)
        return true;
    const long shell = n * leaf->sets + p / n * leaf->shell_count + p % n;
    naive_treelet *parent = &leaf->treelets[p];
    return place_payload(leaf, x, shell, false, &parent->shell) &&
           ((parent->shell.size > 0) == (bytes && next - f->first > 1) ||
            wrong(leaf, "the shell below treelet %ld: bytes or none", p));
}

static bool place_all(naive_leaf *leaf, placing *x) {
    const long n = leaf->treelet_count;
    naive_family_place *families = malloc((size_t)n * sizeof *families);
    bool good = families || wrong(leaf, "no memory");
    for (long root = 0; good && root < n * leaf->sets; root += n) {
        const long count = naive_order_families(leaf, root, families);
        for (long i = 0; good && i < count; i++)
            good = place_family(leaf, x, &families[i]);
    }
    free(families);
    return good;
}

bool naive_places_read(naive_leaf *leaf) {
    placing x = {.end = leaf->sections.payloads};
    if (!place_all(leaf, &x))
        return false;
    if (x.stored != naive_number(leaf->bytes + 88, 8))
        return wrong(leaf, "payload_bytes");
    return naive_sections_hold(&leaf->sections, leaf->bytes, leaf->size, x.end) == leaf->size ||
           wrong(leaf, "the end of the file");
}
