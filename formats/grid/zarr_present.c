#include "formats/grid/zarr_present.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"

/* Read an index as in chunks' names, without zeros in front, at *text, and move *text behind it.
 * Returns whether it is in first .. last. */
static bool take_index(const char **text, uint32_t first, uint32_t last) {
    const char *at = *text;
    uint64_t index = 0;
    if (*at == '0' && at[1] >= '0' && at[1] <= '9')
        return false;
    for (; *at >= '0' && *at <= '9' && index <= UINT32_MAX; at++)
        index = 10 * index + (uint64_t)(*at - '0');
    const bool some = at > *text;
    *text = at;
    return some && index >= first && index <= last;
}

/* Returns whether a name has the indices of the axes from `axis` on; if each axis has a folder, the
 * index of `axis`. */
static bool is_chunk(const zarr_array *a, const zarr_range *r, int axis, const char *name) {
    const int end = a->chunks.separator == '/' ? axis + 1 : a->chunks.axes;
    for (int i = axis; i < end; i++) {
        if (i > axis && *name++ != a->chunks.separator)
            return false;
        if (!take_index(&name, r->first[i], r->last[i]))
            return false;
    }
    return !*name;
}

/* Count the chunks in a folder whose entries name the axes from `axis` on. path: the folder's;
 * names are appended to it. */
static status count_folder(const zarr_array *a, const zarr_range *r, int axis, char *path,
                           size_t room, uint64_t *count) {
    const size_t length = strlen(path);
    const bool inner = a->chunks.separator == '/' && axis + 1 < a->chunks.axes;
    DIR *folder = opendir(path);
    if (!folder) /* a file in the place of an inner folder holds no chunks */
        return axis > 0 && (errno == ENOTDIR || errno == ENOENT)
                   ? ST_OK
                   : file_failed(errno, path, "cannot list the chunks");
    status st = ST_OK;
    for (struct dirent *e; st == ST_OK && (e = readdir(folder));) {
        if (!is_chunk(a, r, axis, e->d_name))
            continue;
        if (!inner) {
            ++*count;
            continue;
        }
        snprintf(path + length, room - length, "/%s", e->d_name);
        st = count_folder(a, r, axis + 1, path, room, count);
        path[length] = 0;
    }
    closedir(folder);
    return st;
}

status zarr_present_count(const zarr_array *a, const zarr_range *range, uint64_t *count) {
    char path[ZARR_PATH + ZARR_AXES * 12];
    *count = 0;
    snprintf(path, sizeof path, "%s", a->path);
    return count_folder(a, range, 0, path, sizeof path, count);
}
