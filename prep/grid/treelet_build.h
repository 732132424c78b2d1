/* treelet_build.h - makes one treelet's payload from its level's samples: samples with halo, codes
 * of the min/max tree, own range (FORMAT.md 4).
 *
 * This is the converter's hot loop: it reads each sample once, vectorises along x, and does not
 * allocate.
 */
#ifndef PREP_GRID_TREELET_BUILD_H
#define PREP_GRID_TREELET_BUILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/leaf/leaf_layout.h"

/* A box of a level's samples in memory; positions are nodes of the level. */
typedef struct sample_box {
    uint32_t origin[3];
    uint32_t size[3];
    size_t row_bytes; /* bytes from one row of a slice to the next */
    const char *const
        *slices; /* size[2] pointers, each to its slice's sample (origin x, origin y) */
    const uint8_t *const *busy; /* maps of the whole slices (slice_tiles.h); NULL: not known */
} sample_box;

/* Per-thread memory, treelet_scratch_bytes() of it. */
typedef struct treelet_scratch treelet_scratch;
size_t treelet_scratch_bytes(void);

/* A treelet's data for the directory. */
typedef struct treelet_summary {
    float own[2]; /* +inf, -inf if no sample is finite; never -0 */
    uint8_t flags;
} treelet_summary;

/* treelet_build_quiet() - returns whether the box's maps show that all samples of a treelet, halo
 * included, are the quiet value. Then there is nothing to build: its payload is implied
 * (formats/leaf/implied_payload.h). */
bool treelet_build_quiet(const leaf_layout *l, uint32_t t, const sample_box *box);

/* treelet_build() - fill payload (leaf_layout_payload(t).bytes, 64-byte aligned) and *summary. box
 * must hold the treelet's samples and halo as far as the level has them. Beyond, indices are
 * clamped.
 */
void treelet_build(const leaf_layout *l, uint32_t t, const sample_box *box,
                   treelet_scratch *scratch, void *payload, treelet_summary *summary);

#endif
