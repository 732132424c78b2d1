#include "render/curved/hex_point.h"

#include "formats/base/vec3.h"
#include "render/curved/hex_stretch.h"

bool hex_point_find(const hexahedron *h, int sense, const double point[3], double at[3],
                    double *value) {
    const ray along = {.o = {point[0], point[1], point[2]}, .d = {0.0, 0.0, 1.0}};
    const sheared_ray r = sheared_ray_of(&along);
    hex_path path;
    const int count = hex_path_of(h, sense, &r, &path);
    for (int i = 0; i < count; i++) {
        const hex_end *from = &path.part[i].end[0], *to = &path.part[i].end[1];
        if (!(from->t <= 0.0 && 0.0 < to->t))
            continue;
        const double share = -from->t / (to->t - from->t);
        double linear[3];
        for (int a = 0; a < 3; a++)
            at[a] = linear[a] = from->at[a] + share * (to->at[a] - from->at[a]);
        if (sense != 0 && hex_stretch_locate(path.q, 0.0, at)) {
            *value = hexahedron_at(h->value, at);
            return true;
        }
        for (int a = 0; a < 3; a++)
            at[a] = linear[a];
        *value = from->value + share * (to->value - from->value);
        return true;
    }
    return false;
}

bool hex_point_gradient(const hexahedron *h, const double at[3], double gradient[3]) {
    double slope[3], edge[3][3];
    hexahedron_slope(h->value, at, slope);
    for (int a = 0; a < 3; a++) {
        double p[HEX_CORNERS], along[3];
        for (int c = 0; c < HEX_CORNERS; c++)
            p[c] = h->p[c][a];
        hexahedron_slope(p, at, along);
        for (int k = 0; k < 3; k++)
            edge[k][a] = along[k];
    }
    const double det = vec3_det(edge[0], edge[1], edge[2]);
    const double most = vec3_size(edge[0]) * vec3_size(edge[1]) * vec3_size(edge[2]);
    for (int a = 0; a < 3; a++)
        gradient[a] = 0.0;
    if (!(fabs(det) > 0x1p-48 * most))
        return false;
    for (int k = 0; k < 3; k++) {
        double across[3];
        vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across);
        for (int a = 0; a < 3; a++)
            gradient[a] += slope[k] / det * across[a];
    }
    return true;
}
