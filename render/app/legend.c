#include "render/app/legend.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Letters of 5 x 7 dots: a row a byte, the left dot is the bit of 16. */
enum { DOTS_X = 5, DOTS_Y = 7, ADVANCE = 6, TEXT_MAX = 16, MARKS = 3 };

static const char LETTERS[] = "0123456789.-+einf";
static const uint8_t FONT[][DOTS_Y] = {
    {14, 17, 19, 21, 25, 17, 14}, {4, 12, 4, 4, 4, 4, 14},    {14, 17, 1, 6, 8, 16, 31},
    {14, 17, 1, 6, 1, 17, 14},    {2, 6, 10, 18, 31, 2, 2},   {31, 16, 30, 1, 1, 17, 14},
    {6, 8, 16, 30, 17, 17, 14},   {31, 1, 2, 4, 8, 8, 8},     {14, 17, 17, 14, 17, 17, 14},
    {14, 17, 17, 15, 1, 2, 12},   {0, 0, 0, 0, 0, 12, 12},    {0, 0, 0, 14, 0, 0, 0},
    {0, 4, 4, 31, 4, 4, 0},       {0, 0, 14, 17, 31, 16, 14}, {4, 0, 12, 4, 4, 4, 14},
    {0, 0, 22, 25, 17, 17, 17},   {6, 8, 8, 28, 8, 8, 8}};

/* A rectangle of pixels, right and lower edge excluded. */
typedef struct box {
    long x0, y0, x1, y1;
} box;

typedef struct canvas {
    const leafcast_image *image;
    long width, height;
} canvas;

/* Put a colour over a pixel. */
static void put(const canvas *c, long x, long y, const float rgb[3], float opacity) {
    float *const planes[4] = {c->image->r, c->image->g, c->image->b, c->image->a};
    const float what[4] = {rgb[0], rgb[1], rgb[2], 1.0f};
    const size_t at = (size_t)y * (size_t)c->width + (size_t)x;
    for (int i = 0; i < 4; i++)
        if (planes[i])
            planes[i][at] = opacity * what[i] + (1.0f - opacity) * planes[i][at];
}

static void fill(const canvas *c, box b, const float rgb[3], float opacity) {
    for (long y = b.y0; y < b.y1; y++)
        for (long x = b.x0; x < b.x1; x++)
            put(c, x, y, rgb, opacity);
}

static void write_letter(const canvas *c, char letter, long x, long y, long dot) {
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const char *found = strchr(LETTERS, letter);
    if (!found)
        return;
    for (long row = 0; row < DOTS_Y; row++)
        for (long column = 0; column < DOTS_X; column++)
            if (FONT[found - LETTERS][row] >> (DOTS_X - 1 - column) & 1)
                fill(c,
                     (box){x + column * dot, y + row * dot, x + (column + 1) * dot,
                           y + (row + 1) * dot},
                     white, 1.0f);
}

static void write_text(const canvas *c, const char *text, long x, long y, long dot) {
    for (; *text; text++, x += ADVANCE * dot)
        write_letter(c, *text, x, y, dot);
}

/* The colours, a row of pixels each. */
static void draw_bar(const canvas *c, box b, const transfer_list *t, const double window[2]) {
    const double rows = (double)(b.y1 - b.y0);
    for (long y = b.y0; y < b.y1; y++) {
        const double s = ((double)(b.y1 - 1 - y) + 0.5) / rows;
        const leafcast_transfer_point p =
            transfer_list_at(t, (1.0 - s) * window[0] + s * window[1], true);
        fill(c, (box){b.x0, y, b.x1, y + 1}, p.rgb, 1.0f);
    }
}

void legend_draw(const leafcast_image *image, uint32_t width, uint32_t height,
                 const transfer_list *t, const double window[2]) {
    static const float black[3] = {0.0f, 0.0f, 0.0f};
    const canvas c = {image, (long)width, (long)height};
    const long dot = 1 + c.height / 600, gap = 4 * dot;
    const long tall = c.height / 2, wide = 10 * dot;
    char text[MARKS][TEXT_MAX];
    size_t letters = 0;
    for (int i = 0; i < MARKS; i++) {
        const double s = (double)i / (MARKS - 1);
        snprintf(text[i], TEXT_MAX, "%.4g", (1.0 - s) * window[0] + s * window[1]);
        letters = strlen(text[i]) > letters ? strlen(text[i]) : letters;
    }
    const long across = wide + 3 * gap + (long)letters * ADVANCE * dot;
    const box frame = {c.width - across - gap, (c.height - tall) / 2 - 2 * gap, c.width - gap,
                       (c.height + tall) / 2 + 2 * gap};
    if (tall < 4 * DOTS_Y * dot || frame.x0 < 0 || frame.y0 < 0 || !image->r)
        return;
    const box bar = {frame.x1 - gap - wide, (c.height - tall) / 2, frame.x1 - gap,
                     (c.height - tall) / 2 + tall};
    fill(&c, frame, black, 0.6f);
    draw_bar(&c, bar, t, window);
    for (int i = 0; i < MARKS; i++)
        write_text(&c, text[i], frame.x0 + gap, bar.y1 - i * tall / (MARKS - 1) - DOTS_Y * dot / 2,
                   dot);
}
