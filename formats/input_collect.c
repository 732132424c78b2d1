#include "formats/input_collect.h"

#include <math.h>
#include <string.h>

#include "formats/base/text.h"

void input_collect_value(input_facts *x, double value) {
    if (!isfinite(value))
        x->non_finite++;
    else {
        x->range[0] = value < x->range[0] ? value : x->range[0];
        x->range[1] = value > x->range[1] ? value : x->range[1];
    }
}

/* Take the input's own name, or else the file's without the suffix. */
void input_collect_name(input_facts *x, const char *own) {
    if (*own || strcmp(x->path, "-") == 0)
        text_name(x->name, sizeof x->name, own);
    else
        text_file_name(x->name, sizeof x->name, x->path);
}

/* Returns the field of this name, adding it if needed; NULL: no room is left. */
input_field *input_collect_listed(input_facts *x, const char *name) {
    char clean[MESH_NAME_MAX + 1];
    text_name(clean, sizeof clean, name);
    const uint32_t listed =
        x->field_count < INPUT_FACTS_FIELDS ? x->field_count : INPUT_FACTS_FIELDS;
    for (uint32_t i = 0; i < listed; i++)
        if (strcmp(x->fields[i].name, clean) == 0)
            return &x->fields[i];
    x->field_count++;
    if (listed == INPUT_FACTS_FIELDS)
        return NULL;
    memcpy(x->fields[listed].name, clean, sizeof clean);
    return &x->fields[listed];
}

void input_collect_field(input_facts *x, const char *name, uint32_t components) {
    input_field *f = *name ? input_collect_listed(x, name) : NULL;
    if (f)
        f->components = components > 1 ? components : 1;
    if (f && f->steps == 0)
        f->steps = 1;
}

void input_collect_times(input_facts *x, uint32_t steps, const double *times) {
    const uint32_t listed = steps < INPUT_FACTS_TIMES ? steps : INPUT_FACTS_TIMES;
    x->timed = true;
    memcpy(x->times, times, listed * sizeof *x->times);
    x->last_time = times[steps - 1];
}
