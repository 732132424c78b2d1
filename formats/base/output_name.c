#include "formats/base/output_name.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/text.h"

/* Suffixes that name a format, ours or others'. tests/cli/output_names.sh compares the list with
 * the formats that are read, written or recognized. */
static const char known[] =
    /* leafcast's own */
    ".leaf .mesh "
    /* grids */
    ".nrrd .nhdr .mha .mhd .nii .hdr .img .npy .npz .mrc .map .pvm .raw .vti .vtr .vts .pvti "
    ".pvtr .pvts .vdb .zarr .h5 .hdf5 .he5 .hdf .nc .nc4 .cdf .mgh .mgz .head .brik .par .rec "
    ".slc .cube .cub .fld .mat .fits .fit .grib .grb .grib2 .dem .p3d .q .dcm .ima "
    /* meshes and surfaces */
    ".vtk .vtu .vtp .pvtp .pvtu .vtm .vtmb .pvd .node .ele .msh .poly .smesh .ply .stl .off .obj "
    ".glb "
    ".gltf .exo .ex2 .e .g .exii .med .rmed .cgns .inp .avs .ucd .bdf .nas .meshb .su2 .ugrid .plt "
    ".szplt "
    ".tec .nek5000 .re2 .foam .case .xdmf .xmf .las .laz "
    /* pictures, tables, texts */
    ".tif .tiff .png .jpg .jpeg .jp2 .exr .pgm .ppm .pnm .pbm .pfm .svg .csv .xyz .json .pdf "
    /* compressed */
    ".gz .bz2 .xz .zst .zip .tar ";

static bool has_one_of(const char *path, const char *suffixes) {
    char suffix[16];
    for (const char *at = suffixes; *at; at += strcspn(at, " ") + 1) {
        snprintf(suffix, sizeof suffix, "%.*s", (int)strcspn(at, " "), at);
        if (text_ends_in(path, suffix))
            return true;
    }
    return false;
}

bool output_name_is_known(const char *path) {
    return has_one_of(path, known);
}

/* Whether a path has a %d, %4d or %04d. */
static bool has_number(const char *path) {
    for (const char *at = path; (at = strchr(at, '%')); at++)
        if (at[1 + strspn(at + 1, "0123456789")] == 'd')
            return true;
    return false;
}

bool output_name_is_stdout(const char *path) {
    return path && strcmp(path, "-") == 0;
}

status output_name_check(const char *path, const output_kind *kind) {
    char ends[64];
    if (!path || output_name_is_stdout(path))
        return ST_OK;
    if (has_number(path) && !kind->sequence)
        return status_describe(ST_USAGE,
                               "%s: a name with %%d in it is that of several files, and %s is one: "
                               "give it a name without",
                               path, kind->what);
    if (!output_name_is_known(path) || has_one_of(path, kind->suffixes))
        return ST_OK;
    snprintf(ends, sizeof ends, "%.*s", (int)strlen(kind->suffixes) - 1, kind->suffixes);
    return status_describe(ST_USAGE, "%s: what is written is %s, so its name ends in %s%s%s", path,
                           kind->what, ends, kind->instead ? ": " : "",
                           kind->instead ? kind->instead : "");
}
