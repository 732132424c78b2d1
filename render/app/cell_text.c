#include "render/app/cell_text.h"

cell_text cell_text_of(const leafcast *volume, uint32_t level, uint64_t number) {
    cell_text c = {.number = number};
    c.indices = leafcast_cell_indices(volume, level, number, c.index);
    return c;
}

void cell_text_print(const cell_text *c, char divider, FILE *out) {
    if (c->indices == 0)
        fprintf(out, "%llu", (unsigned long long)c->number);
    for (int a = 0; a < c->indices; a++) {
        if (a > 0)
            fputc(divider, out);
        fprintf(out, "%u", c->index[a]);
    }
}

json_t *cell_text_json(const cell_text *c) {
    if (c->indices == 0)
        return json_integer((json_int_t)c->number);
    json_t *list = json_array();
    for (int a = 0; a < c->indices; a++)
        json_array_append_new(list, json_integer(c->index[a]));
    return list;
}
