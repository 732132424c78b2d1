/* bench_dynamic_scenes.h - surfaces that move, in the manner of M08's tables 5.8 and 5.9:
 * generated, the same on any machine.
 *
 *   helix      bends: a coiled tube
 *   helix 1M   the same, of a million triangles
 *   walker     a figure walks: limbs of two bones each, vertices between them blended (skinning)
 *   morph      from a ball over a cube to a star and back
 *   explosion  triangles of a ball fly apart to places at random: the worst case
 */
#ifndef RENDER_BENCH_BENCH_DYNAMIC_SCENES_H
#define RENDER_BENCH_BENCH_DYNAMIC_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct dynamic_scene dynamic_scene;
struct dynamic_scene {
    const char *name;
    uint32_t vertices, triangles;
    uint32_t (*rows)[3];
    float (*rest)[3];  /* the vertices before any pose; what they are is the scene's */
    uint8_t *part;     /* of the figure that each vertex is of; or NULL */
    float (*aside)[3]; /* where to, for those that fly; or NULL */
    void (*pose)(const dynamic_scene *s, double phase, float (*positions)[3]);
};

/* dynamic_scene_make() - scene number i; brief: a small one. ST_AGAIN behind the last. On failure
 * nothing is left. */
CHECKED status dynamic_scene_make(mem *m, int i, bool brief, dynamic_scene *out);
void dynamic_scene_release(mem *m, dynamic_scene *s);

#endif
