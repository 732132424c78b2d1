/* input_facts.h - what can be said of an input before it is converted: what it is, where it lies,
 * how its values are spread.
 *
 * The samples of a grid are read once, as a stream, in blocks of up to 32 MiB, or a quarter of the
 * budget where that is less. A mesh is read once; its points and values are kept (16 bytes each),
 * its tets are not.
 */
#ifndef FORMATS_INPUT_FACTS_H
#define FORMATS_INPUT_FACTS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/leaf/histogram.h"
#include "formats/mesh/mesh_input.h"

enum { INPUT_FACTS_FIELDS = 256, INPUT_FACTS_TIMES = 4096 };

/* One that could have been asked for. */
typedef struct input_field {
    char name[MESH_NAME_MAX + 1];
    uint32_t steps, components; /* 1 or more */
} input_field;

typedef struct input_facts {
    const char *path;   /* as given */
    const char *format; /* "NRRD"; constant */
    bool is_mesh;
    bool is_raw;          /* samples whose sizes the hints, a JSON or the name told */
    bool has_fields;      /* of a grid: see volume_has_fields() */
    const char *importer; /* of a grid: see volume_importer(); constant */
    char name[MESH_NAME_MAX + 1];
    /* a grid */
    uint32_t dims[3];
    sample_type type, source; /* as read, and in the file */
    double to_world[12];
    world_frame frame;
    bool rectilinear;
    absent_parts absent;
    char note[GRID_NOTE_MAX]; /* see struct grid */
    /* fields that have a name, and what is taken of them */
    input_field fields[INPUT_FACTS_FIELDS];
    uint32_t field_count; /* may be more than are listed */
    char field[MESH_NAME_MAX + 1];
    uint32_t steps, components; /* that it has */
    uint32_t component;         /* the number that is taken, from 1; 0: all, together */
    bool colours;               /* as a luminance, not a magnitude */
    bool timed;                 /* the steps have times: the first ones, and the last */
    double times[INPUT_FACTS_TIMES], last_time;
    /* a mesh; counts and bounds (lo, hi) when it was read */
    mesh_report report;
    float bounds[6];
    /* values */
    bool read;           /* not with header_only */
    double range[2];     /* of all finite values; lo > hi: none */
    uint64_t non_finite; /* NaN and inf */
    uint64_t trailing;   /* bytes behind the samples */
    histogram values;
} input_facts;

typedef struct input_question {
    const char *path; /* "-": standard input */
    volume_hints grid;
    mesh_hints mesh;
    bool header_only; /* the values are not looked at, nor counted what a mesh has */
    /* Asked once the header has been read, before the values are; a status other than ST_OK ends
     * it. NULL: nobody. */
    status (*opened)(void *ctx, const struct input_facts *x);
    void *ctx;
} input_question;

/* input_facts_read() - ST_CORRUPT, ST_UNSUPPORTED, ST_IO as the readers have it, ST_NOMEM. The
 * facts point into the question. p may be NULL. About 80 KB: not for a small stack. */
CHECKED status input_facts_read(mem *m, const input_question *q, const progress *p,
                                input_facts *out);

/* input_facts_print() - for people, lines that begin with a word. input_facts_json() - for
 * programs, see the man page of info; NULL: no memory. */
void input_facts_print(FILE *to, const input_facts *x);
json_t *input_facts_json(const input_facts *x);

/* input_facts_next() - the command that converts it, as a shell takes it; quoted where need be.
 * False where it does not fit: text is of no use then. */
bool input_facts_next(const input_facts *x, const input_question *q, char *text, size_t room);

#endif
