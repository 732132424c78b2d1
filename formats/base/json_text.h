/* json_text.h - tells why jansson gave nothing. */
#ifndef FORMATS_BASE_JSON_TEXT_H
#define FORMATS_BASE_JSON_TEXT_H

#include <jansson.h>

#include "formats/base/status.h"

/* json_text_status() - call it after a json_load..() that returned NULL. Returns ST_NOMEM where
 * memory ran out, and says so in error->text; else `malformed`. */
CHECKED status json_text_status(json_error_t *error, status malformed);

#endif
