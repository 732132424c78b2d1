/* npy.h - NumPy arrays, .npy of versions 1 to 3.
 *
 * Format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html. A volume is
 * array[z][y][x], in C or Fortran order: the same array is the same volume. Of four axes, a last
 * axis of up to 4 holds the numbers of a sample; else the first axis holds the steps. Axes of one
 * sample in front do not count. Understood: bool, 8 to 64 bit integers, half, float, double,
 * complex numbers (as two numbers a sample); either byte order. Refused with ST_UNSUPPORTED:
 * structures, objects, text, dates, longer floats.
 */
#ifndef FORMATS_GRID_NPY_H
#define FORMATS_GRID_NPY_H

#include "formats/grid/grid_reader.h"

extern const grid_reader npy_reader;

/* A last, fourth axis of up to this length holds the numbers of a sample. */
enum { NPY_NUMBERS = 4 };

/* npy_type() - read a type in NumPy's words, "<f4", into s->type, s->components and the byte order.
 * Returns false if it is not supported. */
bool npy_type(const char *word, stored_samples *s, bool *big_endian);

#endif
