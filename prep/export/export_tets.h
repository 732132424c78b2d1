/* export_tets.h - how the verb export writes meshes of tets: a row of export_main.c. */
#ifndef PREP_EXPORT_EXPORT_TETS_H
#define PREP_EXPORT_EXPORT_TETS_H

#include "prep/export/export_kind.h"

extern const export_kind export_tets_kind;

#endif
