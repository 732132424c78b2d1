/* medium_lab.h - the laboratory of media and projections: small pictures of hostile volumes through
 * the public interface, each pixel of which is judged by the reference (ref_media.h).
 *
 * A picture is told by the name of its volume (a field of fields.h, a field of another type, a
 * sound mesh of tet_meshes.h), the kind of its transfer function or projection, and a seed, from
 * which come the camera, the bound asked for, clips, background and a surface in the medium. These
 * are faults:
 *
 *   outside  a channel is further from the integral than the pixel's own bound
 *   loose    the bound is above the one asked for, and the picture does not count it as
 * uncertified; or a bound is no number
 *
 * And this is none:
 *
 *   refused  a bound above the one asked for, which the picture counts
 *   grazing  a ray whose way leads through other cells when it is moved by 1e-9 of its distance, or
 *            whose surfaces do so; or that begins in the last face: not judged. Rays along edges
 * and in faces are such.
 */
#ifndef TESTS_SUPPORT_MEDIUM_LAB_H
#define TESTS_SUPPORT_MEDIUM_LAB_H

#include "tests/support/hostile_transfer.h"
#include "tests/support/ref_media.h"
#include "tests/support/tet_meshes.h"

/* A volume: opened, and for the reference. One at a time. */
typedef struct medium_body {
    char name[40];
    const char *path;
    leafcast *volume;
    field field;   /* of a grid */
    lab_mesh mesh; /* tet_count 0: it is none */
    ref_volume as_grid;
    tet_ref_mesh as_mesh;
    transfer_range range;
    bool
        tame; /* no wild values: nothing need be refused, unless the transfer function is hostile */
} medium_body;

/* medium_body_count(), medium_body_name() - all that there are. medium_body_make() - trouble fails
 * the running test. options may be NULL. */
int medium_body_count(void);
const char *medium_body_name(int index);
void medium_body_make(medium_body *b, int index, const leafcast_options *options);
void medium_body_release(medium_body *b);

/* medium_body_of_mesh() - a mesh of tet_meshes.h of more cubes, in many treelets. */
void medium_body_of_mesh(medium_body *b, const char *name, int cubes);

/* medium_body_of_bytes() - of samples of the test's own, x fastest, on a lattice of spacing 1 from
 * 0 on. */
void medium_body_of_bytes(medium_body *b, const char *name, const long dims[3],
                          const uint8_t *samples);

/* medium_body_reopen() - with other options. */
leafcast_status medium_body_reopen(medium_body *b, const leafcast_options *options);

/* medium_body_pieces() - of a ray, as far as the clip keeps it. */
size_t medium_body_pieces(const medium_body *b, const ref_ray *ray, const ref_clip *clip,
                          ref_piece *out, size_t room);

/* medium_body_clip() - one in three scenes is clipped, by a box (told in box, too), by planes or
 * both: for the scene, and for the reference, which points into scene and box. */
ref_clip medium_body_clip(const medium_body *b, field_random *r, leafcast_scene *scene,
                          double box[2][3]);

typedef struct medium_tally {
    uint64_t rays, seen; /* seen: something is on the way */
    uint64_t outside, loose, refused, grazing;
    uint64_t needless; /* refused though the bound asked for is wide, and without a surface */
    uint64_t rounded;  /* right but for the rounding of the ray to the volume's own space */
    double worst;      /* error, in bounds */
} medium_tally;

/* One picture. */
typedef struct medium_job {
    const medium_body *body;
    const medium_body *beside; /* filled too, on the same device; NULL: nothing is */
    int kind;                  /* of hostile_transfer() */
    uint64_t seed;
    const char *rerun; /* how a printed line begins: the program */
    bool tell_all;     /* print every pixel */
} medium_job;

/* medium_lab_draw() - judges a picture with a medium; faults are printed, a few. */
void medium_lab_draw(const medium_job *job, medium_tally *sum);

/* medium_lab_project() - the same of a projection, `kind` a leafcast_project: its values, and where
 * they are. `outside`: further from the reference than rounding explains. */
void medium_lab_project(const medium_job *job, medium_tally *sum);

/* medium_lab_planes() - the picture alone. */
enum { MEDIUM_WIDTH = 8, MEDIUM_HEIGHT = 6, MEDIUM_PIXELS = MEDIUM_WIDTH * MEDIUM_HEIGHT };
typedef struct medium_planes {
    double rgba[MEDIUM_PIXELS][4], error[MEDIUM_PIXELS];
} medium_planes;
leafcast_status medium_lab_planes(const medium_job *job, medium_planes *planes);

/* medium_lab_ask() - the same picture with a bound and a medium of the test's own (NULL: the
 * job's); off: how far each pixel is from the integral, NaN where the way of its ray is a matter of
 * rounding.
 */
leafcast_status medium_lab_ask(const medium_job *job, double asked, const leafcast_medium *medium,
                               medium_planes *planes, double off[MEDIUM_PIXELS]);

void medium_tally_add(medium_tally *to, const medium_tally *from);
uint64_t medium_tally_faults(const medium_tally *t);
void medium_tally_print(const char *name, const char *kind, const medium_tally *t);

#endif
