/* view_talk.h - what one page and the server say to each other, without the network: README.md.
 *
 * For the server's thread alone. A page is hostile until it is checked.
 */
#ifndef RENDER_VIEW_VIEW_TALK_H
#define RENDER_VIEW_VIEW_TALK_H

#include "render/view/view_draw.h"
#include "render/view/view_volume.h"

enum { VIEW_HEARD_MAX = 64 << 10 }; /* bytes of a message from a page */

typedef struct view_talk view_talk;

/* view_talk_open() - a page is there: the message about the first volume is the first that waits.
 * NULL: no seat, or no memory. files, machine and life must live as long. view_talk_close() - NULL
 * is fine. */
view_talk *view_talk_open(mem *m, view_draw *draw, const view_file *files, int count,
                          const view_machine *machine, view_life *life);
void view_talk_close(view_talk *t);

typedef enum view_talk_result {
    VIEW_TALK_FINE, /* what was wrong with a message is answered */
    VIEW_TALK_TOO_LONG,
    VIEW_TALK_TOO_FAST /* or no memory */
} view_talk_result;

/* view_talk_hear() - a piece of a message; last: it ends there. Other results end the talk. */
view_talk_result view_talk_hear(view_talk *t, const void *bytes, size_t size, bool last);

/* view_talk_next() - the next message for the page, the caller's; NULL: none yet. view_talk_any() -
 * whether there is one. */
view_message *view_talk_next(view_talk *t);
bool view_talk_any(view_talk *t);

/* view_talk_file() - the wish for a picture as a file: a state's text, "WxH", the number of the
 * file
 * ("": 0). ST_USAGE. */
CHECKED status view_talk_file(mem *m, const view_file *files, int count, const char *state,
                              const char *size, const char *file, view_wish *wish);

#endif
