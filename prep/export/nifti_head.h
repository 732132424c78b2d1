/* nifti_head.h - the heads of NIfTI-1 and NIfTI-2 files (.nii): one volume, or all steps of one,
 * placed by its sform.
 */
#ifndef PREP_EXPORT_NIFTI_HEAD_H
#define PREP_EXPORT_NIFTI_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"
#include "prep/export/sample_times.h"

/* nifti_check1(), nifti_check2() - ST_UNSUPPORTED for rectilinear grids; NIfTI-1 also for more than
 * 32767 samples along an axis, and for maps beyond the range of floats. */
CHECKED status nifti_check1(const grid *g);
CHECKED status nifti_check2(const grid *g);

/* nifti_exact1() - whether NIfTI-1 holds the grid as it is: its map is rounded to floats. */
bool nifti_exact1(const grid *g);

/* nifti_head1(), nifti_head2() - all before the first sample. nifti_head() - NIfTI-1 where that is
 * exact, else NIfTI-2. The name becomes the description. */
CHECKED status nifti_head1(mem *m, out_stream *out, const grid *g);
CHECKED status nifti_head2(mem *m, out_stream *out, const grid *g);
CHECKED status nifti_head(mem *m, out_stream *out, const grid *g);

/* nifti_head_steps() and so on - the same before the samples of all steps, one after the other. The
 * step of the times, and where they start, are rounded to floats in NIfTI-1. ST_UNSUPPORTED there:
 * more than 32767 steps. */
CHECKED status nifti_head1_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);
CHECKED status nifti_head2_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);
CHECKED status nifti_head_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);

/* nifti_head_loses_times() - what of the times is not kept, as a sentence; NULL: nothing. */
const char *nifti_head_loses_times(const sample_times *times);

#endif
