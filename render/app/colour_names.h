/* colour_names.h - colours by the names that CSS gives them. */
#ifndef RENDER_APP_COLOUR_NAMES_H
#define RENDER_APP_COLOUR_NAMES_H

#include <stdbool.h>
#include <stdint.h>

/* colour_names_find() - the colour of this name, in upper or lower case, as a screen shows it:
 * 0xrrggbb. False, and *rgb untouched, where there is none. */
bool colour_names_find(const char *name, uint32_t *rgb);

#endif
