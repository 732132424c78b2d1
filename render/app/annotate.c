#include "render/app/annotate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/base/vec3.h"
#include "formats/base/world_frame.h"
#include "render/look/camera.h"

/* ---- What is wanted ---- */

status annotate_parts(const char *text, unsigned *parts) {
    static const char *const names[] = {"box", "axes", "scale"};
    *parts = text ? 0 : ANNOTATE_ALL;
    for (const char *at = text; at;) {
        const size_t n = strcspn(at, ",");
        size_t i = 0;
        while (i < 3 && !(strlen(names[i]) == n && strncmp(at, names[i], n) == 0))
            i++;
        if (i == 3)
            return status_describe(ST_USAGE, "--annotate: \"%s\" is no list of box, axes and scale",
                                   text);
        *parts |= 1u << i;
        at = at[n] ? at + n + 1 : NULL;
    }
    return ST_OK;
}

double annotate_round(double length) {
    const double power = pow(10.0, floor(log10(length)));
    const double steps[] = {5.0, 2.0, 1.0};
    for (int i = 0; i < 3; i++)
        if (steps[i] * power <= length * (1.0 + 1e-12))
            return steps[i] * power;
    return 0.5 * power;
}

/* ---- From the world to pixels ---- */

typedef struct projector {
    double eye[3], axis[3][3]; /* right, down, forward */
    double scale;              /* pixels per world unit; with perspective, at a distance of 1 */
    double middle[2], nearest;
    bool parallel;
} projector;

/* A world point in the picture. depth: along the camera's axis; far: along the ray, as in
 * image.z. */
typedef struct projected {
    double at[2], depth, far;
} projected;

static double depth_of(const projector *p, const double point[3]) {
    double d[3];
    vec3_sub(point, p->eye, d);
    return vec3_dot(d, p->axis[2]);
}

/* Returns false if the camera is not valid. */
static bool projector_of(const leafcast_camera *from, projector *p) {
    camera c;
    if (camera_init(&c, from) != ST_OK)
        return false;
    const double half = vec3_length(c.up);
    *p = (projector){.scale = 0.5 * (double)from->height / half,
                     .middle = {0.5 * (double)from->width, 0.5 * (double)from->height},
                     .parallel = c.ortho};
    for (int a = 0; a < 3; a++) {
        p->eye[a] = c.eye[a];
        p->axis[0][a] = c.right[a] / half;
        p->axis[1][a] = -c.up[a] / half;
        p->axis[2][a] = c.forward[a];
    }
    p->nearest = 1e-6 * depth_of(p, from->look_at);
    return true;
}

/* Project a point that lies in front of the eye. */
static projected project(const projector *p, const double point[3]) {
    double d[3];
    vec3_sub(point, p->eye, d);
    projected out = {.depth = vec3_dot(d, p->axis[2])};
    const double scale = p->parallel ? p->scale : p->scale / out.depth;
    for (int i = 0; i < 2; i++)
        out.at[i] = p->middle[i] + scale * vec3_dot(d, p->axis[i]);
    out.far = p->parallel ? out.depth : vec3_length(d);
    return out;
}

/* ---- Drawing ---- */

typedef struct page {
    canvas on;
    projector p;
    const double (*bounds)[3];
    const annotation *what;
    text_face *face;
    text_style ink;
    double letters; /* size of the letters in pixels */
} page;

/* A line between two points of the world; parts that surfaces hide are not drawn. */
typedef struct world_line {
    const page *of;
    projected end[2];
} world_line;

/* Returns whether no surface hides the line at this pixel. With perspective 1 / depth is linear in
 * the picture, with parallel rays depth is. */
static bool is_seen(const void *ctx, double share, long x, long y) {
    const world_line *l = ctx;
    const projector *p = &l->of->p;
    const double *z = l->of->on.image->z;
    if (!z)
        return true;
    const double a = l->end[0].depth, b = l->end[1].depth;
    const double depth =
        p->parallel ? (1.0 - share) * a + share * b : 1.0 / ((1.0 - share) / a + share / b);
    const double u = ((double)x + 0.5 - p->middle[0]) / p->scale,
                 v = ((double)y + 0.5 - p->middle[1]) / p->scale;
    const double far = p->parallel ? depth : depth * sqrt(1.0 + u * u + v * v);
    return far <= z[(size_t)y * (size_t)l->of->on.width + (size_t)x] * (1.0 + 1e-4);
}

static void draw_world_line(const page *g, const double a[3], const double b[3], double width,
                            float opacity) {
    double end[2][3];
    memcpy(end[0], a, sizeof end[0]);
    memcpy(end[1], b, sizeof end[1]);
    const double far[2] = {depth_of(&g->p, a), depth_of(&g->p, b)};
    if (!g->p.parallel && !(fmax(far[0], far[1]) > g->p.nearest))
        return;
    for (int i = 0; i < 2 && !g->p.parallel; i++)
        if (far[i] < g->p.nearest) {
            const double share = (g->p.nearest - far[i]) / (far[!i] - far[i]);
            const double *from = i ? b : a, *to = i ? a : b;
            for (int k = 0; k < 3; k++)
                end[i][k] = from[k] + share * (to[k] - from[k]);
        }
    const world_line l = {g, {project(&g->p, end[0]), project(&g->p, end[1])}};
    canvas_line line = {.width = width, .opacity = opacity, .seen = is_seen, .ctx = &l};
    memcpy(line.from, l.end[0].at, sizeof line.from);
    memcpy(line.to, l.end[1].at, sizeof line.to);
    memcpy(line.rgb, g->ink.rgb, sizeof line.rgb);
    canvas_draw_line(&g->on, &line);
}

