#include "formats/leaf/triangle_verify.h"

#include "formats/leaf/places_verify.h"
#include "formats/leaf/triangle_geometry.h"
#include "formats/leaf/triangle_normal.h"

/* A treelet while it is checked. */
typedef struct subject {
    places_subject of;
    triangle_shape shape;
} subject;

static status check_rows(const subject *s, const char *topology) {
    const triangle_shape *shape = &s->shape;
    const uint16_t(*rows)[3] = triangle_rows(shape, topology);
    uint32_t met = 0;
    for (uint32_t i = 0; i < shape->triangles; i++)
        for (uint32_t c = 0; c < TRIANGLE_CORNERS; c++) {
            const size_t at = shape->place_bytes + (TRIANGLE_CORNERS * i + c) * sizeof(uint16_t);
            if (rows[i][c] >= shape->vertices)
                return places_wrong(&s->of, at, "a triangle is at no vertex");
            if (rows[i][c] > met)
                return places_wrong(&s->of, at, "vertices are not in the order of their first use");
            met += rows[i][c] == met;
        }
    if (met < shape->vertices)
        return places_wrong(&s->of, met * sizeof(float), "a vertex is at no triangle");
    return places_check_zeros(&s->of, topology, shape->place_bytes + triangle_rows_bytes(shape),
                              shape->topology_bytes);
}

static status check_normals(const subject *s) {
    const uint32_t *normals = triangle_place_normals(&s->shape, s->of.places);
    for (uint32_t n = 0; n < s->shape.normals; n++)
        if (!triangle_normal_is_code(normals[n]))
            return places_wrong(&s->of, (3 * (size_t)s->shape.vertices + n) * sizeof(uint32_t),
                                "a normal is none");
    return ST_OK;
}

static status check_places(subject *s, uint32_t step) {
    const leaf_layout *l = &s->of.f->layout;
    const uint32_t place = leaf_layout_place(l, step), t = s->of.t;
    s->of.payload = place ? leaf_layout_positions(l, place, t) : t;
    status st = places_check_box(
        &s->of, triangle_directory_of(s->of.f)->bounds[leaf_layout_bounds(l, step, t)]);
    if (st == ST_OK)
        st = check_normals(s);
    return st == ST_OK ? places_check_zeros(&s->of, s->of.places, triangle_place_bytes(&s->shape),
                                            s->shape.place_bytes)
                       : st;
}

static uint64_t triangles_of(const leaf_file *f) {
    return f->header.tets;
}

/* The topology, the places of another step, values. */
static size_t room_of(const leaf_file *f) {
    return 3 * (size_t)leaf_layout_payload_max(&f->layout);
}

static status verify_step(const leaf_verifying *v, subject *s, uint32_t step, char *room,
                          uint64_t *non_finite) {
    const leaf_layout *l = &v->f->layout;
    const uint32_t place = leaf_layout_place(l, step);
    char *values = room + leaf_layout_payload_max(l);
    status st = ST_OK;
    if (place > 0) {
        st = v->load(v, leaf_layout_positions(l, place, s->of.t), room);
        s->of.places = (const float *)(void *)room;
    }
    if (st == ST_OK && (step == 0 || place > 0))
        st = check_places(s, step);
    for (uint32_t field = 0; field * l->steps < l->sets && st == ST_OK; field++) {
        const uint32_t set = leaf_layout_set(l, field, step);
        st = v->load(v, leaf_layout_values(l, set, s->of.t), values);
        s->of.values = (const float *)(void *)values;
        if (st == ST_OK)
            st = places_check_values(&s->of, set, s->shape.value_bytes, non_finite);
    }
    return st;
}

static status verify_treelet(const leaf_verifying *v, uint32_t treelet, uint64_t *non_finite) {
    const leaf_layout *l = &v->f->layout;
    const size_t each = leaf_layout_payload_max(l);
    subject s = {.of = {.f = v->f, .t = treelet, .payload = treelet},
                 .shape = triangle_shape_of(l->counts[treelet])};
    s.of.nodes = s.shape.vertices;
    s.of.places = (const float *)(void *)v->room;
    status st = v->load(v, treelet, v->room);
    if (st == ST_OK)
        st = check_rows(&s, v->room);
    for (uint32_t step = 0; step < l->steps && st == ST_OK; step++)
        st = verify_step(v, &s, step, v->room + each, non_finite);
    return st;
}

const leaf_verifier triangle_verifier = {"triangles", triangles_of, room_of, verify_treelet};
