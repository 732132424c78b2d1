/* image_out.h - write pictures and raw planes to files and to standard output.
 *
 * The format of a picture follows from its name's suffix, in upper or lower case, or from
 * image_out_options. PNG, PPM and PFM are written here. EXR is written by a helper process
 * (image_helper.h), which starts with the first picture that needs it and lives as long as the
 * image_out. EXR gets the channels R G B A Z N.x N.y N.z id error value for which the image has
 * planes, colours linear and premultiplied.
 *
 * A target is opened before its picture is drawn. Files appear under their name only when complete.
 * The name "-" is standard output, where pictures follow one another.
 */
#ifndef RENDER_APP_IMAGE_OUT_H
#define RENDER_APP_IMAGE_OUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "render/app/picture.h"

typedef struct image_out image_out;

typedef struct image_out_options {
    bool force;
    int threads;          /* at least 1 */
    const char *format;   /* "png", "ppm", "pfm", "exr"; NULL: by the suffix of the name, PNG for
                             standard output */
    bool (*stop)(void *); /* or NULL; called during waits for the helper */
    void *ctx;
} image_out_options;

/* image_out_open() - prepare writing; nothing is started yet. The options' pointers must live as
 * long as the image_out. image_out_close() ends the helper; NULL is allowed. */
CHECKED status image_out_open(mem *m, const image_out_options *options, image_out **out);
void image_out_close(image_out *o);

/* image_out_check() - find out before anything is opened whether image_out_begin() would fail: a
 * name without a picture's suffix (ST_USAGE), a file that exists (ST_EXISTS, unless force), no
 * helper (ST_UNSUPPORTED), output to a terminal (ST_USAGE). image_out_check_raw() - the same for a
 * raw plane.
 */
CHECKED status image_out_check(const image_out_options *options, const char *path);
CHECKED status image_out_check_raw(const image_out_options *options, const char *path);

/* image_out_wants_all() - returns whether this picture's format stores more than r, g, b and a. */
bool image_out_wants_all(const image_out_options *options, const char *path);

/* image_out_bytes() - returns the bytes of memory that writing this picture needs beside its
 * planes. */
size_t image_out_bytes(const image_out_options *options, const char *path, uint32_t width);

/* image_out_suffixes() - returns the suffixes of pictures' names, in the form of output_kind.
 * format: only the suffixes of this format; NULL: of all. */
const char *image_out_suffixes(const char *format);

typedef struct image_target image_target;

/* Planes that may be written raw: image.z, rgba (four values a pixel), error, value. */
typedef enum image_raw { IMAGE_DEPTH, IMAGE_RGBA, IMAGE_ERROR, IMAGE_VALUE, IMAGE_RAWS } image_raw;

/* image_out_begin() - open the file, and start the helper if it is needed. image_out_again() - the
 * same of a file that was written before, which it replaces when it is complete.
 * image_out_begin_raw() - the same for a raw plane: little-endian doubles, row by row, nothing
 * else.
 */
CHECKED status image_out_begin(image_out *o, const char *path, image_target **out);
CHECKED status image_out_again(image_out *o, const char *path, image_target **out);
CHECKED status image_out_begin_raw(image_out *o, const char *path, image_raw which,
                                   image_target **out);

/* image_out_finish() - write the picture and give the file its name. Consumes the target in any
 * case. image_out_discard() - drop the target and leave no file; NULL is allowed. */
CHECKED status image_out_finish(image_target *t, const picture *p);
void image_out_discard(image_target *t);

/* image_out_write() - write one picture: all of the above in one call. */
CHECKED status image_out_write(mem *m, const char *path, bool force, const picture *p);

#endif
