/* slice_request.h - one slice as described by the flags of `leafcast slice`: its place, field, step
 * and colours. Used by the verb and by the viewer.
 */
#ifndef RENDER_APP_SLICE_REQUEST_H
#define RENDER_APP_SLICE_REQUEST_H

#include "render/app/medium_options.h"
#include "render/app/slice_options.h"
#include "render/app/slice_picture.h"
#include "render/app/view_options.h"

enum { SLICE_ISOS_MAX = 32 };

/* Keys of the flags that slice_options and medium_options do not have. */
enum { SLICE_FIELD = 0x3000, SLICE_STEP, SLICE_TIME, SLICE_INTERPOLATE, SLICE_ISO, SLICE_COLOUR };

typedef struct slice_request {
    slice_options place;
    slice_look look; /* slice_request_place() sets its colours */
    double isovalues[SLICE_ISOS_MAX];
    medium_options medium;
    bool legend, coloured; /* coloured: --colour was given */
    char field[VIEW_FIELD_MAX];
    uint32_t step, field_number;
    time_options time; /* or a time: slice_request_select() finds its step */
} slice_request;

/* The flags of field, step and picture, for argp. */
extern const struct argp_option slice_request_table[];
enum { SLICE_REQUEST_COUNT = 12 };

/* slice_request_init() - start with no flag given. slice_request_release() - free the place's and
 * the colours' memory. */
void slice_request_init(slice_request *r, mem *m);
void slice_request_release(slice_request *r);

/* slice_request_set() - apply one flag of slice_request_table or slice_options_table. ST_USAGE;
 * ST_AGAIN: not one of these. slice_request_key() - returns a flag's key by its name, with '-' or
 * '_'; 0: there is none. */
CHECKED status slice_request_set(slice_request *r, int key, const char *text);
int slice_request_key(const char *name, view_value *value);

/* slice_request_check() - returns ST_USAGE for flags that contradict each other. */
CHECKED status slice_request_check(slice_request *r);

/* slice_request_select() - select the field and step in the volume. slice_request_place() - call it
 * next: it fills in the place and, if drawn, the colours. */
CHECKED status slice_request_select(slice_request *r, leafcast *volume);
CHECKED status slice_request_place(slice_request *r, const leafcast *volume, bool drawn);

/* slice_request_draw() - draw width x height values as colours, with isolines and the colour bar
 * over them.
 */
void slice_request_draw(slice_request *r, const double *value, uint32_t width, uint32_t height,
                        const leafcast_image *image);

#endif
