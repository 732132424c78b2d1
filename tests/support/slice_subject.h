/* slice_subject.h - files to slice, and what the second readers say of each point: what the tests
 * of slices share. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_SLICE_SUBJECT_H
#define TESTS_SUPPORT_SLICE_SUBJECT_H

#include "render/leafcast.h"
#include "tests/support/fields.h"
#include "tests/support/naive_points.h"

/* A file in both views. */
typedef struct slice_subject {
    char path[600];
    bool mesh;
    naive_leaf grid;
    naive_mesh tets;
} slice_subject;

/* slice_subject_of_field(), slice_subject_of_mesh() - of a field or a mesh by name; type NULL: its
 * own. slice_subject_turned() - a volume that is turned, sheared a bit, and far away.
 * slice_subject_one() - 0: a grid, 1: the turned one, 2: a mesh. Free each. */
slice_subject *slice_subject_of_field(const char *name, const char *type, long n, bool compressed);
slice_subject *slice_subject_of_mesh(const char *name, int cubes, uint32_t treelet_tets);
slice_subject *slice_subject_turned(void);
slice_subject *slice_subject_one(int which);
void slice_subject_free(slice_subject *s);

naive_point slice_subject_truth(const slice_subject *s, int level, const double point[3]);

/* slice_subject_turned_value() - a sample of the turned one. */
enum { SLICE_TURNED_X = 37, SLICE_TURNED_Y = 22, SLICE_TURNED_Z = 19 };
float slice_subject_turned_value(long i, long j, long k);

/* slice_subject_sized() - a slice of that size that lies nowhere yet. slice_subject_slice() - one
 * at random, across the volume and somewhat beyond it, of SLICE_PIXELS pixels.
 * slice_subject_pixel() - where pixel i lies. */
enum { SLICE_WIDTH = 61, SLICE_HEIGHT = 47, SLICE_PIXELS = SLICE_WIDTH * SLICE_HEIGHT };
leafcast_slice_pixels slice_subject_sized(uint32_t width, uint32_t height);
leafcast_slice_pixels slice_subject_slice(const leafcast *v, field_random *r);
void slice_subject_pixel(const leafcast_slice_pixels *s, int i, double point[3]);

leafcast_stats slice_subject_sample(leafcast *v, const leafcast_slice_pixels *s, double *value);

#endif
