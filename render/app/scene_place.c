#include "render/app/scene_place.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "formats/base/vec3.h"
#include "render/ray/placement.h"

const char *const scene_place_keys[] = {"translate", "rotate", "degrees", "scale", "matrix", NULL};

static const double nowhere[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

static status wrong(const char *what, const char *key, const char *wanted) {
    return status_describe(ST_USAGE, "%s: \"%s\" takes %s", what, key, wanted);
}

/* Read an array of so many finite numbers. JSON has no others. */
static bool numbers(const json_t *value, size_t count, double out[]) {
    bool fine = json_is_array(value) && json_array_size(value) == count;
    for (size_t i = 0; i < count && fine; i++) {
        const json_t *item = json_array_get(value, i);
        fine = json_is_number(item);
        out[i] = json_number_value(item);
    }
    return fine;
}

static status read_translate(const json_t *value, const char *what, double step[12]) {
    double by[3];
    if (!numbers(value, 3, by))
        return wrong(what, "translate", "three numbers");
    for (int a = 0; a < 3; a++)
        step[4 * a + 3] = by[a];
    return ST_OK;
}

static status read_scale(const json_t *value, const char *what, double step[12]) {
    double by[3];
    if (json_is_number(value))
        by[0] = by[1] = by[2] = json_number_value(value);
    else if (!numbers(value, 3, by))
        return wrong(what, "scale", "a number, or three");
    for (int a = 0; a < 3; a++)
        step[5 * a] = by[a];
    return ST_OK;
}

/* About an axis through the origin, by the right hand (Rodrigues). */
static status read_rotate(const json_t *value, const json_t *degrees, const char *what,
                          double step[12]) {
    double axis[3], n[3], sine, cosine;
    if (!numbers(value, 3, axis) || !vec3_unit(axis, n))
        return wrong(what, "rotate", "an axis of three numbers, not all 0");
    if (!json_is_number(degrees))
        return wrong(what, "rotate", "\"degrees\" beside it, a number");
    const double angle = json_number_value(degrees);
    if (!(fabs(angle) <= 1e6))
        return wrong(what, "degrees", "-1000000 to 1000000");
    portable_sincos(angle / 360.0, &sine, &cosine);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const double across = r == c                 ? 0.0
                                  : (c - r + 3) % 3 == 1 ? -n[3 - r - c]
                                                         : n[3 - r - c];
            step[4 * r + c] =
                n[r] * n[c] * (1.0 - cosine) + (r == c ? cosine : 0.0) + sine * across;
        }
    return ST_OK;
}

static bool is_key(const char *key) {
    bool is = false;
    for (int i = 0; scene_place_keys[i]; i++)
        is |= strcmp(key, scene_place_keys[i]) == 0;
    return is;
}

static status read_step(json_t *value, const char *what, double step[12]) {
    const char *key, *kind = NULL;
    json_t *of = NULL, *item;
    memcpy(step, nowhere, sizeof nowhere);
    json_object_foreach(value, key, item) {
        if (!is_key(key))
            return status_describe(ST_USAGE,
                                   "%s: there is no \"%s\" (keys: translate rotate degrees scale "
                                   "matrix)",
                                   what, key);
        if (strcmp(key, "degrees") == 0)
            continue;
        if (kind)
            return status_describe(ST_USAGE,
                                   "%s: \"%s\" and \"%s\" are two steps: an array says "
                                   "which comes first",
                                   what, kind, key);
        kind = key;
        of = item;
    }
    const json_t *degrees = json_object_get(value, "degrees");
    if (!kind)
        return status_describe(ST_USAGE, "%s: a step is one of translate, rotate, scale, matrix",
                               what);
    if (strcmp(kind, "rotate") == 0)
        return read_rotate(of, degrees, what, step);
    if (degrees)
        return status_describe(ST_USAGE, "%s: \"degrees\" is of \"rotate\"", what);
    if (strcmp(kind, "translate") == 0)
        return read_translate(of, what, step);
    if (strcmp(kind, "scale") == 0)
        return read_scale(of, what, step);
    return numbers(of, 12, step) ? ST_OK : wrong(what, "matrix", "12 numbers: 3 rows of 4");
}

status scene_place_read(const json_t *value, const char *what, double place[12]) {
    memcpy(place, nowhere, sizeof nowhere);
    if (numbers(value, 12, place))
        return ST_OK;
    memcpy(place, nowhere, sizeof nowhere);
    const bool steps = json_is_array(value);
    const size_t count = steps ? json_array_size(value) : 1;
    for (size_t i = 0; i < count; i++) {
        json_t *item = steps ? json_array_get(value, i) : (json_t *)(uintptr_t)value;
        double step[12];
        if (!json_is_object(item))
            return status_describe(ST_USAGE,
                                   "%s: a transform is 12 numbers, a step such as "
                                   "{\"translate\": [1, 2, 3]}, or an array of steps",
                                   what);
        const status st = read_step(item, what, step);
        if (st != ST_OK)
            return st;
        placement_follow(place, step);
    }
    return ST_OK;
}
