#include "formats/grid/slice_folder.h"

#include <string.h>

#include "formats/base/file_mark.h"

const char *slice_folder_fault(const slice_file *f) {
    const size_t length = strnlen(f->name, sizeof f->name);
    for (size_t i = length; i < sizeof f->name; i++)
        if (f->name[i])
            return "zeros behind a name";
    if (!length || length == sizeof f->name || strchr(f->name, '/') || strcmp(f->name, ".") == 0 ||
        strcmp(f->name, "..") == 0)
        return "the name of a file in the folder";
    return f->modified_ns > 999999999 || f->reserved ? "a time, and zero" : NULL;
}

/* Open a file of the folder, and see which one it is. */
static status look_at(mem *m, const char *folder, const char *name, file **out, file_mark *mark) {
    const size_t length = strlen(folder);
    char *path = mem_alloc(m, length + 1 + strlen(name) + 1);
    if (!path)
        return ST_NOMEM;
    memcpy(path, folder, length);
    path[length] = '/';
    memcpy(path + length + 1, name, strlen(name) + 1);
    status st = file_open(m, path, out);
    mem_free(m, path);
    return st == ST_OK ? file_mark_take(*out, mark) : st;
}

/* Look at a file as look_at() does, unless it is that of the slice before. */
static status mark_one(mem *m, const char *folder, slice_file *of, uint32_t i) {
    file_mark mark;
    file *f = NULL;
    if (i && strcmp(of[i].name, of[i - 1].name) == 0) {
        of[i] = of[i - 1];
        return ST_OK;
    }
    const status st = look_at(m, folder, of[i].name, &f, &mark);
    file_close(f);
    if (st != ST_OK)
        return st;
    of[i].bytes = mark.size;
    of[i].modified_s = mark.modified_s;
    of[i].modified_ns = (uint32_t)mark.modified_ns;
    return ST_OK;
}

status slice_folder_mark(mem *m, const char *folder, slice_file *of, uint32_t count) {
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = mark_one(m, folder, of, i);
    return st;
}

status slice_folder_open(mem *m, const slice_folder *s, uint32_t slice, file **out) {
    const slice_file *then = &s->of[slice];
    const file_mark mark = {
        .size = then->bytes, .modified_s = then->modified_s, .modified_ns = then->modified_ns};
    file_mark now;
    file *f = NULL;
    status st = look_at(m, s->folder, then->name, &f, &now);
    if (st == ST_OK)
        st = file_mark_compare(&now, &mark, file_path(f), s->by);
    if (st != ST_OK) {
        file_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

status slice_folder_check(mem *m, const slice_folder *s) {
    status st = ST_OK;
    for (uint32_t i = 0; i < s->count && st == ST_OK; i++) {
        file *f = NULL;
        if (i == 0 || strcmp(s->of[i].name, s->of[i - 1].name) != 0)
            st = slice_folder_open(m, s, i, &f);
        file_close(f);
    }
    return st;
}
