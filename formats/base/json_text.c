#include "formats/base/json_text.h"

#include <stdio.h>

#include "formats/base/mem.h"

status json_text_status(json_error_t *error, status malformed) {
    enum { ROOM = 1 << 20 };
    /* A malformed text always gives a message. A failed allocation may give one, too, with the code
     * of something else. So ask also whether the system has memory now. */
    if (error->text[0] && json_error_code(error) != json_error_out_of_memory && mem_room(ROOM))
        return malformed;
    snprintf(error->text, sizeof error->text, "no memory to parse it");
    return ST_NOMEM;
}
