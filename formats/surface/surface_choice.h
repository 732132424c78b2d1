/* surface_choice.h - the fields of a surface, and which of them are taken.
 *
 * A reader adds the fields that its header names. Offered first, and so taken unasked, are scalars
 * of the points, then scalars of the faces, then colours; vectors and the like come last, and are
 * taken if asked for. --cells-to-points leaves the faces' own, without colours, which have no mean.
 */
#ifndef FORMATS_SURFACE_SURFACE_CHOICE_H
#define FORMATS_SURFACE_SURFACE_CHOICE_H

#include "formats/mesh/mesh_reader.h"

typedef struct surface_field {
    char name[MESH_NAME_MAX + 1];
    uint32_t components; /* of a colour 1: surface_colour.h */
    bool of_faces, colour;
    bool aside;  /* such as normals: not taken unasked */
    uint32_t at; /* the reader's own number of it */
} surface_field;

/* Begin with source set. */
typedef struct surface_choice {
    const mesh_source *source;
    surface_field *fields;
    size_t count, room;
    uint32_t *taken; /* fields, by number */
    uint32_t taken_count;
} surface_choice;

/* surface_choice_add() - add a field; one that is there already is not added again. */
CHECKED status surface_choice_add(surface_choice *c, const surface_field *field);
void surface_choice_release(surface_choice *c);

/* mesh_reader.take() and .fields(), where the reader's state begins with its choice. */
CHECKED status surface_choice_take(void *state, const char *const *names, uint32_t count);
void surface_choice_fields(const void *state, mesh_field_taker *take, void *ctx);

/* surface_choice_taken() - returns the k-th field that is taken.
 * surface_choice_apart() - returns whether faces get points of their own: one of their fields is
 * taken, not averaged. */
static inline const surface_field *surface_choice_taken(const surface_choice *c, uint32_t k) {
    return &c->fields[c->taken[k]];
}
bool surface_choice_apart(const surface_choice *c);

#endif
