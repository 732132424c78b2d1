/* rays.c - a thousand rays of one's own: every hit as a line: ray, t, isovalue, error bound of t.
 *
 *     cc rays.c $(pkg-config --cflags --libs leafcast) -o rays
 *     ./rays engine.leaf 80 120 >hits.txt
 */
#include <leafcast.h>

#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 40, RAYS = 1000, HITS = 64 };

static leafcast_status shoot(leafcast *volume, const leafcast_surface *surfaces) {
    const leafcast_info info = leafcast_describe(volume);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_status status = LEAFCAST_OK;
    leafcast_hit hits[HITS];
    /* Along z from one face of the box to the other, so that t is a share of its depth. */
    const double direction[3] = {0, 0, info.bounds[1][2] - info.bounds[0][2]};
    for (int ray = 0; ray < RAYS && status == LEAFCAST_OK; ray++) {
        const double u = (ray % SIDE + 0.5) / SIDE, v = (ray / SIDE + 0.5) / (RAYS / SIDE);
        const double origin[3] = {info.bounds[0][0] + u * (info.bounds[1][0] - info.bounds[0][0]),
                                  info.bounds[0][1] + v * (info.bounds[1][1] - info.bounds[0][1]),
                                  info.bounds[0][2]};
        int count = 0;
        status = leafcast_probe_ray(volume, &scene, origin, direction, hits, HITS, &count);
        for (int i = 0; i < count; i++)
            printf("%d %.17g %g %.3g\n", ray, hits[i].t, surfaces[hits[i].surface].isovalue,
                   hits[i].error_bound);
    }
    return status;
}

int main(int argc, char **argv) {
    leafcast *volume = NULL;
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    const int count = argc - 2;
    if (count < 1 || count > LEAFCAST_SURFACES_MAX) {
        fprintf(stderr, "rays FILE.leaf ISOVALUE...\n");
        return 2;
    }
    for (int i = 0; i < count; i++)
        surfaces[i] = leafcast_surface_default(strtod(argv[2 + i], NULL));
    leafcast_status status = leafcast_open(argv[1], NULL, &volume);
    if (status == LEAFCAST_OK)
        status = leafcast_select(volume, surfaces, count);
    if (status == LEAFCAST_OK)
        status = shoot(volume, surfaces);
    if (status != LEAFCAST_OK)
        fprintf(stderr, "%s\n", leafcast_error_text());
    leafcast_close(volume);
    return (int)status;
}
