/* leaf_layout.h - the geometry of a treelet file: all that follows from dims, B, h and the sample
 * type alone, or, for a mesh, from its COUNTS.
 *
 * The file stores nothing of this; writer, reader and renderer derive it here. A mesh looks like a
 * grid of one level: treelets without parents or children, all at place 0, 0, 0.
 */
#ifndef FORMATS_LEAF_LEAF_LAYOUT_H
#define FORMATS_LEAF_LEAF_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf.h"

#define LEAF_NO_TREELET UINT32_MAX /* no child; no treelet has this index */

typedef struct leaf_level {
    uint32_t dims[3];     /* nodes */
    uint32_t cells[3];    /* dims - 1 */
    uint32_t treelets[3]; /* per axis */
    uint32_t first;       /* index of its first treelet */
    uint32_t count;
} leaf_level;

typedef struct leaf_layout {
    const struct leaf_geometry *geometry;
    uint32_t cells_log2, halo, levels; /* cells_log2 is 0 of all kinds but grids */
    uint32_t sampled;                  /* levels from 0 on that have samples: 1, or all */
    sample_type type;
    uint32_t treelets; /* in all levels */
    uint32_t payloads; /* grid: (treelets + shells) * sets; mesh: treelets * blocks */
    uint32_t shells;   /* grid, compressed: treelets above level 0, a shell below each; else 0 */
    uint32_t sets;     /* fields * steps */
    uint32_t steps;
    uint32_t places;             /* of cells: 1 where they stay at all steps, else one a step */
    uint32_t gradient_sets;      /* mesh: sets, or 0 where there are no gradients */
    const uint32_t (*counts)[4]; /* section COUNTS, or NULL; owned by the file or the writer */
    uint32_t payload_max;        /* leaf_layout_payload_max() */
    bool coded;                  /* grid: payloads are compressed (grid_coding.h) */
    bool outside;                /* grid: level 0 has its samples in another file */
    uint32_t beside;             /* payloads keep others beside: leaf_layout_keep_beside() or
                                    leaf_layout_keep_blocks(); 0: they do not */
    leaf_level level[LEAF_LEVELS_MAX];
    /* Per treelet: */
    uint32_t *first_child; /* LEAF_NO_TREELET at level 0 */
    uint32_t (*place)[3];  /* position in its level's treelet grid */
    uint8_t *level_of;
    mem *m;
} leaf_layout;

/* leaf_layout_levels() - compute the levels of a grid: level[].dims/cells/treelets/first/count and
 * totals, without allocating. cells_log2 and halo must be possible ones (else a caller's bug). dims
 * are checked: ST_UNSUPPORTED for less than 2 or more than GRID_DIM_MAX samples on an axis, and if
 * more than 2^32 - 2 treelets or LEAF_LEVELS_MAX levels were needed. */
CHECKED status leaf_layout_levels(leaf_layout *l, const uint32_t dims[3], uint32_t cells_log2,
                                  uint32_t halo, sample_type type);

/* leaf_layout_init() - the same, and make the per-treelet arrays. Of both, all levels have samples;
 * leaf_layout_bare() - only level 0 has. */
CHECKED status leaf_layout_init(leaf_layout *l, mem *m, const uint32_t dims[3], uint32_t cells_log2,
                                uint32_t halo, sample_type type);
static inline void leaf_layout_bare(leaf_layout *l) {
    l->sampled = 1;
}
void leaf_layout_release(leaf_layout *l);

/* leaf_layout_keep_beside() - let a grid's payloads in memory have room for two payloads with
 * samples of `bytes` bytes, too (leaf_between.h). */
void leaf_layout_keep_beside(leaf_layout *l, uint32_t bytes);

/* leaf_layout_keep_blocks() - let payloads of a kind with blocks, but topologies, have room for two
 * others of their block. Call it before counts are set. */
static inline void leaf_layout_keep_blocks(leaf_layout *l) {
    l->beside = 1;
}

/* leaf_layout_repeat() - give a grid's layout so many fields and steps, with payloads set after
 * set, and the shells of all sets behind them if it is compressed. False: that makes 2^32 - 1
 * payloads or more. */
bool leaf_layout_repeat(leaf_layout *l, uint32_t fields, uint32_t steps, bool compressed);

/* leaf_layout_flat() - the layout of a kind without levels, without allocating: treelets have no
 * parents or children, all at place 0, 0, 0. The caller sets counts and payload_max if the kind's
 * functions use them.
 * leaf_layout_init_flat() - make the per-treelet arrays of such a layout. */
