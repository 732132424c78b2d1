#include "render/app/ray_profile.h"

#include <math.h>

#include "formats/base/num.h"

/* ---- All together ---- */

/* Returns a segment's mean value. A polynomial in Bernstein form has the mean of its control
 * values. */
static double mean_of(const leafcast_segment *s) {
    double sum = 0.0;
    for (int i = 0; i <= s->degree; i++)
        sum += s->control[i];
    return sum / (s->degree + 1);
}

ray_profile_total ray_profile_sum(const ray_profile *p) {
    ray_profile_total total = {0.0, NAN, NAN, NAN, NAN, NAN};
    double integral = 0.0;
    for (int i = 0; i < p->count; i++) {
        const leafcast_segment *s = &p->segments[i];
        total.length += s->t1 - s->t0;
        integral += (s->t1 - s->t0) * mean_of(s);
        if (!(s->least >= total.least)) {
            total.least = s->least;
            total.least_t = s->least_t;
        }
        if (!(s->most <= total.most)) {
            total.most = s->most;
            total.most_t = s->most_t;
        }
    }
    if (p->count > 0)
        total.mean = integral / total.length;
    return total;
}

/* ---- Tables ---- */

void ray_profile_csv(const void *profile, FILE *out) {
    const ray_profile *p = profile;
    fprintf(out, "t0,t1,%s,value_t0,value_t1,least,least_t,most,most_t\n",
            p->indexed ? "i,j,k" : p->cell);
    for (int i = 0; i < p->count; i++) {
        const leafcast_segment *s = &p->segments[i];
        const double rest[] = {s->control[0], s->control[s->degree], s->least, s->least_t, s->most,
                               s->most_t};
        char number[NUM_TEXT_MAX];
        fprintf(out, "%s,", num_print(s->t0, number));
        fprintf(out, "%s,", num_print(s->t1, number));
        cell_text_print(&p->cells[i], ',', out);
        for (size_t k = 0; k < sizeof rest / sizeof *rest; k++)
            fprintf(out, ",%s", num_print(rest[k], number));
        fputc('\n', out);
    }
}

void ray_profile_text(const void *profile, FILE *out) {
    const ray_profile *p = profile;
    fprintf(out, "%14s %14s %14s %14s %14s %14s  %s\n", "t0", "t1", "value at t0", "value at t1",
            "least", "most", p->cell);
    for (int i = 0; i < p->count; i++) {
        const leafcast_segment *s = &p->segments[i];
        fprintf(out, "%14.9g %14.9g %14.9g %14.9g %14.9g %14.9g  ", s->t0, s->t1, s->control[0],
                s->control[s->degree], s->least, s->most);
        cell_text_print(&p->cells[i], ' ', out);
        fputc('\n', out);
    }
}

/* ---- The plot ---- */

enum { WIDTH = 800, HEIGHT = 440, LEFT = 84, RIGHT = 70, TOP = 44, BOTTOM = 52 };
enum { X_STEPS = 8, Y_STEPS = 6, TICKS_MAX = 400 };

/* The ranges of t and of values that the plot shows. */
typedef struct frame {
    double t[2], value[2];
} frame;

static double x_of(const frame *f, double t) {
    return LEFT + (WIDTH - LEFT - RIGHT) * ((t - f->t[0]) / (f->t[1] - f->t[0]));
}

static double y_of(const frame *f, double value) {
    return HEIGHT - BOTTOM -
           (HEIGHT - TOP - BOTTOM) * ((value - f->value[0]) / (f->value[1] - f->value[0]));
}

/* Widen a range a little; an empty one becomes a range, too. */
static void pad(double range[2]) {
    double more = 0.05 * (range[1] - range[0]);
    if (!(more > 0.0))
        more = fmax(fabs(range[0]) * 0.05, 1e-300);
    range[0] -= more;
    range[1] += more;
}

static frame frame_of(const ray_profile *p) {
    frame f = {{0.0, 1.0}, {0.0, 1.0}};
    if (p->count > 0) {
        const ray_profile_total total = ray_profile_sum(p);
        f = (frame){{p->segments[0].t0, p->segments[p->count - 1].t1}, {total.least, total.most}};
        pad(f.value);
    }
    return f;
}

static void print_text(FILE *out, double x, double y, const char *style, const char *text) {
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style);
    for (; *text; text++) {
        if (*text == '<' || *text == '&')
            fputs(*text == '<' ? "&lt;" : "&amp;", out);
        else
            fputc(*text, out);
    }
    fputs("</text>\n", out);
}

static void print_line(FILE *out, double x0, double y0, double x1, double y1, const char *style) {
    fprintf(out, "<path d=\"M%.2f %.2fL%.2f %.2f\" %s/>\n", x0, y0, x1, y1, style);
}

/* Returns 1, 2 or 5 times a power of ten that divides the range into about `steps` steps. */
static double step_of(const double range[2], int steps) {
    const double rough = (range[1] - range[0]) / steps, power = pow(10.0, floor(log10(rough)));
    const double times = rough / power;
    return power * (times <= 1.0 ? 1.0 : times <= 2.0 ? 2.0 : times <= 5.0 ? 5.0 : 10.0);
}

