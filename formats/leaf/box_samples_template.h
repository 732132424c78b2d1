/* box_samples_template.h - samples of box_coder.c as unsigned integers of type T: to and from boxes
 * and bytes. Define T and ROWS(name) before each inclusion, and SPLITS for more than one byte. */
#ifdef ROWS

#ifdef SPLITS

/* Split residuals into bytes, the lowest ones of all first. */
static void ROWS(split)(const T *residuals, size_t n, unsigned width, uint8_t *out) {
    for (unsigned b = 0; b < width; b++)
        for (size_t i = 0; i < n; i++)
            out[b * n + i] = (uint8_t)(residuals[i] >> (8 * b));
}

static void ROWS(join)(const uint8_t *restrict in, size_t n, unsigned width, T *restrict out) {
    for (unsigned b = 0; b < width; b++)
        for (size_t i = 0; i < n; i++)
            out[i] = (T)(b ? out[i] | (T)((T)in[b * n + i] << (8 * b)) : in[i]);
}

#endif

/* Turn earlier values into the differences to them; and differences into values. Half the range is
 * added, so that small differences of both signs are near each other. */
static void ROWS(differ)(const T *restrict values, T *restrict earlier, size_t n) {
    const T half = (T)((T)1 << (8 * sizeof(T) - 1));
    for (size_t i = 0; i < n; i++)
        earlier[i] = (T)(values[i] - earlier[i] + half);
}

static void ROWS(undiffer)(T *restrict values, const T *restrict earlier, size_t n) {
    const T half = (T)((T)1 << (8 * sizeof(T) - 1));
    for (size_t i = 0; i < n; i++)
        values[i] = (T)(values[i] + earlier[i] - half);
}

/* The value that most samples have among some spread over the boxes. *share: how many of those, in
 * 256ths. */
static T ROWS(commonest)(const box_coder *c, size_t n, unsigned *share) {
    enum { LOOKED_AT = 512, SLOTS = 1024 };
    T value[SLOTS];
    uint16_t times[SLOTS] = {0};
    const size_t step = n / LOOKED_AT + 1;
    size_t looked = 0, best = 0;
    const T *values = c->w.values;
    for (size_t i = 0; i < n; i += step, looked++) {
        size_t slot = (size_t)(((uint32_t)values[i] * 2654435761U) >> 22);
        while (times[slot] && value[slot] != values[i])
            slot = (slot + 1) % SLOTS;
        value[slot] = values[i];
        if (++times[slot] > times[best])
            best = slot;
    }
    *share = (unsigned)(256 * times[best] / looked);
    return value[best];
}

/* Gather samples from where they lie, and put them there. flip: exclusive or with each. */
static void ROWS(gather)(const coded_box *b, T flip, T *restrict out) {
    const coded_box box = *b; /* bytes that are written may alias what b points at */
    for (uint32_t z = 0; z < box.size[2]; z++)
        for (uint32_t y = 0; y < box.size[1]; y++, out += box.size[0]) {
            const T *restrict row =
                (const T *)box.at + (size_t)z * box.stride[2] + (size_t)y * box.stride[1];
            if (box.stride[0] == 1)
                for (uint32_t x = 0; x < box.size[0]; x++)
                    out[x] = row[x] ^ flip;
            else
                for (uint32_t x = 0; x < box.size[0]; x++)
                    out[x] = row[(size_t)x * box.stride[0]] ^ flip;
        }
}

static void ROWS(scatter)(const coded_box *b, T flip, const T *restrict in) {
    const coded_box box = *b;
    for (uint32_t z = 0; z < box.size[2]; z++)
        for (uint32_t y = 0; y < box.size[1]; y++, in += box.size[0]) {
            T *restrict row = (T *)box.at + (size_t)z * box.stride[2] + (size_t)y * box.stride[1];
            if (box.stride[0] == 1)
                for (uint32_t x = 0; x < box.size[0]; x++)
                    row[x] = in[x] ^ flip;
            else
                for (uint32_t x = 0; x < box.size[0]; x++)
                    row[(size_t)x * box.stride[0]] = in[x] ^ flip;
        }
}

#endif