void leaf_layout_flat(leaf_layout *l, const struct leaf_geometry *geometry, uint32_t treelets,
                      uint32_t payloads);
CHECKED status leaf_layout_init_flat(leaf_layout *l, mem *m);

/* leaf_layout_blocks() - likewise, of a kind with a block of topologies (or of the first step's
 * places), one of values for each set, and where cells move one of positions for each step behind
 * the first. False: that makes 2^32 - 1 payloads or more. leaf_layout_block_count() - how many it
 * makes. leaf_layout_block_series() - the series of a payload in such blocks, gradients among them.
 * leaf_layout_block_repeat(), leaf_layout_block_rows() - of a kind without gradients:
 * leaf_growth.repeat and .rows.
 */
bool leaf_layout_blocks(leaf_layout *l, const struct leaf_geometry *geometry, uint64_t treelets,
                        uint32_t fields, uint32_t steps, bool moving);
uint64_t leaf_layout_block_count(uint64_t treelets, uint32_t fields, uint32_t steps, bool moving);
bool leaf_layout_block_repeat(leaf_layout *l, uint32_t steps);
struct leaf_row;
int leaf_layout_block_rows(const leaf_layout *l, struct leaf_row *rows);

/* leaf_layout_find() - the treelet at a place of a level. Descends from the root: O(levels). */
uint32_t leaf_layout_find(const leaf_layout *l, uint32_t level, const uint32_t place[3]);

/* leaf_layout_parent() - the treelet above one that is not the root. O(levels). */
uint32_t leaf_layout_parent(const leaf_layout *l, uint32_t treelet);

/* leaf_layout_children() - which octants of a treelet exist, as a bit mask (bit x + 2y + 4z); 0 at
 * level 0. The child in octant o is first_child[t] + number of existing octants below o. */
uint8_t leaf_layout_children(const leaf_layout *l, uint32_t treelet);

/* In a layout that keeps two payloads beside each one in memory (leaf_between.h): byte offsets in
 * it of the room for them, which begins with LEAF_ALIGN bytes and scratch memory, and of the two,
 * which end it; bytes of each of the two. Else zeros. */
typedef struct leaf_beside {
    uint32_t at, parts_at, each;
} leaf_beside;

/* LEAF_BESIDE_SCRATCH() - the scratch memory of grids' treelets with so many levels of nodes: for
 * grid_codes.h. */
#define LEAF_BESIDE_SCRATCH(node_levels) (960U + (8U << 3 * (node_levels)))

/* leaf_layout_beside() - behind a payload of so many bytes. leaf_layout_beside_end() - where that
 * ends. */
static inline leaf_beside leaf_layout_beside(uint32_t bytes, size_t scratch, uint32_t each) {
    return (leaf_beside){bytes, bytes + LEAF_ALIGN + leaf_aligned((uint32_t)scratch), each};
}
static inline uint32_t leaf_layout_beside_end(const leaf_beside *b) {
    return b->parts_at + 2 * b->each;
}

/* Sizes of one treelet's payload, before compression. */
typedef struct leaf_payload {
    uint32_t cells[3];    /* real cells, 1 .. B */
    uint32_t samples[3];  /* cells + 1 + 2 halo: the sample array, x fastest */
    uint32_t node_levels; /* K = cells_log2 - LEAF_BLOCK_LOG2: tree levels of 8, 64, .. 8^K nodes */
    uint32_t samples_at;  /* byte offset of the sample array */
    uint32_t bytes;       /* whole payload, a multiple of LEAF_ALIGN */
    leaf_beside beside;
} leaf_payload;

/* leaf_node_levels() - the levels of nodes of a grid's treelets. */
static inline uint32_t leaf_node_levels(const leaf_layout *l) {
    return l->cells_log2 - LEAF_BLOCK_LOG2;
}

leaf_payload leaf_layout_payload(const leaf_layout *l, uint32_t treelet);

/* leaf_payload_sample_bytes() - the bytes of its samples, of this type. */
static inline size_t leaf_payload_sample_bytes(const leaf_payload *p, sample_type type) {
    return (size_t)p->samples[0] * p->samples[1] * p->samples[2] * sample_size(type);
}

/* leaf_layout_samples() - the payload of a grid's treelet in a set; also its element of RANGES, OWN
 * and FLAGS. */
static inline uint32_t leaf_layout_samples(const leaf_layout *l, uint32_t set, uint32_t treelet) {
    return l->treelets * set + treelet;
}

