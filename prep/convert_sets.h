/* convert_sets.h - the fields and steps that a conversion takes: those that the command line names,
 * or all that there are.
 */
#ifndef PREP_CONVERT_SETS_H
#define PREP_CONVERT_SETS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/base/step_list.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"
#include "prep/grid/grid_series.h"

enum { CONVERT_FIELDS_MAX = 256 };

/* Start with zeros. */
typedef struct convert_sets {
    mem *m; /* set before the first convert_sets_all_..() */
    bool all_fields;
    step_list taken;                       /* of the one file's steps */
    int count;                             /* of fields; 0: what the reader takes unasked */
    const char *names[CONVERT_FIELDS_MAX]; /* as the treelet file has them */
    const char *asked[CONVERT_FIELDS_MAX]; /* as the input has them */
    char kept[CONVERT_FIELDS_MAX][MESH_NAME_MAX + 1];
    char *copied[CONVERT_FIELDS_MAX]; /* of asked, where all are taken */
    uint32_t steps;                   /* so many; 0: none are chosen */
    const char *times;                /* as given: "T0,T1,.."; NULL: not given */
    double *parsed;                   /* the same as numbers, or those that the file has */
    char time_unit[WORLD_TIME_UNIT];  /* of the file's */
    bool times_fall; /* the file has times, which do not ascend: 0, 1, .. instead */
} convert_sets;

void convert_sets_release(convert_sets *s);

/* convert_sets_add() - one that the command line names; the text must stay. */
CHECKED status convert_sets_add(convert_sets *s, const char *name);

/* convert_sets_check() - whether what the command line says makes sense for so many inputs. step:
 * another one than the first is asked for. */
CHECKED status convert_sets_check(const convert_sets *s, int inputs, bool step);

/* convert_sets_take_all() - all steps of the file, where the command line says none. */
void convert_sets_take_all(convert_sets *s);

/* convert_sets_first_step() - of a list of steps, which one is read first. */
void convert_sets_first_step(const convert_sets *s, uint32_t *step);

/* convert_sets_of_mesh() - all fields of a mesh, and the steps that are taken, where they are asked
 * for. ST_USAGE: there is no such step. */
CHECKED status convert_sets_of_mesh(convert_sets *s, const mesh_input *x, const char *name);

/* convert_sets_of_grid() - all fields of a volume, and the steps that are taken, where they are
 * asked for. The one that was taken unasked comes first, then the others in the file's order, but
 * for those with other steps where steps are taken. ST_USAGE: there is no such step. */
CHECKED status convert_sets_of_grid(convert_sets *s, const volume *v, const char *name);

/* convert_sets_keep_alike() - of all fields, those that can be in one file with the first, which is
 * v's; `left_out' hears of each other why. series: its number of fields is set. */
CHECKED status convert_sets_keep_alike(convert_sets *s, grid_series *series, const volume *v,
                                       void (*left_out)(void *ctx, const char *name,
                                                        const char *why),
                                       void *ctx);

/* convert_sets_times() - s->parsed: --times for so many steps, or NULL. ST_USAGE for another
 * number of them. */
CHECKED status convert_sets_times(convert_sets *s, uint32_t steps);

#endif
