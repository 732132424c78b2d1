/* surface_value.h - the value of another volume at a point of a surface, by which that is coloured
 * (leafcast_shown.colour_by): the sample that leafcast_probe_point() finds there, resumable.
 *
 * A ray asks when it meets the surface, while it is the record of an integrator. If the treelet
 * that may hold the point is absent, the ray waits for it as for any other.
 */
#ifndef RENDER_SURFACE_SURFACE_VALUE_H
#define RENDER_SURFACE_SURFACE_VALUE_H

#include "render/frame/integrator.h"

typedef struct surface_lookup {
    const leafcast *volume; /* NULL: surfaces are coloured by themselves */
    uint16_t object;        /* the number of its tracer in the frame */
} surface_lookup;

/* What colours a point. */
typedef struct surface_value {
    double value; /* NaN: there is none */
    bool light;   /* it is a colour, whose light is rgb[] */
    float rgb[3];
} surface_value;

/* surface_value_at() - find the value at a point of the scene's world.
 *
 * wanted: LEAF_NO_TREELET at first. Returns false if the search waits for *wanted of by->object:
 * call it again once that has come. *provisional: set if a preview lacks the treelet, or a lenient
 * tracer goes without it; then the value is that of a coarser level, or NaN. */
bool surface_value_at(const frame *f, const surface_lookup *by, const double at[3],
                      uint32_t *wanted, bool *provisional, surface_value *out);

#endif
