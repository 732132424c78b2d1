/* treelet_build.h - one treelet's payload from the samples of its level: samples with halo, codes
 * of the min/max tree, own range (FORMAT.md 4).
 *
 * The converter's hot loop: reads each sample once, vectorises along x, allocates nothing.
 */
#ifndef PREP_GRID_TREELET_BUILD_H
#define PREP_GRID_TREELET_BUILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/leaf/leaf_layout.h"

/* A box of a level's samples as it lies in memory; positions are nodes of the level. */
typedef struct sample_box {
    uint32_t origin[3];
    uint32_t size[3];
    size_t row_bytes; /* from one row to the next of a slice */
    const char *const
        *slices; /* size[2] pointers, each to the slice's sample (origin x, origin y) */
    const uint8_t *const
        *busy; /* maps of the slices (slice_tiles.h), whole ones; NULL: not known */
} sample_box;

/* Per-thread memory, treelet_scratch_bytes() of it. */
typedef struct treelet_scratch treelet_scratch;
size_t treelet_scratch_bytes(void);

/* What the directory holds of a treelet. */
typedef struct treelet_summary {
    float own[2]; /* +inf, -inf without a finite sample; never -0 */
    uint8_t flags;
} treelet_summary;

/* treelet_build_quiet() - whether the box's maps tell that all samples of a treelet, halo included,
 * are the quiet value. Then there is nothing to be built: its payload is implied
 * (formats/leaf/implied_payload.h). */
bool treelet_build_quiet(const leaf_layout *l, uint32_t t, const sample_box *box);

/* treelet_build() - fill payload (leaf_layout_payload(t).bytes, 64-byte aligned) and *summary.
 * box must hold the treelet's samples and halo as far as the level has them; the rest is clamped.
 */
void treelet_build(const leaf_layout *l, uint32_t t, const sample_box *box,
                   treelet_scratch *scratch, void *payload, treelet_summary *summary);

#endif
