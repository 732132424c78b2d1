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

static inline void ROWS(fill)(T *row, uint32_t n, T value) {
    for (uint32_t x = 0; x < n; x++)
        row[x] = value;
}

/* Replace a missing neighbour: predict by the one that is there alone; without both, by 0. */
static int ROWS(settle)(int how, ROWS(neighbours) * k) {
    if (!k->above)
        k->above = k->behind;
    if (!k->above)
        return BOX_NONE;
    return how != BOX_NONE && !k->corner ? BOX_ROW : how;
}

/* What makes a row of samples. */
typedef struct ROWS(recipe) {
    int how;
    bool along;
    T background;
    const uint8_t *coded; /* NULL: all samples are */
    ROWS(neighbours) k;
    const T *residuals;
} ROWS(recipe);

#ifdef __SSE4_1__

enum { ROWS(LANES) = 16 / sizeof(T) };

static inline __m128i ROWS(load)(const T *from) {
    return _mm_loadu_si128((const __m128i *)(const void *)from);
}

static inline __m128i ROWS(prediction)(int how, const ROWS(neighbours) * k, uint32_t x) {
    if (how == BOX_NONE)
        return _mm_setzero_si128();
    const __m128i a = ROWS(load)(k->above + x);
    if (how == BOX_ROW)
        return a;
    const __m128i b = ROWS(load)(k->behind + x), c = ROWS(load)(k->corner + x);
    if (how == BOX_PLANE)
        return ROWS(minus)(ROWS(plus)(a, b), c);
    const __m128i least = ROWS(min)(a, b), most = ROWS(max)(a, b);
    return ROWS(minus)(ROWS(plus)(least, most), ROWS(min)(ROWS(max)(c, least), most));
}

/* Residuals are differences modulo 2^bits, folded so that small ones of either sign are small. */
static inline __m128i ROWS(folded)(__m128i d) {
    return _mm_xor_si128(ROWS(plus)(d, d), ROWS(below)(d, _mm_setzero_si128()));
}

/* Residuals of a row, or the errors of its prediction, in whole vectors. */
static inline __attribute__((always_inline)) void ROWS(errors)(int how, bool along, bool folds,
                                                               const T *row,
                                                               const ROWS(neighbours) * k,
                                                               uint32_t n, T *out) {
    __m128i before = _mm_setzero_si128();
    for (uint32_t x = 0; x < n; x += ROWS(LANES)) {
        const __m128i error = ROWS(minus)(ROWS(load)(row + x), ROWS(prediction)(how, k, x));
        const __m128i one_before = _mm_alignr_epi8(error, before, 16 - sizeof(T));
        const __m128i off = along ? ROWS(minus)(error, one_before) : error;
        before = error;
        _mm_storeu_si128((__m128i *)(void *)(out + x), folds ? ROWS(folded)(off) : off);
    }
}

static void ROWS(errors_of)(int how, bool along, bool folds, const T *row,
                            const ROWS(neighbours) * k, uint32_t n, T *out) {
#define ERRORS(of)                                          \
    do {                                                    \
        if (!folds)                                         \
            ROWS(errors)(of, false, false, row, k, n, out); \
        else if (along)                                     \
            ROWS(errors)(of, true, true, row, k, n, out);   \
        else                                                \
            ROWS(errors)(of, false, true, row, k, n, out);  \
    } while (0)
    switch (how) {
    case BOX_NONE: ERRORS(BOX_NONE); break;
    case BOX_ROW: ERRORS(BOX_ROW); break;
    case BOX_PLANE: ERRORS(BOX_PLANE); break;
    default: ERRORS(BOX_MEDIAN);
    }
#undef ERRORS
}

/* Make the residuals of a row. coded: which samples are coded; NULL: all. Returns how many
 * residuals there are. */
static uint32_t ROWS(row_residuals)(const box_work *c, int how, bool along, ROWS(neighbours) k,
                                    const T *row, uint32_t n, const uint8_t *coded, T *out) {
    T *room = c->row;
    how = ROWS(settle)(how, &k);
    if (!coded) {
        ROWS(errors_of)(how, along, true, row, &k, n, out);
        return n;
    }
    ROWS(errors_of)(how, false, false, row, &k, n, room);
    const uint32_t kept = ROWS(keep)(room, n, coded, room + n);
    ROWS(errors_of)(BOX_NONE, along, true, room + n, &k, kept, out);
    return kept;
}

/* Returns each lane plus all lanes before it. */
static inline __m128i ROWS(sums)(__m128i v) {
    if (sizeof(T) == 1)
        v = ROWS(plus)(v, _mm_slli_si128(v, 1));
    if (sizeof(T) <= 2)
        v = ROWS(plus)(v, _mm_slli_si128(v, 2));
    v = ROWS(plus)(v, _mm_slli_si128(v, 4));
    return ROWS(plus)(v, _mm_slli_si128(v, 8));
}

