/* view_message.h - what goes to a page, and queues of it. */
#ifndef RENDER_VIEW_VIEW_MESSAGE_H
#define RENDER_VIEW_VIEW_MESSAGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

enum { VIEW_MESSAGE_BEFORE = 64 }; /* bytes before the first that whoever sends it may write to */

typedef struct view_message {
    struct view_message *next;
    mem *m;
    bool binary;     /* a picture, else text */
    bool slice;      /* a picture, and not the view's */
    bool failed;     /* text that says why something could not be done */
    uint64_t number; /* of a picture: of its view */
    int part;
    size_t size, room; /* bytes there, and how many may be */
    unsigned char *bytes;
} view_message;

/* view_message_new() - without bytes yet, with room for so many. NULL: no memory. */
view_message *view_message_new(mem *m, size_t room);
void view_message_free(view_message *of); /* NULL is fine */

/* view_message_put() - bytes behind those that are there, as a byte_sink's: ctx is the address of
 * the pointer to the message, which may move. ST_NOMEM. */
CHECKED status view_message_put(void *ctx, const void *data, size_t size);

/* view_message_json() - a JSON object as text, whose reference it takes. NULL: no memory. */
view_message *view_message_json(mem *m, json_t *object);

/* view_message_why() - status_text() for a page, which need not know folders: of a file that the
 * text begins with, its name alone. */
const char *view_message_why(void);

/* view_message_head() - the JSON before a picture, whose reference it takes, and its length before
 * that. The message may move. ST_NOMEM. */
CHECKED status view_message_head(view_message **to, json_t *header);

/* A queue: first in, first out. */
typedef struct view_queue {
    view_message *first, *last;
    int count;
} view_queue;

void view_queue_push(view_queue *q, view_message *message);
view_message *view_queue_pop(view_queue *q); /* NULL: empty */
void view_queue_clear(view_queue *q);

#endif
