/* trust_options.h - options that let a user accept inputs which a verb otherwise refuses. */
#ifndef FORMATS_TRUST_OPTIONS_H
#define FORMATS_TRUST_OPTIONS_H

#include <argp.h>

#include "formats/base/status.h"
#include "formats/input/input_trust.h"

enum { TRUST_KEY_LINKS = 0x3000, TRUST_KEY_MISSING };

/* The two rows for a table of options. flags: OPTION_HIDDEN, or 0. */
#define TRUST_OPTIONS(group) TRUST_OPTIONS_AS(0, group)
#define TRUST_OPTIONS_AS(flags, group)                                                  \
    {"follow-links",                                                                    \
     TRUST_KEY_LINKS,                                                                   \
     NULL,                                                                              \
     flags,                                                                             \
     "read files that the input names wherever they lie, not only those in its folder", \
     group},                                                                            \
    {                                                                                   \
        "allow-missing", TRUST_KEY_MISSING, NULL, flags,                                \
            "take an input that lacks parts: their samples are the fill value", group   \
    }

/* trust_option() - set one of these options. ST_AGAIN: the key is none of them. */
static inline status trust_option(input_trust *trust, int key) {
    switch (key) {
    case TRUST_KEY_LINKS: trust->follow_links = true; return ST_OK;
    case TRUST_KEY_MISSING: trust->allow_missing = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

#endif
