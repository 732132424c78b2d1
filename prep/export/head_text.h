/* head_text.h - builds the head of a file in memory before it is written.
 */
#ifndef PREP_EXPORT_HEAD_TEXT_H
#define PREP_EXPORT_HEAD_TEXT_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* Start with {.m = budget}. */
typedef struct head_text {
    mem *m;
    char *text; /* size bytes and a NUL that is not counted; NULL: empty */
    size_t size, room;
    status st; /* the first failure while adding */
} head_text;

/* head_text_add() - add text as printf() does. head_text_number() - a double's shortest decimal.
 * head_text_xml() - text escaped for an XML attribute. head_text_bytes() - raw bytes. */
void head_text_add(head_text *h, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
void head_text_number(head_text *h, double value);
void head_text_xml(head_text *h, const char *text);
void head_text_bytes(head_text *h, const void *bytes, size_t size);

void head_text_release(head_text *h);

#endif
