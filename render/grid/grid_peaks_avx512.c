#include "render/grid/grid_peaks_template.h"
