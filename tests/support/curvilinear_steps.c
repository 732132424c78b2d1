#include "tests/support/curvilinear_steps.h"

#include <string.h>

float curvilinear_steps_value(const curvilinear_steps *s, uint32_t zone, size_t node,
                              uint32_t field, uint32_t step) {
    return s->zones[zone].values[node] * (float)(1 + field) + (float)step;
}

void curvilinear_steps_place(const curvilinear_steps *s, uint32_t zone, size_t node, uint32_t step,
                             float out[3]) {
    memcpy(out, s->zones[zone].p[node], sizeof(float[3]));
    if (s->moves)
        out[0] += 0.5f * (float)step;
}

static size_t plane_of(const curvilinear_steps *s, uint32_t zone) {
    return (size_t)s->nodes[zone][0] * s->nodes[zone][1];
}

static status ask(const curvilinear_steps *s, uint32_t zone, uint32_t first, uint32_t count) {
    if (first + count > s->nodes[zone][2] || count == 0)
        return status_describe(ST_USAGE, "planes that are not there");
    return s->fails_from && s->step >= s->fails_from ? status_describe(ST_IO, "it fails") : ST_OK;
}

static status places(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    const curvilinear_steps *s = own;
    const size_t plane = plane_of(s, zone);
    for (size_t n = 0; n < count * plane; n++)
        curvilinear_steps_place(s, zone, first * plane + n, s->step, p[n]);
    return ask(s, zone, first, count);
}

static status values(void *own, uint32_t zone, uint32_t field, uint32_t first, uint32_t count,
                     float *to) {
    const curvilinear_steps *s = own;
    const size_t plane = plane_of(s, zone);
    for (size_t n = 0; n < count * plane; n++)
        to[n] = curvilinear_steps_value(s, zone, first * plane + n, field, s->step);
    return ask(s, zone, first, count);
}

static status blanks(void *own, uint32_t zone, uint32_t first, uint32_t count, uint8_t *to) {
    const curvilinear_steps *s = own;
    const size_t plane = plane_of(s, zone);
    if (s->zones[zone].blank)
        memcpy(to, s->zones[zone].blank + first * plane, count * plane);
    else
        memset(to, 1, count * plane);
    return ask(s, zone, first, count);
}

static status open_step(void *ctx, uint32_t step, const curvilinear_source **out) {
    curvilinear_steps *s = ctx;
    s->step = s->before + step;
    *out = &s->source;
    return ST_OK;
}

static const char *path(void *ctx, uint32_t step) {
    (void)ctx, (void)step;
    return "arrays";
}

void curvilinear_steps_init(curvilinear_steps *s, const curvilinear_zone zones[], uint32_t count,
                            uint32_t fields, uint32_t steps) {
    *s = (curvilinear_steps){
        .zones = zones,
        .series = {s, open_step, path, {.fields = fields, .steps = steps}, false},
        .source = {s, count, (const uint32_t(*)[3])s->nodes, false, fields, places, values,
                   blanks}};
    for (uint32_t z = 0; z < count; z++) {
        memcpy(s->nodes[z], zones[z].nodes, sizeof s->nodes[z]);
        s->source.blanked = s->source.blanked || zones[z].blank;
    }
}
