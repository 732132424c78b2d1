#include "tests/support/naive_family.h"

#include <stdlib.h>
#include <string.h>

#include "tests/support/naive_box.h"
#include "tests/support/naive_bytes.h"

enum { SHELL_BOXES_MAX = 7 };

typedef struct box {
    long at[3], size[3];
} box;

/* A family's samples, counted from the first one of its first treelet. */
typedef struct family {
    const naive_leaf *leaf;
    long side, overlap; /* B; samples that two neighbours share */
    long size[3];
    bool two[3]; /* two treelets on the axis */
    size_t width;
    unsigned char *samples;
    bool *known;
} family;

/* ---- its boxes ---- */

/* What an axis has: all samples, the shared ones, those of a segment. */
enum { ALL = -2, SHARED = -1 };

static void cut(const family *f, box *b, int a, long what) {
    const long shared_end = f->side + f->overlap;
    b->at[a] = what == SHARED ? f->side : what == 1 ? shared_end : 0;
    b->size[a] = what == SHARED              ? f->overlap
                 : what == ALL || !f->two[a] ? f->size[a]
                 : what == 1                 ? f->size[a] - shared_end
                                             : f->side;
}

static box box_of(const family *f, long x, long y, long z) {
    box b;
    cut(f, &b, 0, x);
    cut(f, &b, 1, y);
    cut(f, &b, 2, z);
    return b;
}

static int shell_of(const family *f, box boxes[SHELL_BOXES_MAX]) {
    int count = 0;
    if (f->two[2])
        boxes[count++] = box_of(f, ALL, ALL, SHARED);
    for (long z = 0; z < (f->two[2] ? 2 : 1); z++) {
        if (f->two[1])
            boxes[count++] = box_of(f, ALL, SHARED, z);
        for (long y = 0; y < (f->two[1] ? 2 : 1) && f->two[0]; y++)
            boxes[count++] = box_of(f, SHARED, y, z);
    }
    return count;
}

static uint64_t volume(const box *b) {
    return (uint64_t)(b->size[0] * b->size[1] * b->size[2]);
}

/* The axes of a box in the order of its samples, the fastest first. */
static void order_of(const box *b, bool shell, int axes[3]) {
    const int first = shell && b->size[0] < b->size[1] ? 1 : 0;
    for (int n = 0; n < 3; n++)
        axes[n] = (first + n) % 3;
}

/* ---- putting samples where they belong ---- */

static size_t index_of(const family *f, const long i[3]) {
    return (size_t)(i[0] + f->size[0] * (i[1] + f->size[1] * i[2]));
}

/* step: bytes from one sample to the next; 0: all are the same. */
static const char *put_box(family *f, const box *b, const int axes[3], const unsigned char *from,
                           size_t step) {
    long n[3], i[3];
    for (n[2] = 0; n[2] < b->size[axes[2]]; n[2]++)
        for (n[1] = 0; n[1] < b->size[axes[1]]; n[1]++)
            for (n[0] = 0; n[0] < b->size[axes[0]]; n[0]++, from += step) {
                for (int a = 0; a < 3; a++)
                    i[axes[a]] = b->at[axes[a]] + n[a];
                const size_t at = index_of(f, i);
                if (f->known[at])
                    return "a sample of a family is in two boxes";
                f->known[at] = true;
                memcpy(f->samples + at * f->width, from, f->width);
            }
    return NULL;
}

/* The samples of boxes, after those that they have the differences to. out: one box after the
 * other. bytes: of all. */
static const char *decode_code(const family *f, const long (*sizes)[3], int count, uint64_t bytes,
                               const naive_stored *stored, unsigned char *out) {
    unsigned char *earlier = stored->base ? malloc(bytes + 1) : NULL;
    const char *why = NULL;
    if (stored->base)
        why = earlier ? decode_code(f, sizes, count, bytes, stored->base, earlier) : "no memory";
    if (!why)
        why = naive_boxes_decode(f->leaf->sample_type, sizes, count, stored->at, stored->size,
                                 earlier, out);
    free(earlier);
    return why;
}

static const char *decode_boxes(family *f, const box *boxes, int count, bool shell,
                                const naive_stored *stored) {
    long sizes[SHELL_BOXES_MAX][3];
    int axes[SHELL_BOXES_MAX][3];
    uint64_t samples = 0;
    for (int b = 0; b < count; b++) {
        order_of(&boxes[b], shell, axes[b]);
        for (int n = 0; n < 3; n++)
            sizes[b][n] = boxes[b].size[axes[b][n]];
        samples += volume(&boxes[b]);
    }
    unsigned char *bytes = malloc(samples * f->width), *from = bytes;
    const char *why =
        bytes ? decode_code(f, (const long(*)[3])sizes, count, samples * f->width, stored, bytes)
              : "no memory";
    for (int b = 0; !why && b < count; b++) {
        why = put_box(f, &boxes[b], axes[b], from, f->width);
        from += volume(&boxes[b]) * f->width;
    }
    free(bytes);
    return why;
}