static void draw_flat_line(const page *g, const double a[2], const double b[2], double width) {
    canvas_line line = {.width = width, .opacity = 1.0f};
    memcpy(line.from, a, sizeof line.from);
    memcpy(line.to, b, sizeof line.to);
    memcpy(line.rgb, g->ink.rgb, sizeof line.rgb);
    canvas_draw_line(&g->on, &line);
}

/* Draw text centred at (x, y). */
static void draw_text(const page *g, const char *text, double x, double y) {
    text_face_draw(g->face, &g->on, text, x - 0.5 * text_face_width(g->face, text),
                   y + 0.35 * g->letters, &g->ink);
}

/* ---- The box ---- */

/* An edge of the box along an axis. side[]: on the next two axes, 0 the lower side, 1 the upper. */
typedef struct edge {
    int axis, side[2];
} edge;

static void edge_end(const page *g, const edge *e, int end, double out[3]) {
    out[e->axis] = g->bounds[end][e->axis];
    for (int i = 0; i < 2; i++) {
        const int a = (e->axis + 1 + i) % 3;
        out[a] = g->bounds[e->side[i]][a];
    }
}

/* Returns whether the face of the box at this end of an axis faces the eye. */
static bool faces_eye(const page *g, int axis, int side) {
    const double out = side ? 1.0 : -1.0;
    return g->p.parallel ? out * g->p.axis[2][axis] < 0.0
                         : out * (g->p.eye[axis] - g->bounds[side][axis]) > 0.0;
}

/* Returns how many of the edge's two faces face the eye; with 1 the edge is on the outline. */
static int faces_of(const page *g, const edge *e) {
    return faces_eye(g, (e->axis + 1) % 3, e->side[0]) +
           faces_eye(g, (e->axis + 2) % 3, e->side[1]);
}

static void draw_box(const page *g) {
    for (int i = 0; i < 12; i++) {
        const edge e = {i / 4, {i & 1, i >> 1 & 1}};
        double a[3], b[3];
        edge_end(g, &e, 0, a);
        edge_end(g, &e, 1, b);
        const bool behind = faces_of(g, &e) == 0;
        draw_world_line(g, a, b, fmax(1.0, g->letters / 14.0), behind ? 0.35f : 0.85f);
    }
}

/* ---- Values along its edges ---- */

/* Find the direction in the picture that is perpendicular to the edge and points out of the box: a
 * unit vector. Returns false if the edge is too short in the picture or not before the eye. */
static bool edge_outward(const page *g, const edge *e, double out[2]) {
    double end[2][3], middle[3];
    for (int i = 0; i < 2; i++) {
        edge_end(g, e, i, end[i]);
        if (!g->p.parallel && depth_of(&g->p, end[i]) < g->p.nearest)
            return false;
    }
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (g->bounds[0][k] + g->bounds[1][k]);
    if (!g->p.parallel && depth_of(&g->p, middle) < g->p.nearest)
        return false;
    const projected a = project(&g->p, end[0]), b = project(&g->p, end[1]),
                    m = project(&g->p, middle);
    const double d[2] = {b.at[0] - a.at[0], b.at[1] - a.at[1]}, length = hypot(d[0], d[1]);
    if (!(length > 4.0 * g->letters))
        return false;
    const double n[2] = {-d[1] / length, d[0] / length};
    const double side =
        n[0] * (0.5 * (a.at[0] + b.at[0]) - m.at[0]) + n[1] * (0.5 * (a.at[1] + b.at[1]) - m.at[1]);
    for (int i = 0; i < 2; i++)
        out[i] = side < 0.0 ? -n[i] : n[i];
    return true;
}

/* Find the edge of the outline along an axis that is lowest in the picture, or farthest left.
 * Returns false if none is visible. */
static bool find_outline(const page *g, int axis, edge *found, double outward[2]) {
    double best = -INFINITY;
    for (int i = 0; i < 4; i++) {
        const edge e = {axis, {i & 1, i >> 1}};
        double out[2];
        if (faces_of(g, &e) != 1 || !edge_outward(g, &e, out))
            continue;
        const double score = out[1] - 0.5 * out[0];
        if (score > best) {
            best = score;
            *found = e;
            memcpy(outward, out, sizeof out);
        }
    }
    return best > -INFINITY;
}

