#include "formats/leaf/live_rows_template.h"
