/* colour_space.h - which colours lie between two others, as ParaView and VTK have it.
 *
 * Colours go in as a screen shows them (sRGB) and come out linear. The same bits on every CPU.
 */
#ifndef RENDER_APP_COLOUR_SPACE_H
#define RENDER_APP_COLOUR_SPACE_H

#include <stdbool.h>

typedef enum colour_space {
    COLOUR_LINEAR, /* light is linear; ParaView has no such space */
    COLOUR_RGB,
    COLOUR_HSV,         /* hues never pass red */
    COLOUR_HSV_WRAPPED, /* they go the shorter way around */
    COLOUR_LAB,         /* CIE 1976 L*a*b*, white D65 */
    COLOUR_DIVERGING    /* Moreland's Msh, by way of white between two saturated colours */
} colour_space;

/* colour_space_find() - by the name that ParaView's files have: RGB, HSV, Wrapped, Lab, CIELAB,
 * Diverging. False where it is none of these. */
bool colour_space_find(const char *name, colour_space *space);

/* colour_space_between() - the colour at the share s, 0 .. 1, of the way from a to b, whose
 * components are in [0, 1]; linear ones in [0, 1]. What no screen can show is brought back as VTK
 * does: scaled, then cut. */
void colour_space_between(colour_space space, const double a[3], const double b[3], double s,
                          double linear[3]);

/* colour_space_encoded() - what a linear component is on a screen: picture_linear() backwards. */
double colour_space_encoded(double linear);

#endif
