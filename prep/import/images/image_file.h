/* image_file.h - the pages of an image file, as they are stored. Wraps OpenImageIO for C.
 *
 * Samples are as in the file: colour spaces are not converted, alpha is not multiplied in. Integers
 * with fewer bits than a type has (1, 4, 10, 12) are scaled to the type's range, as OpenImageIO
 * does. Colours of a palette become RGB. No exception leaves these functions. One thread per file.
 */
#ifndef PREP_IMPORT_IMAGES_IMAGE_FILE_H
#define PREP_IMPORT_IMAGES_IMAGE_FILE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef struct image_file image_file;

typedef struct image_facts {
    uint32_t width, height;
    uint32_t channels;
    bool colour;          /* the first three are red, green and blue */
    bool grey;            /* all channels but opacity are one: the first */
    double resolution[2]; /* pixels per unit along x and y; 0: unknown */
    double unit;          /* in millimetres; 0: unknown */
} image_facts;

/* image_file_open() - open a file at its first page. ST_IO, ST_CORRUPT, ST_UNSUPPORTED (unknown
 * format, or not of still images). */
CHECKED status image_file_open(const char *path, image_file **out);
void image_file_close(image_file *f); /* NULL is fine */

/* image_file_seek() - go to a page. *there: whether the file has it. */
CHECKED status image_file_seek(image_file *f, uint32_t page, bool *there);

/* About the current page. */
const image_facts *image_file_facts(const image_file *f);
const char *image_file_channel(const image_file *f, uint32_t channel);
const char *image_file_format(const image_file *f); /* "tiff" */

/* image_file_description() - the description in the page's tags; "": none. Valid until the file is
 * closed or another page is sought. */
const char *image_file_description(const image_file *f);

/* image_file_type() - type of a channel's samples; half becomes f32. Channel IMAGE_LUMINANCE: the
 * widest type of the channels that make the luminance. IMAGE_COLOURS: f32. ST_UNSUPPORTED: another
 * type, or colours that are not red, green and blue of 8 or 16 bits. */
enum { IMAGE_LUMINANCE = -1, IMAGE_COLOURS = -2 };
CHECKED status image_file_type(const image_file *f, int channel, sample_type *out);

/* image_file_read() - read a channel of the current page; its luminance: 0.2126 R + 0.7152 G +
 * 0.0722 B of the stored samples, with integers rounded half to even; or its colours: 65536 R + 256
 * G + B, of bytes. Gives width * height samples of image_file_type(), the top row first. */
CHECKED status image_file_read(image_file *f, int channel, void *samples);

/* image_file_known() - returns whether a name has the suffix of a format that can be read. */
bool image_file_known(const char *path);

#ifdef __cplusplus
}
#endif
#endif
