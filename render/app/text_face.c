#include "render/app/text_face.h"

#include <math.h>
#include <unistd.h>

#include <ft2build.h>
#include FT_FREETYPE_H

struct text_face {
    mem *m;
    FT_Library library;
    FT_Face face;
};

/* Sans serif fonts, where Debian, Fedora, Arch and their kin install them. */
static const char *const COMMON[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/liberation-sans/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/freefont/FreeSans.ttf"};

static const char *find_common(void) {
    for (size_t i = 0; i < sizeof COMMON / sizeof *COMMON; i++)
        if (access(COMMON[i], R_OK) == 0)
            return COMMON[i];
    return NULL;
}

status text_face_open(mem *m, const char *path, text_face **out) {
    const char *found = path ? path : find_common();
    if (!found)
        return status_describe(ST_USAGE, "no font is where fonts commonly are: name a file with "
                                         "--font, or install DejaVu (fonts-dejavu-core)");
    text_face *f = mem_alloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    *f = (text_face){.m = m};
    if (FT_Init_FreeType(&f->library) != 0) {
        mem_free(m, f);
        return status_describe(ST_NOMEM, "FreeType cannot begin");
    }
    if (FT_New_Face(f->library, found, 0, &f->face) != 0 || !FT_IS_SCALABLE(f->face)) {
        text_face_close(f);
        return status_describe(ST_USAGE, "%s: no font that can be scaled", found);
    }
    *out = f;
    text_face_size(f, 12.0);
    return ST_OK;
}

void text_face_close(text_face *f) {
    if (!f)
        return;
    if (f->face)
        FT_Done_Face(f->face);
    FT_Done_FreeType(f->library);
    mem_free(f->m, f);
}

void text_face_size(text_face *f, double pixels) {
    FT_Set_Pixel_Sizes(f->face, 0, (FT_UInt)lround(fmin(fmax(pixels, 4.0), 1000.0)));
}

/* Returns the next character of a UTF-8 text, 0 at its end. Bytes that are not UTF-8 are read as
 * Latin-1. */
static unsigned long next_letter(const char **text) {
    const unsigned char *p = (const unsigned char *)*text;
    const int more = *p >= 0xf0 ? 3 : *p >= 0xe0 ? 2 : *p >= 0xc0 ? 1 : 0;
    unsigned long letter = more ? *p & (0x3fu >> more) : *p;
    for (int i = 1; i <= more; i++) {
        if ((p[i] & 0xc0) != 0x80) {
            *text += 1;
            return *p;
        }
        letter = letter << 6 | (p[i] & 0x3fu);
    }
    *text += *p ? more + 1 : 0;
    return letter;
}

/* Returns the advance of the loaded letter in pixels. */
static double advance_of(const text_face *f) {
    return (double)f->face->glyph->advance.x / 64.0;
}

double text_face_width(text_face *f, const char *text) {
    double width = 0.0;
    for (unsigned long letter; (letter = next_letter(&text)) != 0;)
        if (FT_Load_Char(f->face, letter, FT_LOAD_DEFAULT) == 0)
            width += advance_of(f);
    return width;
}

/* Draw the loaded letter at (x, y). */
static void put_letter(const text_face *f, const canvas *c, long x, long y, const float rgb[3],
                       float opacity) {
    const FT_GlyphSlot g = f->face->glyph;
    for (long row = 0; row < (long)g->bitmap.rows; row++)
        for (long column = 0; column < (long)g->bitmap.width; column++) {
            const float cover = (float)g->bitmap.buffer[row * g->bitmap.pitch + column] / 255.0f;
            if (cover > 0.0f)
                canvas_put(c, x + g->bitmap_left + column, y - g->bitmap_top + row, rgb,
                           cover * opacity);
        }
}

void text_face_draw(text_face *f, const canvas *c, const char *text, double x, double y,
                    const text_style *style) {
    static const float THIN = 0.3f; /* opacity of each of the halo's nine copies */
    for (int pass = 0; pass < 2; pass++) {
        const char *at = text;
        double pen = x;
        for (unsigned long letter; (letter = next_letter(&at)) != 0;) {
            if (FT_Load_Char(f->face, letter, FT_LOAD_RENDER) != 0)
                continue;
            const long px = lround(pen), py = lround(y);
            for (int i = 0; i < 9 && pass == 0; i++)
                put_letter(f, c, px + i % 3 - 1, py + i / 3 - 1, style->halo, THIN);
            if (pass == 1)
                put_letter(f, c, px, py, style->rgb, 1.0f);
            pen += advance_of(f);
        }
    }
}
