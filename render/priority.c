#include "render/priority.h"

#include "render/kind.h"

uint64_t priority_of(const frame *f, uint32_t t, int32_t light_index) {
    const leafcast_light *light =
        light_index == PRIORITY_PRIMARY ? NULL : &f->scene->lights[light_index];
    const uint32_t rank = f->tracer->kind->rank(f, t, light);
    return (uint64_t)(light_index + 1) << 32 | rank;
}
