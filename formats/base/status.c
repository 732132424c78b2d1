#include "formats/base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char description[STATUS_TEXT_MAX];

status status_describe(status st, const char *fmt, ...) {
    /* Format into another buffer first: an argument may be the old description itself. */
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    memcpy(description, text, sizeof description);
    return st;
}

const char *status_text(void) {
    return description;
}

int status_exit_code(status st) {
    switch (st) {
    case ST_OK: return 0;
    case ST_USAGE: return 2;
    case ST_CORRUPT:
    case ST_UNSUPPORTED: return 3;
    case ST_NOMEM:
    case ST_NOSPACE: return 4;
    default: return 1;
    }
}

void status_note_take(status_note *note, status st) {
    note->st = st;
    memcpy(note->text, description, sizeof note->text);
}

status status_note_raise(const status_note *note) {
    memcpy(description, note->text, sizeof description);
    return note->st;
}
