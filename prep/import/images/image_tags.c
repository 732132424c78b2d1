#include "prep/import/images/image_tags.h"

#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"

/* ---- values ---- */

static status take_count(const char *path, const char *name, const char *text, uint32_t *out) {
    int64_t value;
    if (num_int(text, name, 1, INT32_MAX, &value) != ST_OK)
        return status_describe(ST_CORRUPT, "%s: its description says %s is \"%.40s\"", path, name,
                               text);
    *out = (uint32_t)value;
    return ST_OK;
}

/* Distances of 0 are ignored, like missing ones. */
static void take_distance(const char *text, double *out) {
    double value;
    if (num_double(text, "", &value) == ST_OK && isfinite(value) && value != 0)
        *out = fabs(value);
}

/* ---- ImageJ ---- */

static status take_line(const char *path, const char *key, const char *value, image_tags *t) {
    if (strcmp(key, "channels") == 0)
        return take_count(path, key, value, &t->channels);
    if (strcmp(key, "slices") == 0)
        return take_count(path, key, value, &t->slices);
    if (strcmp(key, "frames") == 0)
        return take_count(path, key, value, &t->steps);
    if (strcmp(key, "spacing") == 0)
        take_distance(value, &t->spacing[2]);
    if (strcmp(key, "finterval") == 0)
        take_distance(value, &t->time_step);
    return ST_OK;
}

static status read_imagej(const char *path, const char *text, image_tags *t) {
    uint32_t images = 0;
    status st = ST_OK;
    t->by = "ImageJ";
    memcpy(t->order, "CZT", 4);
    memcpy(t->time_unit, "s", 2);
    while (*text && st == ST_OK) {
        const size_t length = strcspn(text, "\n");
        char line[128];
        snprintf(line, sizeof line, "%.*s", (int)(length < 120 ? length : 120), text);
        line[strcspn(line, "\r")] = 0;
        char *value = strchr(line, '=');
        if (value) {
            *value++ = 0;
            st = strcmp(line, "images") == 0 ? take_count(path, line, value, &images)
                                             : take_line(path, line, value, t);
        }
        text += length + (text[length] == '\n');
    }
    /* Old versions give only the number of images. */
    if (!t->slices && !t->channels && !t->steps)
        t->slices = images;
    return st;
}

/* ---- OME ---- */

enum { MAP_TEXT = 512 };

typedef struct ome {
    const char *path;
    image_tags *t;
    uint32_t samples;
    bool seen;   /* the first Pixels element was met */
    bool in_map; /* inside the element whose text is the map */
    char map[MAP_TEXT];
    size_t map_size;
    status st;
    status_note note;
} ome;

static bool named(const char *name, const char *what) {
    const char *colon = strrchr(name, ':');
    return strcmp(colon ? colon + 1 : name, what) == 0;
}

/* "XYCZT": the letters behind X and Y are the order of the pages. */
static status take_order(const char *path, const char *text, image_tags *t) {
    if (strlen(text) != 5 || strncmp(text, "XY", 2) != 0 || !strchr(text + 2, 'C') ||
        !strchr(text + 2, 'Z') || !strchr(text + 2, 'T'))
        return status_describe(ST_CORRUPT, "%s: its OME-XML has DimensionOrder \"%.16s\"", path,
                               text);
    memcpy(t->order, text + 2, 4);
    return ST_OK;
}

