#include "tests/support/scratch.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATHS = 500, PATH_ROOM = 300 };

static char folder[64];
static pid_t owner;

static size_t each_file(void (*visit)(const char *path)) {
    size_t count = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
        char path[PATH_ROOM + sizeof folder];
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        if (visit)
            visit(path);
        count++;
    }
    if (d)
        closedir(d);
    return count;
}

static void remove_file(const char *path) {
    (void)remove(path);
}

static void remove_folder(void) {
    if (getpid() != owner)
        return;
    each_file(remove_file);
    (void)rmdir(folder);
}

static void make_folder(void) {
    if (folder[0])
        return;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%.40s/leafcast-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(folder))
        fail_msg("no folder %s", folder);
    owner = getpid();
    atexit(remove_folder);
}

const char *scratch_path(const char *name) {
    static char paths[PATHS][PATH_ROOM];
    static int used;
    char path[PATH_ROOM];
    make_folder();
    snprintf(path, sizeof path, "%.60s/%.200s", folder, name);
    for (int i = 0; i < used; i++)
        if (strcmp(paths[i], path) == 0)
            return paths[i];
    if (used == PATHS)
        fail_msg("more than %d names", PATHS);
    return strcpy(paths[used++], path);
}

const char *scratch_write(const char *name, const void *data, size_t size) {
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) != 0)
        fail_msg("cannot write %s", path);
    return path;
}

const char *scratch_text(const char *name, const char *text) {
    return scratch_write(name, text, strlen(text));
}

char *scratch_read(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    if (!f || fseek(f, 0, SEEK_END) != 0)
        fail_msg("cannot read %s", path);
    size_t length = (size_t)ftell(f);
    rewind(f);
    char *data = malloc(length + 1);
    if (!data || fread(data, 1, length, f) != length)
        fail_msg("cannot read %s", path);
    fclose(f);
    data[length] = 0;
    if (size)
        *size = length;
    return data;
}

void scratch_same(const char *what, const char *a, const char *b) {
    size_t sizes[2];
    char *bytes[2] = {scratch_read(a, &sizes[0]), scratch_read(b, &sizes[1])};
    if (sizes[0] != sizes[1] || memcmp(bytes[0], bytes[1], sizes[0]) != 0)
        fail_msg("%s: %zu bytes and %zu, and they differ", what, sizes[0], sizes[1]);
    free(bytes[0]);
    free(bytes[1]);
}

size_t scratch_count(void) {
    make_folder();
    return each_file(NULL);
}

const char *scratch_data(const char *name) {
    static char path[4096];
    const char *base = getenv("LEAFCAST_DATA");
    snprintf(path, sizeof path, "%s/%s", base ? base : "../shared/data", name);
    return access(path, R_OK) == 0 ? path : NULL;
}
