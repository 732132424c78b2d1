/* convert_curvilinear.h - how the verb convert takes curvilinear grids: its row (convert_kind.h).
 */
#ifndef PREP_CURVILINEAR_CONVERT_CURVILINEAR_H
#define PREP_CURVILINEAR_CONVERT_CURVILINEAR_H

#include "prep/convert_kind.h"

extern const convert_kind convert_curvilinear;

#endif
