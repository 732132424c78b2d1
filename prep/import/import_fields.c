#include "prep/import/import_fields.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/mesh/mesh_choice.h"

status import_fields_add(import_fields *x, import_owner owner, const char *name) {
    struct import_names *all = &x->all[owner];
    if (all->count == MESH_STREAM_FIELDS_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: more than %d fields %s", x->path,
                               MESH_STREAM_FIELDS_MAX, x->of[owner]);
    status st = mem_grow(x->m, &all->names, sizeof *all->names, all->count, 16, &all->room);
    if (st == ST_OK)
        text_name(all->names[all->count++], sizeof *all->names, name);
    return st;
}

/* Find a field by its name; NULL: the first. Returns the owner's count if there is none. */
static uint32_t find_field(const import_fields *x, import_owner owner, const char *name) {
    const struct import_names *all = &x->all[owner];
    uint32_t i = 0;
    while (name && i < all->count && !text_same_name(name, all->names[i], sizeof *all->names))
        i++;
    return i;
}

bool import_fields_has(const import_fields *x, import_owner owner, const char *name) {
    return find_field(x, owner, name) < x->all[owner].count;
}

/* ---- taking ---- */

static status no_such(const import_fields *x, const char *name) {
    const mesh_hints asked = {.field = name, .cells_to_points = x->owner == IMPORT_CELLS};
    name_list there[IMPORT_OWNERS] = {{0}, {0}};
    for (int o = 0; o < IMPORT_OWNERS; o++)
        for (size_t i = 0; i < x->all[o].count; i++)
            name_list_add(&there[o], x->all[o].names[i]);
    return mesh_choice_missing(x->path, &asked, &there[IMPORT_POINTS], &there[IMPORT_CELLS]);
}

static status take_one(import_fields *x, const char *name) {
    const uint32_t i = find_field(x, x->owner, name);
    if (i == x->all[x->owner].count)
        return no_such(x, name);
    for (uint32_t k = 0; k < x->count; k++)
        if (x->taken[k] == i)
            return status_describe(ST_USAGE, "--field %s: each field is taken once", name);
    x->taken[x->count++] = i;
    return ST_OK;
}

status import_fields_take(import_fields *x, const import_request *q) {
    const char *const first[1] = {NULL};
    const uint32_t count = q->field_count ? q->field_count : 1;
    const char *const *fields = q->field_count ? q->fields : first;
    x->taken = mem_array(x->m, count, sizeof *x->taken);
    x->further = mem_array(x->m, count, sizeof *x->further);
    x->owner = q->cells_to_points ? IMPORT_CELLS : IMPORT_POINTS;
    x->step = q->step;
    status st = x->taken && x->further ? ST_OK : ST_NOMEM;
    if (st == ST_OK && x->steps == 0 && q->field_count == 0 && q->step == 0)
        return ST_OK; /* there are no values of it yet */
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = take_one(x, fields[i]);
    for (uint32_t k = 1; k < x->count; k++)
        x->further[k - 1] = import_fields_taken(x, k);
    if (st == ST_OK && (x->count > 0 || q->step > 0) && q->step >= x->steps)
        st = status_describe(ST_USAGE, "%s: no step %u: there are %llu, counted from 0", x->path,
                             q->step, (unsigned long long)x->steps);
    return st;
}

const char *import_fields_taken(const import_fields *x, uint32_t k) {
    return x->all[x->owner].names[x->taken[k]];
}

void import_fields_describe(const import_fields *x, mesh_stream_header *h) {
    if (x->count == 0)
        return;
    strcpy(h->field, import_fields_taken(x, 0));
    h->fields = x->further;
    h->field_count = x->count - 1;
}

/* ---- listing ---- */

static status list_one(const import_fields *x, import_owner owner, uint32_t i, uint64_t points,
                       const import_list *to) {
    import_item item = {.name = x->all[owner].names[i],
                        .type = x->of[owner],
                        .shape = {points, 1, 1, x->steps},
                        .of_cells = owner == IMPORT_CELLS};
    for (uint32_t k = 0; k < x->count; k++)
        item.taken = item.taken || (x->owner == owner && x->taken[k] == i);
    return to->take(to->ctx, &item);
}

status import_fields_list(import_fields *x, const import_request *q, const char *title,
                          uint64_t points, const import_list *to) {
    status st = ST_OK;
    if (q->field_count > 0 || x->all[q->cells_to_points ? IMPORT_CELLS : IMPORT_POINTS].count > 0)
        st = import_fields_take(x, q);
    if (st == ST_OK && to->about)
        st = to->about(to->ctx, title, x->steps, x->times);
    for (int o = 0; o < IMPORT_OWNERS; o++)
        for (uint32_t i = 0; i < x->all[o].count && st == ST_OK; i++)
            st = list_one(x, (import_owner)o, i, points, to);
    return st;
}

void import_fields_release(import_fields *x) {
    if (!x->m)
        return;
    for (int o = 0; o < IMPORT_OWNERS; o++)
        mem_free(x->m, x->all[o].names);
    mem_free(x->m, x->times);
    mem_free(x->m, x->taken);
    mem_free(x->m, x->further);
}
