/* leafcast_dynamic.h - surfaces of triangles in memory, whose vertices move while they are drawn.
 *
 * Part of leafcast.h, which includes it, and which says how arguments are checked.
 *
 *     leafcast_open_triangles(&mesh, NULL, &volume);
 *     leafcast_surface skin = leafcast_surface_default(0);
 *     leafcast_select(volume, &skin, 1);
 *     while (animate(positions)) {
 *         leafcast_update_vertices(volume, positions, mesh.vertex_count);
 *         leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
 *     }
 *     leafcast_close(volume);
 *
 * Such a volume can do all that a file of triangles of one step can, exactly: alone or in a scene,
 * at places, with media, by pictures, rays and probes. After an update every ray finds what it
 * would find in a volume that was opened with these positions, to the bit. It costs more the more
 * the motion tears triangles apart that were neighbours at first, since boxes are made anew around
 * the same triangles: a body that bends or walks keeps them together; after an explosion opening
 * anew pays.
 */
#ifndef RENDER_LEAFCAST_DYNAMIC_H
#define RENDER_LEAFCAST_DYNAMIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_look.h>
#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct leafcast_options;

enum { LEAFCAST_TRIANGLES_MAX = 1 << 30 };

typedef struct leafcast_triangles {
    size_t size;
    uint32_t vertex_count, triangle_count; /* 1 to LEAFCAST_TRIANGLES_MAX */
    const float (*vertices)[3];            /* finite */
    /* Vertices of each triangle: below vertex_count. From where they go round to the left is the
     * front. A triangle may be without an area, or become so: then no ray meets it. */
    const uint32_t (*triangles)[3];
    const float *values;     /* one a vertex, any; NULL: none. A triangle without finite values is
                                not there */
    const uint32_t *colours; /* one a vertex, 0xRRGGBB in sRGB; NULL: none. With values, too, they
                                are the field behind these: its name is "rgb" */
    const char *field;       /* name of the values, not "rgb"; NULL: "value" */
    bool smooth;             /* shaded by normals at the vertices, which are made from the triangles
                                around each, as `convert --normals smooth` does; anew at each update,
                                by one thread */
} leafcast_triangles;

/* leafcast_open_triangles() - opens a surface, and copies what it needs. Cells are the triangles,
 * with the caller's numbers. options may be NULL for the defaults; `backend` does not matter.
 *
 * All of it is in memory, of the device's budget: some 100 bytes a triangle. LEAFCAST_NOMEM tells
 * how much would do. LEAFCAST_USAGE names the first triangle with a vertex that there is not, or
 * the first vertex that is not finite. */
LEAFCAST_API leafcast_status leafcast_open_triangles(const leafcast_triangles *triangles,
                                                     const struct leafcast_options *options,
                                                     leafcast **volume);

/* leafcast_update_vertices() - gives all vertices other positions, finite ones, count =
 * vertex_count of them: whatever begins from now on shows these. leafcast_get_info() then tells
 * their bounds.
 *
 * Any thread; one update goes on at a time, others wait. Positions are in memory twice: a picture
 * that has begun shows those it began with to its end, of leafcast_frame_begin() and
 * leafcast_frame_end() where it is drawn bit by bit, and no update waits for it; but the next one
 * does. LEAFCAST_USAGE where that is a frame which this thread itself has begun and not ended,
 * whoever goes on with it. Done by as many threads as the device draws with, by others: they need
 * not wait for a picture.
 *
 * LEAFCAST_USAGE names the first vertex that is not finite. After a failure nothing has changed. */
LEAFCAST_API leafcast_status leafcast_update_vertices(leafcast *volume, const float (*positions)[3],
                                                      size_t count);

#ifdef __cplusplus
}
#endif

#endif
