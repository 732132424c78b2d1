/* priority.h - which treelet a waiting ray needs first: smaller comes first.
 *
 * Primary rays come first, front to back from the eye; then shadow rays, light by light, from the
 * surfaces towards the light. Along any ray priorities rise, so that with few treelets resident at
 * a time nearly every one is still read once.
 */
#ifndef RENDER_PRIORITY_H
#define RENDER_PRIORITY_H

#include "render/frame.h"

enum { PRIORITY_PRIMARY = -1 }; /* instead of a light */

/* priority_of() - of treelet t for a ray towards a light of the scene, by its index. */
uint64_t priority_of(const frame *f, uint32_t t, int32_t light_index);

#endif
