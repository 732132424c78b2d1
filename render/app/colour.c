#include "render/app/colour.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "formats/base/num.h"
#include "render/app/colour_names.h"
#include "render/look/picture_bytes.h"

/* Returns the value of two hexadecimal digits, or -1. */
static int hex_byte(const char *text) {
    int value = 0;
    for (int i = 0; i < 2; i++) {
        static const char digits[] = "0123456789abcdef";
        const char *at = text[i] ? strchr(digits, text[i] | 0x20) : NULL;
        if (!at)
            return -1;
        value = value * 16 + (int)(at - digits);
    }
    return value;
}

static bool parse_hex(const char *text, int count, double out[4]) {
    for (int i = 0; i < count; i++) {
        const int byte = hex_byte(text + 1 + 2 * i);
        if (byte < 0)
            return false;
        out[i] = i < 3 ? picture_linear(byte / 255.0) : byte / 255.0;
    }
    return true;
}

static int commas(const char *text) {
    int n = 0;
    for (; *text; text++)
        n += *text == ',';
    return n;
}

status colour_parse(const char *text, const char *what, float rgb[3], float *alpha) {
    double value[4] = {0.0, 0.0, 0.0, 1.0};
    const size_t length = strlen(text);
    bool good = false;
    uint32_t named = 0;
    if (colour_names_find(text, &named)) {
        for (int i = 0; i < 3; i++)
            value[i] = picture_linear((double)(named >> (16 - 8 * i) & 0xff) / 255.0);
        good = true;
    } else if (text[0] == '#') {
        good = (length == 7 || (length == 9 && alpha)) && parse_hex(text, (int)length / 2, value);
    } else if (commas(text) == 2 || (commas(text) == 3 && alpha)) {
        status st = num_doubles(text, what, ",", commas(text) + 1, value);
        if (st)
            return st;
        good = true;
    }
    for (int i = 0; i < 4 && good; i++)
        good = value[i] >= 0.0 && value[i] <= (i < 3 ? 1e6 : 1.0);
    if (!good)
        return status_describe(ST_USAGE,
                               "%s: \"%s\" is no colour: a name such as 'red', R,G,B or #rrggbb",
                               what, text);
    for (int i = 0; i < 3; i++)
        rgb[i] = (float)value[i];
    if (alpha)
        *alpha = (float)value[3];
    return ST_OK;
}
