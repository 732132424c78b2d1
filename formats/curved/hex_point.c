#include "formats/curved/hex_point.h"

#include <string.h>

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
    path_end e;
    if (!path_parts_at(path.part, hex_path_of(h, sense, &r, &path), 0.0, &e))
        return false;
    if (sense != 0) {
        double in[3] = {e.at[0], e.at[1], e.at[2]};
        hex_opened opened;
        hex_open(h, &path, &opened);
        hex_open_into(&opened, in);
        if (path_stretch_locate(&opened.map, 0.0, in)) {
            e.value = hexahedron_at(opened.map.value, in);
            hex_open_out(&opened, in);
            memcpy(e.at, in, sizeof e.at);
        }
    }
    memcpy(at, e.at, sizeof e.at);
    *value = e.value;
    return true;
}

bool hex_point_gradient(const hexahedron *h, const double at[3], double gradient[3]) {
    return hex_gradient(h, at, gradient);
}
