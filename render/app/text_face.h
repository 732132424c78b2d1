/* text_face.h - draw text with a font file, by FreeType. */
#ifndef RENDER_APP_TEXT_FACE_H
#define RENDER_APP_TEXT_FACE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/canvas.h"

typedef struct text_face text_face;

/* text_face_open() - open a font file; NULL: one that Linux systems commonly have. ST_USAGE: no
 * usable font; the description names the file. text_face_close() - NULL is allowed. */
CHECKED status text_face_open(mem *m, const char *path, text_face **out);
void text_face_close(text_face *f);

/* text_face_size() - set the font size in pixels, about the height of a line; 4 to 1000. */
void text_face_size(text_face *f, double pixels);

/* text_face_width() - returns the width of a UTF-8 text in pixels. */
double text_face_width(text_face *f, const char *text);

/* The colours of a text, and of the halo around it. The halo keeps the text legible. */
typedef struct text_style {
    float rgb[3], halo[3];
} text_style;

/* text_face_draw() - draw a text whose baseline begins at (x, y). */
void text_face_draw(text_face *f, const canvas *c, const char *text, double x, double y,
                    const text_style *style);

#endif
