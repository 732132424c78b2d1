/* colour.h - colours from text. */
#ifndef RENDER_APP_COLOUR_H
#define RENDER_APP_COLOUR_H

#include "formats/base/status.h"

/* colour_parse() - a name of CSS, as a screen shows it; "R,G,B" are linear numbers >= 0; "#rrggbb"
 * is what a screen shows (sRGB), made linear. With alpha, "R,G,B,A" and
 * "#rrggbbaa" too (A in [0, 1], not encoded), else alpha may be NULL. rgb is not premultiplied;
 * *alpha is 1 when absent. ST_USAGE naming `what` and the text. The same bits on every CPU: no
 * libm. */
CHECKED status colour_parse(const char *text, const char *what, float rgb[3], float *alpha);

#endif
