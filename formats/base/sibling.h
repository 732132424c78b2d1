/* sibling.h - where leafcast's other programs are. */
#ifndef FORMATS_BASE_SIBLING_H
#define FORMATS_BASE_SIBLING_H

#include <stdbool.h>

enum { SIBLING_PATH = 4096 };

/* sibling_find() - find a program such as "leafcast-convert" beside the running one, or else on
 * PATH. path: out, its path; false when it is nowhere. */
bool sibling_find(const char *name, char path[SIBLING_PATH]);

#endif
