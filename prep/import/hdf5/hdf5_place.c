/* hdf5_place.c - places a data set's samples in the world. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/hdf5/hdf5_field.h"
#include "prep/import/hdf5/hdf5_minc.h"
#include "prep/import/hdf5/hdf5_text.h"

/* ---- VTKHDF ---- */

static const char points[] = "/VTKHDF/PointData/", cells[] = "/VTKHDF/CellData/";

static bool begins(const char *path, const char *with) {
    return strncmp(path, with, strlen(with)) == 0;
}

bool hdf5_vtk_array(hid_t file, const char *path, char *refuse, size_t room) {
    char type[64];
    if (!begins(path, points) && !begins(path, cells))
        return false;
    hid_t group = H5Gopen2(file, "/VTKHDF", H5P_DEFAULT);
    if (group < 0 || !hdf5_string(group, "Type", 0, type, sizeof type))
        snprintf(refuse, room, "VTKHDF of a type that it does not say");
    else if (strcmp(type, "ImageData") != 0)
        snprintf(refuse, room, "VTKHDF of type %s: only ImageData is read", type);
    if (group >= 0)
        H5Gclose(group);
    return true;
}

static void vtk_to_world(const double direction[9], const double spacing[3], const double origin[3],
                         const double first[3], grid *g) {
    for (int row = 0; row < 3; row++) {
        g->to_world[row][3] = origin[row];
        for (int a = 0; a < 3; a++) {
            g->to_world[row][a] = direction[3 * row + a] * spacing[a];
            g->to_world[row][3] += g->to_world[row][a] * first[a];
        }
    }
}

/* Samples of cells lie in the middle of cells. */
static status place_vtk(const char *name, const char *path, hid_t group, grid *g) {
    double extent[6], origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1}, first[3];
    double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const bool of_cells = begins(path, cells);
    if (hdf5_numbers(group, "WholeExtent", extent, 6) != 6)
        return status_describe(ST_CORRUPT, "%s: /VTKHDF: expected 6 numbers in WholeExtent", name);
    hdf5_numbers(group, "Origin", origin, 3);
    hdf5_numbers(group, "Spacing", spacing, 3);
    hdf5_numbers(group, "Direction", direction, 9);
    for (int a = 0; a < 3; a++) {
        const double samples = extent[2 * a + 1] - extent[2 * a] + (of_cells ? 0 : 1);
        if (samples != g->dims[a])
            return status_describe(ST_CORRUPT,
                                   "%s: %s: %u samples along %c, but WholeExtent has %.0f", name,
                                   path, g->dims[a], "xyz"[a], samples);
        first[a] = extent[2 * a] + (of_cells ? 0.5 : 0);
    }
    vtk_to_world(direction, spacing, origin, first, g);
    return ST_OK;
}

/* ---- attributes ---- */

static bool all_positive(const double v[3]) {
    bool all = true;
    for (int a = 0; a < 3; a++)
        all = all && isfinite(v[a]) && v[a] > 0;
    return all;
}

/* Read three numbers, for z, y, x, or one for all. */
static bool spacing_of(hid_t object, double v[3]) {
    static const char *const names[] = {"element_size_um", "spacing",    "voxel_size",
                                        "resolution",      "pixel_size", "voxelsize"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const int n = hdf5_numbers(object, names[i], v, 3);
        if (n == 1)
            v[1] = v[2] = v[0];
        if ((n == 1 || n == 3) && all_positive(v))
            return true;
    }
    return false;
}

static bool origin_of(hid_t object, double v[3]) {
    return (hdf5_numbers(object, "origin", v, 3) == 3 ||
            hdf5_numbers(object, "offset", v, 3) == 3) &&
           isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* The group that holds a data set. */
static hid_t group_of(hid_t file, const char *path) {
    char group[HDF5_PATH];
    snprintf(group, sizeof group, "%s", path);
    char *end = strrchr(group, '/');
    if (end)
        end[end == group] = 0;
    return H5Gopen2(file, end ? group : "/", H5P_DEFAULT);
}

static void place_attributes(hid_t file, const char *path, const hdf5_field *f, grid *g) {
    double v[3];
    hid_t group = group_of(file, path);
    if (spacing_of(f->set, v) || (group >= 0 && spacing_of(group, v)))
        for (int a = 0; a < 3; a++)
            g->to_world[a][a] = v[2 - a];
    if (origin_of(f->set, v) || (group >= 0 && origin_of(group, v)))
        for (int a = 0; a < 3; a++)
            g->to_world[a][3] = v[2 - a];
    if (group >= 0)
        H5Gclose(group);
}

status hdf5_field_place(hid_t file, const char *name, const char *path, const hdf5_field *f,
                        grid *g) {
    char none[HDF5_TEXT];
    if (f->minc)
        return hdf5_minc_place(file, name, f, g);
    if (!hdf5_vtk_array(file, path, none, sizeof none)) {
        place_attributes(file, path, f, g);
        return ST_OK;
    }
    hid_t group = H5Gopen2(file, "/VTKHDF", H5P_DEFAULT);
    if (group < 0)
        return hdf5_failed(name, "/VTKHDF");
    status st = place_vtk(name, path, group, g);
    H5Gclose(group);
    return st;
}
