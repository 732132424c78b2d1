/* info_leaf.h - what leafcast info says of a treelet file: what its kind tells
 * (leaf_teller.tell), the sizes of its payloads, its values, what isovalues need, and the next
 * command. */
#ifndef FORMATS_INFO_LEAF_H
#define FORMATS_INFO_LEAF_H

#include "formats/base/cli.h"
#include "formats/base/step_list.h"
#include "formats/leaf/leaf_file.h"

enum { INFO_ISOS_MAX = 64 };

/* What is asked of it, besides. */
typedef struct info_leaf_question {
    double isos[INFO_ISOS_MAX];
    int iso_count;
    const char *field; /* a name or a number; NULL: the first */
    step_list steps; /* where isovalues are looked for; none: all. Cells are counted at the first */
} info_leaf_question;

/* info_leaf_report() - read what the isovalues need, and print lines, or with --json an object. */
CHECKED status info_leaf_report(cli_common *common, mem *m, leaf_file *f, info_leaf_question *q);

#endif
