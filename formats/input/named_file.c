#include "formats/input/named_file.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"

/* ---- kinds ---- */

status named_file_implied(const char *path) {
    struct stat info;
    if (stat(path, &info) != 0 || S_ISREG(info.st_mode))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: is %s, expected a regular file", path,
                           file_kind_name(info.st_mode));
}

/* ---- places ---- */

static bool is_folder(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* Cut a resolved path to the folder that the file lies in. */
static void cut_name(char *path) {
    char *slash = strrchr(path, '/');
    if (slash)
        slash[slash == path] = 0;
}

/* Set real[] to the folder in which `by` lies as it is written, or to `by` itself if that is a
 * folder. */
static bool folder_given(const char *by, char real[PATH_MAX]) {
    char folder[PATH_MAX];
    const char *slash = strrchr(by, '/');
    if (is_folder(by))
        return realpath(by, real) != NULL;
    if (!slash)
        return realpath(".", real) != NULL;
    const int length = slash == by ? 1 : (int)(slash - by);
    return snprintf(folder, sizeof folder, "%.*s", length, by) < (int)sizeof folder &&
           realpath(folder, real) != NULL;
}

/* Follow the links of the path `by`. Set real[] to the folder of the file at their end. Returns
 * false for folders and absent files. */
static bool folder_led_to(const char *by, char real[PATH_MAX]) {
    if (is_folder(by) || !realpath(by, real))
        return false;
    cut_name(real);
    return true;
}

/* Returns whether a path lies in a folder; both are resolved. */
static bool lies_in(const char *path, const char *folder) {
    size_t length = strlen(folder);
    while (length > 0 && folder[length - 1] == '/')
        length--;
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

/* Returns whether a path has ".." in it. Used where the path leads nowhere and cannot be resolved.
 */
static bool has_steps_up(const char *name) {
    for (const char *at = name; at; at = strchr(at, '/')) {
        at += strspn(at, "/");
        if (strncmp(at, "..", 2) == 0 && (at[2] == '/' || !at[2]))
            return true;
    }
    return false;
}

/* Returns whether a file lies where the rule allows. name: as in the naming file, if known; else
 * the path. */
static bool lies_beside(const char *by, const char *path, const char *name) {
    char real[PATH_MAX], folder[PATH_MAX];
    if (!realpath(path, real))
        return *name != '/' && !has_steps_up(name);
    return (folder_given(by, folder) && lies_in(real, folder)) ||
           (folder_led_to(by, folder) && lies_in(real, folder));
}

static status check(const char *by, const char *path, const char *name, bool follow_links) {
    if (!follow_links && !lies_beside(by, path, name))
        return status_describe(ST_UNSUPPORTED,
                               "%s: names %s, which lies outside of its folder; --follow-links "
                               "reads it all the same",
                               by, name);
    return named_file_implied(path);
}

status named_file_check(const char *by, const char *path, bool follow_links) {
    const size_t length = strlen(by);
    const bool below = strncmp(path, by, length) == 0 && path[length] == '/';
    return check(by, path, below ? path + length + 1 : path, follow_links);
}

/* Returns the path of a name; a relative one is looked for beside the file that has it. */
static char *beside(mem *m, const char *header, const char *name) {
    const char *slash = strrchr(header, '/');
    const size_t folder = slash && *name != '/' ? (size_t)(slash - header) + 1 : 0;
    const size_t length = strlen(name) + 1;
    char *path = mem_alloc(m, folder + length);
    if (!path)
        return NULL;
    memcpy(path, header, folder);
    memcpy(path + folder, name, length);
    return path;
}

status named_file_find(mem *m, const char *by, const char *name, bool follow_links, char **path) {
    char *found = beside(m, by, name);
    if (!found)
        return ST_NOMEM;
    status st = check(by, found, name, follow_links);
    if (st != ST_OK) {
        mem_free(m, found);
        return st;
    }
    *path = found;
    return ST_OK;
}