static status take_attribute(const ome *o, const char *name, const char *value) {
    static const char *const sizes[] = {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
    for (int a = 0; a < 3; a++)
        if (strcmp(name, sizes[a]) == 0)
            take_distance(value, &o->t->spacing[a]);
    if (strcmp(name, "TimeIncrement") == 0)
        take_distance(value, &o->t->time_step);
    if (strcmp(name, "TimeIncrementUnit") == 0)
        text_name(o->t->time_unit, sizeof o->t->time_unit, value);
    if (strcmp(name, "SizeC") == 0)
        return take_count(o->path, name, value, &o->t->channels);
    if (strcmp(name, "SizeZ") == 0)
        return take_count(o->path, name, value, &o->t->slices);
    if (strcmp(name, "SizeT") == 0)
        return take_count(o->path, name, value, &o->t->steps);
    if (strcmp(name, "DimensionOrder") == 0)
        return take_order(o->path, value, o->t);
    return ST_OK;
}

static void take_pixels(ome *o, const char **attributes) {
    o->seen = true;
    o->t->by = "OME";
    memcpy(o->t->order, "CZT", 4);
    memcpy(o->t->time_unit, "s", 2);
    for (int i = 0; attributes[i] && o->st == ST_OK; i += 2)
        o->st = take_attribute(o, attributes[i], attributes[i + 1]);
    if (o->st == ST_OK && o->t->channels % o->samples == 0)
        o->t->channels /= o->samples;
    status_note_take(&o->note, o->st);
}

static void XMLCALL on_element(void *ctx, const char *name, const char **attributes) {
    ome *o = ctx;
    if (!o->seen && named(name, "Pixels"))
        take_pixels(o, attributes);
    for (int i = 0; attributes[i] && named(name, "M"); i += 2)
        o->in_map |= strcmp(attributes[i], "K") == 0 && strcmp(attributes[i + 1], "to_world") == 0;
}

static void XMLCALL on_text(void *ctx, const char *text, int size) {
    ome *o = ctx;
    if (o->in_map && (size_t)size < MAP_TEXT - o->map_size) {
        memcpy(o->map + o->map_size, text, (size_t)size);
        o->map_size += (size_t)size;
    }
}

/* Use the map only if it is twelve finite numbers. */
static void XMLCALL on_end(void *ctx, const char *name) {
    ome *o = ctx;
    double *map = o->t->to_world;
    (void)name;
    if (!o->in_map)
        return;
    o->in_map = false;
    o->t->mapped = num_doubles(o->map, "", " ", 12, map) == ST_OK;
    for (int i = 0; i < 12; i++)
        o->t->mapped &= isfinite(map[i]) != 0;
}

static status read_ome(const char *path, const char *text, uint32_t samples, image_tags *t) {
    ome o = {.path = path, .t = t, .samples = samples, .st = ST_OK};
    XML_Parser parser = XML_ParserCreate(NULL);
    if (!parser)
        return status_describe(ST_NOMEM, "%s: no memory for its OME-XML", path);
    XML_SetUserData(parser, &o);
    XML_SetElementHandler(parser, on_element, on_end);
    XML_SetCharacterDataHandler(parser, on_text);
    const enum XML_Status parsed = XML_Parse(parser, text, (int)strlen(text), 1);
    XML_ParserFree(parser);
    if (o.st != ST_OK)
        return status_note_raise(&o.note);
    if (parsed != XML_STATUS_OK && !o.seen)
        return status_describe(ST_CORRUPT, "%s: its OME-XML is malformed", path);
    return ST_OK;
}

/* ---- either ---- */

static uint32_t at_least_one(uint32_t n) {
    return n ? n : 1;
}

status image_tags_read(const char *path, const char *description, uint32_t samples,
                       image_tags *out) {
    status st = ST_OK;
    *out = (image_tags){0};
    if (strncmp(description, "ImageJ=", 7) == 0)
        st = read_imagej(path, description, out);
    else if (strstr(description, "openmicroscopy.org") && strlen(description) < INT32_MAX)
        st = read_ome(path, description, at_least_one(samples), out);
    if (out->by) {
        out->channels = at_least_one(out->channels);
        out->slices = at_least_one(out->slices);
        out->steps = at_least_one(out->steps);
    }
    return st;
}

uint64_t image_tags_page(const image_tags *t, uint32_t channel, uint32_t slice, uint32_t step) {
    uint64_t page = 0, stride = 1;
    for (int i = 0; i < 3; i++) {
        const char axis = t->order[i];
        page += stride * (axis == 'C' ? channel : axis == 'Z' ? slice : step);
        stride *= axis == 'C' ? t->channels : axis == 'Z' ? t->slices : t->steps;
    }
    return page;
}
