/* colour_by.h - what --colour-by names: another field of the shown file, or another file, whose
 * values colour the surfaces of a volume.
 *
 * A name that is a field of the shown file, or the number of one, is that field. Else it is a file,
 * FILE or FILE:FIELD. A field of the same file has the place of what it colours; another file lies
 * where it says. Both are shown at the step and time of what they colour; a file of one step at
 * any.
 */
#ifndef RENDER_APP_COLOUR_BY_H
#define RENDER_APP_COLOUR_BY_H

#include "render/app/view_options.h"

/* Start with all zeros. */
typedef struct colour_by {
    char name[MEDIUM_NAME_MAX]; /* by which it was opened, */
    const leafcast *of;         /* for this volume */
    leafcast *volume;           /* NULL: none is open */
    uint32_t field;
    bool same;           /* ... of the same file */
    leafcast_axes world; /* in which it was opened */
    uint32_t opened;     /* how often one was */
} colour_by;

/* colour_by_find() - find what flags name for a volume of theirs, as it is shown, and open it on
 * the same device, unless it is open. world: of the picture. A volume that is a surface itself may
 * be coloured by another field of its own: then shown->field becomes that one, and out->volume is
 * NULL. Returns ST_USAGE where there is no such field or file, or where it has no such step at that
 * time.
 */
CHECKED status colour_by_find(colour_by *b, const view_options *v, leafcast_axes world,
                              leafcast_shown *shown, leafcast_colouring *out);
void colour_by_close(colour_by *b);

/* colour_by_image() - whether an image colours, by its own colours. */
bool colour_by_image(const leafcast_colouring *by);

/* colour_by_world() - the axes of the world that a volume was opened in: those asked for, or its
 * own.
 */
leafcast_axes colour_by_world(const leafcast *volume);

#endif
