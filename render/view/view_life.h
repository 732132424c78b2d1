/* view_life.h - one life of the process that draws, and what it is drawing.
 *
 * The viewer is two processes: one draws and serves, the other outlives it (view_supervisor.h).
 * What the first is at lies in memory that both see, so that a crash can be told by what caused it.
 */
#ifndef RENDER_VIEW_VIEW_LIFE_H
#define RENDER_VIEW_VIEW_LIFE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

enum { VIEW_TOLD_MAX = 1024 };

/* What a client has asked for, as far as it fits. */
typedef struct view_told {
    uint64_t talk; /* which client: view_life_json(); 0: none that has a socket */
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
    uint64_t number; /* of the view or the slice */
    view_told told;
} view_doing;

typedef enum view_stage {
    VIEW_BEGINS,
    VIEW_SERVES,   /* pages */
    VIEW_ANNOUNCED /* and the address is printed */
} view_stage;

typedef struct view_life {
    uint32_t number;   /* 0: the first */
    int signal;        /* that ended the one before; 0: this is the first */
    view_doing last;   /* what that was at */
    view_stage before; /* how far any life before has come */
    view_doing *now;   /* seen by the supervisor */
    int channel;       /* to the supervisor; at its end, that is gone */
    uint32_t clients;  /* how many there were */
} view_life;

/* view_told_keep() - the text, cut where it is too long. */
void view_told_keep(view_told *to, uint64_t talk, const char *text, size_t size);

/* view_doing_begin(), view_doing_end() - by the thread that draws. */
void view_doing_begin(view_doing *now, view_doing_what what, const view_told *told,
                      uint64_t number);
void view_doing_end(view_doing *now);

/* view_doing_name() - "view", "slice", "pick", "file" or "nothing". */
const char *view_doing_name(view_doing_what what);

/* view_life_client() - a number for a client that no other one has, in this life or another. */
uint64_t view_life_client(view_life *life);

/* view_life_json() - how the life before ended, for pages; NULL: there was none, or no memory. */
json_t *view_life_json(const view_life *life);

/* view_life_tell() - tells the supervisor how far this life has come: from VIEW_SERVES on a crash
 * is no reason to end. view_life_alone() - whether the supervisor is gone. */
void view_life_tell(const view_life *life, view_stage stage);
bool view_life_alone(const view_life *life);

#endif
