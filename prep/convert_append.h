/* convert_append.h - convert --append: the input becomes further steps of a treelet file. */
#ifndef PREP_CONVERT_APPEND_H
#define PREP_CONVERT_APPEND_H

#include "prep/convert_request.h"

/* convert_append_open() - open the output to add to it; none yet: it will be made. Takes from it
 * how it is made. ST_USAGE: an option asks for something else.
 * convert_append_close() - in any case. */
CHECKED status convert_append_open(convert_request *a, mem *m);
void convert_append_close(convert_request *a);

/* convert_append_memory() - bytes that opening the file once more takes in the end, to prove it.
 * convert_append_check() - further_step_check() of the sets, if there is a file; notes times that
 * are left out. */
size_t convert_append_memory(const convert_request *a, const mem *m);
CHECKED status convert_append_check(const convert_request *a, leaf_sets *sets);

/* convert_append_note() - say what was added.
 * convert_append_bytes() - the bytes of the whole file, to which `added` were added. */
void convert_append_note(const convert_request *a, const leaf_sets *sets);
uint64_t convert_append_bytes(const convert_request *a, uint64_t added);

#endif
