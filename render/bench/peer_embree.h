/* peer_embree.h - Embree 3 draws a mesh: the same camera, picture, shading and threads as ours.
 *
 * Only leafcast-bench-peers links this unit. It is compiled for the machine that builds it
 * (-march=native): the peer is to run as fast as it can. Without Embree's header it is still there,
 * and peer_embree_create() says what to install.
 */
#ifndef RENDER_BENCH_PEER_EMBREE_H
#define RENDER_BENCH_PEER_EMBREE_H

#include <stdbool.h>

#include "formats/base/pool.h"
#include "render/bench/peer_mesh.h"
#include "render/leafcast.h"

typedef struct peer_embree peer_embree;

/* peer_embree_present() - whether this program was built with Embree. */
bool peer_embree_present(void);

/* peer_embree_create() - build the BVH over a mesh, which must outlive it.
 *
 * threads  of the build
 * high     RTC_BUILD_QUALITY_HIGH (spatial splits) instead of MEDIUM (binned SAH)
 *
 * ST_UNSUPPORTED without Embree.
 */
CHECKED status peer_embree_create(mem *m, const peer_mesh *mesh, int threads, bool high,
                                  peer_embree **out);
void peer_embree_destroy(peer_embree *e); /* NULL is fine */

/* peer_embree_version() - "3.13.5"; valid as long as e. */
const char *peer_embree_version(const peer_embree *e);

/* peer_embree_bytes() - what Embree holds: the BVH, with the triangles that it copied. */
size_t peer_embree_bytes(const peer_embree *e);

/* How the rays are handed over: 16, 8 or 1 at a time. */
typedef enum peer_packet { PEER_PACKET_16, PEER_PACKET_8, PEER_PACKET_1, PEER_PACKETS } peer_packet;

/* peer_embree_frame() - one picture: camera rays in 16x16 tiles, nearest hits, normals interpolated
 * between the vertices, diffuse shading with a headlight (M08 eq. 4.6, as shade.h).
 *
 * image  r, g, b and z where they are not NULL; with r NULL nothing is shaded: rays alone
 * hits   out: pixels that show the mesh
 */
CHECKED status peer_embree_frame(const peer_embree *e, pool *threads, peer_packet packet,
                                 const leafcast_camera *from, const leafcast_surface *surface,
                                 const leafcast_scene *scene, const leafcast_image *image,
                                 uint64_t *hits);

#endif
