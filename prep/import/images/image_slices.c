#include "prep/import/images/image_slices.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/base/text.h"
#include "formats/base/vec3.h"
#include "prep/import/images/geotiff.h"
#include "prep/import/images/image_file.h"
#include "prep/import/images/image_names.h"
#include "prep/import/images/image_tags.h"
#include "prep/import/images/jpeg_end.h"
#include "prep/import/images/tiff_pages.h"
#include "prep/import/images/tiff_place.h"

typedef struct page {
    uint32_t file, index;
} page;

typedef struct stack {
    mem *m;
    image_names names;
    page *pages; /* of all files, in order; later only pages of the wanted channel and step */
    size_t page_count, room;
    image_file *open; /* the file of open_index, or NULL */
    uint32_t open_index;
    image_facts first; /* of the first page */
    image_tags tags;
    geotiff geo; /* of the open file, if it is a TIFF */
    int channel; /* or IMAGE_LUMINANCE, or IMAGE_COLOURS */
    sample_type type;
    bool is_file; /* the input is the file itself, not its folder */
    tiff_place place;
} stack;

static void stack_free(stack *s) {
    mem *m = s->m;
    image_file_close(s->open);
    image_names_release(&s->names);
    tiff_place_release(&s->place);
    geotiff_release(&s->geo);
    mem_free(m, s->pages);
    mem_free(m, s);
}

/* ---- the channel ---- */

enum { NO_CHANNEL = IMAGE_COLOURS - 1 };

static status refuse_channel(const stack *s, const char *asked) {
    char known[256] = "";
    for (uint32_t c = 0; c < s->first.channels && strlen(known) < 160; c++)
        text_add(known, sizeof known, "%s%.32s", c ? ", " : "", image_file_channel(s->open, c));
    return status_describe(
        ST_UNSUPPORTED, "%s: %s%s%s%s", s->names.paths[0],
        asked ? "no channel \"" : "its channels are no colours: ", asked ? asked : known,
        asked ? "\", but " : "", asked ? known : "; --component or --field says which to take");
}

static status choose_channel(stack *s, const import_request *q) {
    if (q->field && strcmp(q->field, COLOUR_FIELD) == 0) {
        s->channel = IMAGE_COLOURS;
        return ST_OK;
    }
    if (q->field) {
        for (uint32_t c = 0; c < s->first.channels; c++)
            if (strcmp(q->field, image_file_channel(s->open, c)) == 0) {
                s->channel = (int)c;
                return ST_OK;
            }
        return refuse_channel(s, q->field);
    }
    if (q->component > s->first.channels && s->tags.channels <= 1)
        return status_describe(ST_USAGE, "--component %u: the pages of %s have %u", q->component,
                               s->names.paths[0], s->first.channels);
    const bool of_pages = s->tags.channels > 1 && s->first.channels == 1;
    s->channel = q->component && !of_pages ? (int)q->component - 1 : 0;
    if (q->component || s->first.grey)
        return ST_OK;
    s->channel = IMAGE_LUMINANCE;
    return s->first.colour ? ST_OK : refuse_channel(s, NULL);
}

/* ---- the pages ---- */

static status check_page(const stack *s, uint32_t index) {
    const image_facts *f = image_file_facts(s->open);
    const size_t z = s->page_count;
    sample_type type = s->type;
    if (f->width == s->first.width && f->height == s->first.height &&
        f->channels == s->first.channels) {
        const status st = image_file_type(s->open, s->channel, &type);
        if (st != ST_OK || type == s->type)
            return st;
    }
    return status_describe(ST_UNSUPPORTED,
                           "%s: slice %zu (page %u) has %u x %u pixels, %u channels, %s; slice 0 "
                           "has %u x %u, %u, %s",
                           s->names.paths[s->open_index], z, index, f->width, f->height,
                           f->channels, sample_name(type), s->first.width, s->first.height,
                           s->first.channels, sample_name(s->type));
}

static status add_page(stack *s, uint32_t index) {
    status st = check_page(s, index);
    if (st == ST_OK)
        st = mem_grow(s->m, &s->pages, sizeof *s->pages, s->page_count, 256, &s->room);
    if (st == ST_OK)
        s->pages[s->page_count++] = (page){s->open_index, index};
    return st;
}

static bool is_tiff(const stack *s) {
    return strcmp(image_file_format(s->open), "tiff") == 0;
}

