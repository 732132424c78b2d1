#include "prep/export/head_text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

enum { LEAST = 4096, LINE = 1024 };

/* Make room for `size` more bytes and a NUL. */
static char *reserve(head_text *h, size_t size) {
    if (h->st != ST_OK)
        return NULL;
    if (h->size + size >= h->room) {
        const size_t room = 2 * h->room + size + LEAST;
        char *text = mem_alloc(h->m, room);
        if (!text) {
            h->st = ST_NOMEM;
            return NULL;
        }
        if (h->size > 0)
            memcpy(text, h->text, h->size);
        mem_free(h->m, h->text);
        h->text = text;
        h->room = room;
    }
    return h->text + h->size;
}

void head_text_bytes(head_text *h, const void *bytes, size_t size) {
    char *to = reserve(h, size);
    if (!to)
        return;
    memcpy(to, bytes, size);
    to[size] = 0;
    h->size += size;
}

void head_text_add(head_text *h, const char *fmt, ...) {
    char line[LINE];
    va_list args;
    va_start(args, fmt);
    const int size = vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    assert(size >= 0 && size < LINE);
    head_text_bytes(h, line, (size_t)size);
}

void head_text_number(head_text *h, double value) {
    char number[NUM_TEXT_MAX];
    head_text_add(h, "%s", num_print(value, number));
}

static const char *entity_of(char c) {
    switch (c) {
    case '&': return "&amp;";
    case '<': return "&lt;";
    case '>': return "&gt;";
    case '"': return "&quot;";
    default: return NULL;
    }
}

void head_text_xml(head_text *h, const char *text) {
    for (; *text; text++) {
        const char *entity = entity_of(*text);
        head_text_bytes(h, entity ? entity : text, entity ? strlen(entity) : 1);
    }
}

void head_text_release(head_text *h) {
    mem_free(h->m, h->text);
    *h = (head_text){.m = h->m};
}
