#include "prep/import/dicom/dicom_series.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/text.h"
#include "prep/import/import_hint.h"

/* ---- a file ---- */

static dicom_series *find_series(dicom_study *s, const char *uid) {
    for (size_t i = 0; i < s->series_count; i++)
        if (strcmp(s->series[i].image.series, uid) == 0)
            return &s->series[i];
    return NULL;
}

static status take_place(void *ctx, uint32_t frame, const dicom_place *place) {
    dicom_study *s = ctx;
    status st = mem_grow(s->m, &s->slices, sizeof *s->slices, s->slice_count, 256, &s->slice_room);
    if (st == ST_OK)
        s->slices[s->slice_count++] = (dicom_slice){.frame = frame, .place = *place};
    return st;
}

/* Returns whether two images agree in all that a series must have in common. */
static bool alike(const dicom_image *a, const dicom_image *b) {
    return a->columns == b->columns && a->rows == b->rows && a->samples == b->samples &&
           a->allocated == b->allocated && a->stored == b->stored && a->high == b->high &&
           a->is_signed == b->is_signed && a->segments == b->segments;
}

static void describe(dicom_series *series) {
    const dicom_image *i = &series->image;
    snprintf(series->type, sizeof series->type, "%s, %s%u%s, %s%s%s", i->modality,
             i->is_signed ? "i" : "u", i->stored, i->samples == 3 ? " x 3" : "", i->syntax,
             i->description[0] ? ", " : "", i->description);
    if (i->segments && strlen(series->type) + 32 < sizeof series->type)
        text_add(series->type, sizeof series->type, ", labels of %u segment%s", i->segments,
                 i->segments == 1 ? "" : "s");
}

static status add_series(dicom_study *s, const dicom_image *image, uint32_t at,
                         dicom_series **out) {
    status st = mem_grow(s->m, &s->series, sizeof *s->series, s->series_count, 16, &s->series_room);
    if (st != ST_OK)
        return st;
    *out = &s->series[s->series_count++];
    **out = (dicom_series){.image = *image, .file = at};
    describe(*out);
    return ST_OK;
}

static status take_image(dicom_study *s, uint32_t at, const dicom_image *image, size_t first) {
    dicom_series *series = find_series(s, image->series);
    status st = series ? ST_OK : add_series(s, image, at, &series);
    if (st != ST_OK)
        return st;
    char *refuse = series->image.refuse;
    if (!refuse[0] && !image->refuse[0] && !alike(&series->image, image)) {
        const char *name = strrchr(s->files.path[at], '/');
        snprintf(refuse, DICOM_WORDS, "%.120s is of another size or type than others",
                 name ? name + 1 : s->files.path[at]);
    }
    if (!refuse[0] && image->segments && series->file != at)
        snprintf(refuse, DICOM_WORDS,
                 "several files of segments, each with labels of its own: give one of them");
    if (!refuse[0])
        memcpy(refuse, image->refuse, DICOM_WORDS);
    for (size_t i = first; i < s->slice_count; i++) {
        s->slices[i].series = (uint32_t)(series - s->series);
        s->slices[i].file = at;
    }
    series->slices += s->slice_count - first;
    memcpy(s->instances[at], image->instance, sizeof image->instance);
    return ST_OK;
}

/* Check whether a file begins as DICOM does. Others are no input: a folder may hold the output,
 * too. */
static status look(mem *m, const char *path, uint64_t *bytes, bool *known) {
    char start[132] = "";
    file *f = NULL;
    file_guard_look(true);
    status st = file_open(m, path, &f);
    file_guard_look(false);
    if (st != ST_OK)
        return st;
    *bytes = file_size(f);
    if (*bytes >= sizeof start)
        st = file_read_at(f, 0, start, sizeof start);
    file_close(f);
    *known = memcmp(start + 128, "DICM", 4) == 0;
    return st;
}

static status no_image(const char *path, const dicom_image *image, bool named) {
    if (image->storage)
        return status_describe(ST_CORRUPT, "%s: expected rows and columns; it may be cut off",
                               path);
    if (!image->dicom)
        return status_describe(ST_CORRUPT, "%s: no DICOM file: expected DICM at byte 128", path);
    return named ? status_describe(ST_UNSUPPORTED, "%s: DICOM without an image", path) : ST_OK;
}

/* Some DICOM files lack the usual beginning. They are recognized by their names. */
static status read_file(dicom_study *s, uint32_t at) {
    const char *path = s->files.path[at];
    const bool named = at < s->files.named;
    const size_t first = s->slice_count;
    uint64_t bytes = 0;
    bool known = false;
    dicom_image image = {.refuse = ""};
    status st = look(s->m, path, &bytes, &known);
    if (st != ST_OK || (!known && !named && !text_ends_in(path, ".dcm")))
        return st;
    st = dicom_image_read(path, bytes, &image, &(dicom_places){take_place, s});
    if (st == ST_OK && image.columns && image.rows)
        return take_image(s, at, &image, first);
    if (st == ST_CORRUPT && !known)
        image.dicom = image.storage = false;
    else if (st != ST_OK)
        return st;
    return no_image(path, &image, named);
}

/* ---- all of them ---- */

status dicom_study_read(mem *m, char *const *paths, int count, dicom_study *s) {
    *s = (dicom_study){.m = m};
    dicom_image_begin();
    status st = dicom_files_find(m, paths, count, &s->files);
    if (st == ST_OK && s->files.count > UINT32_MAX)
        st = status_describe(ST_UNSUPPORTED, "%s: too many files", paths[0]);
    if (st == ST_OK) {
        s->instances = mem_array(m, s->files.count + 1, sizeof *s->instances);
        st = s->instances ? ST_OK : ST_NOMEM;
    }
    for (uint32_t i = 0; st == ST_OK && i < s->files.count; i++)
        st = read_file(s, i);
    if (st == ST_OK && s->series_count == 0)
        st = status_describe(ST_UNSUPPORTED, "%s: no DICOM images in it", paths[0]);
    return st;
}

void dicom_study_release(dicom_study *s) {
    if (!s->m)
        return;
    mem_free(s->m, s->slices);
    mem_free(s->m, s->series);
    mem_free(s->m, s->instances);
    dicom_files_release(&s->files);
    *s = (dicom_study){0};
}

/* ---- choosing ---- */

/* Number of series with this name; *out: the last of them. */
static int named(const dicom_study *s, const char *field, uint32_t *out) {
    int count = 0;
    for (uint32_t i = 0; i < s->series_count; i++) {
        if (strcmp(s->series[i].image.series, field) != 0 &&
            strcmp(s->series[i].image.description, field) != 0)
            continue;
        *out = i;
        count++;
    }
    return count;
}

status dicom_study_choose(const dicom_study *s, const import_request *q, uint32_t *out) {
    char hint[IMPORT_HINT_MAX];
    const char *field = q->field;
    const char *input = s->files.path[s->series[0].file];
    if (field) {
        const int count = named(s, field, out);
        if (count == 1)
            return ST_OK;
        return status_describe(ST_USAGE, "%s: %s series \"%s\"; `%s' tells what there is", input,
                               count ? "more than one" : "no", field, import_hint_list(q, hint));
    }
    for (uint32_t i = 0; i < s->series_count; i++)
        if (!s->series[i].image.refuse[0] && s->series[i].slices > 1) {
            *out = i;
            return ST_OK;
        }
    *out = 0;
    if (s->series[0].image.refuse[0])
        return ST_OK; /* the caller will report why not */
    return status_describe(ST_UNSUPPORTED,
                           "%s: no series of several slices; `%s' tells what "
                           "there is",
                           input, import_hint_list(q, hint));
}
