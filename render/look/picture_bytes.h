/* picture_bytes.h - linear premultiplied colours as the bytes that a screen shows.
 *
 * Each byte is the nearest one by IEC 61966-2-1 (sRGB). Values below 0 and NaN become 0, values
 * above 1 become 255. Alpha is not encoded. No libm: the same bytes on every CPU.
 */
#ifndef RENDER_LOOK_PICTURE_BYTES_H
#define RENDER_LOOK_PICTURE_BYTES_H

#include <stddef.h>
#include <stdint.h>

#include "render/leafcast.h"

/* picture_linear() - the linear light of an sRGB component in [0, 1]. */
double picture_linear(double encoded);

/* picture_light() - the linear light of a colour as a field has it (colour_field.h). */
void picture_light(double colour, double rgb[3]);

/* The table covers 2^-13, below which the byte is 0, to 1, with 128 buckets an octave. A bucket has
 * at most one border between two bytes. */
enum { BYTES_OCTAVES = 13, BYTES_BUCKETS = 128 * BYTES_OCTAVES };

typedef struct byte_table {
    uint8_t below[BYTES_BUCKETS]; /* the byte below the bucket's border, */
    float border[BYTES_BUCKETS];  /* which belongs to the next byte */
} byte_table;

void picture_bytes_init(byte_table *t);

/* picture_byte() - the byte of one linear value. */
uint8_t picture_byte(const byte_table *t, float linear);

/* picture_bytes_rgba() - write pixels first .. first + count as R G B A, not premultiplied.
 * picture_bytes_rgb() - write R G B of the premultiplied colours: as seen before black, and
 * unchanged where a picture is opaque. */
void picture_bytes_rgba(const byte_table *t, const leafcast_image *image, size_t first,
                        size_t count, uint8_t *out);
void picture_bytes_rgb(const byte_table *t, const leafcast_image *image, size_t first, size_t count,
                       uint8_t *out);

#endif
