#include "prep/import/hdf5/hdf5_storage.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/input/named_file.h"
#include "prep/import/hdf5/hdf5_text.h"

enum { NAME_MAX_BYTES = 4096, NESTED_MAX = 8 };

/* Global state: the process reads one input, with one budget. */
static mem *budget;
static input_trust allowed;
static status_note denied;

typedef unsigned long long whole;

/* ---- external links ---- */

/* Follow an external link as the library does, but check the rule first. */
static hid_t open_target(hid_t group, const char *name, const char *object, hid_t access) {
    char by[NAME_MAX_BYTES] = "";
    char *path = NULL;
    hid_t target = H5I_INVALID_HID;
    if (H5Fget_name(group, by, sizeof by) < 0)
        return target;
    const status st = named_file_find(budget, by, name, allowed.follow_links, &path);
    if (st != ST_OK) {
        status_note_take(&denied, st);
        H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_LINK, H5E_TRAVERSE,
                 "%s", status_text());
        return target;
    }
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file >= 0)
        target = H5Oopen(file, object, access);
    if (target < 0 && denied.st == ST_OK)
        status_note_take(&denied, status_describe(ST_CORRUPT,
                                                  "%s: an external link leads to %s of %s, which "
                                                  "cannot be opened",
                                                  by, object, path));
    if (file >= 0)
        H5Fclose(file);
    mem_free(budget, path);
    return target;
}

static hid_t traverse(const char *link, hid_t group, const void *data, size_t size, hid_t access,
                      hid_t transfer) {
    unsigned flags;
    const char *name, *object;
    (void)link, (void)transfer;
    if (H5Lunpack_elink_val(data, size, &flags, &name, &object) < 0)
        return H5I_INVALID_HID;
    return open_target(group, name, object, access);
}

/* Give the value of a link to who asks for it: libcgns looks where one leads. */
static ssize_t tell_value(const char *link, const void *data, size_t size, void *to, size_t room) {
    (void)link;
    if (to)
        memcpy(to, data, size < room ? size : room);
    return (ssize_t)size;
}

status hdf5_storage_begin(mem *m, const input_trust *trust) {
    static const H5L_class_t links = {.version = H5L_LINK_CLASS_T_VERS,
                                      .id = H5L_TYPE_EXTERNAL,
                                      .comment = "external, beside its file",
                                      .trav_func = traverse,
                                      .query_func = tell_value};
    budget = m;
    allowed = *trust;
    /* libnetcdf opens data sets without our access list, so set these for it, too. */
    setenv("HDF5_EXTFILE_PREFIX", "${ORIGIN}", !trust->follow_links);
    setenv("HDF5_VDS_PREFIX", "${ORIGIN}", !trust->follow_links);
    return H5Lregister(&links) < 0 ? status_describe(ST_FAILED, "libhdf5: no class of links")
                                   : ST_OK;
}

status hdf5_storage_denied(void) {
    const status_note last = denied;
    denied = (status_note){.st = ST_OK};
    return last.st == ST_OK ? ST_OK : status_note_raise(&last);
}

hid_t hdf5_storage_access(void) {
    hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    H5Pset_efile_prefix(access, "${ORIGIN}");
    H5Pset_virtual_prefix(access, "${ORIGIN}");
    return access;
}

/* ---- external storage ---- */

static uint64_t bytes_of(hid_t set) {
    hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    const uint64_t size = H5Tget_size(type);
    uint64_t bytes = 0;
    if (points > 0 && __builtin_mul_overflow((uint64_t)points, size, &bytes))
        bytes = UINT64_MAX;
    H5Sclose(space);
    H5Tclose(type);
    return bytes;
}

/* Check one external file, from which `need` bytes are read from byte `from` on. */
static status check_external(const char *file, const char *set, const char *name, uint64_t from,
                             uint64_t need, absent_parts *out) {
    char *path = NULL;
    struct stat info = {0};
    status st = named_file_find(budget, file, name, allowed.follow_links, &path);
    if (st != ST_OK)
        return st;
    const bool there = stat(path, &info) == 0;
    const uint64_t size = there ? (uint64_t)info.st_size : 0;
    const bool shorter = size < from || size - from < need;
    out->of++;
    out->count += shorter;
    if (!there)
        st = status_describe(ST_CORRUPT, "%s: the samples of %s are in %s, which is not there",
                             file, set, path);
    else if (shorter && !allowed.allow_missing)
        st = status_describe(ST_CORRUPT,
                             "%s: the samples of %s are in %s, which ends at byte %llu, expected "
                             "%llu bytes from %llu",
                             file, set, path, (whole)size, (whole)need, (whole)from);
    mem_free(budget, path);
    return st;
}

static status check_externals(hid_t set, hid_t plist, const char *file, const char *path,
                              absent_parts *out) {
    uint64_t left = bytes_of(set);
    status st = ST_OK;
    *out = (absent_parts){.parts = "files"};
    for (int i = 0; i < H5Pget_external_count(plist) && left > 0 && st == ST_OK; i++) {
        char name[NAME_MAX_BYTES] = "";
        off_t from = 0;
        hsize_t size = 0;
        if (H5Pget_external(plist, (unsigned)i, sizeof name - 1, name, &from, &size) < 0)
            return hdf5_failed(file, path);
        const uint64_t need = size < left ? size : left;
        st = check_external(file, path, name, from < 0 ? 0 : (uint64_t)from, need, out);
        left -= need;
    }
    return st;
}

