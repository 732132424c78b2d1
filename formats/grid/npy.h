/* npy.h - NumPy arrays, .npy of versions 1 to 3.
 *
 * Format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html. A volume is
 * array[z][y][x], in C or Fortran order: the same array is the same volume. Of four axes, a last
 * one of up to 4 has the numbers of a sample, else the first one the steps; axes of one sample in
 * front do not count. Understood: bool, 8 to 64 bit integers, half, float, double, complex numbers
 * (as two numbers a sample); either byte order. Refused with ST_UNSUPPORTED: structures, objects,
 * text, dates, longer floats.
 */
#ifndef FORMATS_GRID_NPY_H
#define FORMATS_GRID_NPY_H

#include "formats/grid/grid_reader.h"

extern const grid_reader npy_reader;

/* A last, fourth axis of up to so many has the numbers of a sample. */
enum { NPY_NUMBERS = 4 };

/* npy_type() - of a type in NumPy's words, "<f4": s->type and s->components, and the byte order;
 * false for one that is not read. */
bool npy_type(const char *word, stored_samples *s, bool *big_endian);

#endif
