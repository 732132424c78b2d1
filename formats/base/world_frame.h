/* world_frame.h - what the axes of the world mean: which way they point in a body, and the units of
 * lengths and of times.
 *
 * Two conventions are in use, and a file that says neither has axes of its own:
 *   LPS  x to the left of the body, y to its back (posterior), z to its head (superior): DICOM, ITK
 *   RAS  x to the right, y to the front (anterior), z to the head: NIfTI, MINC, FreeSurfer
 * So one is the other with x and y negated. The struct is also that of a treelet file's section
 * WORLD. Zeros: nothing is told.
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
    char unit[3][WORLD_UNIT];          /*    8   96  of x, y, z: "mm"; "": untold; NUL-padded UTF-8 */
    char time_unit[WORLD_TIME_UNIT];   /*  104   64  of steps: "s", "days since 2000-01-01" */
    uint8_t reserved[88];              /*  168   88 */
} world_frame;
/* clang-format on */

_Static_assert(sizeof(world_frame) == 256, "world_frame is 256 bytes");

/* world_frame_is_told() - whether there is anything to keep. */
bool world_frame_is_told(const world_frame *f);

/* world_frame_set() - axes, and the unit of all three; cut if too long.
 * world_frame_set_unit() - of one axis. world_frame_set_time_unit() - of the steps. */
void world_frame_set(world_frame *f, world_axes axes, const char *unit);
void world_frame_set_unit(world_frame *f, int axis, const char *unit);
void world_frame_set_time_unit(world_frame *f, const char *unit);

/* world_frame_unit() - the unit of all three axes; "" where they have none, or not the same. */
const char *world_frame_unit(const world_frame *f);

/* world_frame_units_print() - "mm", "degrees_east, degrees_north, m"; "" where none is told. */
enum { WORLD_UNITS_TEXT = 3 * WORLD_UNIT + 8 };
const char *world_frame_units_print(const world_frame *f, char text[WORLD_UNITS_TEXT]);

/* world_frame_print() - both in a line: "LPS (x to the left, y to the back, z to the head), mm";
 * "" where nothing is told. */
enum { WORLD_FRAME_TEXT = WORLD_UNITS_TEXT + 64 };
const char *world_frame_print(const world_frame *f, char text[WORLD_FRAME_TEXT]);

/* world_axes_name() - "LPS", "RAS"; "" untold. world_axes_find() - by name, in any case of letters;
 * "none" is WORLD_UNTOLD. */
const char *world_axes_name(uint32_t axes);
bool world_axes_find(const char *name, world_axes *out);

/* world_axes_end() - what lies at an axis' end: 'L' at the positive end of x in LPS; 0 untold. */
char world_axes_end(uint32_t axes, int axis, bool positive);

/* world_axes_turn() - a map to the world of axes `from` becomes one to the world of `to`. Nothing
 * happens where either is untold: false then. */
bool world_axes_turn(uint32_t from, uint32_t to, double map[3][4]);

#endif
