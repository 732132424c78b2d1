#include "render/view/view_life.h"

#include <poll.h>
#include <string.h>
#include <unistd.h>

void view_told_keep(view_told *to, uint64_t talk, const char *text, size_t size) {
    const size_t kept = size < sizeof to->text - 1 ? size : sizeof to->text - 1;
    to->talk = talk;
    memcpy(to->text, text, kept);
    to->text[kept] = 0;
}

void view_doing_begin(view_doing *now, view_doing_what what, const view_told *told,
                      uint64_t number) {
    now->number = number;
    now->told.talk = told->talk;
    memcpy(now->told.text, told->text, strlen(told->text) + 1);
    now->what = what;
}

void view_doing_end(view_doing *now) {
    now->what = VIEW_DOING_NOTHING;
}

const char *view_doing_name(view_doing_what what) {
    static const char *const names[] = {"nothing", "view", "slice", "pick", "file"};
    const size_t at = (size_t)what; /* a crash may have damaged the value */
    return names[at < sizeof names / sizeof *names ? at : 0];
}

uint64_t view_life_client(view_life *life) {
    return ((uint64_t)life->number << 32) | ++life->clients;
}

json_t *view_life_json(const view_life *life) {
    if (life->number == 0)
        return NULL;
    return json_pack("{s:I,s:i,s:s,s:s,s:I,s:I}", "life", (json_int_t)life->number, "signal",
                     life->signal, "name", strsignal(life->signal), "what",
                     view_doing_name(life->last.what), "talk", (json_int_t)life->last.told.talk,
                     "number", (json_int_t)life->last.number);
}

void view_life_tell(const view_life *life, view_stage stage) {
    const char word = (char)stage;
    /* If this fails, the supervisor is gone, and this process will end soon, too. */
    (void)!write(life->channel, &word, sizeof word);
}

bool view_life_alone(const view_life *life) {
    struct pollfd end = {.fd = life->channel, .events = POLLIN};
    return poll(&end, 1, 0) > 0;
}