static status open_file(stack *s, uint32_t index) {
    if (s->open && s->open_index == index)
        return ST_OK;
    image_file_close(s->open);
    s->open = NULL;
    s->open_index = index;
    geotiff_release(&s->geo);
    const status st = image_file_open(s->names.paths[index], &s->open);
    return st == ST_OK && is_tiff(s) ? geotiff_read(s->m, s->names.paths[index], &s->geo) : st;
}

/* Find broken files that the library does not report: it takes a TIFF's broken directory for the
 * end. */
static status check_whole(const stack *s, uint32_t found) {
    const char *path = s->names.paths[s->open_index];
    uint64_t said;
    if (strcmp(image_file_format(s->open), "jpeg") == 0)
        return jpeg_end_check(s->m, path);
    if (!is_tiff(s))
        return ST_OK;
    const status st = tiff_pages_count(s->m, path, &said);
    if (st == ST_OK && said != found)
        return status_describe(ST_CORRUPT, "%s: page %u of %llu cannot be read", path, found,
                               (unsigned long long)said);
    return st;
}

static status add_file(stack *s, uint32_t index) {
    status st = open_file(s, index);
    uint32_t found = 0;
    for (bool there = true; st == ST_OK; found++) {
        st = image_file_seek(s->open, found, &there);
        if (st != ST_OK || !there)
            break;
        if (!geotiff_is_beside(&s->geo, found))
            st = add_page(s, found);
    }
    return st == ST_OK ? check_whole(s, found) : st;
}

/* Choose the pages that are slices, by the description of a single file. */
static status choose_pages(stack *s, const import_request *q) {
    const image_tags *t = &s->tags;
    const uint32_t steps = t->by ? t->steps : 1;
    if (q->step >= steps)
        return status_describe(ST_USAGE, "--step %u: %s has %u", q->step, s->names.paths[0], steps);
    if (!t->by)
        return ST_OK;
    const uint64_t said = (uint64_t)t->channels * t->slices;
    if (said > UINT32_MAX || said * t->steps > s->page_count)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %s says it is of %u channels, %u slices, %u steps; it has %zu "
                               "pages: the others are elsewhere, or lie behind it without a "
                               "directory",
                               s->names.paths[0], t->by, t->channels, t->slices, t->steps,
                               s->page_count);
    const uint32_t channel = s->first.channels == 1 && q->component ? q->component - 1 : 0;
    if (channel >= t->channels)
        return status_describe(ST_USAGE, "--component %u: %s has %u", q->component,
                               s->names.paths[0], t->channels);
    page *kept = mem_array(s->m, t->slices, sizeof *kept);
    if (!kept)
        return ST_NOMEM;
    for (uint32_t z = 0; z < t->slices; z++)
        kept[z] = s->pages[image_tags_page(t, channel, z, q->step)];
    mem_free(s->m, s->pages);
    s->pages = kept;
    s->page_count = s->room = t->slices;
    return ST_OK;
}

/* ---- where it lies ---- */

static double spacing_of(const stack *s, const image_wish *wish, int a) {
    const double pixels = s->first.resolution[a < 2 ? a : 0];
    const bool imagej = s->tags.by && strcmp(s->tags.by, "ImageJ") == 0;
    if (wish->spacing[a] != 0)
        return wish->spacing[a];
    if (s->tags.spacing[a] > 0)
        return s->tags.spacing[a];
    if (s->tags.by && !(imagej && a < 2))
        return 1;
    if (!(pixels > 0) || !(1 / pixels > 0))
        return 1;
    return !imagej && s->first.unit > 0 ? s->first.unit / pixels : 1 / pixels;
}

/* A spacing asked for replaces the length of an axis. */
static void stretch(grid *g, const image_wish *wish) {
    for (int a = 0; a < 3; a++) {
        const double column[3] = {g->to_world[0][a], g->to_world[1][a], g->to_world[2][a]};
        for (int row = 0; row < 3 && wish->spacing[a] != 0; row++)
            g->to_world[row][a] = column[row] / vec3_length(column) * wish->spacing[a];
    }
}

/* Take the map of the description. */
static void place_by_map(const stack *s, const image_wish *wish, grid *g) {
    memcpy(g->to_world, s->tags.to_world, sizeof g->to_world);
    stretch(g, wish);
}

/* A single page on a map, of one number a pixel, is terrain. So are colours, wherever they are: to
 * be draped. */
