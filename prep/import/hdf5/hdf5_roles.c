#include "prep/import/hdf5/hdf5_roles.h"

#include <stdio.h>
#include <string.h>

#include "prep/import/cf_names.h"
#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/hdf5/hdf5_text.h"
#include "prep/import/hdf5/hdf5_walk.h"

/* ---- names in attributes ---- */

static status keep(hdf5_roles *r, const char *path) {
    status st = mem_grow(r->m, &r->paths, sizeof *r->paths, r->count, 16, &r->room);
    char *copy = st == ST_OK ? mem_copy_text(r->m, path) : NULL;
    if (!copy)
        return ST_NOMEM;
    r->paths[r->count++] = copy;
    return ST_OK;
}

/* Look for a name in the group of the data set that has it, then in the groups around. */
static status add_name(hdf5_roles *r, const char *path, const char *name) {
    char group[HDF5_PATH], there[2 * HDF5_PATH];
    if (name[0] == '/')
        return keep(r, name);
    snprintf(group, sizeof group, "%s", path);
    for (char *end = strrchr(group, '/'); end; end = strrchr(group, '/')) {
        *end = 0;
        snprintf(there, sizeof there, "%s/%s", group, name);
        if (H5Lexists(r->file, there, H5P_DEFAULT) > 0)
            return keep(r, there);
    }
    return ST_OK;
}

static status add_names(hdf5_roles *r, hid_t set, const char *path) {
    for (int i = 0; i < CF_ROLES; i++) {
        char text[CF_TEXT], name[256];
        const char *at = text;
        if (!hdf5_string(set, cf_roles[i].attribute, 0, text, sizeof text))
            continue;
        while (cf_next_name(&at, name, sizeof name)) {
            status st = add_name(r, path, name);
            if (st != ST_OK)
                return st;
        }
    }
    return ST_OK;
}

static hid_t open_set(hid_t file, const char *path) {
    hid_t access = hdf5_storage_access();
    hid_t set = H5Dopen2(file, path, access);
    H5Pclose(access);
    return set;
}

static status visit(void *ctx, const char *path) {
    hdf5_roles *r = ctx;
    hid_t set = open_set(r->file, path);
    if (set < 0) {
        H5Eclear2(H5E_DEFAULT);
        return ST_OK; /* reported when it is read */
    }
    status st = add_names(r, set, path);
    H5Dclose(set);
    return st;
}

status hdf5_roles_find(mem *m, hid_t file, const char *name, hdf5_roles *out) {
    *out = (hdf5_roles){.m = m, .file = file};
    return hdf5_walk(file, name, visit, out);
}

void hdf5_roles_release(hdf5_roles *r) {
    for (size_t i = 0; i < r->count; i++)
        mem_free(r->m, r->paths[i]);
    if (r->paths)
        mem_free(r->m, r->paths);
    *r = (hdf5_roles){0};
}

bool hdf5_roles_describes(const hdf5_roles *r, const char *path) {
    for (size_t i = 0; i < r->count; i++)
        if (strcmp(r->paths[i], path) == 0)
            return true;
    return false;
}

/* ---- scales ---- */

bool hdf5_is_scale(hid_t set) {
    char text[32];
    return hdf5_string(set, "CLASS", 0, text, sizeof text) && strcmp(text, "DIMENSION_SCALE") == 0;
}

static bool is_time_scale(hid_t scale) {
    cf_coordinates c = {0};
    char path[256] = "";
    hdf5_string(scale, "units", 0, c.units, sizeof c.units);
    hdf5_string(scale, "standard_name", 0, c.standard_name, sizeof c.standard_name);
    hdf5_string(scale, "axis", 0, c.axis, sizeof c.axis);
    hdf5_string(scale, "time_origin", 0, c.time_origin, sizeof c.time_origin);
    H5Iget_name(scale, path, sizeof path);
    const char *name = strrchr(path, '/');
    return cf_is_time(&c, name ? name + 1 : path);
}

/* Returns whether the first scale of a dimension counts times. list: references to the scales. */
static bool counts_times(hid_t set, const hvl_t *list) {
    hid_t scale = list->len && list->p ? H5Rdereference2(set, H5P_DEFAULT, H5R_OBJECT, list->p)
                                       : H5I_INVALID_HID;
    if (scale < 0)
        return false;
    const bool is = H5Iget_type(scale) == H5I_DATASET && is_time_scale(scale);
    H5Oclose(scale);
    return is;
}

static int first_time(hid_t set, hid_t attribute) {
    hvl_t lists[H5S_MAX_RANK] = {{0}};
    int found = -1;
    hid_t space = H5Aget_space(attribute), type = H5Tvlen_create(H5T_STD_REF_OBJ);
    const hssize_t rank = H5Sget_simple_extent_npoints(space);
    const bool read = rank > 0 && rank <= H5S_MAX_RANK && H5Aread(attribute, type, lists) >= 0;
    for (int i = 0; read && i < rank && found < 0; i++)
        if (counts_times(set, &lists[i]))
            found = i;
    if (read)
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, lists);
    H5Tclose(type);
    H5Sclose(space);
    return found;
}

int hdf5_time_dimension(hid_t set) {
    if (H5Aexists(set, "DIMENSION_LIST") <= 0)
        return -1;
    hid_t attribute = H5Aopen(set, "DIMENSION_LIST", H5P_DEFAULT);
    if (attribute < 0)
        return -1;
    const int found = first_time(set, attribute);
    H5Aclose(attribute);
    return found;
}
