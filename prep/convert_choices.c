#include "prep/convert_choices.h"

#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"

typedef struct choices {
    const cli_common *common;
    const convert_sets *sets;
    uint32_t component; /* --component; 0: not given */
    bool step;          /* --step or --steps is given */
    uint32_t steps;     /* steps of a mesh */
    name_list taken, others;
    uint32_t count; /* fields in both lists */
} choices;

static bool speaks(const cli_common *common) {
    return common->verbosity > 0;
}

/* Returns whether a field goes into the file: named on the command line, one of all, or the
 * reader's default. */
static bool is_wanted(const convert_sets *s, const char *name, bool taken) {
    for (int i = 0; i < s->count; i++)
        if (text_same_name(s->asked[i], name, sizeof s->kept[0]))
            return true;
    return s->all_fields || (s->count == 0 && taken);
}

static void note_components(const choices *c, const slice_field *f) {
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

static void note_steps(const choices *c, const slice_field *f) {
    if (f->steps > 1 && !c->step)
        cli_note(c->common, 1, "%s: of %u steps the first is taken, 0; --step N takes another%s",
                 c->common->input, f->steps,
                 c->common->input_count > 1 ? "" : ", --steps all takes all");
}

static status take_field(void *ctx, const slice_field *f) {
    choices *c = ctx;
    const bool wanted = is_wanted(c->sets, f->name, f->taken);
    c->count++;
    name_list_add(wanted ? &c->taken : &c->others, f->name);
    if (wanted)
        note_components(c, f);
    if (f->taken)
        note_steps(c, f);
    return ST_OK;
}

static void note_fields(const choices *c) {
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

void convert_note_volume(const cli_common *common, const volume *v, const volume_hints *hints,
                         bool step, const convert_sets *sets) {
    choices c = {.common = common,
                 .sets = sets,
                 .component = hints->component,
                 .step = step || step_list_given(&sets->taken)};
    if (!speaks(common) || !volume_has_fields(v))
        return;
    if (volume_fields(v, &(slice_fields){take_field, &c}) == ST_OK)
        note_fields(&c);
    else
        cli_note(common, 1, "%s: what else it has cannot be listed: %s", common->input,
                 status_text());
}

/* The first array is the default. A name that comes again belongs to another piece or step: skip
 * it. */
static void take_array(void *ctx, const char *name, int components) {
    choices *c = ctx;
    const slice_field f = {.name = name,
                           .steps = c->steps,
                           .taken = c->count == 0,
                           .components = (uint32_t)components};
    name_list before = {0};
    name_list_add(&before, name);
    if (!strstr(c->taken.text, before.text) && !strstr(c->others.text, before.text))
        take_field(c, &f);
}

void convert_note_mesh(const cli_common *common, const mesh_input *x, const mesh_hints *hints,
                       bool step, const convert_sets *sets) {
    choices c = {.common = common,
                 .sets = sets,
                 .component = (uint32_t)hints->component,
                 .steps = mesh_input_steps(x),
                 .step = step || step_list_given(&sets->taken)};
    if (!speaks(common))
        return;
    mesh_input_fields(x, take_array, &c);
    note_fields(&c);
}
