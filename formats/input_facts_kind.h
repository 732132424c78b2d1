/* input_facts_kind.h - how an input of one kind is asked for its facts: a row each, for
 * input_facts.c. */
#ifndef FORMATS_INPUT_FACTS_KIND_H
#define FORMATS_INPUT_FACTS_KIND_H

#include "formats/base/fact_sheet.h"
#include "formats/input_facts.h"

typedef struct input_facts_kind {
    const input_kind *of;
    const char *drawn; /* what its histogram counts: "samples" */
    /* Collect the facts (input_collect.h) and those of its own in x->own. Calls q->opened() as soon
     * as the header is known. own: of the input. */
    status (*ask)(mem *m, void *own, const input_question *q, const progress *p, input_facts *x);
    /* Tell the facts of its own, in lines and values. */
    void (*tell)(const input_facts *x, const fact_sheet *to);
} input_facts_kind;

#endif
