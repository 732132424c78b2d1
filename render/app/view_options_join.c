/* view_options_join.c - the tables of options that verbs share, joined with a verb's own. */
#include <assert.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "render/app/view_options.h"

/* Returns whether a verb has its own option of this name, which hides the view's. */
static bool has_own(const struct argp_option *own, const char *name) {
    for (; name && (own->name || own->doc); own++)
        if (own->name && strcmp(own->name, name) == 0)
            return true;
    return false;
}

static int append_table(struct argp_option out[VIEW_OPTIONS_ROOM], int n,
                        const struct argp_option *table, const struct argp_option *own,
                        const char *basic) {
    for (const struct argp_option *o = table; o->name || o->doc; o++) {
        assert(n < VIEW_OPTIONS_ROOM - 1);
        if (has_own(own, o->name))
            continue;
        out[n] = *o;
        out[n++].flags |= cli_options_listed(basic, o->name) ? CLI_BASIC : 0;
    }
    return n;
}

void view_options_join(struct argp_option out[VIEW_OPTIONS_ROOM], const struct argp_option *own,
                       bool media, const char *basic) {
    int n = 0;
    for (const struct argp_option *o = own; o->name || o->doc; o++)
        out[n++] = *o;
    n = append_table(out, n, view_options_table, own, basic);
    if (media)
        n = append_table(out, n, medium_options_table, own, basic);
    out[n] = (struct argp_option){0};
}
