/* surface_integrator.h - isosurfaces, opaque or transparent, with lights and shadows. Follows a ray
 * (surface_ray.h), and composites each surface behind those before it.
 */
#ifndef RENDER_SURFACE_SURFACE_INTEGRATOR_H
#define RENDER_SURFACE_SURFACE_INTEGRATOR_H

#include "render/frame/integrator.h"
#include "render/look/transfer.h"
#include "render/surface/surface_value.h"

extern const integrator surface_integrator;

/* How surfaces look: frame.look. Arrays have an element for each volume. */
typedef struct surface_look {
    const leafcast_scene *scene;                               /* its lights, shading, background */
    const leafcast_surface (*surfaces)[LEAFCAST_SURFACES_MAX]; /* by isovalue of the tracer */
    const int32_t *first_id; /* in image.id: the first surface's number */
    const transfer *colours; /* by the value at a surface; without spans: there are none */
    const surface_lookup
        *lookups; /* whose value that is, if not the surface's; NULL: none has any */
    /* More is asked than one ray to each light; kernels of tiles cannot. */
    bool soft;
    int bounces; /* mirrored and refracted rays, one after the other; 0: no surface reflects or
                    bends. Above 0: soft */
    bool opaque; /* all surfaces are; false: unknown */
    bool clear;  /* some surface is not opaque; false: unknown */
} surface_look;

static inline const surface_look *surface_look_of(const frame *f) {
    return f->look;
}

/* surface_opaque() - whether no light comes through any surface. */
bool surface_opaque(const frame *f);

/* surface_lookup_of() - by what surfaces of volume v are coloured; NULL: by themselves. */
static inline const surface_lookup *surface_lookup_of(const frame *f, uint16_t v) {
    const surface_lookup *lookups = surface_look_of(f)->lookups;
    return lookups && lookups[v].volume ? &lookups[v] : NULL;
}

/* surface_colour() - the colour of a surface of volume v that was met. With a surface_lookup_of()
 * it is point->own, where surface_colour_by() has put it: that of a value, or of the surface where
 * the value is NaN. */
void surface_colour_by(const frame *f, uint16_t v, const hit *found, const surface_value *value,
                       surface_point *point);
void surface_colour(const frame *f, uint16_t v, const hit *found, const surface_point *point,
                    float rgb[3]);

/* surface_layers() - the most surfaces of a ray that count; 0: any number. */
static inline int surface_layers(const frame *f) {
    return surface_opaque(f) ? 1 : surface_look_of(f)->scene->layers_max;
}

/* Where surfaces hide this much, the rest of the light no longer counts: less than 2^-12. */
static const float surface_opaque_enough = 1.0f - 1.0f / 4096.0f;

/* surface_shows_through() - whether anything behind a surface may still count. alpha: of all
 * composited so far, the surface included. */
static inline bool surface_shows_through(float alpha, float opacity) {
    return alpha < surface_opaque_enough && opacity < 1.0f;
}

#endif