/* Draw one tick with its value. Returns the width of the value's text in pixels. */
static double draw_tick(const page *g, const edge *e, double value, const double outward[2]) {
    const double length = 0.4 * g->letters;
    double at[3];
    char text[32];
    edge_end(g, e, 0, at);
    at[e->axis] = value;
    const projected p = project(&g->p, at);
    draw_flat_line(g, p.at,
                   (double[2]){p.at[0] + length * outward[0], p.at[1] + length * outward[1]},
                   fmax(1.0, g->letters / 14.0));
    snprintf(text, sizeof text, "%.6g", value);
    const double off = length + 0.7 * g->letters, wide = text_face_width(g->face, text);
    draw_text(g, text, p.at[0] + (off + 0.5 * wide * fabs(outward[0])) * outward[0],
              p.at[1] + off * outward[1]);
    return wide;
}

static void draw_name(const page *g, int axis, const double at[2], const double outward[2],
                      double off) {
    static const char *const names[] = {"x", "y", "z"};
    char text[ANNOTATE_UNIT_MAX + 24];
    snprintf(text, sizeof text, "%s", names[axis]);
    if (g->what->axes != LEAFCAST_AXES_FILE)
        text_add(text, sizeof text, ", %c to %c", world_axes_end(g->what->axes, axis, false),
                 world_axes_end(g->what->axes, axis, true));
    if (g->what->unit[0])
        text_add(text, sizeof text, " (%s)", g->what->unit);
    const double half = 0.5 * text_face_width(g->face, text);
    const double x = at[0] + (off + half * fabs(outward[0])) * outward[0],
                 y = at[1] + off * outward[1];
    /* Keep the name inside the picture. */
    draw_text(g, text, fmin(fmax(x, half + 2.0), (double)g->on.width - half - 2.0),
              fmin(fmax(y, g->letters), (double)g->on.height - g->letters));
}

/* Draw the axis' name and ticks at round values, as many as there is room for. */
static void draw_axis(const page *g, int axis) {
    double outward[2], a[3], b[3], widest = 0.0;
    edge e = {axis, {0, 0}};
    if (!find_outline(g, axis, &e, outward))
        return;
    edge_end(g, &e, 0, a);
    edge_end(g, &e, 1, b);
    const projected pa = project(&g->p, a), pb = project(&g->p, b);
    const double middle[2] = {0.5 * (pa.at[0] + pb.at[0]), 0.5 * (pa.at[1] + pb.at[1])};
    const double extent = b[axis] - a[axis];
    const double room = 5.0 * g->letters / hypot(pb.at[0] - pa.at[0], pb.at[1] - pa.at[1]) * extent;
    double step = annotate_round(extent);
    while (annotate_round(0.6 * step) >= room)
        step = annotate_round(0.6 * step);
    for (double v = ceil(a[axis] / step) * step; v <= b[axis] + 1e-9 * extent; v += step)
        widest = fmax(widest, draw_tick(g, &e, fabs(v) < 1e-9 * step ? 0.0 : v, outward));
    draw_name(g, axis, middle, outward, 2.4 * g->letters + widest * fabs(outward[0]));
}

/* ---- Scale and title ---- */

static void draw_scale(const page *g, const leafcast_camera *view) {
    const double a_pixel = (g->p.parallel ? 1.0 : depth_of(&g->p, view->look_at)) / g->p.scale;
    const double length = annotate_round(0.25 * (double)g->on.width * a_pixel);
    const double pixels = length / a_pixel, thick = fmax(2.0, 0.2 * g->letters);
    const double x = (double)g->on.width - pixels - 1.5 * g->letters,
                 y = (double)g->on.height - 1.2 * g->letters;
    char text[64];
    draw_flat_line(g, (double[2]){x, y}, (double[2]){x + pixels, y}, thick);
    snprintf(text, sizeof text, "%.6g%s%s", length, g->what->unit[0] ? " " : "", g->what->unit);
    draw_text(g, text, x + 0.5 * pixels, y - 0.9 * g->letters);
}

static void draw_title(page *g) {
    text_face_size(g->face, 1.4 * g->letters);
    draw_text(g, g->what->title, 0.5 * (double)g->on.width, 1.4 * g->letters);
    text_face_size(g->face, g->letters);
}

void annotate_draw(const leafcast_image *image, const leafcast_camera *view,
                   const double bounds[2][3], const annotation *a, bool light, text_face *face) {
    static const text_style bright = {{0.85f, 0.85f, 0.85f}, {0.02f, 0.02f, 0.02f}},
                            dark = {{0.03f, 0.03f, 0.03f}, {0.9f, 0.9f, 0.9f}};
    page g = {.on = {image, (long)view->width, (long)view->height},
              .bounds = bounds,
              .what = a,
              .face = face,
              .ink = light ? dark : bright,
              .letters = fmax(10.0, (double)view->height / 50.0)};
    if (!image->r || !projector_of(view, &g.p))
        return;
    text_face_size(face, g.letters);
    if (a->parts & ANNOTATE_BOX)
        draw_box(&g);
    for (int axis = 0; axis < 3 && a->parts & ANNOTATE_AXES; axis++)
        draw_axis(&g, axis);
    if (a->parts & ANNOTATE_SCALE)
        draw_scale(&g, view);
    if (a->title[0])
        draw_title(&g);
}
