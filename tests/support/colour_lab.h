/* colour_lab.h - files of all kinds, and scenes of one volume whose surfaces another one colours:
 * what tests of that share. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_COLOUR_LAB_H
#define TESTS_SUPPORT_COLOUR_LAB_H

#include "render/leafcast.h"
#include "tests/support/heights_lab.h"
#include "tests/support/pictures.h"

/* The files. Those before COLOURING colour others, and so does an image; SERIES: no file yet. */
enum {
    GRID,
    HOLES,
    MESH,
    CURVED,
    MIXED,
    HEIGHTS,
    COLOURING,
    TRIANGLES = COLOURING,
    FILES,
    SERIES = FILES,
    IMAGE
};
extern const char *const colour_lab_names[FILES];
extern char colour_lab_paths[IMAGE + 1][600];

/* What the image was made of: heights that are colours. */
extern heights_terrain colour_lab_image;

/* colour_lab_set() - make the files: of a group of tests, whose end is scene_stage_clear(). */
int colour_lab_set(void **state);

/* colour_lab_keep() - let a path be that of a file. colour_lab_place() - the place that takes a
 * volume's box to [0, 10]^3, turned about the third axis and scaled. */
void colour_lab_keep(int which, const char *path);
void colour_lab_place(const leafcast *v, double angle, double scale, double place[12]);

/* A scene of one volume coloured by another. */
typedef struct coloured {
    leafcast_device *device;
    leafcast *of, *by;
    double place[2][12];
    leafcast_transfer_point points[3];
    leafcast_medium map;
    leafcast_surface surfaces[2];
    leafcast_colouring colouring;
    leafcast_shown shown;
    leafcast_scene scene;
    leafcast_camera camera;
} coloured;

/* Where the two lie: as their files say; both at places; or only what colours, so that the other is
 * drawn by kernels of tiles. */
typedef enum where { AS_FILES_SAY, PLACED, TILED } where;

/* colour_lab_open() - the scene of a file coloured by another. device: NULL: the default one.
 * treelets: at most so many of each in memory; 0: all. */
void colour_lab_open(coloured *c, int of, int by, where how, const leafcast_options *device,
                     uint32_t treelets);
void colour_lab_close(coloured *c);

/* colour_lab_refused() - assert that the scene is refused with a message that has these words. */
void colour_lab_refused(coloured *c, const char *said);

#endif
