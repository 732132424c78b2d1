#include "prep/import/images/image_names.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool digit(char c) {
    return c >= '0' && c <= '9';
}

/* Compare runs of digits by value: skip leading zeros, then compare lengths, then digits. */
static int compare_runs(const char **a, const char **b) {
    while (**a == '0')
        ++*a;
    while (**b == '0')
        ++*b;
    const char *x = *a, *y = *b;
    while (digit(**a))
        ++*a;
    while (digit(**b))
        ++*b;
    if (*a - x != *b - y)
        return *a - x < *b - y ? -1 : 1;
    return strncmp(x, y, (size_t)(*a - x));
}

int image_names_compare(const char *first, const char *second) {
    const char *a = first, *b = second;
    while (*a && *b) {
        if (digit(*a) && digit(*b)) {
            const int order = compare_runs(&a, &b);
            if (order != 0)
                return order;
            continue;
        }
        if (*a != *b)
            return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
        a++;
        b++;
    }
    return *a || *b ? (*a ? 1 : -1) : strcmp(first, second);
}

static int compare_paths(const void *a, const void *b) {
    return image_names_compare(*(char *const *)a, *(char *const *)b);
}

/* ---- a folder ---- */

static status add(image_names *n, const char *folder, const char *name) {
    status st = mem_grow(n->m, &n->paths, sizeof *n->paths, n->count, 64, &n->room);
    if (st != ST_OK)
        return st;
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path = mem_alloc(n->m, size);
    if (!path)
        return ST_NOMEM;
    snprintf(path, size, "%s%s%s", folder, *folder ? "/" : "", name);
    n->paths[n->count++] = path;
    return ST_OK;
}

/* A slice that is left out would move all behind it: what has an image's name must be one. */
static status check_file(int folder, const char *path, const char *name) {
    struct stat s;
    if (fstatat(folder, name, &s, 0) != 0)
        return status_describe(ST_IO, "%s/%s: cannot open: %s", path, name, strerror(errno));
    if (!S_ISREG(s.st_mode))
        return status_describe(
            ST_UNSUPPORTED, "%s/%s: has the name of an image, but is no regular file", path, name);
    return ST_OK;
}

static status list_folder(image_names *n, const char *path, bool (*known)(const char *)) {
    DIR *folder = opendir(path);
    if (!folder)
        return status_describe(ST_IO, "%s: cannot open: %s", path, strerror(errno));
    status st = ST_OK;
    for (struct dirent *e; st == ST_OK && (e = readdir(folder)) != NULL;)
        if (e->d_name[0] != '.' && known(e->d_name)) {
            st = check_file(dirfd(folder), path, e->d_name);
            st = st == ST_OK ? add(n, path, e->d_name) : st;
        }
    closedir(folder);
    if (st == ST_OK && n->count == 0)
        return status_describe(ST_UNSUPPORTED, "%s: no image in this folder", path);
    return st;
}

status image_names_find(mem *m, char *const *paths, size_t count, bool as_given,
                        bool (*known)(const char *path), image_names *out) {
    struct stat s;
    *out = (image_names){.m = m};
    status st = ST_OK;
    const bool folder = count == 1 && stat(paths[0], &s) == 0 && S_ISDIR(s.st_mode);
    if (folder)
        st = list_folder(out, paths[0], known);
    for (size_t i = 0; i < count && !folder && st == ST_OK; i++)
        st = add(out, "", paths[i]);
    if (st != ST_OK)
        image_names_release(out);
    else if (folder || !as_given)
        qsort(out->paths, out->count, sizeof *out->paths, compare_paths);
    return st;
}

void image_names_release(image_names *n) {
    for (size_t i = 0; i < n->count; i++)
        mem_free(n->m, n->paths[i]);
    mem_free(n->m, n->paths);
    *n = (image_names){0};
}