static void place_on_map(const stack *s, const image_wish *wish, grid *g) {
    const geotiff *geo = &s->geo;
    g->terrain = s->channel == IMAGE_COLOURS && s->page_count == 1;
    if (!geo->placed || s->page_count != 1)
        return;
    for (int row = 0; row < 2; row++) {
        g->to_world[row][0] = geo->map[row][0];
        g->to_world[row][1] = geo->map[row][1];
        g->to_world[row][3] = geo->map[row][2];
        world_frame_set_unit(&g->frame, row, geo->unit);
    }
    g->to_world[2][2] = 1.0;
    world_frame_set_unit(&g->frame, 2, geo->up);
    stretch(g, wish);
    g->terrain = g->terrain || s->first.channels == 1;
}

/* A number that stands for no data: of 32 bits its text may be cut or rounded up. One that no
 * sample can be is none. */
static void set_missing(const stack *s, grid *g) {
    const double asked = s->geo.missing, most = (double)FLT_MAX;
    g->missing = s->type != SAMPLE_F32 ? asked
                 : fabs(asked) <= most ? (double)(float)asked
                                       : copysign(most, asked);
    g->has_missing =
        s->channel != IMAGE_COLOURS && s->geo.has_missing && sample_holds(s->type, g->missing);
}

static void describe_grid(const stack *s, const image_wish *wish, const char *path, grid *g) {
    const uint32_t slices = s->page_count < UINT32_MAX ? (uint32_t)s->page_count : UINT32_MAX;
    grid_init(g, (uint32_t[3]){s->first.width, s->first.height, slices}, s->type);
    for (int a = 0; a < 3; a++)
        g->to_world[a][a] = spacing_of(s, wish, a);
    if (s->tags.mapped)
        place_by_map(s, wish, g);
    place_on_map(s, wish, g);
    set_missing(s, g);
    if (s->geo.scaled)
        snprintf(g->note, sizeof g->note, "%s", "GDAL's scale and offset are not applied");
    text_file_name(g->name, sizeof g->name, path);
}

/* ---- where samples can stay ---- */

/* Find the pages' samples in their files. */
static status look_at_pages(stack *s, sample_place *out) {
    uint32_t *pages = mem_array(s->m, s->page_count, sizeof *pages);
    const char **paths = mem_array(s->m, s->page_count, sizeof *paths);
    for (size_t z = 0; z < s->page_count && pages && paths; z++) {
        pages[z] = s->pages[z].index;
        paths[z] = s->names.paths[s->pages[z].file];
    }
    const tiff_wish wish = {.paths = paths,
                            .pages = pages,
                            .slices = (uint32_t)s->page_count,
                            .in_slices = !s->is_file,
                            .component = (uint32_t)(s->channel + 1),
                            .type = s->type};
    tiff_place_release(&s->place);
    const status st = pages && paths ? tiff_place_find(s->m, &wish, &s->place, out) : ST_NOMEM;
    mem_free(s->m, pages);
    mem_free(s->m, paths);
    return st;
}

static bool find_place(void *ctx, sample_place *out) {
    stack *s = ctx;
    *out = (sample_place){.path = NULL};
    if (!s->open || !is_tiff(s))
        return false;
    if (s->channel == IMAGE_COLOURS)
        out->refused = "colours are made one number each";
    else if (s->is_file && s->names.count > 1)
        out->refused = "its slices are named one by one, and not their folder";
    else if (look_at_pages(s, out) != ST_OK)
        out->refused = "its pages cannot be looked through";
    return true;
}

/* ---- all of it ---- */

static status look(stack *s, const import_request *q, const image_wish *wish) {
    status st = image_names_find(s->m, q->paths, (size_t)q->path_count, wish->as_given,
                                 image_file_known, &s->names);
    if (st == ST_OK)
        st = open_file(s, 0);
    if (st != ST_OK)
        return st;
    s->is_file = strcmp(q->paths[0], s->names.paths[0]) == 0;
    s->first = *image_file_facts(s->open);
    st = image_tags_read(s->names.paths[0], image_file_description(s->open), s->first.channels,
                         &s->tags);
    if (st == ST_OK && s->names.count > 1) /* the file is one of several: take its pages in order */
        s->tags.channels = s->tags.slices = s->tags.steps = 0;
    return st;
}

