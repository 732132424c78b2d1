/* world_frame.h - what the axes of the world mean: their directions in a body, and the units of
 * lengths and of times.
 *
 * Two conventions are in use; a file that states neither has axes of its own:
 *   LPS  x to the left of the body, y to its back (posterior), z to its head (superior): DICOM, ITK
 *   RAS  x to the right, y to the front (anterior), z to the head: NIfTI, MINC, FreeSurfer
 * Each is the other with x and y negated. The section WORLD of a treelet file is this struct. All
 * zeros: nothing is known.
 */
#ifndef FORMATS_BASE_WORLD_FRAME_H
#define FORMATS_BASE_WORLD_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum world_axes { WORLD_UNTOLD, WORLD_LPS, WORLD_RAS, WORLD_AXES } world_axes;

enum { WORLD_UNIT = 32, WORLD_TIME_UNIT = 64 };

/* clang-format off */
typedef struct world_frame {           /* offset size */
    uint32_t axes;                     /*    0    4  world_axes */
    uint32_t reserved0;                /*    4    4 */
    char unit[3][WORLD_UNIT];          /*    8   96  x, y, z: "mm"; "": unknown; NUL-padded UTF-8 */
    char time_unit[WORLD_TIME_UNIT];   /*  104   64  of steps: "s", "days since 2000-01-01" */
    uint8_t reserved[88];              /*  168   88 */
} world_frame;
/* clang-format on */

_Static_assert(sizeof(world_frame) == 256, "world_frame is 256 bytes");

/* world_frame_is_told() - whether the frame says anything. */
bool world_frame_is_told(const world_frame *f);

/* world_frame_set() - set the axes, and the unit of all three; cut if too long.
 * world_frame_set_unit() - set the unit of one axis.
 * world_frame_set_time_unit() - set the unit of the steps' times. */
void world_frame_set(world_frame *f, world_axes axes, const char *unit);
void world_frame_set_unit(world_frame *f, int axis, const char *unit);
void world_frame_set_time_unit(world_frame *f, const char *unit);

/* world_frame_unit() - the unit that all three axes share; "" where they have none, or differ. */
const char *world_frame_unit(const world_frame *f);

/* world_frame_units_print() - the units as text: "mm", "degrees_east, degrees_north, m"; "" where
 * none is known. */
enum { WORLD_UNITS_TEXT = 3 * WORLD_UNIT + 8 };
const char *world_frame_units_print(const world_frame *f, char text[WORLD_UNITS_TEXT]);

/* world_frame_print() - axes and units in a line: "LPS (x to the left, y to the back, z to the
 * head), mm"; "" where nothing is known. */
enum { WORLD_FRAME_TEXT = WORLD_UNITS_TEXT + 64 };
const char *world_frame_print(const world_frame *f, char text[WORLD_FRAME_TEXT]);

/* world_axes_name() - "LPS", "RAS"; "" where unknown.
 * world_axes_find() - the axes of a name, in upper or lower case; "none" is WORLD_UNTOLD. */
const char *world_axes_name(uint32_t axes);
bool world_axes_find(const char *name, world_axes *out);

/* world_axes_end() - the letter of an axis' end: 'L' at the positive end of x in LPS; 0 where
 * unknown. */
char world_axes_end(uint32_t axes, int axis, bool positive);

/* world_axes_turn() - change a map to the world of axes `from` into one to the world of axes `to`.
 * Returns false, and changes nothing, where either is unknown. */
bool world_axes_turn(uint32_t from, uint32_t to, double map[3][4]);

#endif
