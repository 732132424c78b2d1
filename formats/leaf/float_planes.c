#include "formats/leaf/float_planes.h"

#include <string.h>

void float_planes_encode(const void *floats, size_t count, size_t axes, uint8_t *planes) {
    for (size_t a = 0; a < axes; a++) {
        const char *at = (const char *)floats + a * sizeof(float);
        uint32_t bits, before = 0;
        for (size_t i = 0; i < count; i++, at += axes * sizeof(float), before = bits) {
            memcpy(&bits, at, sizeof bits);
            float_planes_put(planes + a * count + i, axes * count, bits, before);
        }
    }
}

void float_planes_decode(const uint8_t *planes, size_t count, size_t axes, void *floats) {
    for (size_t a = 0; a < axes; a++) {
        char *at = (char *)floats + a * sizeof(float);
        uint32_t bits = 0;
        for (size_t i = 0; i < count; i++, at += axes * sizeof(float)) {
            bits = float_planes_get(planes + a * count + i, axes * count, bits);
            memcpy(at, &bits, sizeof bits);
        }
    }
}
