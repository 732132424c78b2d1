/* lost_marks.h - marks the pixels of a picture that lack something. */
#ifndef RENDER_APP_LOST_MARKS_H
#define RENDER_APP_LOST_MARKS_H

#include <stddef.h>

#include "render/leafcast.h"

/* lost_marks_draw() - mix magenta, half and half, into the colours of all provisional pixels of so
 * many. Other planes stay as they are. */
void lost_marks_draw(leafcast_image *image, size_t pixels);

#endif
