#include "prep/export/sample_format.h"

#include "formats/grid/nrrd_writer.h"
#include "prep/export/metaimage_head.h"
#include "prep/export/nifti_head.h"
#include "prep/export/npy_head.h"
#include "prep/export/tiff_head.h"
#include "prep/export/vdb_writer.h"
#include "prep/export/vtk_head.h"
#include "prep/export/zarr_writer.h"

static status nrrd_head(mem *m, out_stream *out, const grid *g) {
    (void)m;
    return nrrd_write_header(out, g);
}

#define TIFF(end)                                                                   \
    {                                                                               \
        .name = "tiff", .suffix = end, .check = tiff_head_check, .head = tiff_head, \
        .loses = tiff_head_loses, .unpacked = true, .slices = true                  \
    }

#define NIFTI(called, end, checked, of)                                                        \
    {                                                                                          \
        .name = called, .suffix = end, .check = checked, .head = of, .head_steps = of##_steps, \
        .loses_times = nifti_head_loses_times, .steps = true                                   \
    }

const sample_format sample_formats[] = {
    {.name = "nrrd", .suffix = ".nrrd", .head = nrrd_head},
    {.name = "raw", .suffix = ".raw"},
    NIFTI("nifti", ".nii", nifti_check2, nifti_head),
    NIFTI("nifti1", NULL, nifti_check1, nifti_head1),
    NIFTI("nifti2", NULL, nifti_check2, nifti_head2),
    {.name = "metaimage",
     .suffix = ".mha",
     .check = metaimage_head_check,
     .head = metaimage_head,
     .loses = metaimage_head_loses,
     .unpacked = true},
    {.name = "npy", .suffix = ".npy", .head = npy_head, .loses = npy_head_loses, .unpacked = true},
    {.name = "vti",
     .suffix = ".vti",
     .check = vtk_head_image_check,
     .head = vtk_head_image,
     .tail = vtk_head_tail,
     .named = true},
    {.name = "vtr",
     .suffix = ".vtr",
     .check = vtk_head_axes_check,
     .head = vtk_head_axes,
     .tail = vtk_head_tail,
     .named = true},
    TIFF(".tif"),
    TIFF(".tiff"),
    {.name = "vdb",
     .suffix = ".vdb",
     .check = vdb_writer_check,
     .write = vdb_writer_run,
     .fields = true,
     .unpacked = true},
    {.name = "zarr",
     .suffix = ".zarr",
     .check = zarr_writer_check,
     .write = zarr_writer_run,
     .loses = zarr_writer_loses,
     .loses_times = zarr_writer_loses_times,
     .steps = true,
     .folder = true,
     .unpacked = true},
};
const int sample_format_count = sizeof sample_formats / sizeof *sample_formats;
