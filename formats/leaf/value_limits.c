#include "formats/leaf/value_limits.h"

#include <math.h>

float value_limits_threshold(double v) {
    const float f = (float)v;
    return (double)f < v ? nextafterf(f, INFINITY) : f;
}
