#include "formats/grid/stored_samples.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 1024 }; /* numbers */

static uint32_t components_of(const stored_samples *s) {
    return s->components ? s->components : 1;
}

static bool is_scaled(const stored_samples *s) {
    return s->slope != 0 && !(s->slope == 1 && s->intercept == 0);
}

/* Returns whether several numbers make one sample. */
static bool is_joined(const stored_samples *s) {
    return components_of(s) > 1 && s->component == 0;
}

size_t stored_samples_bytes(const stored_samples *s) {
    return sample_size(s->type) * components_of(s);
}

bool stored_samples_plain(const stored_samples *s) {
    return components_of(s) == 1 && !is_scaled(s) && sample_widened(s->type) == s->type;
}

sample_type stored_samples_type(const stored_samples *s) {
    return is_joined(s) || is_scaled(s) ? sample_computed(s->type) : sample_widened(s->type);
}

status stored_samples_choose(stored_samples *s, const char *file, const volume_hints *hints,
                             grid *g) {
    const uint32_t count = components_of(s);
    if (count > STORED_SAMPLES_COMPONENTS)
        return status_describe(ST_UNSUPPORTED, "%s: %u numbers a sample; at most %d are supported",
                               file, count, STORED_SAMPLES_COMPONENTS);
    if (hints->component > count)
        return status_describe(ST_USAGE, "%s: no component %u: a sample has %u", file,
                               hints->component, count);
    if (hints->component)
        s->component = hints->component;
    g->type = stored_samples_type(s);
    g->source = g->type == s->type ? (sample_type)0 : s->type;
    return ST_OK;
}

void stored_samples_tell(const stored_samples *s, slice_field *to) {
    to->components = components_of(s);
    to->component = s->component;
    to->colours = s->colours;
}

/* Move the chosen number of each sample to the front, side by side. */
static void pick(const stored_samples *s, char *numbers, size_t count) {
    const size_t width = sample_size(s->type), step = width * components_of(s);
    const char *from = numbers + (s->component - 1) * width;
    for (size_t i = 0; i < count; i++)
        memmove(numbers + i * width, from + i * step, width);
}

/* Returns the luminance of linear light (Rec. 709). */
static double luminance(const double *c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

static double magnitude(const double *v, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

/* Join the numbers of count samples, in place. */
static void join(const stored_samples *s, double *v, size_t count) {
    const uint32_t n = components_of(s);
    for (size_t i = 0; i < count; i++) {
        const double *sample = v + i * n;
        v[i] = !s->colours ? magnitude(sample, n) : n < 3 ? sample[0] : luminance(sample);
    }
}

static void scale(const stored_samples *s, double *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        v[i] = s->slope * v[i] + s->intercept;
}

static void store(const stored_samples *s, sample_type to, const double *v, char *out,
                  size_t count) {
    if (to == SAMPLE_F64) {
        memcpy(out, v, count * sizeof *v);
        return;
    }
    const double error = sample_to_stored(SAMPLE_F64, v, out, count);
    if (s->rounding && error > *s->rounding)
        *s->rounding = error;
}

size_t stored_samples_take(const stored_samples *s, void *in, sample_type to, void *out,
                           size_t count) {
    if (components_of(s) > 1 && s->component)
        pick(s, in, count);
    if (to == s->type && !is_joined(s) && !is_scaled(s)) {
        memcpy(out, in, count * sample_size(to));
        return count;
    }
    const size_t numbers = is_joined(s) ? components_of(s) : 1;
    const size_t from = numbers * sample_size(s->type), most = BLOCK / numbers;
    double v[BLOCK];
    for (size_t done = 0, n; done < count; done += n) {
        n = count - done < most ? count - done : most;
        const size_t bad = sample_to_doubles(s->type, (char *)in + done * from, v, n * numbers);
        if (bad < n * numbers)
            return done + bad / numbers;
        if (is_scaled(s))
            scale(s, v, n * numbers);
        if (is_joined(s))
            join(s, v, n);
        store(s, to, v, (char *)out + done * sample_size(to), n);
    }
    return count;
}
