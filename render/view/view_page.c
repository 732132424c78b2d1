#include "render/view/view_page.h"

#include <string.h>

/* The build makes VIEW_PAGE_FILES from the folder: a PAGE(number, name) for each file. */
#define PAGE(number, name)                                                         \
    __asm__(".pushsection .rodata\n"                                               \
            "view_page_begin_" #number ": .incbin \"render/view/page/" name "\"\n" \
            "view_page_end_" #number ": .byte 0\n"                                 \
            ".popsection\n");                                                      \
    extern const unsigned char view_page_begin_##number[], view_page_end_##number[];
#include VIEW_PAGE_FILES
#undef PAGE

static const struct {
    const char *name;
    const unsigned char *begin, *end;
} FILES[] = {
#define PAGE(number, name) {name, view_page_begin_##number, view_page_end_##number},
#include VIEW_PAGE_FILES
#undef PAGE
};

static const char *type_of(const char *name) {
    static const char *const types[][2] = {{".html", "text/html; charset=utf-8"},
                                           {".css", "text/css; charset=utf-8"},
                                           {".js", "text/javascript; charset=utf-8"},
                                           {".svg", "image/svg+xml"},
                                           {".png", "image/png"}};
    const char *end = strrchr(name, '.');
    for (size_t i = 0; end && i < sizeof types / sizeof *types; i++)
        if (strcmp(end, types[i][0]) == 0)
            return types[i][1];
    return "application/octet-stream";
}

bool view_page_find(const char *path, view_page *found) {
    const char *name = strcmp(path, "/") == 0 ? "index.html" : path + (*path == '/');
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++)
        if (strcmp(name, FILES[i].name) == 0) {
            *found = (view_page){FILES[i].name, type_of(FILES[i].name), FILES[i].begin,
                                 (size_t)(FILES[i].end - FILES[i].begin)};
            return true;
        }
    return false;
}
