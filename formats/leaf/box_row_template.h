/* box_row_template.h - box_rows.h for unsigned integers of type T. Define T and ROWS(name) before
 * each inclusion; box_rows_template.h includes it for three widths. */
#ifdef ROWS

/* The samples next to a row, in rows that are known: above (y - 1), behind (z - 1), and both.
 * Missing ones are NULL. */
typedef struct ROWS(neighbours) {
    const T *above, *behind, *corner;
} ROWS(neighbours);

static ROWS(neighbours)
    ROWS(neighbours_of)(const T *row, const uint32_t size[3], uint32_t y, uint32_t z) {
    const size_t line = size[0], sheet = line * size[1];
    return (ROWS(neighbours)){.above = y ? row - line : NULL,
                              .behind = z ? row - sheet : NULL,
                              .corner = y && z ? row - sheet - line : NULL};
}

/* Predict a row from its neighbours. Without one of them the other stands for both. Returns the
 * prediction: one of the rows, zeros, or room with what was computed. */
static const T *ROWS(predict)(int how, ROWS(neighbours) k, uint32_t n, const T *zeros,
                              T *restrict room) {
    const T *above = k.above ? k.above : k.behind, *behind = k.behind, *corner = k.corner;
    if (how == BOX_NONE || !above)
        return zeros;
    if (how == BOX_ROW || !corner)
        return above;
    if (how == BOX_PLANE) {
        for (uint32_t x = 0; x < n; x++)
            room[x] = (T)(above[x] + behind[x] - corner[x]);
        return room;
    }
    for (uint32_t x = 0; x < n; x++) {
        const T a = above[x], b = behind[x], c = corner[x];
        const T least = a < b ? a : b, most = a < b ? b : a;
        const T plane = (T)(a + b - c), low = c <= least ? most : plane;
        room[x] = c >= most ? least : low;
    }
    return room;
}

/* Residuals are differences modulo 2^bits, folded so that small ones of either sign are small. */
static inline T ROWS(fold)(T d) {
    return (T)((T)(d << 1) ^ (T)(0 - (T)(d >> (8 * sizeof(T) - 1))));
}

static inline T ROWS(unfold)(T r) {
    return (T)((T)(r >> 1) ^ (T)(0 - (T)(r & 1)));
}

/* Keep those values of a row that are coded. Writes as many as the row has, at most. */
static uint32_t ROWS(keep)(const T *restrict row, uint32_t n, const uint8_t *restrict coded,
                           T *restrict out) {
    uint32_t count = 0;
    for (uint32_t x = 0; x < n; x += 8) {
        unsigned bits = coded[x / 8];
        const uint32_t end = x + 8 < n ? x + 8 : n;
#ifdef __BMI2__
        if (sizeof(T) == 1 && end == x + 8) {
            uint64_t some;
            memcpy(&some, row + x, sizeof some);
            some = _pext_u64(some, _pdep_u64(bits, 0x0101010101010101U) * 255);
            memcpy(out + count, &some, sizeof some);
            count += (uint32_t)__builtin_popcount(bits);
            continue;
        }
#endif
        for (uint32_t i = x; i < end; i++, bits >>= 1) {
            out[count] = row[i];
            count += bits & 1;
        }
    }
    return count;
}

/* Residuals of a row for its prediction. coded: which samples are coded; NULL: all. room: for two
 * rows. Returns how many residuals there are. */
static uint32_t ROWS(subtract)(const T *restrict row, const T *restrict predicted, uint32_t n,
                               bool along, const uint8_t *coded, T *restrict room,
                               T *restrict out) {
    const T *errors = room;
    for (uint32_t x = 0; x < n; x++)
        room[x] = (T)(row[x] - predicted[x]);
    if (coded) {
        const uint32_t kept = ROWS(keep)(room, n, coded, room + n);
        errors = room + n;
        n = kept;
    }
    if (along) {
        if (n > 0)
            out[0] = ROWS(fold)(errors[0]);
        for (uint32_t x = 1; x < n; x++)
            out[x] = ROWS(fold)((T)(errors[x] - errors[x - 1]));
    } else {
        for (uint32_t x = 0; x < n; x++)
            out[x] = ROWS(fold)(errors[x]);
    }
    return n;
}

