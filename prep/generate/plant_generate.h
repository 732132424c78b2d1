/* plant_generate.h - small plants of triangles, for scenes that place them many times: in metres,
 * the root at the origin, upright along z. The same seed gives the same bytes on any machine.
 *
 * A stem is a chain of tapering rings; twigs grow out of it, and out of these others, each turned
 * by the golden angle from the one before. Leaves are pairs of triangles, needles single ones. Part
 * of each root lies below z = 0, for ground that is not even.
 */
#ifndef PREP_GENERATE_PLANT_GENERATE_H
#define PREP_GENERATE_PLANT_GENERATE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef enum plant_shape { PLANT_CONIFER, PLANT_BROADLEAF, PLANT_BUSH, PLANT_GRASS } plant_shape;

/* plant_shape_find() - by name: conifer, broadleaf, bush, grass. Returns false if there is none.
 * plant_shape_names() - all of them, for messages. */
bool plant_shape_find(const char *name, plant_shape *shape);
const char *plant_shape_names(void);

typedef struct plant {
    float (*vertices)[3];
    uint8_t (*rgb)[3]; /* of each */
    uint32_t (*triangles)[3];
    uint32_t vertex_count, triangle_count;
} plant;

/* plant_grow() - make a plant, which is the caller's to plant_release(). ST_NOMEM. */
CHECKED status plant_grow(mem *m, plant_shape shape, uint64_t seed, plant *out);
void plant_release(mem *m, plant *p);

/* plant_generate() - write a plant as PLY, of vertices with colours, and say how many triangles it
 * has. */
CHECKED status plant_generate(mem *m, plant_shape shape, uint64_t seed, const char *output,
                              bool force, uint32_t *triangles);

#endif
