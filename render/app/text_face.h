/* text_face.h - letters of a font file, by FreeType.
 */
#ifndef RENDER_APP_TEXT_FACE_H
#define RENDER_APP_TEXT_FACE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/canvas.h"

typedef struct text_face text_face;

/* text_face_open() - a font file; NULL: one that Linux systems commonly have. ST_USAGE where there
 * is none, naming it. text_face_close() - NULL is fine. */
CHECKED status text_face_open(mem *m, const char *path, text_face **out);
void text_face_close(text_face *f);

/* text_face_size() - so many pixels from line to line, about; 4 to 1000. */
void text_face_size(text_face *f, double pixels);

/* text_face_width() - of a text (UTF-8), in pixels. */
double text_face_width(text_face *f, const char *text);

/* How a text is drawn: its colour, over a halo of another, which keeps it legible. */
typedef struct text_style {
    float rgb[3], halo[3];
} text_style;

/* text_face_draw() - a text whose line begins at (x, y), that is, letters stand on y. */
void text_face_draw(text_face *f, const canvas *c, const char *text, double x, double y,
                    const text_style *style);

#endif
