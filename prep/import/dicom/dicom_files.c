#include "prep/import/dicom/dicom_files.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"

static status add(dicom_files *f, char *path) {
    status st = path ? mem_grow(f->m, &f->path, sizeof *f->path, f->count, 64, &f->room) : ST_NOMEM;
    if (st != ST_OK)
        mem_free(f->m, path);
    else
        f->path[f->count++] = path;
    return st;
}

static char *join(mem *m, const char *folder, const char *name) {
    const size_t room = strlen(folder) + strlen(name) + 2;
    char *path = mem_alloc(m, room);
    if (path)
        snprintf(path, room, "%s/%s", folder, name);
    return path;
}

/* Returns whether a path is a folder; a link to a folder is not. */
static bool is_folder(const char *path) {
    struct stat s;
    return lstat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

static bool is_regular(const char *path) {
    struct stat s;
    return stat(path, &s) == 0 && S_ISREG(s.st_mode);
}

/* Add the files of a folder. Its folders are added to `folders`, to be visited later. */
static status take_entries(dicom_files *f, dicom_files *folders, const char *folder, DIR *dir) {
    status st = ST_OK;
    for (struct dirent *e; st == ST_OK && (e = readdir(dir));) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        char *path = join(f->m, folder, e->d_name);
        if (path && !is_folder(path) && !is_regular(path))
            mem_free(f->m, path);
        else
            st = add(path && is_folder(path) ? folders : f, path);
    }
    return st;
}

static status walk(dicom_files *f, const char *top) {
    dicom_files folders = {.m = f->m};
    status st = add(&folders, mem_copy_text(f->m, top));
    for (size_t i = 0; st == ST_OK && i < folders.count; i++) {
        DIR *dir = opendir(folders.path[i]);
        if (!dir) {
            st = file_failed(errno, folders.path[i], "reading the folder");
            break;
        }
        st = take_entries(f, &folders, folders.path[i], dir);
        closedir(dir);
    }
    dicom_files_release(&folders);
    return st;
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool leads_to_folder(const char *path) {
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

status dicom_files_find(mem *m, char *const *paths, int count, dicom_files *f) {
    status st = ST_OK;
    *f = (dicom_files){.m = m};
    for (int i = 0; i < count && st == ST_OK; i++)
        if (!leads_to_folder(paths[i]))
            st = add(f, mem_copy_text(m, paths[i]));
    f->named = f->count;
    for (int i = 0; i < count && st == ST_OK; i++)
        if (leads_to_folder(paths[i]))
            st = walk(f, paths[i]);
    if (f->count > f->named)
        qsort(f->path + f->named, f->count - f->named, sizeof *f->path, by_name);
    return st;
}

void dicom_files_release(dicom_files *f) {
    for (size_t i = 0; i < f->count; i++)
        mem_free(f->m, f->path[i]);
    mem_free(f->m, f->path);
    f->path = NULL;
    f->count = 0;
}