/* Take the next residuals into the lanes of coded samples, zeros into the others. *is: all bits set
 * in coded lanes. */
static inline __m128i ROWS(scattered)(const T **residuals, const uint8_t *coded, uint32_t x,
                                      __m128i *is) {
    uint64_t parts[2], masks[2];
#ifdef __BMI2__
    enum { HALF = ROWS(LANES) / 2 }; /* in 64 bits */
    const uint64_t ones = UINT64_MAX / ((T)-1);
    const unsigned all = ROWS(bits_from)(coded, x);
    for (int i = 0; i < 2; i++) {
        const unsigned bits = all >> (i * HALF) & ((1U << HALF) - 1);
        memcpy(&parts[i], *residuals, sizeof parts[i]);
        masks[i] = _pdep_u64(bits, ones) * (T)-1;
        parts[i] = _pdep_u64(parts[i], masks[i]);
        *residuals += __builtin_popcount(bits);
    }
#else
    T value[ROWS(LANES)], mask[ROWS(LANES)];
    for (uint32_t i = 0; i < ROWS(LANES); i++) {
        const unsigned bit = coded[(x + i) / 8] >> (x + i) % 8 & 1;
        mask[i] = (T)(0 - (T)bit);
        value[i] = (T)(**residuals & mask[i]);
        *residuals += bit;
    }
    memcpy(parts, value, sizeof parts);
    memcpy(masks, mask, sizeof masks);
#endif
    *is = _mm_loadu_si128((const __m128i *)(const void *)masks);
    return _mm_loadu_si128((const __m128i *)(const void *)parts);
}

/* Decode a row in whole vectors. They overwrite up to BOX_SPARE bytes behind it: decode rows in
 * order. */
static inline __attribute__((always_inline)) void ROWS(make)(const ROWS(recipe) * r, int how,
                                                             uint32_t n, T *row) {
    const __m128i quiet = ROWS(all)(r->background), last = ROWS(last_lane)();
    const T *residuals = r->residuals;
    __m128i is = _mm_set1_epi8(-1), before = _mm_setzero_si128();
    for (uint32_t x = 0; x < n; x += ROWS(LANES)) {
        const __m128i folded =
            r->coded ? ROWS(scattered)(&residuals, r->coded, x, &is) : ROWS(load)(residuals + x);
        __m128i error = ROWS(unfolded)(folded);
        if (r->along) {
            error = ROWS(plus)(ROWS(sums)(error), before);
            before = _mm_shuffle_epi8(error, last);
        }
        const __m128i value = ROWS(plus)(ROWS(prediction)(how, &r->k, x), error);
        _mm_storeu_si128((__m128i *)(void *)(row + x), _mm_blendv_epi8(quiet, value, is));
    }
}

static void ROWS(make_row)(const box_work *c, const ROWS(recipe) * r, uint32_t n, T *row) {
    (void)c;
    switch (r->how) {
    case BOX_NONE: ROWS(make)(r, BOX_NONE, n, row); break;
    case BOX_ROW: ROWS(make)(r, BOX_ROW, n, row); break;
    case BOX_PLANE: ROWS(make)(r, BOX_PLANE, n, row); break;
    default: ROWS(make)(r, BOX_MEDIAN, n, row);
    }
}

#else

