/* slice_request.h - one slice as the flags of `leafcast slice` describe it: where it lies, of which
 * field and step, in which colours. The verb and the viewer draw by it.
 */
#ifndef RENDER_APP_SLICE_REQUEST_H
#define RENDER_APP_SLICE_REQUEST_H

#include "render/app/medium_options.h"
#include "render/app/slice_options.h"
#include "render/app/slice_picture.h"
#include "render/app/view_options.h"

enum { SLICE_ISOS_MAX = 32 };

/* Keys of the flags behind slice_options' and beside medium_options'. */
enum { SLICE_FIELD = 0x3000, SLICE_STEP, SLICE_ISO, SLICE_COLOUR };

typedef struct slice_request {
    slice_options place;
    slice_look look; /* its colours: slice_request_place() */
    double isovalues[SLICE_ISOS_MAX];
    medium_options medium;
    bool legend, coloured; /* coloured: --color was given */
    char field[VIEW_FIELD_MAX];
    uint32_t step, field_number;
} slice_request;

/* The flags that are no place: field, step and the picture's; for argp. */
extern const struct argp_option slice_request_table[];
enum { SLICE_REQUEST_COUNT = 10 };

/* slice_request_init() - nothing given yet. slice_request_release() - what the place and the
 * colours hold. */
void slice_request_init(slice_request *r, mem *m);
void slice_request_release(slice_request *r);

/* slice_request_set() - one flag of slice_request_table or slice_options_table: ST_USAGE, ST_AGAIN:
 * it is none of them. slice_request_key() - of a flag by its name, in either spelling of its
 * dashes; 0: there is none. */
CHECKED status slice_request_set(slice_request *r, int key, const char *text);
int slice_request_key(const char *name, view_value *value);

/* slice_request_check() - that the flags go together: ST_USAGE. */
CHECKED status slice_request_check(slice_request *r);

/* slice_request_select() - the field and step of the volume become the selected ones.
 * slice_request_place() - then the place is known in full, and the colours where it is drawn. */
CHECKED status slice_request_select(slice_request *r, leafcast *volume);
CHECKED status slice_request_place(slice_request *r, const leafcast *volume, bool drawn);

/* slice_request_draw() - width x height values as colours, isolines and the colour bar over them.
 */
void slice_request_draw(slice_request *r, const double *value, uint32_t width, uint32_t height,
                        const leafcast_image *image);

#endif
