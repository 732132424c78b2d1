/* urgency.h - which treelet a waiting ray needs first: smaller comes first.
 *
 * Primary rays come first, front to back from the eye; then shadow rays, light by light, from the
 * surfaces towards the light. Along any ray urgencies rise, so that with few treelets resident at a
 * time nearly every one is still read once.
 */
#ifndef RENDER_URGENCY_H
#define RENDER_URGENCY_H

#include "render/frame.h"

enum { URGENCY_PRIMARY = -1 }; /* instead of a light */

/* urgency_of() - of treelet t for a ray towards a light of the scene, by its index. */
uint64_t urgency_of(const frame *f, uint32_t t, int32_t light_index);

#endif
