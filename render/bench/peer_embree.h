/* peer_embree.h - Embree 3 draws a mesh: the same camera, picture, shading and threads as ours.
 *
 * Only leafcast-bench-peers links this unit. It is compiled for the machine that builds it
 * (-march=native): the peer is to run as fast as it can. Without Embree's header it is still there,
 * and peer_embree_create() says what to install.
 */
#ifndef RENDER_BENCH_PEER_EMBREE_H
#define RENDER_BENCH_PEER_EMBREE_H

#include <stdbool.h>

#include "formats/base/cpu.h"
#include "formats/base/pool.h"
#include "render/bench/peer_mesh.h"
#include "render/leafcast.h"

typedef struct peer_embree peer_embree;

/* peer_embree_present() - whether this program was built with Embree. */
bool peer_embree_present(void);

typedef struct peer_build {
    int threads;
    bool high;     /* RTC_BUILD_QUALITY_HIGH (spatial splits) instead of MEDIUM (binned SAH) */
    bool one_pass; /* for frames that go that way */
    cpu_isa isa;   /* instructions that Embree uses; CPU_SCALAR: those it likes best */
} peer_build;

/* peer_embree_create() - build the BVH over a mesh, which must outlive it. ST_UNSUPPORTED without
 * Embree. */
CHECKED status peer_embree_create(mem *m, const peer_mesh *mesh, const peer_build *how,
                                  peer_embree **out);
void peer_embree_destroy(peer_embree *e); /* NULL is fine */

/* peer_embree_version() - "3.13.5"; valid as long as e. */
const char *peer_embree_version(const peer_embree *e);

/* peer_embree_bytes() - what Embree holds: the BVH, with the triangles that it copied. */
size_t peer_embree_bytes(const peer_embree *e);

/* How the rays are handed over: 16, 8 or 1 at a time. */
typedef enum peer_packet { PEER_PACKET_16, PEER_PACKET_8, PEER_PACKET_1, PEER_PACKETS } peer_packet;

typedef struct peer_way {
    peer_packet packet;
    bool incoherent; /* what Embree is told of rays behind the first surface, and to lights */
    bool one_pass; /* all surfaces on a ray in one traversal, by a filter that collects them, of 16
                      rays; else each surface by another ray behind the one before */
} peer_way;

/* peer_embree_layers() - after how many surfaces of this opacity (below 1) a ray ends at the
 * latest. One pass does for up to PEER_COLLECTED_MAX. */
enum { PEER_COLLECTED_MAX = 32 };
int peer_embree_layers(int layers_max, float opacity);

/* What is drawn: one surface through a camera, with the scene's lights, shadows and layers. */
typedef struct peer_view {
    const leafcast_camera *camera;
    const leafcast_surface *surface;
    const leafcast_scene *scene;
    double cell; /* world length of one: rays behind a surface begin a thousandth of it behind */
} peer_view;

typedef struct peer_counts {
    uint64_t hits;        /* pixels that show the mesh */
    uint64_t surfaces;    /* that made the picture */
    uint64_t shadow_rays; /* towards lights */
} peer_counts;

/* peer_embree_frame() - one picture: camera rays in 16x16 tiles, nearest hits, normals interpolated
 * between the vertices, diffuse shading (M08 eq. 4.6, as shade.h) by a headlight or by the scene's
 * lights, to which rays of rtcOccludedN go where it has shadows; a transparent surface, and then
 * what is behind it. A light is hidden, too, where the triangle is seen from its other side.
 *
 * way.one_pass  e was made for it
 * image         r, g, b and z where they are not NULL; with r NULL nothing is shaded: rays alone
 */
CHECKED status peer_embree_frame(const peer_embree *e, pool *threads, const peer_way *way,
                                 const peer_view *view, const leafcast_image *image,
                                 peer_counts *counts);

#endif
