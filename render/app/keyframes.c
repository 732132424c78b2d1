#include "render/app/keyframes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/num.h"
#include "formats/base/vec3.h"

enum { TEXT_MAX = 1024 };

/* Keys whose values change linearly; "step" changes by whole steps. */
static const char *const EVEN[] = {
    "iso",      "opacity",     "colour",  "eye",      "look-at",   "up",         "fov",
    "ortho",    "window",      "ambient", "specular", "shininess", "clip-plane", "light",
    "clip-box", "point-light", "error",   "step",     "time",      "background"};

static bool changes_evenly(const char *key) {
    for (size_t i = 0; i < sizeof EVEN / sizeof *EVEN; i++)
        if (strcmp(key, EVEN[i]) == 0)
            return true;
    return strcmp(key, "opacity-length") == 0;
}

/* ---- One flat object per key, with names in one form ---- */

static status flatten(const json_t *from, json_t *to, const char *what, int depth) {
    char name[64];
    const char *key;
    json_t *value;
    void *at = json_object_iter((json_t *)from);
    if (!json_is_object(from) || depth > 4)
        return status_describe(ST_USAGE, "%s: not a JSON object", what);
    for (; at; at = json_object_iter_next((json_t *)from, at)) {
        key = json_object_iter_key(at);
        value = json_object_iter_value(at);
        if (strcmp(key, "camera") == 0) {
            const status st = flatten(value, to, what, depth + 1);
            if (st != ST_OK)
                return st;
            continue;
        }
        cli_options_name(strcmp(key, "isovalues") == 0 ? "iso" : key, name, sizeof name);
        if (json_object_set(to, name, value) != 0)
            return status_describe(ST_NOMEM, "no memory for the views of a movie");
    }
    return ST_OK;
}

/* ---- Between two values ---- */

static double between(double a, double b, double t) {
    return a == b ? a : a + t * (b - a);
}

/* Interpolate "#rrggbb" or "#rrggbbaa", digit pair by digit pair. Returns false if the two are not
 * of one form. */
static bool between_colours(const char *a, const char *b, double t, char *out) {
    const size_t n = strlen(a);
    unsigned from, to;
    if (a[0] != '#' || n != strlen(b) || n % 2 == 0 || n > 9)
        return false;
    strcpy(out, "#");
    for (size_t i = 1; i < n; i += 2) {
        if (sscanf(a + i, "%2x", &from) != 1 || sscanf(b + i, "%2x", &to) != 1)
            return false;
        snprintf(out + i, 3, "%02x", (unsigned)lround(between(from, to, t)));
    }
    return true;
}

/* Read the number at the start of *at and move *at behind it. */
static bool take_number(const char **at, double *value) {
    char token[64];
    const size_t n = strspn(*at, "0123456789.+-eE");
    if (n == 0 || n >= sizeof token)
        return false;
    memcpy(token, *at, n);
    token[n] = 0;
    *at += n;
    return num_double(token, "a view", value) == ST_OK;
}

/* Interpolate texts that differ in their numbers alone: "0:0,40:0.2". */
static bool between_texts(const char *a, const char *b, double t, char out[TEXT_MAX]) {
    size_t n = 0;
    while (*a && n + NUM_TEXT_MAX + 1 < TEXT_MAX) {
        double from, to;
        if (strchr(":, ", *a)) {
            if (*a != *b)
                return false;
            out[n++] = *a++;
            b++;
        } else if (take_number(&a, &from) && take_number(&b, &to)) {
            num_print(between(from, to, t), out + n);
            n += strlen(out + n);
        } else {
            return false;
        }
    }
    out[n] = 0;
    return !*a && !*b;
}

/* Returns a new value between a and b, or a if they cannot be interpolated. */
static json_t *between_values(json_t *a, json_t *b, double t) {
    if (json_is_number(a) && json_is_number(b))
        return json_real(between(json_number_value(a), json_number_value(b), t));
    if (json_is_string(a) && json_is_string(b)) {
        char text[TEXT_MAX];
        const char *from = json_string_value(a), *to = json_string_value(b);
        if (between_colours(from, to, t, text) || between_texts(from, to, t, text))
            return json_string(text);
    }
    if (!json_is_array(a) || !json_is_array(b) || json_array_size(a) != json_array_size(b))
        return json_incref(a);
    json_t *out = json_array();
    for (size_t i = 0; i < json_array_size(a); i++)
        json_array_append_new(out, between_values(json_array_get(a, i), json_array_get(b, i), t));
    return out;
}

/* ---- The camera ---- */

typedef struct pose {
    double look_at[3], up[3], away[3]; /* away, up: unit */
    double log_distance;
} pose;

static bool take_vector(const json_t *object, const char *key, double out[3]) {
    const json_t *value = json_object_get(object, key);
    if (json_array_size(value) != 3)
        return false;
    for (size_t i = 0; i < 3; i++) {
        if (!json_is_number(json_array_get(value, i)))
            return false;
        out[i] = json_number_value(json_array_get(value, i));
    }
    return true;
}

