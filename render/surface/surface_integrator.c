#include "render/surface/surface_integrator.h"

#include <math.h>
#include <string.h>

#include "render/ray/kind.h"
#include "render/surface/shade.h"
#include "render/surface/surface_ray.h"

typedef struct surface_pixel {
    surface_ray way;
    float rgba[4]; /* composited so far, premultiplied */
} surface_pixel;

static surface_pixel *surface_pixel_of(ray_record *r) {
    return (surface_pixel *)r;
}

bool surface_opaque(const frame *f) {
    const surface_look *look = surface_look_of(f);
    if (look->opaque || look->clear)
        return look->opaque;
    for (int v = 0; v < f->volumes; v++)
        for (int i = 0; i < f->tracer[v].isos.count; i++)
            if (surface_look_of(f)->surfaces[v][i].opacity < 1.0f)
                return false;
    return true;
}

void surface_colour_by(const frame *f, uint16_t v, const hit *found, const surface_value *value,
                       surface_point *point) {
    const surface_look *look = surface_look_of(f);
    double rgb[3];
    if (value->light || isnan(value->value)) {
        memcpy(point->own, value->light ? value->rgb : look->surfaces[v][found->iso].rgb,
               sizeof point->own);
        return;
    }
    transfer_rgb(&look->colours[v], value->value, rgb);
    for (int c = 0; c < 3; c++)
        point->own[c] = (float)rgb[c];
}

void surface_colour(const frame *f, uint16_t v, const hit *found, const surface_point *point,
                    float rgb[3]) {
    const surface_look *look = surface_look_of(f);
    const tracer *tr = &f->tracer[v];
    if (surface_lookup_of(f, v)) {
        memcpy(rgb, point->own, sizeof(float[3]));
        return;
    }
    if (look->colours && look->colours[v].spans > 0) {
        double of[3];
        transfer_rgb(&look->colours[v],
                     tr->kind->given ? (double)point->own[0] : tr->isos.isovalues[found->iso], of);
        for (int c = 0; c < 3; c++)
            rgb[c] = (float)of[c];
        return;
    }
    memcpy(rgb, tr->coloured ? point->own : look->surfaces[v][found->iso].rgb, sizeof(float[3]));
}

static void surface_begin(const frame *f, uint32_t pixel, ray_record *r) {
    surface_pixel *p = surface_pixel_of(r);
    surface_ray_begin(f, pixel, &p->way);
    memset(p->rgba, 0, sizeof p->rgba);
}

static bool surface_ask(const frame *f, ray_record *record, ray_question *q,
                        ray_counters *counters) {
    surface_pixel *p = surface_pixel_of(record);
    do {
        if (p->way.head.leg == SURFACE_PRIMARY) {
            if (surface_ray_find(f, &p->way, q))
                return true;
            if (!surface_ray_meet(f, &p->way, counters))
                break;
        }
        if (surface_ray_light(f, &p->way, q, counters))
            return true;
    } while (surface_ray_composite(f, &p->way, p->rgba));
    shade_background(p->rgba, surface_look_of(f)->scene->background);
    surface_ray_write(f, &p->way, p->rgba, counters);
    return false;
}

static void surface_answer(const frame *f, ray_record *record, trace_result result) {
    surface_ray_answer(f, &surface_pixel_of(record)->way, result);
}

/* A tile's kernel walks one volume, and may have but one colour for each surface, unless another
 * volume's values colour it. */
static tile_fn surface_tile(const frame *f) {
    const transfer *colours = surface_look_of(f)->colours;
    const bool coloured = f->tracer->coloured || (colours && colours->spans > 0);
    return f->projection && !surface_look_of(f)->soft &&
                   (!coloured || surface_lookup_of(f, 0) || f->tracer->kind->tiles->colours)
               ? f->tracer->kernels->tile
               : NULL;
}

const integrator surface_integrator = {.record_bytes = sizeof(surface_pixel),
                                       .begin = surface_begin,
                                       .ask = surface_ask,
                                       .answer = surface_answer,
                                       .bundle = surface_ray_bundle,
                                       .tile = surface_tile};
