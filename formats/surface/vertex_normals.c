#include "formats/surface/vertex_normals.h"

#include <assert.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/triangle_normal.h"

#define NO_PLACE UINT32_MAX

/* Twice as many slots as vertices, or more. */
static size_t slots_for(size_t room) {
    size_t slots = 2;
    while (slots < 2 * room)
        slots *= 2;
    return slots;
}

size_t vertex_normals_memory(size_t room) {
    return room * (sizeof(vertex_sum) + sizeof(uint32_t)) + slots_for(room) * sizeof(uint32_t) +
           512;
}

status vertex_normals_init(vertex_normals *v, mem *m, size_t room) {
    assert(room > 0 && room < NO_PLACE);
    *v = (vertex_normals){.m = m, .room = room, .mask = slots_for(room) - 1};
    v->sums = mem_array(m, room, sizeof *v->sums);
    v->place_of = mem_array(m, room, sizeof *v->place_of);
    v->slots = mem_array(m, v->mask + 1, sizeof *v->slots);
    return v->sums && v->place_of && v->slots ? ST_OK : ST_NOMEM;
}

void vertex_normals_release(vertex_normals *v) {
    mem_free(v->m, v->sums);
    mem_free(v->m, v->place_of);
    mem_free(v->m, v->slots);
    *v = (vertex_normals){.m = v->m};
}

void vertex_normals_begin(vertex_normals *v) {
    v->count = 0;
    v->places = 0;
    memset(v->slots, 0xff, (v->mask + 1) * sizeof *v->slots);
}

static uint64_t mixed(uint64_t x) {
    x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
    return x ^ x >> 29;
}

/* Returns the slot of a place, or the empty one where it belongs. */
static uint32_t *slot_of(const vertex_normals *v, const float at[3]) {
    uint32_t bits[3];
    memcpy(bits, at, sizeof bits);
    const uint64_t hash = mixed(mixed(bits[0] | (uint64_t)bits[1] << 32) + bits[2]);
    for (size_t i = hash & v->mask;; i = (i + 1) & v->mask) {
        const uint32_t place = v->slots[i];
        if (place == NO_PLACE || memcmp(v->sums[place].at, at, sizeof v->sums[place].at) == 0)
            return &v->slots[i];
    }
}

/* -0 and 0 are one place. */
static void take_place(const float at[3], float to[3]) {
    for (int a = 0; a < 3; a++)
        to[a] = at[a] + 0.0f;
}

void vertex_normals_put(vertex_normals *v, const float at[3]) {
    float place[3];
    assert(v->count < v->room);
    take_place(at, place);
    uint32_t *slot = slot_of(v, place);
    if (*slot == NO_PLACE) {
        *slot = v->places++;
        v->sums[*slot] = (vertex_sum){.at = {place[0], place[1], place[2]}};
    }
    v->place_of[v->count++] = *slot;
}

static uint32_t place_at(const vertex_normals *v, const float at[3]) {
    float place[3];
    take_place(at, place);
    return *slot_of(v, place);
}

void vertex_normals_add(vertex_normals *v, const float corner[3][3], const size_t numbers[3]) {
    double e[2][3], normal[3];
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = (double)corner[k + 1][a] - (double)corner[0][a];
    vec3_cross(e[0], e[1], normal);
    for (int k = 0; k < 3; k++) {
        const uint32_t place =
            numbers[k] < v->count ? v->place_of[numbers[k]] : place_at(v, corner[k]);
        for (int a = 0; a < 3 && place != NO_PLACE; a++)
            v->sums[place].sum[a] += normal[a];
    }
}

uint32_t vertex_normals_code(const vertex_normals *v, size_t number) {
    return triangle_normal_encode(v->sums[v->place_of[number]].sum);
}