static bool take_pose(const json_t *key, pose *p) {
    double eye[3];
    if (!take_vector(key, "eye", eye) || !take_vector(key, "look-at", p->look_at))
        return false;
    if (!json_object_get(key, "up"))
        memcpy(p->up, (double[3]){0.0, 0.0, 1.0}, sizeof p->up);
    else if (!take_vector(key, "up", p->up))
        return false;
    vec3_sub(eye, p->look_at, p->away);
    p->log_distance = log(vec3_length(p->away));
    return vec3_unit(p->away, p->away) && vec3_unit(p->up, p->up);
}

/* Turn the unit vector a towards b on their great circle. Opposite vectors have many; one of these
 * is taken. t may be outside of 0 .. 1. */
static void turn(const double a[3], const double b[3], double t, double out[3]) {
    double axis[3], side[3];
    vec3_cross(a, b, axis);
    const double angle = t * atan2(vec3_length(axis), vec3_dot(a, b));
    if (vec3_length(axis) < 1e-12) {
        const int least = fabs(a[0]) < 0.6 ? 0 : 1;
        vec3_cross(a, (double[3]){least == 0, least == 1, 0.0}, axis);
    }
    (void)vec3_unit(axis, axis);
    vec3_cross(axis, a, side);
    for (int i = 0; i < 3; i++)
        out[i] = cos(angle) * a[i] + sin(angle) * side[i];
}

static pose pose_between(const pose *a, const pose *b, double t) {
    pose out;
    for (int i = 0; i < 3; i++)
        out.look_at[i] = between(a->look_at[i], b->look_at[i], t);
    out.log_distance = between(a->log_distance, b->log_distance, t);
    turn(a->away, b->away, t, out.away);
    turn(a->up, b->up, t, out.up);
    return out;
}

/* Evaluate a Catmull-Rom spline by Barry and Goldman's pyramid (SIGGRAPH 1988), with knots -1, 0,
 * 1, 2. It works on the sphere as well as in space. */
static pose pose_at(const pose p[4], double t) {
    const pose a = pose_between(&p[0], &p[1], t + 1.0), b = pose_between(&p[1], &p[2], t),
               c = pose_between(&p[2], &p[3], t - 1.0);
    const pose d = pose_between(&a, &b, 0.5 * (t + 1.0)), e = pose_between(&b, &c, 0.5 * t);
    return pose_between(&d, &e, t);
}

static json_t *vector(const double x[3]) {
    return json_pack("[f,f,f]", x[0], x[1], x[2]);
}

static void put_camera(const json_t *keys, size_t k, double t, json_t *out) {
    const size_t last = json_array_size(keys) - 1;
    pose p[4];
    for (int i = 0; i < 4; i++) {
        const size_t at = k + (size_t)i < 1 ? 0 : k + (size_t)i - 1;
        if (!take_pose(json_array_get(keys, at > last ? last : at), &p[i]))
            return;
    }
    const pose now = pose_at(p, t);
    double eye[3];
    for (int i = 0; i < 3; i++)
        eye[i] = now.look_at[i] + exp(now.log_distance) * now.away[i];
    json_object_set_new(out, "eye", vector(eye));
    json_object_set_new(out, "look-at", vector(now.look_at));
    json_object_set_new(out, "up", vector(now.up));
}

/* ---- Views ---- */

/* Returns the view at the share t between keys k and k + 1. */
static json_t *view_between(const json_t *keys, size_t k, double t) {
    json_t *from = json_array_get(keys, k), *to = json_array_get(keys, k + 1), *value;
    json_t *out = json_copy(from);
    const char *key;
    json_object_foreach(from, key, value) {
        json_t *next = json_object_get(to, key);
        if (!next || !changes_evenly(key))
            continue;
        json_t *now = between_values(value, next, t);
        if (strcmp(key, "step") == 0 && json_is_real(now)) {
            const double step = floor(json_real_value(now));
            json_decref(now);
            now = json_integer((json_int_t)step);
        }
        json_object_set_new(out, key, now);
    }
    put_camera(keys, k, t, out);
    return out;
}

static json_t *view_at(const json_t *keys, int frame, int frames) {
    const size_t last = json_array_size(keys) - 1;
    const double at = frames > 1 ? (double)frame * (double)last / (frames - 1) : 0.0;
    const size_t k = (size_t)at;
    const double t = at - (double)k;
    /* At a key, use its view unchanged, to the bit. */
    return t == 0.0 ? json_incref(json_array_get(keys, k)) : view_between(keys, k, t);
}

status keyframes_spread(const json_t *keys, const char *file, int frames, json_t **path) {
    status st = ST_OK;
    json_t *flat = json_array(), *out = json_array();
    for (size_t i = 0; i < json_array_size(keys) && st == ST_OK; i++) {
        json_t *key = json_object();
        char what[TEXT_MAX];
        snprintf(what, sizeof what, "%s: entry %zu", file, i + 1);
        st = flatten(json_array_get(keys, i), key, what, 0);
        if (json_array_append_new(flat, key) != 0 && st == ST_OK)
            st = status_describe(ST_NOMEM, "no memory for the views of a movie");
    }
    for (int i = 0; i < frames && st == ST_OK; i++)
        if (json_array_append_new(out, view_at(flat, i, frames)) != 0)
            st = status_describe(ST_NOMEM, "no memory for the views of a movie");
    json_decref(flat);
    if (st == ST_OK)
        *path = out;
    else
        json_decref(out);
    return st;
}
