#include "render/app/transfer_curve.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "render/app/colour_space.h"

enum { HALVINGS_MAX = 12, CHECKS = 16 };

/* The error allowed at the places that are checked; between them it may be a little larger. */
static const double MOST = 0.9 * TRANSFER_CURVE_ERROR;

/* An end of a piece of the curve: the point at s, from 0 at the curve's start to 1 at its end. */
typedef struct end {
    double s;
    leafcast_transfer_point p;
} end;

static end end_at(const transfer_curve *c, double s) {
    end e = {s, {.value = s >= 1.0 ? c->to : (1.0 - s) * c->from + s * c->to}};
    c->at(c->ctx, s, &e.p);
    return e;
}

static bool near_component(double exact, double drawn) {
    return fabs(exact - drawn) <= MOST &&
           fabs(colour_space_encoded(exact) - colour_space_encoded(drawn)) <= MOST;
}

static double swallowed(double extinction) {
    return 1.0 - portable_exp(-extinction);
}

static bool is_near(const leafcast_transfer_point *exact, const end *a, const end *b, double w) {
    const double drawn = (1.0 - w) * a->p.extinction + w * b->p.extinction;
    bool near = fabs(swallowed(exact->extinction) - swallowed(drawn)) <= MOST;
    for (int c = 0; c < 3 && near; c++)
        near = near_component(exact->rgb[c], (1.0 - w) * a->p.rgb[c] + w * b->p.rgb[c]);
    return near;
}

static bool straight(const transfer_curve *c, const end *a, const end *b) {
    for (int i = 1; i < CHECKS; i++) {
        const double w = (double)i / CHECKS;
        const end exact = end_at(c, a->s + w * (b->s - a->s));
        if (!is_near(&exact.p, a, b, w))
            return false;
    }
    return true;
}

static status add_piece(transfer_list *out, const transfer_curve *c, const end *a, const end *b,
                        int halvings) {
    if (halvings == HALVINGS_MAX || straight(c, a, b))
        return transfer_list_add(out, b->p);
    const end middle = end_at(c, 0.5 * (a->s + b->s));
    status st = add_piece(out, c, a, &middle, halvings + 1);
    return st == ST_OK ? add_piece(out, c, &middle, b, halvings + 1) : st;
}

static bool same_point(const leafcast_transfer_point *a, const leafcast_transfer_point *b) {
    return memcmp(&a->value, &b->value, sizeof a->value) == 0 &&
           memcmp(a->rgb, b->rgb, sizeof a->rgb) == 0 &&
           memcmp(&a->extinction, &b->extinction, sizeof a->extinction) == 0;
}

status transfer_curve_add(transfer_list *out, const transfer_curve *c) {
    const end first = end_at(c, 0.0), last = end_at(c, 1.0);
    const leafcast_transfer_point *before = out->count ? &out->points[out->count - 1] : NULL;
    status st = ST_OK;
    if (!before || !same_point(before, &first.p))
        st = transfer_list_add(out, first.p);
    if (st != ST_OK)
        return st;
    return add_piece(out, c, &first, &last, c->from < c->to ? 0 : HALVINGS_MAX);
}
