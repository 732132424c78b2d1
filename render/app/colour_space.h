/* colour_space.h - interpolate between two colours in the colour spaces of ParaView and VTK.
 *
 * Colours go in as sRGB and come out linear. The results have the same bits on every CPU.
 */
#ifndef RENDER_APP_COLOUR_SPACE_H
#define RENDER_APP_COLOUR_SPACE_H

#include <stdbool.h>

typedef enum colour_space {
    COLOUR_LINEAR, /* interpolates linear light; ParaView has no such space */
    COLOUR_RGB,
    COLOUR_HSV,         /* hues never pass red */
    COLOUR_HSV_WRAPPED, /* hues go the shorter way around */
    COLOUR_LAB,         /* CIE 1976 L*a*b*, white D65 */
    COLOUR_DIVERGING    /* Moreland's Msh, by way of white between two saturated colours */
} colour_space;

/* colour_space_find() - find a space by its name in ParaView's files: RGB, HSV, Wrapped, Lab,
 * CIELAB, Diverging. Returns false for any other name. */
bool colour_space_find(const char *name, colour_space *space);

/* colour_space_between() - compute the colour at the share s, 0 .. 1, of the way from a to b.
 * Components of a and b are in [0, 1], and so are the linear ones of the result. Colours that no
 * screen can show are brought into range as VTK does: scaled, then clamped. */
void colour_space_between(colour_space space, const double a[3], const double b[3], double s,
                          double linear[3]);

/* colour_space_encoded() - returns the sRGB value of a linear component: the inverse of
 * picture_linear(). */
double colour_space_encoded(double linear);

#endif
