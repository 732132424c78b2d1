/* view_message.h - messages to a page, and queues of them. */
#ifndef RENDER_VIEW_VIEW_MESSAGE_H
#define RENDER_VIEW_VIEW_MESSAGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

enum { VIEW_MESSAGE_BEFORE = 64 }; /* bytes in front of a message that its sender may overwrite */

typedef struct view_message {
    struct view_message *next;
    mem *m;
    bool binary;     /* a picture; else text */
    bool slice;      /* a picture of a slice, not of the view */
    bool failed;     /* text that says why a picture could not be drawn */
    uint64_t number; /* of a picture: the number of its view */
    int part;
    size_t size, room; /* bytes used and allocated */
    size_t held;       /* what a picture as a file counts for until it is sent; else 0 */
    unsigned char *bytes;
} view_message;

/* view_message_new() - returns an empty message with room for `room` bytes; NULL: no memory. */
view_message *view_message_new(mem *m, size_t room);
void view_message_free(view_message *of); /* NULL is allowed */

/* view_message_put() - append bytes to a message, as the put() of a byte_sink. ctx: the address of
 * the pointer to the message, which may move. ST_NOMEM. */
CHECKED status view_message_put(void *ctx, const void *data, size_t size);

/* view_message_json() - returns a JSON object as text; takes over the object's reference. NULL: no
 * memory. */
view_message *view_message_json(mem *m, json_t *object);

/* view_message_why() - returns status_text() for a page. A file name at its start loses its
 * folder. */
const char *view_message_why(void);

/* view_message_head() - append the JSON header of a picture, with its length in front; takes over
 * the header's reference. The message may move. ST_NOMEM. */
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