/* Replace each of n values by the sum of all up to it. */
static void ROWS(accumulate)(T *row, uint32_t n) {
    uint32_t x = 0;
    T sum = 0;
#ifdef __SSSE3__
    enum { LANES = 16 / sizeof(T) };
    const __m128i last = ROWS(last_lane)();
    __m128i before = _mm_setzero_si128();
    for (; x + LANES <= n; x += LANES) {
        __m128i v = _mm_loadu_si128((const __m128i *)(const void *)(row + x));
        if (sizeof(T) == 1)
            v = ROWS(plus)(v, _mm_slli_si128(v, 1));
        if (sizeof(T) <= 2)
            v = ROWS(plus)(v, _mm_slli_si128(v, 2));
        v = ROWS(plus)(v, _mm_slli_si128(v, 4));
        v = ROWS(plus)(v, _mm_slli_si128(v, 8));
        v = ROWS(plus)(v, before);
        before = _mm_shuffle_epi8(v, last);
        _mm_storeu_si128((__m128i *)(void *)(row + x), v);
    }
    sum = x ? row[x - 1] : 0;
#endif
    for (; x < n; x++)
        row[x] = sum = (T)(sum + row[x]);
}

/* The samples of a row of which all are coded. */
static void ROWS(add)(const T *restrict residuals, const T *restrict predicted, uint32_t n,
                      bool along, T *restrict row) {
    for (uint32_t x = 0; x < n; x++)
        row[x] = ROWS(unfold)(residuals[x]);
    if (along)
        ROWS(accumulate)(row, n);
    for (uint32_t x = 0; x < n; x++)
        row[x] = (T)(row[x] + predicted[x]);
}

/* Spread residuals over the coded samples of a row, and zeros over the others. is: all bits of the
 * coded ones. As many residuals may be read as the row has samples. */
static void ROWS(expand)(const T *restrict residuals, const uint8_t *restrict coded, uint32_t n,
                         T *restrict row, T *restrict is) {
    for (uint32_t x = 0; x < n; x += 8) {
        unsigned bits = coded[x / 8];
        const uint32_t end = x + 8 < n ? x + 8 : n;
#ifdef __BMI2__
        if (sizeof(T) == 1 && end == x + 8) {
            uint64_t some;
            const uint64_t mask = _pdep_u64(bits, 0x0101010101010101U) * 255;
            memcpy(&some, residuals, sizeof some);
            some = _pdep_u64(some, mask);
            memcpy(row + x, &some, sizeof some);
            memcpy(is + x, &mask, sizeof mask);
            residuals += __builtin_popcount(bits);
            continue;
        }
#endif
        for (uint32_t i = x; i < end; i++, bits >>= 1) {
            is[i] = (T)(0 - (T)(bits & 1));
            row[i] = (T)(*residuals & is[i]);
            residuals += bits & 1;
        }
    }
}

/* The samples of a row of which some are coded. room: for a row. */
static void ROWS(spread)(const T *restrict residuals, const T *restrict predicted, uint32_t n,
                         bool along, const uint8_t *restrict coded, T background, T *restrict room,
                         T *restrict row) {
    ROWS(expand)(residuals, coded, n, row, room);
    for (uint32_t x = 0; x < n; x++)
        row[x] = ROWS(unfold)(row[x]);
    if (along)
        ROWS(accumulate)(row, n);
    for (uint32_t x = 0; x < n; x++)
        row[x] = (T)(((T)(row[x] + predicted[x]) & room[x]) | (background & (T)~room[x]));
}

/* ---- boxes ---- */

/* Residuals of every `step`-th row of all boxes, one box behind the other. background: whether the
 * map says which samples are coded. Returns how many residuals there are. */
