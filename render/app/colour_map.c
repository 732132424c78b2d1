#include "render/app/colour_map.h"

#include <stdint.h>
#include <string.h>

#include "render/app/transfer_curve.h"
#include "render/look/picture_bytes.h"

/* ---- By name ---- */

/* A position in 0 .. 255 and its colour, 0xrrggbb. */
typedef struct knot {
    uint8_t at;
    uint32_t rgb;
} knot;

enum { KNOTS_MAX = 29 };

/* viridis to magma: the fewest of their 256 colours that keep all 256 within 1 of 255 when
 * interpolated. cool-warm: Moreland 2009. */
static const struct named {
    const char *name;
    colour_space space;
    int count;
    knot knots[KNOTS_MAX];
} MAPS[] = {{"grey", COLOUR_RGB, 2, {{0, 0x000000}, {255, 0xffffff}}},
            {"viridis", COLOUR_LINEAR, 21, {{0, 0x440154},   {7, 0x460b5e},   {19, 0x481c6e},
                                            {34, 0x472f7d},  {55, 0x3f4889},  {81, 0x32648e},
                                            {114, 0x25838e}, {139, 0x1e9b8a}, {151, 0x21a685},
                                            {162, 0x2ab07f}, {172, 0x38b977}, {180, 0x46c06f},
                                            {188, 0x56c667}, {197, 0x69cd5b}, {207, 0x81d34d},
                                            {218, 0x9dd93b}, {228, 0xb8de29}, {237, 0xd0e11c},
                                            {244, 0xe2e418}, {250, 0xf1e51d}, {255, 0xfde725}}},
            {"plasma",
             COLOUR_LINEAR,
             19,
             {{0, 0x0d0887},
              {5, 0x1b068d},
              {16, 0x310597},
              {32, 0x4c02a1},
              {48, 0x6600a7},
              {64, 0x7e03a8},
              {75, 0x8e0ca4},
              {87, 0x9e199d},
              {100, 0xae2892},
              {115, 0xbf3984},
              {133, 0xd04d73},
              {155, 0xe26660},
              {176, 0xf0804e},
              {197, 0xfa9c3c},
              {216, 0xfeb82c},
              {233, 0xfbd324},
              {248, 0xf4ed27},
              {253, 0xf1f525},
              {255, 0xf0f921}}},
            {"inferno",
             COLOUR_LINEAR,
             29,
             {{0, 0x000004},   {3, 0x010108},   {9, 0x040314},   {16, 0x0b0724},  {23, 0x140b34},
              {31, 0x1f0c48},  {40, 0x2f0a5b},  {50, 0x400a67},  {63, 0x550f6d},  {81, 0x721a6e},
              {98, 0x8d2369},  {119, 0xae305c}, {136, 0xc73e4c}, {151, 0xda4e3c}, {165, 0xe9612b},
              {176, 0xf1731d}, {186, 0xf78410}, {192, 0xf98e09}, {198, 0xfb9906}, {204, 0xfca50a},
              {210, 0xfcb014}, {216, 0xfbbc21}, {222, 0xf9c72f}, {227, 0xf7d13d}, {232, 0xf5db4c},
              {237, 0xf3e55d}, {242, 0xf1ed71}, {248, 0xf3f68a}, {255, 0xfcffa4}}},
            {"magma",
             COLOUR_LINEAR,
             22,
             {{0, 0x000004},   {4, 0x020109},   {9, 0x040414},   {15, 0x090720},  {21, 0x100b2d},
              {29, 0x19103f},  {38, 0x251255},  {47, 0x341069},  {58, 0x471078},  {72, 0x5d177f},
              {88, 0x762181},  {107, 0x942c80}, {129, 0xb83779}, {149, 0xd8456c}, {162, 0xe95462},
              {173, 0xf3655c}, {185, 0xf97b5d}, {196, 0xfc9065}, {209, 0xfea973}, {224, 0xfec488},
              {239, 0xfde0a1}, {255, 0xfcfdbf}}},
            {"cool-warm", COLOUR_DIVERGING, 2, {{0, 0x3b4cc0}, {255, 0xb40426}}},
            {"rainbow", COLOUR_HSV, 2, {{0, 0x0000ff}, {255, 0xff0000}}}};

enum { MAPS_COUNT = sizeof MAPS / sizeof *MAPS };

const char *colour_map_names(void) {
    return "grey|viridis|plasma|inferno|magma|cool-warm|rainbow";
}

static status convert_named(const struct named *map, transfer_list *out) {
    colour_point points[KNOTS_MAX];
    for (int i = 0; i < map->count; i++) {
        points[i].value = map->knots[i].at / 255.0;
        for (int c = 0; c < 3; c++)
            points[i].rgb[c] = (map->knots[i].rgb >> (16 - 8 * c) & 0xff) / 255.0;
    }
    return colour_map_convert(map->space, points, (size_t)map->count, out);
}

status colour_map_named(const char *name, transfer_list *out) {
    for (int i = 0; i < MAPS_COUNT; i++)
        if (strcmp(name, MAPS[i].name) == 0)
            return convert_named(&MAPS[i], out);
    return ST_AGAIN;
}

/* ---- From points ---- */

typedef struct span {
    colour_space space;
    const colour_point *a, *b;
} span;

static void colour_at(const void *ctx, double s, leafcast_transfer_point *p) {
    const span *of = ctx;
    double linear[3];
    const colour_point *end = s <= 0.0 ? of->a : s >= 1.0 ? of->b : NULL;
    if (!end)
        colour_space_between(of->space, of->a->rgb, of->b->rgb, s, linear);
    for (int c = 0; c < 3; c++)
        p->rgb[c] = end ? picture_linear(end->rgb[c]) : linear[c];
}

status colour_map_convert(colour_space space, const colour_point *points, size_t count,
                          transfer_list *out) {
    status st = ST_OK;
    for (size_t i = 0; i + 1 < count + (count == 1) && st == ST_OK; i++) {
        const span of = {space, &points[i], &points[count == 1 ? i : i + 1]};
        st = transfer_curve_add(out, &(transfer_curve){of.a->value, of.b->value, colour_at, &of});
    }
    return st;
}
