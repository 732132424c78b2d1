/* cell_text.h - say which cell it is, for people and programs: by its indices, or by its number if
 * cells have no indices. */
#ifndef RENDER_APP_CELL_TEXT_H
#define RENDER_APP_CELL_TEXT_H

#include <jansson.h>
#include <stdio.h>

#include "render/leafcast.h"

/* A cell by its number and, if indices is 3, by its place in rows, columns and slices. */
typedef struct cell_text {
    uint64_t number;
    int indices;
    uint32_t index[3];
} cell_text;

/* cell_text_of() - returns a cell of a volume's level of detail. */
cell_text cell_text_of(const leafcast *volume, uint32_t level, uint64_t number);

/* cell_text_print() - print the indices with a divider between them, or the number.
 * cell_text_json() - returns a list of indices, or a number. */
void cell_text_print(const cell_text *c, char divider, FILE *out);
json_t *cell_text_json(const cell_text *c);

#endif
