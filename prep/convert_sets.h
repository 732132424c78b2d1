/* convert_sets.h - the fields and steps that a conversion takes: named on the command line, or all.
 */
#ifndef PREP_CONVERT_SETS_H
#define PREP_CONVERT_SETS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/base/step_list.h"
#include "formats/base/world_frame.h"
#include "formats/mesh/mesh_sink.h"

enum { CONVERT_FIELDS_MAX = 256 };

/* Zero-initialize it. */
typedef struct convert_sets {
    mem *m; /* set before the input is asked */
    bool all_fields;
    step_list taken;                       /* chosen steps of the single input file */
    int count;                             /* of fields; 0: the reader's default field */
    const char *names[CONVERT_FIELDS_MAX]; /* as written to the treelet file */
    const char *asked[CONVERT_FIELDS_MAX]; /* as the input spells them */
    char kept[CONVERT_FIELDS_MAX][MESH_NAME_MAX + 1];
    char *copied[CONVERT_FIELDS_MAX]; /* owned copies in `asked`, if all fields are taken */
    uint32_t steps;                   /* number of chosen steps; 0: none are chosen */
    const char *times;                /* of --times: "T0,T1,.."; NULL: not given */
    double *parsed;                   /* `times` as numbers, or the times of the file */
    char time_unit[WORLD_TIME_UNIT];  /* unit of the file's times */
    bool times_fall;                  /* the file's times do not ascend, so 0, 1, .. are used */
} convert_sets;

void convert_sets_release(convert_sets *s);

/* convert_sets_add() - add a field named on the command line. The text must outlive the sets. */
CHECKED status convert_sets_add(convert_sets *s, const char *name);

/* convert_sets_check() - ST_USAGE: the command line makes no sense for this many inputs. step: a
 * step other than the first is asked for. */
CHECKED status convert_sets_check(const convert_sets *s, int inputs, bool step);

/* convert_sets_take_all() - take all steps of the file if the command line chooses none. */
void convert_sets_take_all(convert_sets *s);

/* convert_sets_first_step() - set *step to the first of a list of steps, if one is given. */
void convert_sets_first_step(const convert_sets *s, uint32_t *step);

/* convert_sets_take_steps() - if steps of the file `name` are asked for, note how many, and their
 * times. The file has so many; times: of each, NULL: none. ST_USAGE: there is no such step. */
CHECKED status convert_sets_take_steps(convert_sets *s, const char *name, uint32_t steps,
                                       const double *times);

/* convert_sets_take_copy() - add a field of the input, once per name.
 * convert_sets_take_times() - copy the input's times of the chosen steps. If they do not ascend,
 * keep none.
 * convert_sets_drop() - drop field i, which is such a copy. */
CHECKED status convert_sets_take_copy(convert_sets *s, const char *name);
CHECKED status convert_sets_take_times(convert_sets *s, const double *all);
void convert_sets_drop(convert_sets *s, int i);

/* convert_sets_times() - parse --times for this many steps into s->parsed, or set that to NULL.
 * ST_USAGE: there is another number of them. */
CHECKED status convert_sets_times(convert_sets *s, uint32_t steps);

/* convert_sets_count_steps() - returns how many steps come of so many inputs. */
static inline uint32_t convert_sets_count_steps(const convert_sets *s, int inputs) {
    return s->steps ? s->steps : (uint32_t)inputs;
}

#endif
