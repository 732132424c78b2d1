#include "formats/vtk/vtk_array.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

sample_type vtk_array_samples(vtk_type type) {
    static const sample_type types[] = {
        [VTK_I8] = SAMPLE_I8,   [VTK_U8] = SAMPLE_U8,   [VTK_I16] = SAMPLE_I16,
        [VTK_U16] = SAMPLE_U16, [VTK_I32] = SAMPLE_I32, [VTK_U32] = SAMPLE_U32,
        [VTK_I64] = SAMPLE_I64, [VTK_U64] = SAMPLE_U64, [VTK_F32] = SAMPLE_F32,
        [VTK_F64] = SAMPLE_F64, [VTK_STRING] = 0};
    return types[type];
}

size_t vtk_array_width(vtk_type type) {
    return sample_size(vtk_array_samples(type));
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
