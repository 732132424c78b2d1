/* box_coder_rows.h - the rows of box_coder.c for unsigned integers of type T. Define T and
 * ROWS(name) before each inclusion; box_coder.c includes it for three widths. */

/* The samples next to a row, in rows that are known: above (y - 1), behind (z - 1), and both.
 * Missing ones are NULL. */
typedef struct ROWS(neighbours) {
    const T *above, *behind, *corner;
} ROWS(neighbours);

static ROWS(neighbours) ROWS(neighbours_of)(const T *row, const uint32_t size[3], uint32_t y,
                                            uint32_t z) {
    const size_t line = size[0], sheet = line * size[1];
    return (ROWS(neighbours)){.above = y ? row - line : NULL,
                              .behind = z ? row - sheet : NULL,
                              .corner = y && z ? row - sheet - line : NULL};
}

/* Predict a row from its neighbours. Without one of them the other stands for both. */
static void ROWS(predict)(int how, ROWS(neighbours) k, uint32_t n, T *restrict out) {
    const T *above = k.above ? k.above : k.behind, *behind = k.behind, *corner = k.corner;
    if (how == BOX_NONE || !above) {
        memset(out, 0, n * sizeof *out);
    } else if (how == BOX_ROW || !corner) {
        memcpy(out, above, n * sizeof *out);
    } else if (how == BOX_PLANE) {
        for (uint32_t x = 0; x < n; x++)
            out[x] = (T)(above[x] + behind[x] - corner[x]);
    } else {
        for (uint32_t x = 0; x < n; x++) {
            const T a = above[x], b = behind[x], c = corner[x];
            const T least = a < b ? a : b, most = a < b ? b : a;
            const T plane = (T)(a + b - c), low = c <= least ? most : plane;
            out[x] = c >= most ? least : low;
        }
    }
}

/* Residuals are differences modulo 2^bits, folded so that small ones of either sign are small. */
static inline T ROWS(fold)(T d) {
    return (T)((T)(d << 1) ^ (T)(0 - (T)(d >> (8 * sizeof(T) - 1))));
}

static inline T ROWS(unfold)(T r) {
    return (T)((T)(r >> 1) ^ (T)(0 - (T)(r & 1)));
}

/* Keep those values of a row that are coded. Writes one more than it keeps, at most. */
static uint32_t ROWS(keep)(const T *row, uint32_t n, const uint8_t *coded, T *out) {
    uint32_t count = 0;
    for (uint32_t x = 0; x < n; x++) {
        out[count] = row[x];
        count += coded[x / 8] >> x % 8 & 1;
    }
    return count;
}

/* Residuals of a row for its prediction. coded: which samples are coded; NULL: all. room: for a
 * row. Returns how many residuals there are. */
static uint32_t ROWS(subtract)(const T *restrict row, const T *restrict predicted, uint32_t n,
                               bool along, const uint8_t *coded, T *restrict room,
                               T *restrict out) {
    for (uint32_t x = 0; x < n; x++)
        out[x] = (T)(row[x] - predicted[x]);
    if (coded) {
        n = ROWS(keep)(out, n, coded, room);
        memcpy(out, room, n * sizeof *out);
    } else if (along) {
        memcpy(room, out, n * sizeof *out);
    }
    if (along)
        for (uint32_t x = 1; x < n; x++)
            out[x] = (T)(room[x] - room[x - 1]);
    for (uint32_t x = 0; x < n; x++)
        out[x] = ROWS(fold)(out[x]);
    return n;
}

/* The samples of a row of which all are coded. */
static void ROWS(add)(const T *restrict residuals, const T *restrict predicted, uint32_t n,
                      bool along, T *restrict row) {
    T error = 0;
    for (uint32_t x = 0; x < n; x++)
        row[x] = ROWS(unfold)(residuals[x]);
    for (uint32_t x = 0; along && x < n; x++)
        row[x] = error = (T)(error + row[x]);
    for (uint32_t x = 0; x < n; x++)
        row[x] = (T)(row[x] + predicted[x]);
}

/* The samples of a row of which some are coded, as many as there are residuals. One residual more
 * may be read. */
static void ROWS(spread)(const T *restrict residuals, const T *restrict predicted, uint32_t n,
                         bool along, const uint8_t *restrict coded, T background,
                         T *restrict row) {
    T error = 0;
    for (uint32_t x = 0; x < n; x += 8) {
        const uint32_t end = x + 8 < n ? x + 8 : n;
        unsigned bits = coded[x / 8];
        if (!bits) {
            for (uint32_t i = x; i < end; i++)
                row[i] = background;
            continue;
        }
        for (uint32_t i = x; i < end; i++, bits >>= 1) {
            const T is = (T)(0 - (T)(bits & 1));
            const T d = (T)(ROWS(unfold)(*residuals) & is);
            residuals += bits & 1;
            error = along ? (T)(error + d) : d;
            row[i] = (T)(((T)(predicted[i] + error) & is) | (background & (T)~is));
        }
    }
}