static status look_at_all(stack *s, const import_request *q) {
    status st = choose_channel(s, q);
    if (st == ST_OK)
        st = image_file_type(s->open, s->channel, &s->type);
    for (uint32_t i = 0; i < s->names.count && st == ST_OK; i++)
        st = add_file(s, i);
    if (st != ST_OK || s->names.count == 1)
        return st == ST_OK ? choose_pages(s, q) : st;
    return q->step ? status_describe(ST_USAGE, "--step: several files are the slices of one step")
                   : ST_OK;
}

static status make_stack(mem *m, const import_request *q, const image_wish *wish, stack **out) {
    stack *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    const status st = look(s, q, wish);
    if (st == ST_OK)
        *out = s;
    else
        stack_free(s);
    return st;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    stack *s = ctx;
    const size_t bytes = (size_t)s->first.width * s->first.height * sample_size(s->type);
    status st = ST_OK;
    for (uint32_t z = first; z < first + count && st == ST_OK; z++) {
        bool there = true;
        st = open_file(s, s->pages[z].file);
        if (st == ST_OK)
            st = image_file_seek(s->open, s->pages[z].index, &there);
        if (st == ST_OK && !there)
            st = status_describe(ST_CORRUPT, "%s: page %u cannot be read",
                                 s->names.paths[s->open_index], s->pages[z].index);
        if (st == ST_OK)
            st = check_page(s, s->pages[z].index);
        if (st == ST_OK)
            st = image_file_read(s->open, s->channel, (char *)slices + bytes * (z - first));
    }
    return st;
}

static void close_stack(void *ctx) {
    stack_free(ctx);
}

status image_slices_open(mem *m, const import_request *q, const image_wish *wish,
                         slice_source *out) {
    stack *s;
    status st = make_stack(m, q, wish, &s);
    if (st != ST_OK)
        return st;
    st = look_at_all(s, q);
    if (st != ST_OK) {
        stack_free(s);
        return st;
    }
    *out = (slice_source){.format = "images",
                          .name = q->paths[0],
                          .m = m,
                          .read = read_slices,
                          .place = find_place,
                          .place_ctx = s,
                          .close = close_stack,
                          .ctx = s};
    describe_grid(s, wish, q->paths[0], &out->g);
    return ST_OK;
}

/* Times of the steps if the description gives their distance; else NULL. */
static status make_times(const stack *s, double **out) {
    const image_tags *t = &s->tags;
    *out = NULL;
    if (!t->by || t->steps < 2 || !(t->time_step > 0))
        return ST_OK;
    *out = mem_array(s->m, t->steps, sizeof **out);
    for (uint32_t i = 0; *out && i < t->steps; i++)
        (*out)[i] = i * t->time_step;
    return *out ? ST_OK : ST_NOMEM;
}

/* wanted: the channel that is taken; IMAGE_LUMINANCE: all. If each channel has its own pages,
 * channels are listed as components. */
static status list_channels(const stack *s, const import_request *q, int wanted,
                            const import_list *to) {
    const bool of_pages = s->tags.channels > 1 && s->first.channels == 1;
    double *times;
    status st = make_times(s, &times);
    for (uint32_t c = 0; c < s->first.channels && st == ST_OK; c++) {
        sample_type type;
        const bool can = image_file_type(s->open, (int)c, &type) == ST_OK;
        const import_item item = {.name = image_file_channel(s->open, c),
                                  .type = can ? sample_name(type) : "?",
                                  .shape = {s->first.width, s->first.height, s->page_count,
                                            s->tags.steps > 1 ? s->tags.steps : 0},
                                  .refuse = can ? NULL : "of this type there are no samples",
                                  .taken = can && (int)c == wanted,
                                  .times = times,
                                  .time_unit = times ? s->tags.time_unit : NULL,
                                  .components = of_pages ? s->tags.channels : 1,
                                  .component = q->component ? q->component : 1};
        st = to->take(to->ctx, &item);
    }
    mem_free(s->m, times);
    return st;
}

status image_slices_list(mem *m, const import_request *q, const image_wish *wish,
                         const import_list *to) {
    import_request any = *q;
    stack *s;
    status st = make_stack(m, q, wish, &s);
    if (st != ST_OK)
        return st;
    any.field = NULL;
    any.component = 1;
    st = look_at_all(s, &any);
    if (st == ST_OK) {
        const int wanted = choose_channel(s, q) == ST_OK ? s->channel : NO_CHANNEL;
        st = list_channels(s, q, wanted, to);
    }
    stack_free(s);
    return st;
}