static void tick_text(char text[NUM_TEXT_MAX], double at, double step) {
    snprintf(text, NUM_TEXT_MAX, "%.10g", fabs(at) < 1e-9 * step ? 0.0 : at);
}

static void draw_axes(const ray_profile *p, const frame *f, FILE *out) {
    static const char GRID[] = "stroke=\"#e4e4e4\"";
    const double bottom = HEIGHT - BOTTOM, right = WIDTH - RIGHT;
    const double dt = step_of(f->t, X_STEPS), dv = step_of(f->value, Y_STEPS);
    char text[NUM_TEXT_MAX];
    for (double i = ceil(f->t[0] / dt); i * dt <= f->t[1]; i++) {
        const double x = x_of(f, i * dt);
        print_line(out, x, TOP, x, bottom, GRID);
        tick_text(text, i * dt, dt);
        print_text(out, x, bottom + 18, "text-anchor=\"middle\" fill=\"#555\"", text);
    }
    for (double i = ceil(f->value[0] / dv); i * dv <= f->value[1]; i++) {
        const double y = y_of(f, i * dv);
        print_line(out, LEFT, y, right, y, GRID);
        tick_text(text, i * dv, dv);
        print_text(out, LEFT - 6, y + 4, "text-anchor=\"end\" fill=\"#555\"", text);
    }
    /* Mark where the ray enters each cell, unless there are too many marks. */
    for (int i = 0; i < p->count && p->count <= TICKS_MAX; i++) {
        const double x = x_of(f, p->segments[i].t0);
        print_line(out, x, bottom - 4, x, bottom, "stroke=\"#888\" stroke-width=\"0.6\"");
    }
    fprintf(out, "<path d=\"M%d %dV%.1fH%.1f\" stroke=\"#222\" fill=\"none\"/>\n", LEFT, TOP,
            bottom, right);
    print_text(out, (LEFT + right) / 2, HEIGHT - 12, "text-anchor=\"middle\"",
               "t, in lengths of the ray's direction");
    print_text(out, LEFT, TOP - 8, "text-anchor=\"end\"", "value");
}

static void draw_isovalues(const ray_profile *p, const frame *f, FILE *out) {
    for (int i = 0; i < p->isos; i++) {
        const double iso = p->isovalues[i], y = y_of(f, iso);
        char text[NUM_TEXT_MAX];
        if (!(iso >= f->value[0] && iso <= f->value[1]))
            continue;
        print_line(out, LEFT, y, WIDTH - RIGHT, y,
                   "stroke=\"#b5452c\" stroke-dasharray=\"5 4\" fill=\"none\"");
        tick_text(text, iso, 0.0);
        print_text(out, WIDTH - RIGHT + 6, y + 4, "fill=\"#b5452c\"", text);
    }
    for (int i = 0; i < p->hit_count; i++)
        fprintf(out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"3.5\" fill=\"#b5452c\"/>\n",
                x_of(f, p->hits[i].t), y_of(f, p->isovalues[p->hits[i].surface]));
}

/* Draw the values as Bezier curves: the control points of a cubic over t are its control values. */
static void draw_curve(const ray_profile *p, const frame *f, FILE *out) {
    fputs("<path d=\"", out);
    for (int i = 0; i < p->count; i++) {
        const leafcast_segment *s = &p->segments[i];
        const double dt = (s->t1 - s->t0) / s->degree;
        /* Leave a gap where there is no segment. */
        if (i == 0 || s->t0 > p->segments[i - 1].t1 + 1e-9 * (s->t1 - s->t0))
            fprintf(out, "M%.2f %.2f", x_of(f, s->t0), y_of(f, s->control[0]));
        fputc(s->degree == 3 ? 'C' : 'L', out);
        for (int k = 1; k <= s->degree; k++)
            fprintf(out, "%s%.2f %.2f", k > 1 ? " " : "", x_of(f, s->t0 + k * dt),
                    y_of(f, s->control[k]));
    }
    fputs("\" stroke=\"#1f5f8b\" stroke-width=\"1.6\" fill=\"none\" stroke-linejoin=\"round\"/>\n",
          out);
}

void ray_profile_svg(const void *profile, FILE *out) {
    const ray_profile *p = profile;
    const frame f = frame_of(p);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            WIDTH, HEIGHT);
    print_text(out, WIDTH / 2.0, 20, "text-anchor=\"middle\" font-weight=\"bold\"", p->title);
    if (p->count > 0) {
        draw_axes(p, &f, out);
        draw_curve(p, &f, out);
        draw_isovalues(p, &f, out);
    } else {
        print_text(out, WIDTH / 2.0, HEIGHT / 2.0, "text-anchor=\"middle\"",
                   "the ray passes no cell with data");
    }
    fputs("</svg>\n", out);
}
