/* import_hint.h - commands that messages of importers name, as they can be typed.
 */
#ifndef PREP_IMPORT_IMPORT_HINT_H
#define PREP_IMPORT_IMPORT_HINT_H

#include "prep/import/importer.h"

enum { IMPORT_HINT_MAX = 600 };

/* import_hint_list() - "leafcast import-vdb F.vdb --list", into text, which is returned. Of several
 * paths as many as there is room for. */
const char *import_hint_list(const import_request *q, char text[IMPORT_HINT_MAX]);

#endif