/* ---- virtual data sets ---- */

static status check_set(hid_t set, const char *file, const char *path, int depth,
                        absent_parts *out);

/* Returns whether the library would find a source in the working folder: it looks there if the
 * source is not beside the file. */
static bool is_elsewhere(const char *name) {
    struct stat info;
    return !allowed.follow_links && stat(name, &info) == 0;
}

/* Check the data set of a source, in the source's own file. */
static status check_inside(const char *path, const char *set, int depth, bool *there) {
    absent_parts inner;
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), access = hdf5_storage_access();
    hid_t source = file < 0 ? file : H5Dopen2(file, set, access);
    status st = hdf5_storage_denied();
    *there = source >= 0;
    if (*there)
        st = check_set(source, path, set, depth + 1, &inner);
    H5Eclear2(H5E_DEFAULT);
    if (source >= 0)
        H5Dclose(source);
    if (file >= 0)
        H5Fclose(file);
    H5Pclose(access);
    return st;
}

static status check_source(const char *file, const char *path, const char *name, const char *set,
                           int depth, absent_parts *out) {
    char *source = NULL;
    bool there = false;
    const bool own = strcmp(name, ".") == 0, pattern = strchr(name, '%') || strchr(set, '%');
    if (pattern && !allowed.follow_links)
        return status_describe(
            ST_UNSUPPORTED,
            "%s: %s names its sources by a pattern, %s %s, of which nobody knows "
            "where it leads; --follow-links reads it all the same",
            file, path, name, set);
    if (pattern)
        return ST_OK;
    status st = own ? ST_OK : named_file_find(budget, file, name, allowed.follow_links, &source);
    if (st != ST_OK)
        return st;
    if (own || access(source, F_OK) == 0)
        st = check_inside(own ? file : source, set, depth, &there);
    else if (is_elsewhere(name))
        st = status_describe(ST_UNSUPPORTED, "%s: %s: its source %s is not beside it", file, path,
                             name);
    out->of++;
    out->count += !there;
    if (st == ST_OK && !there && !allowed.allow_missing)
        st = status_describe(ST_CORRUPT,
                             "%s: %s is put together from others, of which %s of %s is not there; "
                             "--allow-missing takes the fill value instead",
                             file, path, set, own ? "the same file" : source);
    mem_free(budget, source);
    return st;
}

static status check_sources(hid_t plist, const char *file, const char *path, int depth,
                            absent_parts *out) {
    size_t count = 0;
    status st = ST_OK;
    *out = (absent_parts){.parts = "sources"};
    if (depth == NESTED_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: %s: sources of sources, more than %d times",
                               file, path, NESTED_MAX);
    if (H5Pget_virtual_count(plist, &count) < 0)
        return hdf5_failed(file, path);
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        char name[NAME_MAX_BYTES] = "", set[NAME_MAX_BYTES] = "";
        if (H5Pget_virtual_filename(plist, i, name, sizeof name) < 0 ||
            H5Pget_virtual_dsetname(plist, i, set, sizeof set) < 0)
            return hdf5_failed(file, path);
        st = check_source(file, path, name, set, depth, out);
    }
    return st;
}

/* ---- chunks never written ---- */

static void count_chunks(hid_t set, hid_t plist, absent_parts *out) {
    hsize_t dims[H5S_MAX_RANK], chunk[H5S_MAX_RANK], there = 0;
    hid_t space = H5Dget_space(set);
    const int rank = H5Sget_simple_extent_dims(space, dims, NULL);
    const bool counted = H5Dget_num_chunks(set, space, &there) >= 0;
    H5Sclose(space);
    if (!counted || rank < 1 || H5Pget_chunk(plist, rank, chunk) != rank)
        return; /* reading it reports the error */
    *out = (absent_parts){.of = 1, .parts = "chunks"};
    for (int i = 0; i < rank; i++) {
        const uint64_t along = dims[i] / chunk[i] + (dims[i] % chunk[i] != 0);
        if (__builtin_mul_overflow(out->of, along, &out->of))
            out->of = UINT64_MAX;
    }
    out->count = out->of > there ? out->of - there : 0;
}

static void count_whole(hid_t set, absent_parts *out) {
    H5D_space_status_t state = H5D_SPACE_STATUS_ALLOCATED;
    const bool known = H5Dget_space_status(set, &state) >= 0;
    *out = (absent_parts){.of = 1, .parts = "blocks"};
    out->count = known && state == H5D_SPACE_STATUS_NOT_ALLOCATED;
}

/* ---- all of it ---- */

static status check_set(hid_t set, const char *file, const char *path, int depth,
                        absent_parts *out) {
    hid_t plist = H5Dget_create_plist(set);
    status st = ST_OK;
    *out = (absent_parts){0};
    if (plist < 0)
        return hdf5_failed(file, path);
    switch (H5Pget_layout(plist)) {
    case H5D_VIRTUAL: st = check_sources(plist, file, path, depth, out); break;
    case H5D_CHUNKED: count_chunks(set, plist, out); break;
    case H5D_CONTIGUOUS:
        if (H5Pget_external_count(plist) > 0)
            st = check_externals(set, plist, file, path, out);
        else
            count_whole(set, out);
        break;
    default: break;
    }
    H5Pclose(plist);
    return st;
}

status hdf5_storage_check(hid_t set, const char *file, const char *path, absent_parts *out) {
    return check_set(set, file, path, 0, out);
}
