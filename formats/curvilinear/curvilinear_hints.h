/* curvilinear_hints.h - what the command line says of a curvilinear grid. Zero/NULL = not given. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_HINTS_H
#define FORMATS_CURVILINEAR_CURVILINEAR_HINTS_H

typedef struct curvilinear_hints {
    const char *field; /* the field's name; NULL: the default. Of a vector also "velocity_x" */
    int component;     /* component of a vector: 1, 2, ..; 0: its magnitude */
    const char *name;  /* name of the data set, in place of the grid's own */
    /* PLOT3D: paths of the files that go with the grid, and how all of them are written: words
     * split by commas, see plot3d_layout.h. Any of these makes any regular file a
     * PLOT3D grid. */
    const char *solution, *functions, *layout;
} curvilinear_hints;

#endif
