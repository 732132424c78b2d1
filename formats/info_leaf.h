/* info_leaf.h - what leafcast info says of a treelet file: what its kind tells
 * (leaf_teller.tell), the sizes of its payloads, its values, what isovalues need, and the next
 * command. */
#ifndef FORMATS_INFO_LEAF_H
#define FORMATS_INFO_LEAF_H

#include "formats/base/cli.h"
#include "formats/leaf/leaf_file.h"

/* info_leaf_report() - read what the isovalues need, and print lines, or with --json an object. */
CHECKED status info_leaf_report(cli_common *common, mem *m, leaf_file *f, const double *isos,
                                int iso_count);

#endif
