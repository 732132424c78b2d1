/* surface_input_facts.h - what is told of a surface that is an input: a row of input_facts.c. It is
 * read once; nothing of it is kept but some values for the histogram. */
#ifndef FORMATS_SURFACE_SURFACE_INPUT_FACTS_H
#define FORMATS_SURFACE_SURFACE_INPUT_FACTS_H

#include "formats/input_facts_kind.h"

extern const input_facts_kind surface_input_facts_kind;

#endif
