#include "formats/leaf/blend_rows_template.h"
