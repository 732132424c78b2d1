/* dicom_order.h - the slices of a series in order, and where their grid lies.
 *
 * Along the normal of their planes: across x down. Distances come from positions alone. Positions
 * may be off by a hundredth of the distance, as they are rounded in files. Where no slice has a
 * position, they are ordered by number.
 */
#ifndef PREP_IMPORT_DICOM_DICOM_ORDER_H
#define PREP_IMPORT_DICOM_DICOM_ORDER_H

#include "formats/grid/grid.h"
#include "prep/import/dicom/dicom_series.h"

/* dicom_order() - slices of one series, count of them, sorted; those of other time steps are
 * dropped. All positions having the same number of slices, these are time steps, in the order of
 * their numbers.
 *
 * kept: out, how many are left: g->dims[2]. Sets to_world of g, whose other dims are set, and where
 * distances differ its z axis.
 * ST_UNSUPPORTED: planes that differ, slices missing (gaps: not), some positions doubled, named
 * with their files; ST_USAGE: no such step. */
CHECKED status dicom_order(const dicom_study *s, dicom_slice *slices, size_t count, uint32_t step,
                           bool gaps, grid *g, size_t *kept);

#endif
