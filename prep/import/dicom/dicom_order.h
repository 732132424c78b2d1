/* dicom_order.h - sorts the slices of a series, and places their grid.
 *
 * Slices are sorted along the normal of their planes: across x down. Distances come from positions
 * alone. Positions may be off by a hundredth of the distance, since files hold rounded ones. If no
 * slice has a position, slices are sorted by number.
 */
#ifndef PREP_IMPORT_DICOM_DICOM_ORDER_H
#define PREP_IMPORT_DICOM_DICOM_ORDER_H

#include "formats/grid/grid.h"
#include "prep/import/dicom/dicom_series.h"

/* dicom_order() - sort `count` slices of one series, and drop those of other time steps. If all
 * positions have the same number of slices, these are time steps, in the order of their numbers.
 *
 * kept: out, how many slices are left: g->dims[2]. Sets to_world of g, and its z axis if distances
 * differ; g's other dims are set already. ST_UNSUPPORTED, naming files: planes differ, slices are
 * missing (unless gaps), some positions are doubled. ST_USAGE: no such step. */
CHECKED status dicom_order(const dicom_study *s, dicom_slice *slices, size_t count, uint32_t step,
                           bool gaps, grid *g, size_t *kept);

#endif
