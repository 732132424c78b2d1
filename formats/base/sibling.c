#include "formats/base/sibling.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool sibling_find(const char *name, char path[SIBLING_PATH]) {
    const ssize_t n = readlink("/proc/self/exe", path, SIBLING_PATH - strlen(name) - 1);
    if (n > 0) {
        path[n] = 0;
        char *slash = strrchr(path, '/');
        strcpy(slash ? slash + 1 : path, name);
        if (access(path, X_OK) == 0)
            return true;
    }
    const char *folders = getenv("PATH");
    while (folders && *folders) {
        const int length = (int)strcspn(folders, ":");
        snprintf(path, SIBLING_PATH, "%.*s/%s", length, folders, name);
        if (access(path, X_OK) == 0)
            return true;
        folders += length + (folders[length] == ':');
    }
    return false;
}
