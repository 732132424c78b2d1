/* import_hint.h - commands for importers' messages, in a form that can be typed.
 */
#ifndef PREP_IMPORT_IMPORT_HINT_H
#define PREP_IMPORT_IMPORT_HINT_H

#include "prep/import/importer.h"

enum { IMPORT_HINT_MAX = 600 };

/* import_hint_list() - write a command such as "leafcast import-vdb F.vdb --list" to text, and
 * return it. Of several paths, it names as many as fit. */
const char *import_hint_list(const import_request *q, char text[IMPORT_HINT_MAX]);

#endif
