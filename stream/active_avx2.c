#include "stream/active_template.h"
