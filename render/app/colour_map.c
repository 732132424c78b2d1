#include "render/app/colour_map.h"

#include <stdint.h>
#include <string.h>

#include "render/app/transfer_curve.h"
#include "render/picture_bytes.h"

/* ---- By name ---- */

/* A place of 0 .. 255 and its colour, 0xrrggbb. */
typedef struct knot {
    uint8_t at;
    uint32_t rgb;
} knot;

enum { KNOTS_MAX = 20 };

/* Knots of the first four are the fewest of the 256 colours, as bytes, that keep all of them within
 * one byte. cool-warm: Moreland 2009, table 1. */
static const struct named {
    const char *name;
    colour_space space;
    int count;
    knot knots[KNOTS_MAX];
} MAPS[] = {{"grey", COLOUR_RGB, 2, {{0, 0x000000}, {255, 0xffffff}}},
            {"viridis",
             COLOUR_RGB,
             16,
             {{0, 0x440154},
              {4, 0x46075a},
              {23, 0x482173},
              {39, 0x453581},
              {62, 0x3c508b},
              {99, 0x2b758e},
              {129, 0x20928c},
              {146, 0x1fa187},
              {159, 0x27ad81},
              {174, 0x3bbb75},
              {191, 0x5cc863},
              {208, 0x84d44b},
              {236, 0xcde11d},
              {243, 0xdfe318},
              {249, 0xefe51c},
              {255, 0xfde725}}},
            {"plasma",
             COLOUR_RGB,
             15,
             {{0, 0x0d0887},
              {4, 0x19068c},
              {18, 0x350498},
              {42, 0x5c01a6},
              {58, 0x7501a8},
              {70, 0x8707a6},
              {88, 0xa01a9c},
              {119, 0xc33d80},
              {158, 0xe56a5d},
              {191, 0xf89441},
              {216, 0xfeb82c},
              {233, 0xfbd324},
              {249, 0xf3ee27},
              {253, 0xf1f525},
              {255, 0xf0f921}}},
            {"inferno",
             COLOUR_RGB,
             20,
             {{0, 0x000004},   {3, 0x010108},   {13, 0x08051d},  {26, 0x180c3c},  {40, 0x2f0a5b},
              {50, 0x400a67},  {64, 0x57106e},  {87, 0x7c1d6d},  {110, 0xa02a63}, {132, 0xc13a50},
              {154, 0xde5238}, {175, 0xf1711f}, {194, 0xfa9207}, {201, 0xfc9f07}, {209, 0xfcae12},
              {222, 0xf9c72f}, {233, 0xf4dd4f}, {241, 0xf1ec6d}, {248, 0xf3f68a}, {255, 0xfcffa4}}},
            {"magma",
             COLOUR_RGB,
             16,
             {{0, 0x000004},
              {6, 0x02020d},
              {20, 0x0e0b2b},
              {37, 0x241253},
              {48, 0x36106b},
              {58, 0x471078},
              {74, 0x601880},
              {102, 0x8c2981},
              {127, 0xb5367a},
              {151, 0xdb476a},
              {166, 0xed5a5f},
              {177, 0xf66c5c},
              {189, 0xfb835f},
              {206, 0xfea36f},
              {227, 0xfeca8d},
              {255, 0xfcfdbf}}},
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
        p->rgb[c] = (float)(end ? picture_linear(end->rgb[c]) : linear[c]);
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
