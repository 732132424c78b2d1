#include "formats/leaf/deviation_rows_template.h"
