#include "formats/vtk/vtk_fields.h"

#include <string.h>

#include "formats/base/text.h"

status vtk_fields_add(vtk_fields *f, mem *m, vtk_owner owner, const char *name,
                      const vtk_array *field) {
    size_t *count = &f->count[owner];
    status st = mem_grow(m, &f->items[owner], sizeof *field, *count, 8, &f->room[owner]);
    char *kept = st == ST_OK ? mem_copy_text(m, name) : NULL;
    if (!kept)
        return ST_NOMEM;
    vtk_array *a = &f->items[owner][(*count)++];
    *a = *field;
    a->name = kept;
    return ST_OK;
}

bool vtk_fields_is_one(const vtk_array *a) {
    return vtk_array_width(a->type) > 0 && strcmp(a->name, VTK_GHOST_TYPE) != 0 &&
           strcmp(a->name, VTK_GHOST_LEVELS) != 0;
}

const vtk_array *vtk_fields_find(const vtk_fields *f, vtk_owner owner, const char *name) {
    for (size_t i = 0; i < f->count[owner]; i++) {
        const vtk_array *a = &f->items[owner][i];
        if (name ? text_same_name(a->name, name, VTK_NAME_MAX) : vtk_fields_is_one(a))
            return a;
    }
    return NULL;
}

const vtk_array *vtk_fields_ghosts(const vtk_fields *f) {
    for (size_t i = 0; i < f->count[VTK_OF_CELLS]; i++) {
        const vtk_array *a = &f->items[VTK_OF_CELLS][i];
        if (strcmp(a->name, VTK_GHOST_TYPE) == 0 || strcmp(a->name, VTK_GHOST_LEVELS) == 0)
            return a;
    }
    return NULL;
}

void vtk_fields_release(vtk_fields *f, mem *m) {
    for (int o = 0; o < VTK_OWNERS; o++) {
        for (size_t i = 0; i < f->count[o]; i++)
            mem_free(m, f->items[o][i].name);
        mem_free(m, f->items[o]);
    }
}
