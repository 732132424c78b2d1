#include "prep/convert_defaults.h"

leaf_parameters convert_parameters_default(void) {
    leaf_parameters p = leaf_parameters_default();
    p.histograms = true;
    p.deviations = true;
    return p;
}
