/* naive_leaf.h - a second reader of treelet files, written from formats/FORMAT.md alone: slow,
 * whole, and strict.
 *
 * Holds the file and all levels in memory and recomputes whatever the format says about every byte:
 * padding, offsets, checksums, ranges, codes, halos, overlaps, compressed boxes; of all sets. The
 * samples that are left are those of one.
 */
#ifndef TESTS_SUPPORT_NAIVE_LEAF_H
#define TESTS_SUPPORT_NAIVE_LEAF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tests/support/naive_sections.h"

enum { NAIVE_LEVELS_MAX = 24, NAIVE_WHY_MAX = 256 };

typedef struct naive_level {
    long cells[3], nodes[3];
    long treelets[3]; /* per axis */
    float *samples;   /* all nodes, x fastest */
    bool *known;      /* nodes that some treelet holds: all, when loaded */
} naive_level;

/* A payload in the file. */
typedef struct naive_stored {
    uint64_t offset, size;           /* 0 bytes: implied, or outside */
    const unsigned char *at;         /* where it is in memory */
    const struct naive_stored *base; /* it has the differences to that; NULL: to none */
} naive_stored;

typedef struct naive_treelet {
    int level;
    long at[3]; /* its position among its level's treelets */
    long cells[3];
    long parent; /* of the same set; -1: the root */
    float own[2], merged[2];
    bool has_non_finite;
    naive_stored stored;
    bool outside; /* its samples lie in another file, with this checksum */
    uint64_t checksum;
    naive_stored shell;    /* compressed, above level 0: what its children share */
    uint64_t payload_size; /* raw */
} naive_treelet;

typedef struct naive_leaf {
    int version;
    int sample_type,
        source_type; /* 1 u8 2 i8 3 u16 4 i16 5 f32 6 u32 7 i32 8 f64 9 f16 10 u64 11 i64 */
    long dims[3];
    int levels, cells_log2, halo, run_align_log2, codec;
    bool rectilinear, outside, bare;
    bool heights;   /* HEIGHTS.md */
    bool in_slices; /* each slice outside in a file of its own */
    long outside_chunks;
    double value_min, value_max, rounding_error, to_world[3][4];
    uint64_t non_finite;
    char name[64], provenance[1024];
    double *axis[3];
    long fields, steps, sets;
    char (*field_names)[64]; /* NULL: untold */
    double *times;           /* likewise */
    naive_level level[NAIVE_LEVELS_MAX];
    naive_treelet *treelets; /* of all sets, one after the other */
    long treelet_count;      /* of one */
    long shell_count;        /* of one, compressed: of treelets above level 0 */
    unsigned char *other;    /* samples of level 0 in another file, or NULL */
    unsigned char *bytes;    /* the file, or this segment of it */
    size_t size;
    const struct naive_leaf *before; /* the segments before this one, */
    long segments_before;            /* and how many; 0: it is a file, or the first one */
    naive_sections sections;
    char why[NAIVE_WHY_MAX]; /* what is wrong with it */
} naive_leaf;

/* naive_leaf_load() - read and check everything; false: leaf->why says what is wrong. Release it
 * either way. */
bool naive_leaf_load(naive_leaf *leaf, const char *path);

/* naive_leaf_load_set() - the same; the samples are those of this set, which the test knows to be
 * there. */
bool naive_leaf_load_set(naive_leaf *leaf, const char *path, long set);
void naive_leaf_release(naive_leaf *leaf);

/* naive_leaf_read() - the same of a segment whose bytes are there, and what is before it; all else
 * is zeros. path: of the whole file. */
bool naive_leaf_read(naive_leaf *leaf, const char *path, long set);

/* naive_leaf_is_bare() - whether a treelet has no samples, nor have the nodes of its level. */
static inline bool naive_leaf_is_bare(const naive_leaf *leaf, const naive_treelet *t) {
    return leaf->bare && t->level > 0;
}

/* naive_leaf_sample() - of a node of a level. */
float naive_leaf_sample(const naive_leaf *leaf, int level, long i, long j, long k);

#endif
