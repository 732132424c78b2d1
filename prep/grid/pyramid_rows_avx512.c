#include "prep/grid/pyramid_rows_template.h"
