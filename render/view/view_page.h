/* view_page.h - the files of render/view/page, which are embedded in the program. */
#ifndef RENDER_VIEW_VIEW_PAGE_H
#define RENDER_VIEW_VIEW_PAGE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct view_page {
    const char *name; /* "index.html" */
    const char *type; /* MIME type */
    const unsigned char *bytes;
    size_t size;
} view_page;

/* view_page_find() - find a file by the path of a request; "/" is the index. Returns false for any
 * other path; no file on disk is looked for. */
bool view_page_find(const char *path, view_page *found);

#endif