static size_t ROWS(residuals)(const box_work *c, const coded_box *boxes, uint32_t count, int how,
                              bool background, uint32_t step) {
    const T *row = c->values;
    const uint8_t *map = c->map;
    T *out = c->residuals, *predicted = c->predicted, *room = c->row;
    const T *zeros = c->zeros;
    uint32_t skip = 0; /* rows before the next that is looked at */
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        const uint32_t bytes = box_map_row_bytes(size[0]);
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++, row += size[0], map += bytes) {
                if (skip > 0) {
                    skip--;
                    continue;
                }
                skip = step - 1;
                const bool some = background && map_row_count(map, size[0]) < size[0];
                const T *guess =
                    ROWS(predict)(how & BOX_MEDIAN, ROWS(neighbours_of)(row, size, y, z), size[0],
                                  zeros, predicted);
                out += ROWS(subtract)(row, guess, size[0], how & BOX_ALONG, some ? map : NULL, room,
                                      out);
            }
    }
    return (size_t)(out - (T *)c->residuals);
}

/* Make the bits of a row: which samples are not the background. room: for a row. */
static void ROWS(mark_row)(const T *restrict row, uint32_t n, T background, uint8_t *restrict room,
                           uint8_t *restrict bits) {
    uint32_t x = 0;
    for (uint32_t i = 0; i < n; i++)
        room[i] = (uint8_t)(0 - (row[i] != background));
#ifdef __SSE2__
    for (; x + 16 <= n; x += 16) {
        const __m128i differs = _mm_loadu_si128((const __m128i *)(const void *)(room + x));
        const uint16_t some = (uint16_t)_mm_movemask_epi8(differs);
        memcpy(bits + x / 8, &some, sizeof some);
    }
#endif
    for (; x < n; x += 8) {
        const uint32_t end = x + 8 < n ? x + 8 : n;
        unsigned some = 0;
        for (uint32_t i = x; i < end; i++)
            some |= (room[i] & 1U) << (i - x);
        bits[x / 8] = (uint8_t)some;
    }
}

static void ROWS(mark)(const box_work *c, const coded_box *boxes, uint32_t count,
                       uint32_t background) {
    const T *row = c->values;
    uint8_t *map = c->map;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t n = boxes[i].size[0], rows = boxes[i].size[1] * boxes[i].size[2];
        for (uint32_t r = 0; r < rows; r++, row += n, map += box_map_row_bytes(n))
            ROWS(mark_row)(row, n, (T)background, c->row, map);
    }
}

/* The samples of all boxes from their residuals. False: there are fewer or more residuals than the
 * map says. */
static bool ROWS(values)(const box_work *c, const coded_box *boxes, uint32_t count,
                         const box_code *code) {
    const bool background = code->prediction & BOX_BACKGROUND, along = code->prediction & BOX_ALONG;
    const int how = code->prediction & BOX_MEDIAN;
    const T quiet = (T)code->background;
    const T *residuals = c->residuals, *end = residuals + code->coded;
    const uint8_t *map = c->map;
    T *row = c->values, *predicted = c->predicted, *room = c->row;
    const T *zeros = c->zeros, *guess = zeros;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++, row += size[0]) {
                const uint32_t n = background ? map_row_count(map, size[0]) : size[0];
                if (n > size[0] || n > (size_t)(end - residuals) ||
                    (background && map_row_rest(map, size[0])))
                    return false;
                if (n > 0)
                    guess = ROWS(predict)(how, ROWS(neighbours_of)(row, size, y, z), size[0], zeros,
                                          predicted);
                if (n == size[0])
                    ROWS(add)(residuals, guess, n, along, row);
                else
                    ROWS(spread)(residuals, guess, size[0], along, map, quiet, room, row);
                residuals += n;
                map += box_map_row_bytes(size[0]);
            }
    }
    return residuals == end;
}

static const box_rows ROWS(table) = {
    .residuals = ROWS(residuals), .values = ROWS(values), .mark = ROWS(mark)};

#endif
