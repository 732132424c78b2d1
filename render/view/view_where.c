#include "render/view/view_where.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

typedef struct square {
    uint32_t x, y, width, height; /* pixels */
} square;

static bool any_in(const uint8_t *provisional, uint32_t width, const square *s) {
    for (uint32_t y = s->y; y < s->y + s->height; y++)
        if (memchr(provisional + (size_t)y * width + s->x, 1, s->width))
            return true;
    return false;
}

/* Append the lengths of all runs. */
static void list_runs(const uint8_t *provisional, uint32_t width, uint32_t height, uint32_t side,
                      json_t *runs) {
    bool now = false;
    json_int_t length = 0;
    for (uint32_t y = 0; y < height; y += side)
        for (uint32_t x = 0; x < width; x += side) {
            const square s = {x, y, least(side, width - x), least(side, height - y)};
            const bool any = !provisional || any_in(provisional, width, &s);
            if (any != now) {
                json_array_append_new(runs, json_integer(length));
                length = 0;
                now = any;
            }
            length++;
        }
    json_array_append_new(runs, json_integer(length));
}

json_t *view_where_describe(const uint8_t *provisional, uint32_t width, uint32_t height) {
    const double pixels = (double)width * height;
    const uint32_t side = (uint32_t)fmax(1.0, ceil(sqrt(pixels / VIEW_WHERE_MAX)));
    json_t *runs = json_array();
    if (runs)
        list_runs(provisional, width, height, side, runs);
    return json_pack("{s:I,s:I,s:o}", "side", (json_int_t)side, "columns",
                     (json_int_t)((width + side - 1) / side), "runs", runs);
}