/* leaf_layout_shell() - the payload that holds what the children of a treelet share
 * (grid_family.h); treelet < shells. leaf_layout_is_shell() - whether payload p is one; *set,
 * *parent: of which treelet's children. */
static inline uint32_t leaf_layout_shell(const leaf_layout *l, uint32_t set, uint32_t treelet) {
    return l->sets * l->treelets + set * l->shells + treelet;
}
static inline bool leaf_layout_is_shell(const leaf_layout *l, uint32_t p, uint32_t *set,
                                        uint32_t *parent) {
    if (!l->shells || p < l->sets * l->treelets)
        return false;
    *set = (p - l->sets * l->treelets) / l->shells;
    *parent = (p - l->sets * l->treelets) % l->shells;
    return true;
}

/* leaf_layout_is_outside() - whether payload p is a treelet's whose samples lie in another file, or
 * implied. */
static inline bool leaf_layout_is_outside(const leaf_layout *l, uint32_t p) {
    return l->outside && p < l->sets * l->treelets && l->level_of[p % l->treelets] == 0;
}

/* leaf_layout_is_bare() - whether a treelet has no samples, as its level has none. Its own range is
 * empty then, and it has neither flags nor a payload. */
static inline bool leaf_layout_is_bare(const leaf_layout *l, uint32_t treelet) {
    return l->level_of[treelet] >= l->sampled;
}

/* leaf_layout_own_samples() - how many samples of a treelet no sibling has.
 * leaf_layout_shell_samples() - how many the children of a treelet share (grid_family.h).
 * leaf_layout_shell_max() - at most so many are in any shell.
 * leaf_layout_code_max() - at most so many are coded by one compressed payload. */
size_t leaf_layout_own_samples(const leaf_layout *l, uint32_t treelet);
size_t leaf_layout_shell_samples(const leaf_layout *l, uint32_t parent);
size_t leaf_layout_shell_max(const leaf_layout *l);
size_t leaf_layout_code_max(const leaf_layout *l);

/* leaf_layout_payload_bytes() - bytes of payload p before compression. p counts as in the
 * directory: a grid's treelets set after set, then its shells; a mesh's blocks of topologies,
 * values, gradients, positions. */
uint32_t leaf_layout_payload_bytes(const leaf_layout *l, uint32_t p);

/* leaf_layout_payload_max() - the most bytes of a treelet's payload (mesh: of a block's). Shells
 * may have more: leaf_layout_shell_max() samples. */
uint32_t leaf_layout_payload_max(const leaf_layout *l);

/* leaf_layout_stored() - the most bytes that payload p takes in a file.
 * leaf_layout_stored_max() - an upper bound of that for all payloads. */
uint32_t leaf_layout_stored(const leaf_layout *l, uint32_t p);
uint32_t leaf_layout_stored_max(const leaf_layout *l);

/* ---- Sets, steps and places ----
 *
 * A set is the values of a field at a step: set = field * steps + step. Where cells are (vertices,
 * boxes of treelets) is the same in all sets; or, in a volume that moves, in all sets of a step.
 * What changes with a step, besides values, is asked here. */

/* leaf_layout_set() - the set of a field at a step. leaf_layout_step() - the step of a set. */
static inline uint32_t leaf_layout_set(const leaf_layout *l, uint32_t of_field, uint32_t step) {
    return of_field * l->steps + step;
}
static inline uint32_t leaf_layout_step(const leaf_layout *l, uint32_t set) {
    return set % l->steps;
}

/* leaf_layout_series() - the payloads that hold the same thing in each set (a mesh's positions: at
 * each step): of which p is number `at`. Number i is payload first + i * stride. */
typedef struct leaf_series {
    uint32_t first, stride, at;
} leaf_series;
/* leaf_series_of() - of payload p, where each of them is in a block of `stride` from payload
 * `block` on. */
static inline leaf_series leaf_series_of(uint32_t p, uint32_t block, uint32_t stride) {
    return (leaf_series){block + (p - block) % stride, stride, (p - block) / stride};
}
leaf_series leaf_layout_series(const leaf_layout *l, uint32_t p);
leaf_series leaf_layout_block_series(const leaf_layout *l, uint32_t p);
static inline uint32_t leaf_series_payload(const leaf_series *s, uint32_t i) {
    return s->first + i * s->stride;
}

/* Payloads may lead to others of earlier sets, in their series (FORMAT.md 14): per payload 0, or 1
 * + the number of the one that has the same bytes, or that it has the differences to. NULL: all 0.
 */
typedef struct leaf_links {
    const uint32_t *same, *bases;
} leaf_links;

