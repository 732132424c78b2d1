/* sibling.h - where the other programs of leafcast are. */
#ifndef FORMATS_BASE_SIBLING_H
#define FORMATS_BASE_SIBLING_H

#include <stdbool.h>

enum { SIBLING_PATH = 4096 };

/* sibling_find() - the full path of a program such as "leafcast-convert": beside the running one,
 * or on PATH; false when it is nowhere. */
bool sibling_find(const char *name, char path[SIBLING_PATH]);

#endif