void naive_family_value(const naive_leaf *leaf, const naive_treelet *t, unsigned char bytes[4]) {
    const float value = t->own[0];
    uint32_t bits = 0x7fc00000;
    if (leaf->sample_type != 5)
        bits = (uint32_t)(int32_t)value;
    else if (t->own[0] <= t->own[1])
        memcpy(&bits, &value, sizeof bits);
    for (int b = 0; b < 4; b++)
        bytes[b] = (unsigned char)(bits >> (8 * b));
}

bool naive_family_is_value(const naive_leaf *leaf, const naive_treelet *t,
                           const unsigned char *bytes, uint64_t count) {
    const size_t width = (size_t)naive_sample_bytes(leaf->sample_type);
    for (uint64_t i = 1; i < count; i++)
        if (memcmp(bytes, bytes + i * width, width) != 0)
            return false;
    const float value = naive_sample(bytes, leaf->sample_type, 0);
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return t->has_non_finite ? bits == 0x7fc00000 : bits != 0x80000000;
}

/* Of a treelet: its own box, and no more. */
static const char *read_own(family *f, const naive_treelet *t) {
    const long *at = t->at;
    const box own = box_of(f, at[0] % 2, at[1] % 2, at[2] % 2);
    unsigned char value[4];
    int axes[3];
    if (t->stored.size)
        return decode_boxes(f, &own, 1, false, &t->stored);
    naive_family_value(f->leaf, t, value);
    order_of(&own, false, axes);
    return put_box(f, &own, axes, value, 0);
}

/* ---- families ---- */

static bool make_family(family *f, const naive_leaf *leaf, const naive_treelet *t, long count) {
    *f = (family){.leaf = leaf,
                  .side = 1L << leaf->cells_log2,
                  .overlap = 1 + 2 * leaf->halo,
                  .width = (size_t)naive_sample_bytes(leaf->sample_type)};
    /* The last one is the farthest on each axis that has two. */
    const naive_treelet *last = t + count - 1;
    for (int a = 0; a < 3; a++) {
        f->two[a] = last->at[a] != t->at[a];
        f->size[a] = (f->two[a] ? f->side : 0) + last->cells[a] + f->overlap;
    }
    const size_t samples = (size_t)(f->size[0] * f->size[1] * f->size[2]);
    f->samples = malloc(samples * f->width);
    f->known = calloc(samples, sizeof f->known[0]);
    return f->samples && f->known;
}

/* The window of a treelet. */
static const char *take(const family *f, const naive_treelet *t, unsigned char **held) {
    long size[3], n[3], i[3];
    for (int a = 0; a < 3; a++)
        size[a] = t->cells[a] + f->overlap;
    unsigned char *to = *held = malloc((size_t)(size[0] * size[1] * size[2]) * f->width);
    if (!to)
        return "no memory";
    for (n[2] = 0; n[2] < size[2]; n[2]++)
        for (n[1] = 0; n[1] < size[1]; n[1]++)
            for (n[0] = 0; n[0] < size[0]; n[0]++, to += f->width) {
                for (int a = 0; a < 3; a++)
                    i[a] = f->side * (t->at[a] % 2) + n[a];
                if (!f->known[index_of(f, i)])
                    return "a sample of a family is in no box";
                memcpy(to, f->samples + index_of(f, i) * f->width, f->width);
            }
    return NULL;
}

/* What is shared is implied, too, if all treelets are: they overlap, so they have the same value.
 */
static const char *imply_shell(family *f, const box *boxes, int count, const naive_treelet *t) {
    const char *why = NULL;
    unsigned char value[4];
    int axes[3];
    naive_family_value(f->leaf, t, value);
    for (int b = 0; !why && b < count; b++) {
        order_of(&boxes[b], true, axes);
        why = put_box(f, &boxes[b], axes, value, 0);
    }
    return why;
}

/* A treelet without bytes has one value in its part of the shell, too. */
static const char *check_implied(const family *f, const naive_treelet *t,
                                 const unsigned char *held) {
    unsigned char value[4];
    naive_family_value(f->leaf, t, value);
    long samples = 1;
    for (int a = 0; a < 3; a++)
        samples *= t->cells[a] + f->overlap;
    for (long n = 0; n < samples; n++)
        if (memcmp(held + (size_t)n * f->width, value, f->width) != 0)
            return "a payload without bytes, and a shell that says otherwise";
    return NULL;
}

const char *naive_family_read(const naive_leaf *leaf, long parent, long first, long count,
                              unsigned char **held) {
    const naive_treelet *t = &leaf->treelets[first];
    const naive_stored *shell = parent < 0 ? NULL : &leaf->treelets[parent].shell;
    family f;
    box boxes[SHELL_BOXES_MAX];
    const char *why = make_family(&f, leaf, t, count) ? NULL : "no memory";
    const int shells = why ? 0 : shell_of(&f, boxes);
    if (shells)
        why = shell->size ? decode_boxes(&f, boxes, shells, true, shell)
                          : imply_shell(&f, boxes, shells, t);
    for (long i = 0; !why && i < count; i++)
        why = read_own(&f, t + i);
    for (long i = 0; !why && i < count; i++) {
        why = take(&f, t + i, &held[i]);
        if (!why && !t[i].stored.size)
            why = check_implied(&f, t + i, held[i]);
    }
    free(f.samples);
    free(f.known);
    return why;
}
