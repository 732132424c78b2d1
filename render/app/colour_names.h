/* colour_names.h - look up colours by their CSS names. */
#ifndef RENDER_APP_COLOUR_NAMES_H
#define RENDER_APP_COLOUR_NAMES_H

#include <stdbool.h>
#include <stdint.h>

/* colour_names_find() - find the sRGB colour of a name in upper or lower case: 0xrrggbb. Returns
 * false, with *rgb untouched, if there is none. */
bool colour_names_find(const char *name, uint32_t *rgb);

#endif
