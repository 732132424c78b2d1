#include "formats/leaf/box_rows_template.h"
