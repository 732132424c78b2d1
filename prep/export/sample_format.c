#include "prep/export/sample_format.h"

#include "formats/grid/nrrd_writer.h"
#include "prep/export/nifti_head.h"
#include "prep/export/vtk_head.h"

static status nrrd_head(mem *m, out_stream *out, const grid *g) {
    (void)m;
    return nrrd_write_header(out, g);
}

/* Formats behind heavy libraries would be rows whose head() starts a process to write into. */
const sample_format sample_formats[] = {
    {"nrrd", ".nrrd", NULL, nrrd_head, NULL},
    {"raw", ".raw", NULL, NULL, NULL},
    {"nifti", ".nii", nifti_check2, nifti_head, NULL},
    {"nifti1", NULL, nifti_check1, nifti_head1, NULL},
    {"nifti2", NULL, nifti_check2, nifti_head2, NULL},
    {"vti", ".vti", vtk_head_image_check, vtk_head_image, vtk_head_tail},
    {"vtr", ".vtr", vtk_head_axes_check, vtk_head_axes, vtk_head_tail},
};
const int sample_format_count = sizeof sample_formats / sizeof *sample_formats;
