#include "render/view/view_message.h"

#include <stdlib.h>
#include <string.h>

#include "formats/base/status.h"
#include "formats/base/text.h"

view_message *view_message_new(mem *m, size_t room) {
    view_message *made = mem_alloc(m, sizeof *made + VIEW_MESSAGE_BEFORE + room);
    if (!made)
        return NULL;
    *made = (view_message){.m = m, .room = room};
    made->bytes = (unsigned char *)(made + 1) + VIEW_MESSAGE_BEFORE;
    return made;
}

void view_message_free(view_message *of) {
    if (of)
        mem_free(of->m, of);
}

status view_message_put(void *ctx, const void *data, size_t size) {
    view_message **at = ctx, *now = *at;
    if (now->room - now->size < size) {
        view_message *more = view_message_new(now->m, 2 * (now->size + size));
        if (!more)
            return ST_NOMEM;
        unsigned char *const bytes = more->bytes;
        const size_t room = more->room;
        memcpy(bytes, now->bytes, now->size);
        *more = *now;
        more->bytes = bytes;
        more->room = room;
        view_message_free(now);
        *at = now = more;
    }
    memcpy(now->bytes + now->size, data, size);
    now->size += size;
    return ST_OK;
}

view_message *view_message_json(mem *m, json_t *object) {
    char *text = object ? json_dumps(object, JSON_COMPACT) : NULL;
    view_message *made = text ? view_message_new(m, strlen(text)) : NULL;
    if (made) {
        made->size = strlen(text);
        memcpy(made->bytes, text, made->size);
    }
    free(text);
    json_decref(object);
    return made;
}

const char *view_message_why(void) {
    static _Thread_local char printable[STATUS_TEXT_MAX];
    const char *name = text_printable(printable, sizeof printable, status_text());
    /* Skip quoted text: that comes from the page itself. */
    for (const char *c = name; *c && *c != ':' && *c != '"'; c++)
        if (*c == '/')
            name = c + 1;
    return name;
}

status view_message_head(view_message **to, json_t *header) {
    view_message *text = view_message_json((*to)->m, header);
    if (!text)
        return ST_NOMEM;
    const uint32_t n = (uint32_t)text->size;
    const uint8_t length[4] = {(uint8_t)n, (uint8_t)(n >> 8), (uint8_t)(n >> 16),
                               (uint8_t)(n >> 24)};
    status st = view_message_put(to, length, sizeof length);
    if (st == ST_OK)
        st = view_message_put(to, text->bytes, text->size);
    view_message_free(text);
    return st;
}

void view_queue_push(view_queue *q, view_message *message) {
    message->next = NULL;
    if (q->last)
        q->last->next = message;
    else
        q->first = message;
    q->last = message;
    q->count++;
}

view_message *view_queue_pop(view_queue *q) {
    view_message *message = q->first;
    if (!message)
        return NULL;
    q->first = message->next;
    if (!q->first)
        q->last = NULL;
    q->count--;
    return message;
}

void view_queue_clear(view_queue *q) {
    view_message *message;
    while ((message = view_queue_pop(q)))
        view_message_free(message);
}
