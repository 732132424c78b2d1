#include "render/look/picture_bytes.h"

#include <math.h>
#include <string.h>

#include "formats/base/colour_field.h"

/* x^(1/5) for x in (0, 1], by Newton's method from above: every step but the last decreases. */
static double fifth_root(double x) {
    double root = 1.0;
    for (;;) {
        const double fourth = root * root * root * root;
        const double next = root - (root - x / fourth) / 5.0;
        if (!(next < root))
            return root;
        root = next;
    }
}

/* x^2.4 = x^2 (x^2)^(1/5). */
double picture_linear(double x) {
    if (x <= 0.04045)
        return x / 12.92;
    const double base = (x + 0.055) / 1.055;
    return base * base * fifth_root(base * base);
}

void picture_light(double colour, double rgb[3]) {
    const uint32_t bytes = colour_field_bytes(colour);
    for (int c = 0; c < 3; c++)
        rgb[c] = picture_linear((bytes >> (16 - 8 * c) & 255U) / 255.0);
}

/* The high half of a float's bits: sign, exponent and 7 bits of the fraction. */
static uint32_t high_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 16;
}

static const float SMALLEST = 1.0f / (1 << BYTES_OCTAVES);

/* The smallest float whose byte is at least k. */
static float border_below(int k) {
    const double exact = picture_linear((k - 0.5) / 255.0);
    const float near = (float)exact;
    return (double)near < exact ? nextafterf(near, INFINITY) : near;
}

void picture_bytes_init(byte_table *t) {
    const uint32_t first = high_bits(SMALLEST);
    float border[256];
    for (int k = 0; k < 255; k++)
        border[k] = border_below(k + 1);
    border[255] = INFINITY;
    int k = 0;
    for (uint32_t i = 0; i < BYTES_BUCKETS; i++) {
        const uint32_t bits = (first + i) << 16;
        float from;
        memcpy(&from, &bits, sizeof from);
        while (border[k] <= from)
            k++;
        t->below[i] = (uint8_t)k;
        t->border[i] = border[k];
    }
}

uint8_t picture_byte(const byte_table *t, float linear) {
    if (!(linear >= SMALLEST))
        return 0;
    if (linear >= 1.0f)
        return 255;
    const uint32_t bucket = high_bits(linear) - high_bits(SMALLEST);
    return (uint8_t)(t->below[bucket] + (linear >= t->border[bucket]));
}

static uint8_t alpha_byte(float a) {
    const double clamped = a > 0.0f ? a < 1.0f ? (double)a : 1.0 : 0.0;
    return (uint8_t)(clamped * 255.0 + 0.5);
}

void picture_bytes_rgba(const byte_table *t, const leafcast_image *image, size_t first,
                        size_t count, uint8_t *out) {
    for (size_t i = first; i < first + count; i++, out += 4) {
        const float a = image->a[i];
        if (!(a > 0.0f)) {
            memset(out, 0, 4);
            continue;
        }
        out[0] = picture_byte(t, image->r[i] / a);
        out[1] = picture_byte(t, image->g[i] / a);
        out[2] = picture_byte(t, image->b[i] / a);
        out[3] = alpha_byte(a);
    }
}

void picture_bytes_rgb(const byte_table *t, const leafcast_image *image, size_t first, size_t count,
                       uint8_t *out) {
    for (size_t i = first; i < first + count; i++, out += 3) {
        out[0] = picture_byte(t, image->r[i]);
        out[1] = picture_byte(t, image->g[i]);
        out[2] = picture_byte(t, image->b[i]);
    }
}
