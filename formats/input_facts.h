/* input_facts.h - what can be said of an input before it is converted: what it is, where it lies,
 * and the distribution of its values. The input is read once.
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
#include "formats/base/world_frame.h"
#include "formats/input_kind.h"
#include "formats/leaf/histogram.h"

enum { INPUT_FACTS_FIELDS = 256, INPUT_FACTS_TIMES = 4096, INPUT_FACTS_OWN = 1024 };

/* A field that can be asked for. */
typedef struct input_field {
    char name[MESH_NAME_MAX + 1];
    uint32_t steps, components; /* 1 or more */
} input_field;

typedef struct input_facts {
    const char *path;   /* as in the question */
    const char *format; /* "NRRD"; constant */
    const input_kind *kind;
    unsigned traits; /* see input_kind.traits() */
    char name[MESH_NAME_MAX + 1];
    world_frame frame; /* what the world's axes mean; zeros: the input does not say */
    /* Named fields, and what is taken of them: */
    input_field fields[INPUT_FACTS_FIELDS];
    uint32_t field_count; /* may exceed the number listed */
    char field[MESH_NAME_MAX + 1];
    uint32_t steps, components; /* of the field that is taken */
    uint32_t component;         /* the number of the component taken, from 1; 0: all together */
    bool colours;               /* all together: as a luminance, not a magnitude */
    bool timed;                 /* the steps have times; times: the first ones */
    double times[INPUT_FACTS_TIMES], last_time;
    bool lacks_values; /* there is no field to take */
    bool needs_whole;  /* it has cells that only whole ones keep */
    bool is_surface;   /* it is a surface by itself: it has no isosurfaces */
    /* Values: */
    bool read;           /* whether the values were read: not with header_only */
    double range[2];     /* of all finite values; lo > hi: none */
    uint64_t non_finite; /* NaN and inf */
    uint64_t trailing;   /* bytes behind the samples */
    histogram values;
    /* What its kind knows besides, such as volume_facts. */
    union {
        double align;
        unsigned char bytes[INPUT_FACTS_OWN];
    } own;
} input_facts;

typedef struct input_question {
    const char *path; /* "-": standard input */
    input_hints hints;
    bool header_only; /* look at neither values nor cells */
    /* Called once the header has been read, before the values are. Any status but ST_OK ends the
     * reading. NULL: not called. */
    status (*opened)(void *ctx, const struct input_facts *x);
    void *ctx;
} input_question;

/* input_facts_read() - read an input and collect its facts. ST_CORRUPT, ST_UNSUPPORTED, ST_IO from
 * the readers, ST_NOMEM. The facts point into the question. p may be NULL. The facts take about 80
 * KB: not for a small stack. */
CHECKED status input_facts_read(mem *m, const input_question *q, const progress *p,
                                input_facts *out);

/* input_facts_print() - print the facts for people, in lines that begin with a word.
 * input_facts_json() - the facts for programs, see the man page of info; NULL: no memory. */
void input_facts_print(FILE *to, const input_facts *x);
json_t *input_facts_json(const input_facts *x);

/* input_facts_next() - print the shell command that converts the input, quoted where needed.
 * Returns false where it does not fit: text is then of no use. */
bool input_facts_next(const input_facts *x, const input_question *q, char *text, size_t room);

#endif
