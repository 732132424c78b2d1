/* view_life.h - one life of the process that draws, and what it is drawing.
 *
 * The viewer is two processes: one draws and serves, the other outlives it (view_supervisor.h). The
 * current work of the first is noted in memory that both share, so that the cause of a crash can be
 * reported.
 */
#ifndef RENDER_VIEW_VIEW_LIFE_H
#define RENDER_VIEW_VIEW_LIFE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

enum { VIEW_TOLD_MAX = 1024 };

/* What a client has asked for, cut if it is too long. */
typedef struct view_told {
    uint64_t talk; /* number of the client; 0: one without a socket */
    char text[VIEW_TOLD_MAX];
} view_told;

typedef enum view_doing_what {
    VIEW_DOING_NOTHING,
    VIEW_DOING_VIEW,
    VIEW_DOING_SLICE,
    VIEW_DOING_PICK,
    VIEW_DOING_FILE
} view_doing_what;

/* What is being drawn. */
typedef struct view_doing {
    view_doing_what what;
    uint64_t number; /* number of the view or the slice */
    view_told told;
} view_doing;

typedef enum view_stage {
    VIEW_BEGINS,
    VIEW_SERVES,   /* it serves pages */
    VIEW_ANNOUNCED /* the address is printed, too */
} view_stage;

typedef struct view_life {
    uint32_t number;   /* 0: the first life */
    int signal;        /* signal that ended the life before; 0: this is the first */
    view_doing last;   /* what that life was doing */
    view_stage before; /* the furthest stage of all lives before */
    view_doing *now;   /* shared with the supervisor */
    int channel;       /* to the supervisor; it ends when the supervisor does */
    uint32_t clients;  /* number of clients so far */
} view_life;

/* view_told_keep() - keep a client's text, cut if it is too long. */
void view_told_keep(view_told *to, uint64_t talk, const char *text, size_t size);

/* view_doing_begin(), view_doing_end() - note what is being drawn; for the drawing thread. */
void view_doing_begin(view_doing *now, view_doing_what what, const view_told *told,
                      uint64_t number);
void view_doing_end(view_doing *now);

/* view_doing_name() - returns "view", "slice", "pick", "file" or "nothing". */
const char *view_doing_name(view_doing_what what);

/* view_life_client() - returns a number for a client, unique over all lives. */
uint64_t view_life_client(view_life *life);

/* view_life_json() - returns how the life before ended, for pages; NULL: there was none, or no
 * memory. */
json_t *view_life_json(const view_life *life);

/* view_life_tell() - tell the supervisor the stage of this life. From VIEW_SERVES on, a crash is
 * followed by another life. view_life_alone() - returns whether the supervisor is gone. */
void view_life_tell(const view_life *life, view_stage stage);
bool view_life_alone(const view_life *life);

#endif
