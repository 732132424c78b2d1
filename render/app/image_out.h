/* image_out.h - pictures and raw planes to files and to standard output.
 *
 * A picture's format is told by its name's end, in letters of any case, or by image_out_options.
 * PNG, PPM and PFM are written here; EXR by a helper process (image_helper.h), which is started
 * with the first picture that needs it and lives as long as the image_out. EXR gets the channels
 * R G B A Z N.x N.y N.z id error value, colours linear and premultiplied, as far as there are
 * planes.
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
    const char *format;   /* "png", "ppm", "pfm", "exr"; NULL: by the ends of the names,
                             PNG to standard output */
    bool (*stop)(void *); /* or NULL; asked while the helper is waited for */
    void *ctx;
} image_out_options;

/* image_out_open() - starts nothing yet. The options' pointers must live as long. image_out_close()
 * ends the helper; NULL is fine. */
CHECKED status image_out_open(mem *m, const image_out_options *options, image_out **out);
void image_out_close(image_out *o);

/* image_out_check() - what would make image_out_begin() fail can be told before anything is opened:
 * a name of no picture (ST_USAGE), a file that is there already (ST_EXISTS, unless force), no
 * helper (ST_UNSUPPORTED), a terminal (ST_USAGE). image_out_check_raw(): the same of a raw plane.
 */
CHECKED status image_out_check(const image_out_options *options, const char *path);
CHECKED status image_out_check_raw(const image_out_options *options, const char *path);

/* image_out_wants_all() - whether this picture takes more than r, g, b and a. */
bool image_out_wants_all(const image_out_options *options, const char *path);

/* image_out_bytes() - memory that writing such a picture takes at a time beside its planes. */
size_t image_out_bytes(const image_out_options *options, const char *path, uint32_t width);

/* image_out_suffixes() - of names of pictures, as an output_kind has them; of one format, or NULL:
 * of all. */
const char *image_out_suffixes(const char *format);

typedef struct image_target image_target;

/* Planes that may be written as they are: image.z, rgba (four values a pixel), error, value. */
typedef enum image_raw { IMAGE_DEPTH, IMAGE_RGBA, IMAGE_ERROR, IMAGE_VALUE, IMAGE_RAWS } image_raw;

/* image_out_begin() - open the file, start the helper if it is needed. image_out_begin_raw() - of a
 * raw plane: doubles, little endian, row by row, nothing else. */
CHECKED status image_out_begin(image_out *o, const char *path, image_target **out);
CHECKED status image_out_begin_raw(image_out *o, const char *path, image_raw which,
                                   image_target **out);

/* image_out_finish() - write the picture and give the file its name. Consumes the target in any
 * case. image_out_discard() - leave nothing; NULL is fine. */
CHECKED status image_out_finish(image_target *t, const picture *p);
void image_out_discard(image_target *t);

/* image_out_write() - one picture, all of the above. */
CHECKED status image_out_write(mem *m, const char *path, bool force, const picture *p);

#endif
