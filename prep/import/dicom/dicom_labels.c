#include "prep/import/dicom/dicom_labels.h"

#include <math.h>
#include <stdlib.h>

/* Tolerances: as a part of a pixel, and of the distance of slices. */
static const double SAME_PLACE = 1e-3, SAME_DISTANCE = 1e-2;
enum { FILLED_MAX = 1 << 14 };

/* ---- groups ---- */

static double along_normal(const dicom_place *p) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += p->position[i] * (p->across[j] * p->down[k] - p->across[k] * p->down[j]);
    }
    return sum;
}

static int by_place(const void *a, const void *b) {
    const dicom_label *x = a, *y = b;
    if (x->along != y->along)
        return x->along < y->along ? -1 : 1;
    return x->frame < y->frame ? -1 : x->frame > y->frame;
}

static int by_segment(const void *a, const void *b) {
    const dicom_label *x = a, *y = b;
    if (x->group != y->group)
        return x->group < y->group ? -1 : 1;
    if (x->segment != y->segment)
        return x->segment < y->segment ? -1 : 1;
    return x->frame < y->frame ? -1 : x->frame > y->frame;
}

static bool same_place(const dicom_place *a, const dicom_place *b) {
    for (int i = 0; i < 3; i++)
        if (fabs(a->position[i] - b->position[i]) > SAME_PLACE * fabs(a->between[0]))
            return false;
    return true;
}

uint32_t dicom_labels_group(dicom_label *labels, uint32_t count) {
    uint32_t group = 0;
    for (uint32_t i = 0; i < count; i++)
        labels[i].along = along_normal(&labels[i].place);
    qsort(labels, count, sizeof *labels, by_place);
    for (uint32_t i = 0, first = 0; i < count; i++) {
        if (!same_place(&labels[i].place, &labels[first].place)) {
            group++;
            first = i;
        }
        labels[i].group = group;
    }
    qsort(labels, count, sizeof *labels, by_segment);
    return count ? group + 1 : 0;
}

/* ---- places ---- */

/* Distance of slices: from the header, else the least one found. */
static double distance(const dicom_label *labels, uint32_t count) {
    double least = labels[0].place.apart;
    if (least > 0)
        return least;
    least = 0;
    for (uint32_t i = 1; i < count; i++) {
        const double apart = labels[i].along - labels[i - 1].along;
        if (labels[i].group != labels[i - 1].group && (least == 0 || apart < least))
            least = apart;
    }
    return least;
}

/* Number of slices that are missing between two groups; 0 if the gap is not a whole number of
 * steps. */
static uint32_t absent_between(double gap, double apart) {
    const double steps = apart > 0 ? rint(gap / apart) : 0;
    if (!(steps > 1 && steps <= FILLED_MAX) || fabs(gap - steps * apart) > SAME_DISTANCE * apart)
        return 0;
    return (uint32_t)steps - 1;
}

static status tell_absent(const dicom_label *a, const dicom_label *b, uint32_t absent,
                          uint32_t *frame, const dicom_places *places) {
    status st = ST_OK;
    for (uint32_t i = 1; i <= absent && st == ST_OK; i++) {
        dicom_place p = a->place;
        for (int k = 0; k < 3; k++)
            p.position[k] += (b->place.position[k] - a->place.position[k]) * i / (absent + 1);
        p.number = (int)*frame;
        st = places->take(places->ctx, (*frame)++, &p);
    }
    return st;
}

status dicom_labels_tell(const dicom_label *labels, uint32_t count, uint32_t frames,
                         const dicom_places *places) {
    const dicom_label *last = NULL;
    const double apart = count ? distance(labels, count) : 0;
    uint32_t filled = frames;
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++) {
        const dicom_label *at = &labels[i];
        if (last && at->group == last->group)
            continue;
        const uint32_t absent = last ? absent_between(at->along - last->along, apart) : 0;
        if (absent && filled - frames <= FILLED_MAX)
            st = tell_absent(last, at, absent, &filled, places);
        if (st == ST_OK)
            st = places->take(places->ctx, at->frame, &at->place);
        last = at;
    }
    return st;
}

/* ---- pixels ---- */

const dicom_label *dicom_labels_first(const dicom_label *labels, uint32_t count, uint32_t frame) {
    const dicom_label *first = NULL;
    for (uint32_t i = 0; i < count; i++) {
        if (!first || first->group != labels[i].group)
            first = &labels[i];
        if (labels[i].frame == frame)
            return first;
    }
    return NULL;
}

uint64_t dicom_labels_put(const uint8_t *bits, uint32_t frame, size_t pixels, uint32_t value,
                          uint32_t allocated, void *numbers) {
    uint8_t *bytes = numbers;
    uint16_t *shorts = numbers;
    uint64_t taken = 0, bit = (uint64_t)frame * pixels;
    for (size_t i = 0; i < pixels; i++, bit++) {
        if (!(bits[bit >> 3] >> (bit & 7) & 1))
            continue;
        if (allocated == 8 ? bytes[i] : shorts[i])
            taken++;
        else if (allocated == 8)
            bytes[i] = (uint8_t)value;
        else
            shorts[i] = (uint16_t)value;
    }
    return taken;
}
