#include "formats/leaf/triangle_geometry.h"

#include "formats/base/exact.h"
#include "formats/leaf/hex_blending.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/listed_geometry.h"
#include "formats/leaf/triangle_coder.h"
#include "formats/leaf/triangle_normal.h"
#include "formats/leaf/triangle_verify.h"

triangle_shape triangle_shape_of(const uint32_t counts[4]) {
    triangle_shape s = {.triangles = counts[0], .vertices = counts[1], .normals = counts[2]};
    s.place_bytes = leaf_aligned(triangle_place_bytes(&s));
    s.topology_bytes = s.place_bytes + leaf_aligned(triangle_rows_bytes(&s));
    s.value_bytes = leaf_aligned(s.vertices * (uint32_t)sizeof(float));
    return s;
}

const char *triangle_counts_fault(const uint32_t counts[4], uint32_t treelet_triangles) {
    if (counts[0] < 1 || counts[0] > treelet_triangles)
        return "so many triangles";
    if (counts[1] < TRIANGLE_CORNERS || counts[1] > TRIANGLE_CORNERS * counts[0])
        return "so many vertices";
    if (counts[2] != 0 && counts[2] != counts[1])
        return "so many normals";
    return counts[3] ? "more than triangles, vertices and normals" : NULL;
}

/* Its three projections along axes have no area: with a point off the plane of an axis, each is a
 * tet without a volume. */
static bool is_flat_exactly(const float p[3][3]) {
    for (int axis = 0; axis < 3; axis++) {
        double x[4][3] = {{0.0}};
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                x[k][a] = a == axis ? 0.0 : (double)p[k][a];
        x[3][axis] = 1.0;
        if (exact_volume((const double(*)[3])x) != 0.0)
            return false;
    }
    return true;
}

bool triangle_is_flat(const float p[3][3]) {
    double e[2][3];
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = (double)p[k + 1][a] - (double)p[0][a];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const double up = e[0][b] * e[1][c], down = e[0][c] * e[1][b];
        if (fabs(up - down) > EXACT_BOUND * (fabs(up) + fabs(down)) + EXACT_SMALLEST)
            return false;
    }
    return is_flat_exactly(p);
}

bool triangle_have_normals(const leaf_file *f) {
    bool any = false;
    for (uint32_t t = 0; t < f->layout.treelets; t++)
        any = any || f->layout.counts[t][2] > 0;
    return any;
}

/* ---- Cells ---- */

static void count(hex_treelet *h) {
    const uint32_t *counts = h->f->layout.counts[h->id];
    h->cells = counts[0];
    h->nodes = counts[1];
}

static void row_of(const hex_treelet *h, uint32_t cell, uint32_t row[CELL_ROW]) {
    const triangle_shape s = triangle_shape_of(h->f->layout.counts[h->id]);
    const uint16_t *from = triangle_rows(&s, h->topology)[cell];
    for (int k = 0; k < CELL_ROW; k++)
        row[k] = from[k < TRIANGLE_CORNERS ? k : TRIANGLE_CORNERS - 1];
}

/* The normals of both, added by their shares; none where one of them has none. */
static void mix_normals(const hex_treelet *h, const float *const from[2], double share,
                        float *places) {
    const triangle_shape s = triangle_shape_of(h->f->layout.counts[h->id]);
    uint32_t *to = (uint32_t *)(void *)(places + 3 * (size_t)s.vertices);
    for (uint32_t n = 0; n < s.normals; n++) {
        double unit[2][3], sum[3] = {0.0, 0.0, 0.0};
        const bool both = triangle_normal_decode(triangle_place_normals(&s, from[0])[n], unit[0]) &&
                          triangle_normal_decode(triangle_place_normals(&s, from[1])[n], unit[1]);
        for (int a = 0; a < 3 && both; a++)
            sum[a] = (1.0 - share) * unit[0][a] + share * unit[1][a];
        to[n] = triangle_normal_encode(sum);
    }
}

static const leaf_noded noded = {.listed = true,
                                 .count = count,
                                 .row = row_of,
                                 .cells_max = TRIANGLES_MAX,
                                 .nodes_least = TRIANGLE_CORNERS,
                                 .nodes_each = TRIANGLE_CORNERS,
                                 .counts_fault = triangle_counts_fault,
                                 .mix = mix_normals};

const leaf_geometry triangle_geometry = {LISTED_GEOMETRY, .coder = &triangle_coder, .noded = &noded,
                                         .verifier = &triangle_verifier};
