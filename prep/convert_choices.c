#include "prep/convert_choices.h"

#include <string.h>

#include "formats/base/text.h"

/* Returns whether a field goes into the file: named on the command line, one of all, or the
 * reader's default. */
static bool is_wanted(const convert_sets *s, const char *name, bool taken) {
    for (int i = 0; i < s->count; i++)
        if (text_same_name(s->asked[i], name, sizeof s->kept[0]))
            return true;
    return s->all_fields || (s->count == 0 && taken);
}

static void note_components(const convert_choices *c, const slice_field *f) {
    const char *quote = *f->name ? "\"" : "", *gap = *f->name ? " " : "";
    if (f->components < 2 || c->component)
        return;
    if (f->component)
        cli_note(c->common, 1,
                 "%s: %s%s%s%sof %u components number %u is taken; --component N takes another",
                 c->common->input, quote, f->name, quote, gap, f->components, f->component);
    else
        cli_note(c->common, 1,
                 "%s: %s%s%s%sof %u components their %s is taken; --component N takes one",
                 c->common->input, quote, f->name, quote, gap, f->components,
                 f->colours ? "luminance" : "magnitude");
}

static void note_steps(const convert_choices *c, const slice_field *f) {
    if (f->steps > 1 && !c->step)
        cli_note(c->common, 1, "%s: of %u steps the first is taken, 0; --step N takes another%s",
                 c->common->input, f->steps,
                 c->common->input_count > 1 ? "" : ", --steps all takes all");
}

void convert_choices_take(convert_choices *c, const slice_field *f) {
    const bool wanted = is_wanted(c->sets, f->name, f->taken);
    c->count++;
    name_list_add(wanted ? &c->taken : &c->others, f->name);
    if (wanted)
        note_components(c, f);
    if (f->taken)
        note_steps(c, f);
}

void convert_choices_note(const convert_choices *c) {
    if (c->count < 2 || c->sets->count > 0 || c->sets->all_fields)
        return;
    if (c->taken.text[0])
        cli_note(c->common, 1, "%s: of %u fields %s is taken; --field NAME takes another: %s",
                 c->common->input, c->count, name_list_print(&c->taken),
                 name_list_print(&c->others));
    else
        cli_note(c->common, 1,
                 "%s: its %u channels, %s, are taken together, as their luminance; "
                 "--field NAME takes one",
                 c->common->input, c->count, name_list_print(&c->others));
}
