#include "formats/leaf/code_rows_template.h"
