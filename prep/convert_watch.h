/* convert_watch.h - convert --watch: files become steps of the output as they come. */
#ifndef PREP_CONVERT_WATCH_H
#define PREP_CONVERT_WATCH_H

#include "prep/convert_request.h"

/* convert_watch_run() - add the files that fit the only input, a pattern, in their order, each when
 * it is whole (a->watch); those that the output has already are the first ones. one(): convert a
 * request's only input; called in a process of its own. Returns the exit status. */
int convert_watch_run(convert_request *a, status (*one)(convert_request *a));

#endif
