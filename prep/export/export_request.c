#include "prep/export/export_request.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"

enum { ALL_MAX = 1024 };

bool export_request_to_stdout(const export_request *a) {
    return strcmp(a->common.output, "-") == 0;
}

bool export_request_is_sequence(const export_request *a) {
    return a->samples && a->samples->slices && strchr(a->common.output, '%');
}

bool export_request_is_folder(const export_request *a) {
    return a->samples && a->samples->folder;
}

status export_request_field(const leaf_file *f, const char *name, uint32_t *index) {
    for (*index = 0; *index < f->header.fields; ++*index)
        if (strcmp(f->names[*index], name) == 0)
            return ST_OK;
    return status_describe(ST_USAGE, "--field %s: there is none; the first is %s", name,
                           f->names[0]);
}

status export_request_step(const export_request *a, const leaf_file *f) {
    if (a->step < f->header.steps)
        return ST_OK;
    return status_describe(ST_USAGE, "--step %u: there are %u steps, from 0 on", a->step,
                           f->header.steps);
}

/* Returns whether one file of the format holds several fields. */
static bool takes_all(const export_request *a) {
    return a->samples ? a->samples->fields : a->pieces->solid || (a->given && !a->pieces->loose);
}

/* The fields that are named, or all, or the first. fields: room for all of them. */
static status choose_fields(const export_request *a, const leaf_file *f, uint32_t *fields,
                            uint32_t *count) {
    status st = ST_OK;
    *count = a->field_count ? a->field_count : takes_all(a) ? f->header.fields : 1;
    if (*count > 1 && !takes_all(a))
        return status_describe(ST_USAGE, "--field: %s are of one field",
                               a->samples ? "samples" : "surfaces");
    if (*count > ALL_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %u fields: more than %d are not exported at once, "
                               "--field says which",
                               a->common.input, *count, ALL_MAX);
    for (uint32_t i = 0; i < *count && st == ST_OK; i++) {
        fields[i] = i;
        if (a->field_count)
            st = export_request_field(f, a->fields[i], &fields[i]);
    }
    return st;
}

/* Make names that VTK files can have: unique and not empty. */
static void name_fields(const leaf_file *f, const uint32_t *fields, uint32_t count,
                        char (*names)[80], const char **list) {
    for (uint32_t i = 0; i < count; i++) {
        char own[64];
        text_name(own, sizeof own, f->names[fields[i]]);
        snprintf(names[i], sizeof names[i], "%s", own[0] ? own : "value");
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(names[k], names[i]) == 0)
                snprintf(names[i], sizeof names[i], "%s (field %u)", own[0] ? own : "value",
                         fields[i]);
        list[i] = names[i];
    }
}

/* The sets of one field at all steps. */
static status list_steps(mem *m, const leaf_file *f, export_fields *l) {
    mem_free(m, l->sets);
    l->sets = mem_array(m, f->header.steps, sizeof *l->sets);
    if (!l->sets)
        return ST_NOMEM;
    l->count = f->header.steps;
    for (uint32_t i = 0; i < l->count; i++)
        l->sets[i] = leaf_layout_set(&f->layout, l->fields[0], i);
    return ST_OK;
}

status export_request_fields(const export_request *a, mem *m, const leaf_file *f,
                             export_fields *l) {
    const uint32_t most = f->header.fields + a->field_count;
    *l = (export_fields){.fields = mem_array(m, most, sizeof *l->fields),
                         .sets = mem_array(m, most, sizeof *l->sets),
                         .texts = mem_array(m, most, sizeof *l->texts),
                         .names = mem_array(m, most, sizeof *l->names)};
    status st = l->fields && l->sets && l->texts && l->names ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = export_request_step(a, f);
    if (st == ST_OK)
        st = choose_fields(a, f, l->fields, &l->count);
    if (st == ST_OK)
        name_fields(f, l->fields, l->count, l->texts, l->names);
    for (uint32_t i = 0; i < l->count && st == ST_OK; i++)
        l->sets[i] = leaf_layout_set(&f->layout, l->fields[i], a->step);
    return st == ST_OK && a->all_steps ? list_steps(m, f, l) : st;
}

void export_request_release(mem *m, export_fields *l) {
    mem_free(m, l->fields);
    mem_free(m, l->sets);
    mem_free(m, l->texts);
    mem_free(m, l->names);
}
