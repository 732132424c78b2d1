/* nifti_head.h - heads of NIfTI-1 and NIfTI-2 files (.nii): one volume, or all its steps, placed by
 * the sform.
 */
#ifndef PREP_EXPORT_NIFTI_HEAD_H
#define PREP_EXPORT_NIFTI_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"
#include "prep/export/sample_times.h"

/* nifti_check1(), nifti_check2() - ST_UNSUPPORTED for rectilinear grids. NIfTI-1 also refuses more
 * than 32767 samples along an axis, and maps beyond the range of floats. */
CHECKED status nifti_check1(const grid *g);
CHECKED status nifti_check2(const grid *g);

/* nifti_exact1() - returns whether NIfTI-1 holds the grid exactly; it rounds the map to floats. */
bool nifti_exact1(const grid *g);

/* nifti_head1(), nifti_head2() - write all bytes before the first sample. nifti_head() - NIfTI-1 if
 * that is exact, else NIfTI-2. The name becomes the description. */
CHECKED status nifti_head1(mem *m, out_stream *out, const grid *g);
CHECKED status nifti_head2(mem *m, out_stream *out, const grid *g);
CHECKED status nifti_head(mem *m, out_stream *out, const grid *g);

/* nifti_head_steps() and so on - the same for a file of all steps, one after the other. NIfTI-1
 * rounds the first time and the time step to floats, and refuses more than 32767 steps
 * (ST_UNSUPPORTED). */
CHECKED status nifti_head1_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);
CHECKED status nifti_head2_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);
CHECKED status nifti_head_steps(mem *m, out_stream *out, const grid *g, const sample_times *times);

/* nifti_head_loses_times() - a sentence about times that are not kept; NULL: all are. */
const char *nifti_head_loses_times(const sample_times *times);

#endif