/* Rows are short, so loops run in whole vectors: as if rows were longer (BOX_SPARE). */
static inline uint32_t ROWS(whole)(uint32_t n) {
    enum { LANES_MOST = BOX_SPARE / 2 / sizeof(T) };
    return (n + LANES_MOST - 1) / LANES_MOST * LANES_MOST;
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
    const uint32_t whole = ROWS(whole)(n);
    if (how == BOX_PLANE) {
        for (uint32_t x = 0; x < whole; x++)
            room[x] = (T)(above[x] + behind[x] - corner[x]);
        return room;
    }
    for (uint32_t x = 0; x < whole; x++) {
        const T a = above[x], b = behind[x], c = corner[x];
        const T least = a < b ? a : b, most = a < b ? b : a;
        const T low = c < least ? least : c, clamped = low < most ? low : most;
        room[x] = (T)(least + most - clamped);
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

/* Residuals of a row for its prediction. coded: which samples are coded; NULL: all. room: for two
 * rows. Returns how many residuals there are. */
static uint32_t ROWS(subtract)(const T *restrict row, const T *restrict predicted, uint32_t n,
                               bool along, const uint8_t *coded, T *restrict room,
                               T *restrict out) {
    const T *errors = room;
    uint32_t whole = ROWS(whole)(n);
    for (uint32_t x = 0; x < whole; x++)
        room[x] = (T)(row[x] - predicted[x]);
    if (coded) {
        const uint32_t kept = ROWS(keep)(room, n, coded, room + n);
        errors = room + n;
        n = kept;
        whole = ROWS(whole)(n);
    }
    if (along) {
        out[0] = ROWS(fold)(errors[0]);
        for (uint32_t x = 0; x < whole; x++)
            out[x + 1] = ROWS(fold)((T)(errors[x + 1] - errors[x]));
    } else {
        for (uint32_t x = 0; x < whole; x++)
            out[x] = ROWS(fold)(errors[x]);
    }
    return n;
}

/* Make the residuals of a row. coded: which samples are coded; NULL: all. Returns how many
 * residuals there are. */
static uint32_t ROWS(row_residuals)(const box_work *c, int how, bool along, ROWS(neighbours) k,
                                    const T *row, uint32_t n, const uint8_t *coded, T *out) {
    const T *guess = ROWS(predict)(how, k, n, c->zeros, c->predicted);
    return ROWS(subtract)(row, guess, n, along, coded, c->row, out);
}

/* Replace each of n values by the sum of all up to it. */
static inline void ROWS(accumulate)(T *row, uint32_t n) {
    T sum = 0;
    for (uint32_t x = 0; x < n; x++)
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
static inline void ROWS(expand)(const T *restrict residuals, const uint8_t *restrict coded,
                                uint32_t n, T *restrict row, T *restrict is) {
    for (uint32_t x = 0; x < n; x++) {
        is[x] = (T)(0 - (T)(coded[x / 8] >> x % 8 & 1));
        row[x] = (T)(*residuals & is[x]);
        residuals += coded[x / 8] >> x % 8 & 1;
    }
}

/* The samples of a row of which some are coded. room: for a row. */
static inline void ROWS(spread)(const T *restrict residuals, const T *restrict predicted,
                                uint32_t n, bool along, const uint8_t *restrict coded, T background,
                                T *restrict room, T *restrict row) {
    ROWS(expand)(residuals, coded, n, row, room);
    for (uint32_t x = 0; x < n; x++)
        row[x] = ROWS(unfold)(row[x]);
    if (along)
        ROWS(accumulate)(row, n);
    for (uint32_t x = 0; x < n; x++)
        row[x] = (T)(((T)(row[x] + predicted[x]) & room[x]) | (background & (T)~room[x]));
}

static void ROWS(make_row)(const box_work *c, const ROWS(recipe) * r, uint32_t n, T *row) {
    const T *guess = ROWS(predict)(r->how, r->k, n, c->zeros, c->predicted);
    if (!r->coded)
        ROWS(add)(r->residuals, guess, n, r->along, row);
    else
        ROWS(spread)(r->residuals, guess, n, r->along, r->coded, r->background, c->row, row);
}

#endif

/* ---- boxes ---- */

/* Residuals of every `step`-th row of all boxes, one box behind the other. background: whether the
 * map says which samples are coded. Returns how many residuals there are. */
static size_t ROWS(residuals)(const box_work *c, const coded_box *boxes, uint32_t count, int how,
                              bool background, uint32_t step) {
    const T *row = c->values;
    const uint8_t *map = c->map;
    T *out = c->residuals;
    uint32_t next = 0; /* row of the box that is looked at next */
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        const uint32_t bytes = box_map_row_bytes(size[0]), rows = size[1] * size[2];
        for (; next < rows; next += step) {
            const T *from = row + (size_t)next * size[0];
            const uint8_t *bits = map + (size_t)next * bytes;
            const bool some = background && map_row_count(bits, size[0]) < size[0];
            out +=
                ROWS(row_residuals)(c, how & BOX_MEDIAN, how & BOX_ALONG,
                                    ROWS(neighbours_of)(from, size, next % size[1], next / size[1]),
                                    from, size[0], some ? bits : NULL, out);
        }
        next -= rows;
        row += (size_t)rows * size[0];
        map += (size_t)rows * bytes;
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
    const bool background = code->prediction & BOX_BACKGROUND;
    const T *const end = (const T *)c->residuals + code->coded;
    const uint8_t *map = c->map;
    ROWS(recipe)
    r = {.along = code->prediction & BOX_ALONG,
         .background = (T)code->background,
         .residuals = c->residuals};
    T *row = c->values;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size[3] = {boxes[i].size[0], boxes[i].size[1], boxes[i].size[2]};
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++, row += size[0]) {
                const uint32_t n = background ? map_row_count(map, size[0]) : size[0];
                if (n > size[0] || n > (size_t)(end - r.residuals) ||
                    (background && map_row_rest(map, size[0])))
                    return false;
                r.k = ROWS(neighbours_of)(row, size, y, z);
                r.how = ROWS(settle)(code->prediction & BOX_MEDIAN, &r.k);
                r.coded = n < size[0] ? map : NULL;
                if (n > 0)
                    ROWS(make_row)(c, &r, size[0], row);
                else
                    ROWS(fill)(row, size[0], r.background);
                r.residuals += n;
                map += box_map_row_bytes(size[0]);
            }
    }
    return r.residuals == end;
}

static const box_rows ROWS(table) = {
    .residuals = ROWS(residuals), .values = ROWS(values), .mark = ROWS(mark)};

#endif