/* Split residuals into bytes, the lowest ones of all first. */
static void ROWS(split)(const T *residuals, size_t n, unsigned width, uint8_t *out) {
    for (unsigned b = 0; b < width; b++)
        for (size_t i = 0; i < n; i++)
            out[b * n + i] = (uint8_t)(residuals[i] >> (8 * b));
}

static void ROWS(join)(const uint8_t *restrict in, size_t n, unsigned width, T *restrict out) {
    if (width == 0)
        memset(out, 0, n * sizeof *out);
    for (unsigned b = 0; b < width; b++)
        for (size_t i = 0; i < n; i++)
            out[i] = b ? (T)(out[i] | (T)((T)in[b * n + i] << (8 * b))) : in[i];
}

/* ---- boxes ---- */

/* Residuals of every `step`-th row of all boxes, one box behind the other. background: whether the
 * map says which samples are coded. Returns how many residuals there are. */
static size_t ROWS(residuals_of)(box_coder *c, const coded_box *boxes, uint32_t count, int how,
                                 bool background, uint32_t step) {
    const T *row = c->values;
    const uint8_t *map = c->map;
    T *out = c->residuals, *predicted = c->predicted, *room = c->row;
    size_t rows = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        const uint32_t bytes = map_row_bytes(size[0]);
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++, row += size[0], map += bytes) {
                if (rows++ % step)
                    continue;
                const bool some = background && map_row_count(map, size[0]) < size[0];
                ROWS(predict)(how & BOX_MEDIAN, ROWS(neighbours_of)(row, size, y, z), size[0],
                              predicted);
                out += ROWS(subtract)(row, predicted, size[0], how & BOX_ALONG, some ? map : NULL,
                                      room, out);
            }
    }
    return (size_t)(out - (T *)c->residuals);
}

/* Make the map of samples that are not the background. */
static void ROWS(mark)(box_coder *c, const coded_box *boxes, uint32_t count, T background) {
    const T *row = c->values;
    uint8_t *map = c->map;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t n = boxes[i].size[0], rows = boxes[i].size[1] * boxes[i].size[2];
        for (uint32_t r = 0; r < rows; r++, row += n, map += map_row_bytes(n))
            for (uint32_t x = 0; x < n; x += 8) {
                const uint32_t some = n - x < 8 ? n - x : 8;
                unsigned bits = 0;
                for (uint32_t k = 0; k < some; k++)
                    bits |= (unsigned)(row[x + k] != background) << k;
                map[x / 8] = (uint8_t)bits;
            }
    }
}

/* The samples of all boxes from their residuals. False: there are fewer or more residuals than the
 * map says. */
static bool ROWS(values_of)(box_coder *c, const coded_box *boxes, uint32_t count,
                            const box_code *code) {
    const bool background = code->prediction & BOX_BACKGROUND, along = code->prediction & BOX_ALONG;
    const int how = code->prediction & BOX_MEDIAN;
    const T quiet = (T)code->background;
    const T *residuals = c->residuals, *end = residuals + code->coded;
    const uint8_t *map = c->map;
    T *row = c->values, *predicted = c->predicted;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++, row += size[0]) {
                const uint32_t n = background ? map_row_count(map, size[0]) : size[0];
                if (n > (size_t)(end - residuals))
                    return false;
                if (n > 0)
                    ROWS(predict)(how, ROWS(neighbours_of)(row, size, y, z), size[0], predicted);
                if (n == size[0])
                    ROWS(add)(residuals, predicted, n, along, row);
                else
                    ROWS(spread)(residuals, predicted, size[0], along, map, quiet, row);
                residuals += n;
                map += map_row_bytes(size[0]);
            }
    }
    return residuals == end;
}

/* The value that most samples have among some spread over the boxes. *share: how many of those, in
 * 256ths. */
static T ROWS(commonest)(const box_coder *c, size_t n, unsigned *share) {
    enum { LOOKED_AT = 512, SLOTS = 1024 };
    T value[SLOTS];
    uint16_t times[SLOTS] = {0};
    const size_t step = n / LOOKED_AT + 1;
    size_t looked = 0, best = 0;
    const T *values = c->values;
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
