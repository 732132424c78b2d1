#include "prep/import/hdf5/hdf5_walk.h"

#include <stdbool.h>
#include <string.h>

#include "prep/import/hdf5/hdf5_text.h"

enum { SHARED_MAX = 1024 };

typedef struct walk {
    const char *name;
    hdf5_walk_take *take;
    void *ctx;
    char path[HDF5_PATH]; /* of the current group; "": the root */
    int depth;
    haddr_t shared[SHARED_MAX]; /* entered groups that have several names */
    int shared_count;
    status st;
} walk;

/* Returns whether a group has not been entered before. */
static bool is_new(walk *w, const H5O_info_t *info) {
    if (info->rc < 2)
        return true;
    for (int i = 0; i < w->shared_count; i++)
        if (w->shared[i] == info->addr)
            return false;
    if (w->shared_count == SHARED_MAX) {
        w->st = status_describe(ST_UNSUPPORTED, "%s: more than %d groups with several names each",
                                w->name, SHARED_MAX);
        return false;
    }
    w->shared[w->shared_count++] = info->addr;
    return true;
}

static herr_t visit(hid_t group, const char *name, const H5L_info_t *link, void *ctx);

static void enter(walk *w, hid_t parent, const char *name) {
    if (w->depth == HDF5_DEPTH_MAX) {
        w->st = status_describe(ST_UNSUPPORTED,
                                "%s: groups nested more than %d deep; --field takes a data set by "
                                "its full name",
                                w->name, HDF5_DEPTH_MAX);
        return;
    }
    hid_t group = H5Gopen2(parent, name, H5P_DEFAULT);
    w->depth++;
    if ((group < 0 || H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, visit, w) < 0) &&
        w->st == ST_OK)
        w->st = hdf5_failed(w->name, "listing its data sets");
    w->depth--;
    if (group >= 0)
        H5Gclose(group);
}

/* Append the name to the group's path for the visit, and cut it off again. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *link, void *ctx) {
    walk *w = ctx;
    H5O_info_t info;
    const size_t length = strlen(w->path), more = strlen(name);
    if (link->type != H5L_TYPE_HARD || length + more + 2 > sizeof w->path)
        return 0;
    if (H5Oget_info_by_name2(group, name, &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0)
        return -1;
    w->path[length] = '/';
    memcpy(w->path + length + 1, name, more + 1);
    if (info.type == H5O_TYPE_DATASET)
        w->st = w->take(w->ctx, w->path);
    else if (info.type == H5O_TYPE_GROUP && is_new(w, &info))
        enter(w, group, name);
    w->path[length] = 0;
    return w->st == ST_OK ? 0 : -1;
}

status hdf5_walk(hid_t file, const char *name, hdf5_walk_take *take, void *ctx) {
    walk w = {.name = name, .take = take, .ctx = ctx};
    enter(&w, file, "/");
    return w.st;
}
