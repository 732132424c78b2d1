/* image_file.h - the pages of an image file, as they are stored; what C sees of OpenImageIO.
 *
 * Samples come as the file has them: no colour space is changed, no alpha multiplied in. Whole
 * numbers of fewer bits than a type has (1, 4, 10, 12) are scaled to the type's range, as
 * OpenImageIO does; colours of a palette become RGB. No exception leaves these functions. One
 * thread a file.
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
    bool grey;            /* the first one is all but opacity */
    double resolution[2]; /* pixels a unit along x and y; 0: not said */
    double unit;          /* millimetres; 0: not said */
} image_facts;

/* image_file_open() - its first page. ST_IO, ST_UNSUPPORTED (a format of none or not of still
 * images), ST_CORRUPT. */
CHECKED status image_file_open(const char *path, image_file **out);
void image_file_close(image_file *f); /* NULL is fine */

/* image_file_seek() - make a page the current one; *there: whether the file has it. */
CHECKED status image_file_seek(image_file *f, uint32_t page, bool *there);

/* Of the current page. */
const image_facts *image_file_facts(const image_file *f);
const char *image_file_channel(const image_file *f, uint32_t channel);
const char *image_file_format(const image_file *f); /* "tiff" */

/* image_file_description() - the text that the page's tags have for people; "": none. Valid until
 * the file is closed or another page is sought. */
const char *image_file_description(const image_file *f);

/* image_file_type() - the type that a channel's samples have; half is f32. Channel
 * IMAGE_LUMINANCE: what luminance is made with, the widest of all. ST_UNSUPPORTED for others. */
enum { IMAGE_LUMINANCE = -1 };
CHECKED status image_file_type(const image_file *f, int channel, sample_type *out);

/* image_file_read() - a channel of the current page, or its luminance: 0.2126 R + 0.7152 G + 0.0722
 * B of the samples as they are stored, whole numbers rounded half to even. width * height samples
 * of image_file_type(), the top row first. */
CHECKED status image_file_read(image_file *f, int channel, void *samples);

/* image_file_known() - whether a name ends like a file of the formats that are read. */
bool image_file_known(const char *path);

#ifdef __cplusplus
}
#endif
#endif
