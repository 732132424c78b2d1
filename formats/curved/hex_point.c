#include "formats/curved/hex_point.h"

#include "formats/base/simd_one.h"
#include "formats/base/vec3.h"
#include "formats/curved/curved_normal_template.h"
#include "formats/curved/hex_open.h"
#include "formats/curved/path_stretch.h"

bool hex_point_find(const hexahedron *h, int sense, const double point[3], double at[3],
                    double *value) {
    static const double up[3] = {0.0, 0.0, 1.0};
    const sheared_ray r = sheared_ray_of(point, up);
    hex_path path;
    const int count = hex_path_of(h, sense, &r, &path);
    for (int i = 0; i < count; i++) {
        const path_end *from = &path.part[i].end[0], *to = &path.part[i].end[1];
        if (!(from->t <= 0.0 && 0.0 < to->t))
            continue;
        const double share = -from->t / (to->t - from->t);
        double linear[3], in[3];
        hex_opened opened;
        hex_open(h, &path, &opened);
        for (int a = 0; a < 3; a++)
            at[a] = linear[a] = from->at[a] + share * (to->at[a] - from->at[a]);
        for (int a = 0; a < 3; a++)
            in[a] = linear[a];
        hex_open_into(&opened, in);
        if (sense != 0 && path_stretch_locate(&opened.map, 0.0, in)) {
            *value = hexahedron_at(opened.map.value, in);
            hex_open_out(&opened, in);
            for (int a = 0; a < 3; a++)
                at[a] = in[a];
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
    return hex_gradient(h, at, gradient);
}
