/* plot3d_files.h - files of PLOT3D for tests, by a writer of their own: what a node has follows
 * from its zone and its number.
 */
#ifndef TESTS_SUPPORT_PLOT3D_FILES_H
#define TESTS_SUPPORT_PLOT3D_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/path_pattern.h"

enum { PLOT3D_FILES_ZONES = 3, PLOT3D_FILES_ROOM = 1 << 16 };

/* How a file is written. */
typedef struct plot3d_form {
    bool records, little, wide, blanks, multi, planes;
    bool text;      /* in place of the first two */
    uint32_t zones; /* up to PLOT3D_FILES_ZONES; 1 unless multi */
    uint32_t nodes[PLOT3D_FILES_ZONES][3];
} plot3d_form;

/* plot3d_form_of() - the form whose flags are these bits, in the order above; of two zones if
 * multi. Without text.
 */
plot3d_form plot3d_form_of(unsigned bits);

/* The layout's words of a form, as curvilinear_hints.layout. Valid until the next call. */
const char *plot3d_form_words(const plot3d_form *f);

/* plot3d_number() - a number of a node: 0 to 2 its place, 3 to 7 its solution, 8 and on its
 * functions. In a file of f32 it is a float; else it lies between two. Text is as exact as either.
 * plot3d_blank() - its IBLANK: -2, 0 or 1. */
double plot3d_number(const plot3d_form *f, uint32_t zone, uint64_t node, uint32_t number);
int32_t plot3d_blank(uint32_t zone, uint64_t node);

/* What is in the file, and how many functions. The bytes; *size: how many. Valid until the next
 * call. */
typedef enum plot3d_part {
    PLOT3D_PART_GRID,
    PLOT3D_PART_SOLUTION,
    PLOT3D_PART_FUNCTIONS
} plot3d_part;
enum { PLOT3D_FILES_FUNCTIONS = 2 };
uint8_t *plot3d_bytes(const plot3d_form *f, plot3d_part part, size_t *size);

/* plot3d_one() - a list of one file. Valid for the next 7 calls.
 * plot3d_write() - the same as a file of the scratch folder; its path. */
path_list plot3d_one(const char *path);
const char *plot3d_write(const plot3d_form *f, plot3d_part part, const char *name);

#endif
