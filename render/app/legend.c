#include "render/app/legend.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "render/app/canvas.h"

/* Letters of 5 x 7 dots: one byte per row, the leftmost dot is the bit of 16. */
enum { DOTS_X = 5, DOTS_Y = 7, ADVANCE = 6, TEXT_MAX = 16, MARKS = 3 };

static const char LETTERS[] = "0123456789.-+einf";
static const uint8_t FONT[][DOTS_Y] = {
    {14, 17, 19, 21, 25, 17, 14}, {4, 12, 4, 4, 4, 4, 14},    {14, 17, 1, 6, 8, 16, 31},
    {14, 17, 1, 6, 1, 17, 14},    {2, 6, 10, 18, 31, 2, 2},   {31, 16, 30, 1, 1, 17, 14},
    {6, 8, 16, 30, 17, 17, 14},   {31, 1, 2, 4, 8, 8, 8},     {14, 17, 17, 14, 17, 17, 14},
    {14, 17, 17, 15, 1, 2, 12},   {0, 0, 0, 0, 0, 12, 12},    {0, 0, 0, 14, 0, 0, 0},
    {0, 4, 4, 31, 4, 4, 0},       {0, 0, 14, 17, 31, 16, 14}, {4, 0, 12, 4, 4, 4, 14},
    {0, 0, 22, 25, 17, 17, 17},   {6, 8, 8, 28, 8, 8, 8}};

static void write_letter(const canvas *c, char letter, long x, long y, long dot) {
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const char *found = strchr(LETTERS, letter);
    if (!found)
        return;
    for (long row = 0; row < DOTS_Y; row++)
        for (long column = 0; column < DOTS_X; column++)
            if (FONT[found - LETTERS][row] >> (DOTS_X - 1 - column) & 1)
                canvas_fill(c,
                            (canvas_box){x + column * dot, y + row * dot, x + (column + 1) * dot,
                                         y + (row + 1) * dot},
                            white, 1.0f);
}

/* How text is drawn: with the face, or (NULL) as dots of `dot` pixels. */
typedef struct hand {
    long dot;
    text_face *face;
} hand;

static long width_of(const hand *h, const char *text) {
    return h->face ? (long)ceil(text_face_width(h->face, text))
                   : (long)strlen(text) * ADVANCE * h->dot;
}

/* Write text centred vertically at y. */
static void write_text(const canvas *c, const hand *h, const char *text, long x, long y) {
    static const text_style white = {{1.0f, 1.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
    const long half = DOTS_Y * h->dot / 2;
    if (h->face)
        text_face_draw(h->face, c, text, (double)x, (double)(y + half), &white);
    for (; !h->face && *text; text++, x += ADVANCE * h->dot)
        write_letter(c, *text, x, y - half, h->dot);
}

/* Draw the colours, one row of pixels each. */
static void draw_bar(const canvas *c, canvas_box b, const transfer_list *t,
                     const double window[2]) {
    const double rows = (double)(b.y1 - b.y0);
    for (long y = b.y0; y < b.y1; y++) {
        const double s = ((double)(b.y1 - 1 - y) + 0.5) / rows;
        const leafcast_transfer_point p =
            transfer_list_at(t, (1.0 - s) * window[0] + s * window[1], true);
        const float rgb[3] = {(float)p.rgb[0], (float)p.rgb[1], (float)p.rgb[2]};
        canvas_fill(c, (canvas_box){b.x0, y, b.x1, y + 1}, rgb, 1.0f);
    }
}

void legend_draw(const leafcast_image *image, uint32_t width, uint32_t height,
                 const transfer_list *t, const double window[2], const char *title,
                 text_face *face) {
    static const float black[3] = {0.0f, 0.0f, 0.0f};
    const canvas c = {image, (long)width, (long)height};
    const long dot = 1 + c.height / 600, gap = 4 * dot;
    const long tall = c.height / 2, wide = 10 * dot;
    const hand h = {dot, face};
    char text[MARKS][TEXT_MAX];
    long letters = 0;
    if (face)
        text_face_size(face, 1.4 * (double)(DOTS_Y * dot));
    for (int i = 0; i < MARKS; i++) {
        const double s = (double)i / (MARKS - 1);
        snprintf(text[i], TEXT_MAX, "%.4g", (1.0 - s) * window[0] + s * window[1]);
        letters = width_of(&h, text[i]) > letters ? width_of(&h, text[i]) : letters;
    }
    const long named = face && *title ? width_of(&h, title) + 2 * gap : 0,
               bare = wide + 3 * gap + letters, room = named < c.width - gap ? named : 0,
               across = room > bare ? room : bare, head = room > 0 ? 2 * DOTS_Y * dot : 0;
    const canvas_box frame = {c.width - across - gap, (c.height - tall) / 2 - 2 * gap - head,
                              c.width - gap, (c.height + tall) / 2 + 2 * gap};
    if (tall < 4 * DOTS_Y * dot || frame.x0 < 0 || frame.y0 < 0 || !image->r)
        return;
    const canvas_box bar = {frame.x1 - gap - wide, (c.height - tall) / 2, frame.x1 - gap,
                            (c.height - tall) / 2 + tall};
    canvas_fill(&c, frame, black, 0.6f);
    draw_bar(&c, bar, t, window);
    if (head > 0)
        write_text(&c, &h, title, frame.x0 + gap, frame.y0 + gap + DOTS_Y * dot / 2);
    for (int i = 0; i < MARKS; i++)
        write_text(&c, &h, text[i], frame.x0 + gap, bar.y1 - i * tall / (MARKS - 1));
}
