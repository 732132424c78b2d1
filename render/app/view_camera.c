#include "render/app/view_camera.h"

#include <math.h>
#include <string.h>

bool view_camera_fits(const view_options *v) {
    return v->fit && !v->eye;
}

leafcast_camera view_camera_fit(const view_options *v, const leafcast *volume) {
    const leafcast_camera *given = &v->camera;
    double isovalues[LEAFCAST_SURFACES_MAX];
    uint32_t field;
    leafcast_camera c = {.size = sizeof c};
    for (int i = 0; i < v->isos; i++)
        isovalues[i] = v->surfaces[i].isovalue;
    if (view_options_field(v, volume, &field) == ST_OK &&
        leafcast_fit_view(volume, field, v->step, isovalues, v->isos, v->fov ? given->fov : 0.0,
                          given->width, given->height, &c) == LEAFCAST_OK)
        return c;
    /* There is no such field or step: drawing will report that. */
    return leafcast_standard_view(volume, v->distance, given->width, given->height);
}

static leafcast_camera first_view(const view_options *v, const leafcast *volume) {
    const leafcast_camera *given = &v->camera;
    if (v->hold)
        return *v->hold;
    if (view_camera_fits(v))
        return view_camera_fit(v, volume);
    return leafcast_standard_view(volume, v->distance, given->width, given->height);
}

static double diagonal_of(const leafcast *volume) {
    const leafcast_info info = leafcast_describe(volume);
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        const double edge = info.bounds[1][a] - info.bounds[0][a];
        square += edge * edge;
    }
    return sqrt(square);
}

/* Move the eye in front of all that is shown: parallel rays begin in the plane through it. */
static void step_back(leafcast_camera *c, double diagonal) {
    double away = 0.0;
    for (int a = 0; a < 3; a++) {
        const double from = c->eye[a] - c->look_at[a];
        away += from * from;
    }
    for (int a = 0; a < 3; a++)
        c->eye[a] = c->look_at[a] + (c->eye[a] - c->look_at[a]) * diagonal / sqrt(away);
}

leafcast_camera view_camera_of(const view_options *v, const leafcast *volume) {
    const leafcast_camera *given = &v->camera;
    leafcast_camera c = first_view(v, volume);
    if (v->eye)
        memcpy(c.eye, given->eye, sizeof c.eye);
    if (v->look_at)
        memcpy(c.look_at, given->look_at, sizeof c.look_at);
    if (v->up)
        memcpy(c.up, given->up, sizeof c.up);
    if (v->fov)
        c.fov = given->fov;
    c.ortho_height = given->ortho_height;
    if (c.ortho_height > 0.0 && !v->eye)
        step_back(&c, v->hold_diagonal > 0.0 ? v->hold_diagonal : diagonal_of(volume));
    /* Looking straight down or up, +z cannot be up. */
    if (!v->up && c.eye[0] == c.look_at[0] && c.eye[1] == c.look_at[1]) {
        c.up[1] = 1.0;
        c.up[2] = 0.0;
    }
    return c;
}

void view_camera_turn(view_options *v, const leafcast *volume, double share) {
    const leafcast_camera c = view_camera_of(v, volume);
    const double turn = 2.0 * 3.14159265358979323846 * share, cosine = cos(turn), sine = sin(turn);
    double axis[3], from[3], along = 0.0, length = 0.0;
    for (int a = 0; a < 3; a++)
        length += c.up[a] * c.up[a];
    for (int a = 0; a < 3; a++) {
        axis[a] = c.up[a] / sqrt(length);
        from[a] = c.eye[a] - c.look_at[a];
        along += axis[a] * from[a];
    }
    /* Rodrigues' formula: the part along the axis stays, the rest turns. */
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, d = (a + 2) % 3;
        const double across = axis[b] * from[d] - axis[d] * from[b];
        v->camera.eye[a] =
            c.look_at[a] + axis[a] * along + (from[a] - axis[a] * along) * cosine + across * sine;
    }
    memcpy(v->camera.look_at, c.look_at, sizeof c.look_at);
    memcpy(v->camera.up, c.up, sizeof c.up);
    v->camera.fov = c.fov;
    v->eye = v->look_at = v->up = v->fov = true;
}
