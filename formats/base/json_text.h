/* json_text.h - what it means that jansson gave nothing. */
#ifndef FORMATS_BASE_JSON_TEXT_H
#define FORMATS_BASE_JSON_TEXT_H

#include <jansson.h>

#include "formats/base/status.h"

/* json_text_status() - behind a json_load..() that returned NULL: ST_NOMEM where memory ran out,
 * which error->text then says, else `malformed`. */
CHECKED status json_text_status(json_error_t *error, status malformed);

#endif
