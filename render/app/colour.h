/* colour.h - read colours from text. */
#ifndef RENDER_APP_COLOUR_H
#define RENDER_APP_COLOUR_H

#include "formats/base/status.h"

/* colour_parse() - read a colour: a CSS name or "#rrggbb", both sRGB and made linear, or "R,G,B",
 * linear numbers >= 0. If alpha is not NULL, "R,G,B,A" and "#rrggbbaa" are allowed too (A in [0,
 * 1], not encoded). rgb is not premultiplied; *alpha is 1 when absent. ST_USAGE names `what` and
 * the text. The result has the same bits on every CPU: no libm. */
CHECKED status colour_parse(const char *text, const char *what, float rgb[3], float *alpha);

#endif
