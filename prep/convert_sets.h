/* convert_sets.h - the fields and steps that a conversion takes: those that the command line names,
 * or all that there are.
 */
#ifndef PREP_CONVERT_SETS_H
#define PREP_CONVERT_SETS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"
#include "prep/grid/grid_series.h"

enum { CONVERT_FIELDS_MAX = 256 };

/* Start with zeros. */
typedef struct convert_sets {
    mem *m; /* set before the first convert_sets_all_..() */
    bool all_fields, all_steps;
    int count;                             /* of fields; 0: what the reader takes unasked */
    const char *names[CONVERT_FIELDS_MAX]; /* as the treelet file has them */
    const char *asked[CONVERT_FIELDS_MAX]; /* as the input has them */
    char kept[CONVERT_FIELDS_MAX][MESH_NAME_MAX + 1];
    char *copied[CONVERT_FIELDS_MAX]; /* of asked, where all are taken */
    uint32_t steps;                   /* in the one file, of all_steps; else 0 */
    const char *times;                /* as given: "T0,T1,.."; NULL: not given */
    double *parsed;                   /* the same as numbers */
} convert_sets;

void convert_sets_release(convert_sets *s);

/* convert_sets_add() - one that the command line names; the text must stay. */
CHECKED status convert_sets_add(convert_sets *s, const char *name);

/* convert_sets_check() - whether what the command line says makes sense for so many inputs. step:
 * another one than the first is asked for. */
CHECKED status convert_sets_check(const convert_sets *s, int inputs, bool step);

/* convert_sets_of_mesh() - all fields of a mesh, where all are asked for. */
CHECKED status convert_sets_of_mesh(convert_sets *s, const mesh_input *x);

/* convert_sets_of_grid() - all fields and all steps of a volume, where they are asked for. The one
 * that was taken unasked comes first, then the others in the file's order, but for those with other
 * steps where all steps are taken. */
CHECKED status convert_sets_of_grid(convert_sets *s, const volume *v);

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
