#include "prep/import/hdf5/hdf5_minc.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/hdf5/hdf5_text.h"
#include "prep/import/minc.h"

static const char group[] = "/minc-2.0/image/";

/* ---- recognizing MINC ---- */

/* Parse a list such as "zspace,yspace,xspace" into dimensions of space; -1: another kind. Returns
 * how many.
 */
static int order_of(hid_t set, int spaces[H5S_MAX_RANK]) {
    char text[256], *rest = text;
    int count = 0;
    if (!hdf5_string(set, "dimorder", 0, text, sizeof text))
        return 0;
    for (char *word; (word = strsep(&rest, ", ")) && count < H5S_MAX_RANK;)
        if (*word)
            spaces[count++] = minc_space(word);
    return count;
}

static void find_range(hdf5_field *f) {
    packed_samples *p = &f->packed;
    double told[2], range[2];
    if (hdf5_numbers(f->set, "valid_range", told, 2) != 2)
        told[0] = told[1] = NAN;
    minc_range(p->type, told, range);
    p->has_range = true;
    p->least = range[0];
    p->most = range[1];
}

/* Returns whether the last three dimensions are of space, each once, with at most one of times in
 * front. */
static bool is_volume(const int *spaces, int count) {
    int seen = 0;
    for (int i = count - 3; i >= 0 && i < count; i++)
        seen |= spaces[i] >= 0 ? 1 << spaces[i] : 0;
    return seen == 7 && (count == 3 || (count == 4 && spaces[0] < 0));
}

void hdf5_minc_find(const char *path, hdf5_field *f) {
    int spaces[H5S_MAX_RANK];
    const size_t length = strlen(path);
    f->minc = strncmp(path, group, strlen(group)) == 0 && length > 6 &&
              strcmp(path + length - 6, "/image") == 0;
    if (!f->minc || f->refuse[0])
        return;
    const int count = order_of(f->set, spaces);
    if (count != f->rank || f->packed.components > 1 || !is_volume(spaces, count) ||
        f->dims[0] > UINT32_MAX) {
        snprintf(f->refuse, sizeof f->refuse,
                 "MINC 2 whose dimensions are not xspace, yspace and zspace, perhaps behind times: "
                 "mnc2nii makes NIfTI of it");
        return;
    }
    for (int a = 0; a < HDF5_AXES; a++)
        f->at[a] = a <= HDF5_Z ? f->rank - 1 - a : -1;
    f->at[HDF5_T] = f->rank == 4 ? 0 : -1;
    if (sample_is_integer(f->packed.type) && !f->packed.wide)
        find_range(f);
}

/* ---- where it lies ---- */

static status find_dimension(hid_t file, const char *name, int space, minc_dimension *d) {
    char path[64], text[32];
    snprintf(path, sizeof path, "/minc-2.0/dimensions/%cspace", "xyz"[space]);
    *d = minc_usual(space);
    hid_t set =
        H5Lexists(file, path, H5P_DEFAULT) > 0 ? H5Oopen(file, path, H5P_DEFAULT) : H5I_INVALID_HID;
    if (set < 0)
        return ST_OK;
    const bool uneven =
        hdf5_string(set, "spacing", 0, text, sizeof text) && strcmp(text, "irregular") == 0;
    hdf5_numbers(set, "step", &d->step, 1);
    hdf5_numbers(set, "start", &d->start, 1);
    hdf5_numbers(set, "direction_cosines", d->cosines, 3);
    H5Oclose(set);
    return uneven ? status_describe(ST_UNSUPPORTED,
                                    "%s: MINC whose %cspace is irregular is not read: mincresample "
                                    "makes it even",
                                    name, "xyz"[space])
                  : ST_OK;
}

status hdf5_minc_place(hid_t file, const char *name, const hdf5_field *f, grid *g) {
    int spaces[H5S_MAX_RANK];
    minc_dimension d[3];
    const int count = order_of(f->set, spaces);
    status st = ST_OK;
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = find_dimension(file, name, spaces[count - 1 - a], &d[a]);
    if (st == ST_OK)
        minc_place(d, g);
    return st;
}

/* ---- values ---- */

enum { IMAGE_PATH = HDF5_PATH + 8 };

/* Read all numbers of image-min or image-max: one, one per slice, or one per slice and step. */
static status read_ends(hid_t file, const char *name, const char *path, uint64_t slices,
                        uint64_t steps, double *out, uint64_t *count) {
    hid_t access = hdf5_storage_access();
    hid_t set =
        H5Lexists(file, path, H5P_DEFAULT) > 0 ? H5Dopen2(file, path, access) : H5I_INVALID_HID;
    status st = ST_OK;
    absent_parts absent;
    H5Pclose(access);
    *count = 0;
    if (set < 0)
        return ST_OK;
    st = hdf5_storage_check(set, name, path, &absent);
    hid_t space = st == ST_OK ? H5Dget_space(set) : H5I_INVALID_HID;
    const hssize_t points = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
    if (st == ST_OK && points != 1 && points != (hssize_t)slices &&
        points != (hssize_t)(slices * steps))
        st = status_describe(ST_UNSUPPORTED,
                             "%s: MINC whose %s is not one number a slice is not read: mnc2nii "
                             "makes NIfTI of it",
                             name, path);
    if (st == ST_OK && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0)
        st = hdf5_failed(name, path);
    *count = (uint64_t)points;
    if (space >= 0)
        H5Sclose(space);
    H5Dclose(set);
    return st;
}

/* The number for slice `at`, from an array of `count`. */
static double end_of(const double *all, uint64_t count, uint64_t slices, uint64_t at,
                     double usual) {
    return count == 0 ? usual : count == 1 ? all[0] : all[count == slices ? at % slices : at];
}

status hdf5_minc_scales(mem *m, hid_t file, const char *name, const char *path, const hdf5_field *f,
                        uint32_t step, double **out) {
    const uint64_t slices = hdf5_field_count(f, HDF5_Z), steps = hdf5_field_count(f, HDF5_T);
    const double valid[2] = {f->packed.least, f->packed.most};
    const int stem = (int)strlen(path) - (int)strlen("image");
    char least_path[IMAGE_PATH], most_path[IMAGE_PATH];
    uint64_t least_count = 0, most_count = 0;
    double *scales = *out = mem_array(m, 2 * slices, sizeof *scales);
    double *ends = mem_array(m, 2 * slices * steps, sizeof *ends);
    double *most = ends ? ends + slices * steps : NULL;
    status st = scales && ends ? ST_OK : ST_NOMEM;
    snprintf(least_path, sizeof least_path, "%.*simage-min", stem, path);
    snprintf(most_path, sizeof most_path, "%.*simage-max", stem, path);
    if (st == ST_OK)
        st = read_ends(file, name, least_path, slices, steps, ends, &least_count);
    if (st == ST_OK)
        st = read_ends(file, name, most_path, slices, steps, most, &most_count);
    for (uint64_t z = 0; z < slices && st == ST_OK; z++)
        minc_scale(valid, end_of(ends, least_count, slices, step * slices + z, 0),
                   end_of(most, most_count, slices, step * slices + z, 1), &scales[2 * z],
                   &scales[2 * z + 1]);
    if (ends)
        mem_free(m, ends);
    return st;
}
