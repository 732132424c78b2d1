/* view_talk.h - the messages between one page and the server, without the network; see README.md.
 *
 * For the server's thread alone. Messages of a page are not trusted until they are checked.
 */
#ifndef RENDER_VIEW_VIEW_TALK_H
#define RENDER_VIEW_VIEW_TALK_H

#include "render/view/view_draw.h"
#include "render/view/view_volume.h"

enum { VIEW_HEARD_MAX = 64 << 10 }; /* bytes of a message from a page */

typedef struct view_talk view_talk;

/* view_talk_open() - begin for a new page; the first message that waits describes the first volume.
 * NULL: no seat, or no memory. files, scene (NULL: none), machine and life must live as long as the
 * talk.
 * view_talk_close() - NULL is allowed. */
view_talk *view_talk_open(mem *m, view_draw *draw, const view_file *files, int count,
                          const view_scene *scene, const view_machine *machine, view_life *life);
void view_talk_close(view_talk *t);

typedef enum view_talk_result {
    VIEW_TALK_FINE, /* an error in a message has been answered */
    VIEW_TALK_TOO_LONG,
    VIEW_TALK_TOO_FAST /* too many messages at once, or no memory */
} view_talk_result;

/* view_talk_receive() - take a piece of a message; last: it ends there. Results but VIEW_TALK_FINE
 * end the talk. */
view_talk_result view_talk_receive(view_talk *t, const void *bytes, size_t size, bool last);

/* view_talk_follow() - if the file that is shown has other steps than the page was told of, or
 * takes in no further ones, tell it. Returns whether anything was told. */
bool view_talk_follow(view_talk *t);

/* view_talk_next() - returns the next message for the page, which the caller owns; NULL: none yet.
 * view_talk_any() - returns whether there is one. */
view_message *view_talk_next(view_talk *t);
bool view_talk_any(view_talk *t);

/* view_talk_file() - make the wish for a picture as a file, from a state's text, a size "WxH" and
 * the number of the file ("": 0). The wish is to be released (view_wish_release()). ST_USAGE. */
CHECKED status view_talk_file(mem *m, const view_file *files, int count, const view_scene *scene,
                              const char *state, const char *size, const char *file,
                              view_wish *wish);

#endif
