#include "formats/vtk/vtk_array.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

size_t vtk_array_width(vtk_type type) {
    switch (type) {
    case VTK_I8:
    case VTK_U8: return 1;
    case VTK_I16:
    case VTK_U16: return 2;
    case VTK_I32:
    case VTK_U32:
    case VTK_F32: return 4;
    case VTK_I64:
    case VTK_U64:
    case VTK_F64: return 8;
    default: return 0;
    }
}

bool vtk_array_whole(vtk_type type) {
    return type >= VTK_I8 && type <= VTK_U64;
}

status vtk_array_check_file(const char *path) {
    struct stat info;
    if (stat(path, &info) == 0 && S_ISREG(info.st_mode))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: VTK files are read at several places at once, so from a regular "
                           "file alone",
                           strcmp(path, "-") == 0 ? "standard input" : path);
}

status vtk_array_fault(const vtk_array *a, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const char *quote = a->name ? "\"" : "";
    return status_describe(st, "%s: %s %llu: %s%s%.60s%s: %s", a->path, a->line ? "line" : "byte",
                           (unsigned long long)(a->line ? a->line : a->at), a->name ? "array " : "",
                           quote, a->name ? a->name : a->role, quote, text);
}
