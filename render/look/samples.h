/* samples.h - where in a pixel its rays go, and the mean of their colours.
 *
 * N = n x n samples are a grid of n x n points, turned so that each of N columns and N rows of the
 * pixel holds one: point (i, j), 0 <= i, j < n, is at
 *
 *   x = (i + (j + 1/2) / n) / n       y = (j + (n - i - 1/2) / n) / n
 *
 * from the pixel's upper left corner. N = 1: its centre; N = 4: the rotated grid. A picture is
 * drawn once for each sample, with the whole camera moved by the sample's distance from the centre.
 * The mean is of linear, premultiplied colours, summed in the order i + n j in single precision; N
 * is a power of two, so the division is exact. So the result does not depend on threads, kernels or
 * memory.
 */
#ifndef RENDER_LOOK_SAMPLES_H
#define RENDER_LOOK_SAMPLES_H

#include <stdbool.h>

#include "formats/base/pool.h"
#include "render/leafcast.h"

/* samples_valid() - true for 1, 4, 16 and 0; 0 counts as 1. */
bool samples_valid(int count);

/* samples_shift() - offset of sample s of count from the pixel's centre, in pixels, y down. */
void samples_shift(int count, int s, double shift[2]);

/* samples_add() - add each r, g, b, a of `from` to `to`, then multiply by `scale`, for the pixels
 * that the images hold. Skips planes that are NULL in `to`. */
CHECKED status samples_add(pool *threads, const leafcast_image *to, const leafcast_image *from,
                           float scale);

#endif
