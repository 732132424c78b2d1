/* nifti.h - NIfTI-1 and NIfTI-2: .nii, or .hdr with its samples in the .img beside it; the path of
 * either will do.
 *
 * Format: https://nifti.nimh.nih.gov, nifti1.h and nifti2.h. Understood: either byte order; 8 to 64
 * bit integers, float, double; RGB24 and RGBA32, and complex numbers, as several numbers a sample;
 * the fourth axis as steps, or the fifth as the numbers of a sample; scl_slope and scl_inter; the
 * transform of the sform where it has a code, else of the qform, else pixdim along the axes from
 * node (0, 0, 0) at the origin. Refused with ST_UNSUPPORTED: bits, 128-bit floats, more axes.
 */
#ifndef FORMATS_GRID_NIFTI_H
#define FORMATS_GRID_NIFTI_H

#include "formats/grid/grid_reader.h"

extern const grid_reader nifti_reader;

#endif
