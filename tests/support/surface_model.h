/* surface_model.h - one model, a cube of 8 points and 12 triangles with a value at each point and
 * face and colours of the points, written in every format that is read.
 */
#ifndef TESTS_SUPPORT_SURFACE_MODEL_H
#define TESTS_SUPPORT_SURFACE_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum { SURFACE_MODEL_POINTS = 8, SURFACE_MODEL_TRIANGLES = 12 };

extern const float surface_model_xyz[SURFACE_MODEL_POINTS][3];
extern const uint32_t surface_model_triangles[SURFACE_MODEL_TRIANGLES][3];

/* The value of a point, of a face, and the colour of a point as of surface_colour.h. */
float surface_model_value(uint32_t point);
float surface_model_face(uint32_t face);
float surface_model_colour(uint32_t point);

typedef struct surface_model_form {
    const char *name;                    /* of the file; the suffix tells the format */
    const char *format;                  /* as mesh_input_format() names it */
    bool values, faces, colours, apart;  /* what the format has; apart: points are not shared */
    bool piped;                          /* may be read from a pipe */
    const char *scalar, *of_faces, *rgb; /* the fields' names */
} surface_model_form;

/* All forms; the last has no name. */
extern const surface_model_form surface_model_forms[];

/* surface_model_write() - write one into the scratch folder; returns its path. */
const char *surface_model_write(const surface_model_form *form);

#endif
