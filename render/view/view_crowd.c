#include "render/view/view_crowd.h"

#include <stddef.h>
#include <string.h>

static void remove_at(view_crowd *c, int i) {
    c->count--;
    memmove(c->who + i, c->who + i + 1, (size_t)(c->count - i) * sizeof *c->who);
}

void *view_crowd_enter(view_crowd *c, void *who) {
    void *oldest = NULL;
    if (c->count == VIEW_CROWD_MAX) {
        oldest = c->who[0];
        remove_at(c, 0);
    }
    c->who[c->count++] = who;
    return oldest;
}

void view_crowd_leave(view_crowd *c, const void *who) {
    for (int i = 0; i < c->count; i++)
        if (c->who[i] == who) {
            remove_at(c, i);
            return;
        }
}
