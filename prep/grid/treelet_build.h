/* treelet_build.h - makes one treelet's payload from its level's samples: samples with halo, codes
 * of the min/max tree, own range (FORMAT.md 4).
 *
 * This and grid_codes.h are the converter's hot loop.
 */
#ifndef PREP_GRID_TREELET_BUILD_H
#define PREP_GRID_TREELET_BUILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/leaf/grid_codes.h"
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

/* treelet_build_quiet() - returns whether the box's maps show that all samples of a treelet, halo
 * included, are the quiet value. Then there is nothing to build: its payload is implied
 * (formats/leaf/implied_payload.h). */
bool treelet_build_quiet(const leaf_layout *l, uint32_t t, const sample_box *box);

/* treelet_build() - fill payload (leaf_layout_payload(t).bytes, 64-byte aligned) and *summary. box
 * must hold the treelet's samples and halo as far as the level has them. Beyond, indices are
 * clamped.
 * treelet_build_shell() - fill the samples that the children of a treelet share
 * (grid_family_parts()), leaf_layout_shell_max() at most. box: likewise, of the family. */
void treelet_build(const leaf_layout *l, uint32_t t, const sample_box *box,
                   grid_codes_scratch *scratch, void *payload, grid_summary *summary);
void treelet_build_shell(const leaf_layout *l, uint32_t parent, const sample_box *box,
                         void *samples);

#endif
