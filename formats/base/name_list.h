/* name_list.h - a list of names for a message: "a", "b", ..; each name once, cut if there are too
 * many.
 */
#ifndef FORMATS_BASE_NAME_LIST_H
#define FORMATS_BASE_NAME_LIST_H

#include <stdbool.h>
#include <stddef.h>

enum { NAME_LIST_TEXT = 400 };

/* Start with all zeros. */
typedef struct name_list {
    size_t length;
    bool full; /* the text ends in ".." */
    char text[NAME_LIST_TEXT];
} name_list;

void name_list_add(name_list *names, const char *name);

/* name_list_print() - the text, or "none". */
const char *name_list_print(const name_list *names);

#endif
