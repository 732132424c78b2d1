#include "formats/surface/surface_choice.h"

#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"
#include "formats/mesh/mesh_choice.h"

enum { RANKS = 6, ASIDE = 4, NOT_OFFERED = RANKS };

/* Returns a field's place in what is offered. */
static int rank_of(const surface_choice *c, const surface_field *f) {
    const int aside = f->aside || f->components > 1;
    if (c->source->hints.cells_to_points)
        return f->of_faces && !f->colour ? ASIDE * aside : NOT_OFFERED;
    return ASIDE * aside + 2 * f->colour + f->of_faces;
}

status surface_choice_add(surface_choice *c, const surface_field *field) {
    for (size_t i = 0; i < c->count; i++)
        if (c->fields[i].of_faces == field->of_faces &&
            text_same_name(c->fields[i].name, field->name, sizeof field->name))
            return ST_OK;
    status st = mem_grow(c->source->m, &c->fields, sizeof *c->fields, c->count, 8, &c->room);
    if (st == ST_OK)
        c->fields[c->count++] = *field;
    return st;
}

void surface_choice_release(surface_choice *c) {
    mem_free(c->source->m, c->fields);
    mem_free(c->source->m, c->taken);
}

static bool fits(const surface_choice *c, const surface_field *f, const char *name) {
    return name ? text_same_name(f->name, name, sizeof f->name)
                : f->components >= (uint32_t)c->source->hints.component;
}

/* Find a field by its name; NULL: the first that is not aside, or that has the hints' component.
 * Returns the number of fields where there is none. */
static size_t find(const surface_choice *c, const char *name) {
    const int ranks = name || c->source->hints.component > 0 ? RANKS : ASIDE;
    for (int rank = 0; rank < ranks; rank++)
        for (size_t i = 0; i < c->count; i++)
            if (rank_of(c, &c->fields[i]) == rank && fits(c, &c->fields[i], name))
                return i;
    return c->count;
}

static status missing(const surface_choice *c, const char *name) {
    const mesh_hints *hints = &c->source->hints;
    name_list names = {0};
    for (size_t i = 0; i < c->count; i++)
        if (rank_of(c, &c->fields[i]) < RANKS)
            name_list_add(&names, c->fields[i].name);
    if (!name && !hints->cells_to_points && hints->component == 0)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: no field %s%s%s of the surface%s, which %s %s",
                           byte_stream_name(c->source->data), name ? "\"" : "",
                           name               ? name
                           : hints->component ? "of several components"
                                              : "of numbers",
                           name ? "\"" : "", hints->cells_to_points ? "'s faces" : "",
                           hints->cells_to_points ? "have" : "has", name_list_print(&names));
}

static status take_one(surface_choice *c, const char *name) {
    const size_t i = find(c, name);
    if (i == c->count)
        return missing(c, name);
    c->taken[c->taken_count++] = (uint32_t)i;
    return mesh_choice_component(byte_stream_name(c->source->data), &c->source->hints,
                                 c->fields[i].name, (int)c->fields[i].components);
}

status surface_choice_take(void *state, const char *const *names, uint32_t count) {
    surface_choice *c = state;
    mem_free(c->source->m, c->taken);
    c->taken_count = 0;
    c->taken = mem_array(c->source->m, count, sizeof *c->taken);
    status st = c->taken ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        st = take_one(c, names[i]);
    return st;
}

void surface_choice_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const surface_choice *c = state;
    for (int rank = 0; rank < RANKS; rank++)
        for (size_t i = 0; i < c->count; i++)
            if (rank_of(c, &c->fields[i]) == rank)
                take(ctx, c->fields[i].name,
                     (rank < ASIDE ? 1 : -1) * (int)c->fields[i].components);
}

bool surface_choice_apart(const surface_choice *c) {
    for (uint32_t k = 0; k < c->taken_count; k++)
        if (surface_choice_taken(c, k)->of_faces && !c->source->hints.cells_to_points)
            return true;
    return false;
}