/* leaf_layout_home() - the payload whose bytes p has: itself, or an earlier set's.
 * leaf_layout_chain() - the payloads whose codes are needed for p's samples: its home, the home's
 * base, that one's, .., up to a whole code. Returns how many, 1 to LEAF_CHAIN_MAX.
 *
 * Links must be sound, as leaf_check_directory() finds them. */
uint32_t leaf_layout_home(const leaf_layout *l, const leaf_links *links, uint32_t p);
int leaf_layout_chain(const leaf_layout *l, const leaf_links *links, uint32_t p,
                      uint32_t chain[LEAF_CHAIN_MAX]);

/* leaf_layout_moves() - returns whether cells change their places from step to step.
 * leaf_layout_place() - returns which of the `places` the cells have at a step; 0: the one of step
 * 0. */
static inline bool leaf_layout_moves(const leaf_layout *l) {
    return l->places > 1;
}
static inline uint32_t leaf_layout_place(const leaf_layout *l, uint32_t step) {
    return leaf_layout_moves(l) ? step : 0;
}

/* leaf_layout_values() - the payload that holds the values of a mesh's treelet in a set.
 * leaf_layout_gradients() - the payload of its gradients in a set, below gradient_sets.
 * leaf_layout_positions() - the payload of its positions at a step from 1 up to places - 1.
 * Positions of step 0, and of every step where nothing moves, are in the topology. */
static inline uint32_t leaf_layout_values(const leaf_layout *l, uint32_t set, uint32_t treelet) {
    return l->treelets * (1 + set) + treelet;
}
static inline uint32_t leaf_layout_gradients(const leaf_layout *l, uint32_t set, uint32_t treelet) {
    return l->treelets * (1 + l->sets + set) + treelet;
}
static inline uint32_t leaf_layout_positions(const leaf_layout *l, uint32_t step,
                                             uint32_t treelet) {
    return l->treelets * (l->sets + l->gradient_sets + step) + treelet;
}

/* leaf_layout_bounds() - the element of BOUNDS for a treelet at a step. */
static inline size_t leaf_layout_bounds(const leaf_layout *l, uint32_t step, uint32_t treelet) {
    return (size_t)leaf_layout_place(l, step) * l->treelets + treelet;
}

/* What a mesh's payload holds. leaf_layout_block_of() - the block of payload p; *index: its set
 * (values, gradients) or step (positions). */
typedef enum leaf_block {
    LEAF_BLOCK_TOPOLOGY,
    LEAF_BLOCK_VALUES,
    LEAF_BLOCK_GRADIENTS,
    LEAF_BLOCK_POSITIONS
} leaf_block;
leaf_block leaf_layout_block_of(const leaf_layout *l, uint32_t p, uint32_t *index);

/* leaf_layout_set_counts() - set COUNTS, or what a kind has in their place, which sizes of payloads
 * in blocks follow from. They must be sound, and outlive l. */
void leaf_layout_set_counts(leaf_layout *l, const uint32_t (*counts)[4]);

/* leaf_layout_block_beside() - where a payload of such a block, which has so many bytes in a file,
 * has those of two steps in memory; zeros: nothing is made of it, as of topologies, which are the
 * same in all sets. leaf_layout_block_bytes() - its bytes in memory. */
leaf_beside leaf_layout_block_beside(const leaf_layout *l, leaf_block block, uint32_t bytes,
                                     size_t scratch);
static inline uint32_t leaf_layout_block_bytes(const leaf_beside *b, uint32_t bytes) {
    return b->at ? leaf_layout_beside_end(b) : bytes;
}

/* leaf_layout_payload_name() - for messages: "treelet 5's payload", "treelet 5's values of set 2".
 * Returns text. */
enum { LEAF_NAME_MAX = 64 };
const char *leaf_layout_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]);

/* leaf_layout_aligned() - the first multiple of 2^log2 at or behind `at`. */
static inline uint64_t leaf_layout_aligned(uint64_t at, uint32_t log2) {
    uint64_t mask = ((uint64_t)1 << log2) - 1;
    return (at + mask) & ~mask;
}

/* leaf_layout_begins_run() - whether payload p is the first of a run. */
bool leaf_layout_begins_run(const leaf_layout *l, uint32_t p);

/* Offset of the codes of tree level k (1 .. K) in the payload: lo[8^k], then hi[8^k]. */
static inline uint32_t leaf_codes_at(uint32_t k) {
    /* 2 * (8 + 64 + ... + 8^(k-1)) */
    return 2u * (((1u << (3 * k)) - 8u) / 7u);
}

#endif
