#include "prep/import/netcdf/netcdf_heights.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "prep/import/cf_names.h"
#include "prep/import/netcdf/netcdf_roles.h"
#include "prep/import/netcdf/netcdf_slices.h"

static status refuse(const netcdf_heights *h, const char *why) {
    const netcdf_variable *v = &h->fr->v;
    char name[NC_MAX_NAME + 1] = "";
    nc_inq_dimname(v->group, v->dim[v->rank - 3], name);
    return status_describe(ST_UNSUPPORTED, "%s: %s: nothing tells heights along %s: %s",
                           file_path(h->fr->f->guard), v->path, name, why);
}

static cf_measure measure_of(int group, int id, double *factor) {
    char units[64];
    netcdf_text(group, id, "units", units, sizeof units);
    *factor = 1;
    return cf_measure_of(units, factor);
}

/* ---- levels ---- */

/* Whether a variable is called as heights are: the thickness of layers is a length, too. */
static bool is_called_height(int group, int id) {
    static const char *const begins[] = {"z", "lev", "alt", "height", "depth", "pres", "plev"};
    char name[NC_MAX_NAME + 1] = "";
    bool is = false;
    nc_inq_varname(group, id, name);
    for (size_t i = 0; i < sizeof begins / sizeof *begins; i++)
        is = is || strncasecmp(name, begins[i], strlen(begins[i])) == 0;
    return is;
}

/* Lengths or pressures of the group along z alone, which nothing names: only if there is but one.
 */
static bool find_any_line(const netcdf_frame *fr, netcdf_term *t) {
    int count = 0, found = 0, last = -1;
    nc_inq_nvars(fr->v.group, &count);
    for (int id = 0; id < count; id++) {
        double factor;
        if (measure_of(fr->v.group, id, &factor) == CF_OTHER ||
            !is_called_height(fr->v.group, id) || !netcdf_frame_term(fr, fr->v.group, id, t) ||
            t->axes != NETCDF_Z)
            continue;
        last = id;
        found++;
    }
    return found == 1 && netcdf_frame_term(fr, fr->v.group, last, t);
}

/* Coordinates along z alone: of its dimension, named by the attribute, or alone in the group. */
static bool find_line(const netcdf_frame *fr, netcdf_term *t) {
    const netcdf_variable *v = &fr->v;
    char text[CF_TEXT], name[NC_MAX_NAME + 1];
    const char *at = text;
    int group, id;
    if (netcdf_coordinates(v->group, v->dim[v->rank - 3], &group, &id) &&
        netcdf_frame_term(fr, group, id, t))
        return true;
    netcdf_text(v->group, v->id, "coordinates", text, sizeof text);
    while (cf_next_name(&at, name, sizeof name))
        if (netcdf_find(v->group, name, &group, &id) && netcdf_frame_term(fr, group, id, t) &&
            t->axes == NETCDF_Z)
            return true;
    return find_any_line(fr, t);
}

static status take_levels(netcdf_heights *h, const netcdf_term *t, cf_measure measure,
                          double factor) {
    if (measure == CF_LENGTH && netcdf_goes_down(t->v.group, t->v.id))
        factor = -factor;
    h->levels = mem_array(h->m, h->fr->n[2], sizeof *h->levels);
    const status st = h->levels ? netcdf_frame_levels(h->fr, t, h->levels) : ST_NOMEM;
    for (uint32_t k = 0; k < h->fr->n[2] && st == ST_OK; k++) {
        h->levels[k] *= factor;
        if (measure == CF_PRESSURE)
            h->levels[k] = netcdf_formula_height(h->levels[k]);
    }
    h->moves = h->moves || t->moves;
    return st;
}

/* ---- formulas ---- */

/* Read a term as numbers of each level. */
static status read_levels(const netcdf_heights *h, const netcdf_term *t, double factor,
                          netcdf_part *part) {
    part->levels = mem_array(h->m, h->fr->n[2], sizeof *part->levels);
    const status st = part->levels ? netcdf_frame_levels(h->fr, t, part->levels) : ST_NOMEM;
    for (uint32_t k = 0; k < h->fr->n[2] && st == ST_OK; k++)
        part->levels[k] *= factor;
    return st;
}

static status read_map(netcdf_heights *h, const netcdf_term *t, double factor, netcdf_part *part) {
    const size_t count = h->fr->columns;
    double *numbers = mem_array(h->m, count, sizeof *numbers);
    part->map = mem_array(h->m, count, sizeof *part->map);
    const status st = numbers && part->map ? netcdf_frame_map(h->fr, t, numbers) : ST_NOMEM;
    for (size_t c = 0; c < count && st == ST_OK; c++) {
        part->map[c] = (float)(numbers[c] * factor);
    }
    mem_free(h->m, numbers);
    return st;
}

static status read_part(netcdf_heights *h, int group, const char *name, netcdf_term *t,
                        netcdf_part *part) {
    char why[NC_MAX_NAME + 96];
    int in, id;
    double factor;
    const bool found = netcdf_find(group, name, &in, &id) && netcdf_frame_term(h->fr, in, id, t) &&
                       (t->axes == NETCDF_Z || !(t->axes & NETCDF_Z));
    snprintf(why, sizeof why, "%s, which its formula names, %s", name,
             netcdf_find(group, name, &in, &id) ? "does not lie along it" : "is not in the file");
    if (!found)
        return refuse(h, why);
    (void)measure_of(in, id, &factor);
    h->moves = h->moves || t->moves;
    if (t->axes == NETCDF_Z)
        return read_levels(h, t, factor, part);
    if (t->axes)
        return read_map(h, t, factor, part);
    double *alone = mem_array(h->m, h->fr->n[2], sizeof *alone);
    const status st = alone ? netcdf_frame_levels(h->fr, t, alone) : ST_NOMEM;
    if (st == ST_OK)
        part->alone = alone[0] * factor;
    mem_free(h->m, alone);
    return st;
}

static status take_formula(netcdf_heights *h, const netcdf_term *line, const char *terms) {
    netcdf_term *t = mem_alloc(h->m, sizeof *t);
    status st = t ? ST_OK : ST_NOMEM;
    for (int i = 0; i < NETCDF_TERMS && h->formula->terms[i] && st == ST_OK; i++) {
        char name[NC_MAX_NAME + 1];
        if (!cf_term(terms, h->formula->terms[i], name, sizeof name))
            name[0] = 0;
        st = read_part(h, line->v.group, name, t, &h->parts[i]);
    }
    h->pressure = h->formula->pressure;
    mem_free(h->m, t);
    return st;
}

/* ---- variables of three dimensions ---- */

static status add_volume(netcdf_heights *h, const netcdf_term *t, double factor) {
    netcdf_planes *p = &h->planes[h->volumes];
    snprintf(p->path, sizeof p->path, "%s", t->v.path);
    for (int a = 0; a < 3; a++)
        p->has[a] = t->v.count[t->v.rank - 1 - a];
    p->factor = factor;
    for (int i = 0; i < t->v.rank - 3; i++)
        p->step = p->step * (uint32_t)t->v.count[i] + (uint32_t)t->start[i];
    h->volumes++;
    h->moves = h->moves || t->moves;
    return ST_OK;
}

/* One that the attribute names, of lengths or pressures. */
static status take_named(netcdf_heights *h, netcdf_term *t) {
    const netcdf_variable *v = &h->fr->v;
    char text[CF_TEXT], name[NC_MAX_NAME + 1];
    const char *at = text;
    int group, id;
    netcdf_text(v->group, v->id, "coordinates", text, sizeof text);
    while (h->volumes == 0 && cf_next_name(&at, name, sizeof name)) {
        double factor;
        if (!netcdf_find(v->group, name, &group, &id) || !netcdf_frame_term(h->fr, group, id, t) ||
            !(t->axes & NETCDF_Z) || t->axes == NETCDF_Z)
            continue;
        const cf_measure measure = measure_of(group, id, &factor);
        h->pressure = measure == CF_PRESSURE;
        if (measure == CF_LENGTH && netcdf_goes_down(group, id))
            factor = -factor;
        const status st = measure == CF_OTHER ? ST_OK : add_volume(h, t, factor);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Whether a term lies along the frame's z, or along that as WRF names it between: z_stag. */
static bool is_staggered(const netcdf_frame *fr, const netcdf_term *t) {
    char own[NC_MAX_NAME + 8] = "", its[NC_MAX_NAME + 1] = "";
    const int dim = fr->v.dim[fr->v.rank - 3], of = t->v.dim[t->v.rank - 3];
    nc_inq_dimname(fr->v.group, dim, own);
    nc_inq_dimname(t->v.group, of, its);
    strcat(own, "_stag");
    return dim == of || strcmp(own, its) == 0;
}

/* WRF's geopotential, in m2 s-2, is split in two. */
static status take_geopotential(netcdf_heights *h, netcdf_term *t) {
    static const char *const names[NETCDF_VOLUMES] = {"PH", "PHB"};
    const double gravity = 9.81; /* WRF's own */
    status st = ST_OK;
    for (int i = 0; i < NETCDF_VOLUMES && st == ST_OK; i++) {
        int group, id;
        if (!netcdf_find(h->fr->v.group, names[i], &group, &id) ||
            !netcdf_frame_term(h->fr, group, id, t) ||
            t->axes != (NETCDF_X | NETCDF_Y | NETCDF_Z) || !is_staggered(h->fr, t))
            break;
        st = add_volume(h, t, 1 / gravity);
    }
    if (h->volumes < NETCDF_VOLUMES)
        h->volumes = 0;
    return st;
}

static status make_planes(netcdf_heights *h) {
    size_t most = 0;
    status st = ST_OK;
    for (int i = 0; i < h->volumes && st == ST_OK; i++) {
        netcdf_planes *p = &h->planes[i];
        const size_t has = p->has[0] * p->has[1];
        most = has > most ? has : most;
        p->last[0] = mem_array(h->m, h->fr->columns, sizeof(double));
        p->last[1] = mem_array(h->m, h->fr->columns, sizeof(double));
        st = p->last[0] && p->last[1] ? ST_OK : ST_NOMEM;
    }
    if (h->volumes == 0)
        return ST_OK;
    h->raw = mem_array(h->m, most, sizeof(double));
    h->plane = mem_array(h->m, most, sizeof *h->plane);
    return st == ST_OK && h->raw && h->plane ? ST_OK : ST_NOMEM;
}

/* Open one, to begin with its first plane. */
static status begin(const netcdf_heights *h, netcdf_planes *p) {
    const netcdf_wish wish = {.indices = true};
    import_request q = *h->q;
    q.field = p->path;
    q.step = p->step;
    slice_source_close(&p->source);
    p->next = 0;
    return netcdf_slices_open_in(h->fr->f, &q, &wish, &p->source);
}

static status next_plane(const netcdf_heights *h, netcdf_planes *p) {
    const status st = p->source.read(p->source.ctx, p->next, 1, h->raw);
    const size_t count = p->has[0] * p->has[1];
    double *first = p->last[0];
    if (st != ST_OK)
        return st;
    (void)sample_to_doubles(p->source.g.type, h->raw, h->plane, count);
    p->last[0] = p->last[1];
    p->last[1] = first;
    netcdf_frame_widen(h->fr, h->plane, p->has, p->last[1]);
    if (p->next == 0)
        memcpy(p->last[0], p->last[1], h->fr->columns * sizeof(double));
    p->next++;
    return ST_OK;
}

/* Read up to the planes that a level lies between, or on. */
static status turn_planes(netcdf_heights *h, netcdf_planes *p, uint32_t level) {
    const size_t most = p->has[2] - 1, upper = level + (p->has[2] > h->fr->n[2]);
    const size_t wanted = upper < most ? upper : most;
    status st = p->next == 0 || wanted + 1 < p->next ? begin(h, p) : ST_OK;
    while (st == ST_OK && p->next <= wanted)
        st = next_plane(h, p);
    return st;
}

/* A level's number of a column: on a plane, or between two. */
static double plane_number(const netcdf_heights *h, const netcdf_planes *p, size_t column,
                           uint32_t level) {
    const double low = p->last[0][column], high = p->last[1][column];
    if (p->has[2] == h->fr->n[2])
        return high * p->factor;
    if (p->has[2] < h->fr->n[2] && level == p->has[2])
        return high * p->factor; /* above the last plane there is none */
    return (low + high) / 2 * p->factor;
}

/* ---- all of it ---- */

static status take_line(netcdf_heights *h, const netcdf_term *t) {
    char terms[CF_TEXT], name[80], why[192];
    double factor;
    netcdf_text(t->v.group, t->v.id, "formula_terms", terms, sizeof terms);
    netcdf_text(t->v.group, t->v.id, "standard_name", name, sizeof name);
    h->formula = terms[0] ? netcdf_formula_find(name, terms) : NULL;
    if (h->formula)
        return take_formula(h, t, terms);
    const cf_measure measure = measure_of(t->v.group, t->v.id, &factor);
    if (!terms[0] && measure != CF_OTHER)
        return take_levels(h, t, measure, factor);
    if (terms[0])
        snprintf(why, sizeof why, "its formula (%s) is not known, or lacks terms",
                 name[0] ? name : "without a standard_name");
    else
        snprintf(why, sizeof why, "its coordinates are no lengths or pressures");
    return refuse(h, why);
}

static status find(netcdf_heights *h, netcdf_term *t) {
    status st = take_named(h, t);
    if (st != ST_OK || h->volumes > 0)
        return st;
    st = take_geopotential(h, t);
    if (st != ST_OK || h->volumes > 0)
        return st;
    return find_line(h->fr, t)
               ? take_line(h, t)
               : refuse(h, "it has no coordinates, and none of three dimensions are named");
}

status netcdf_heights_find(const netcdf_frame *fr, const import_request *q, netcdf_heights *h) {
    *h = (netcdf_heights){.m = fr->f->m, .fr = fr, .q = q};
    netcdf_term *t = mem_alloc(h->m, sizeof *t);
    status st = t ? find(h, t) : ST_NOMEM;
    mem_free(h->m, t);
    return st == ST_OK ? make_planes(h) : st;
}

void netcdf_heights_release(netcdf_heights *h) {
    if (!h->m)
        return;
    mem_free(h->m, h->levels);
    for (int i = 0; i < NETCDF_TERMS; i++) {
        mem_free(h->m, h->parts[i].levels);
        mem_free(h->m, h->parts[i].map);
    }
    for (int i = 0; i < NETCDF_VOLUMES; i++) {
        slice_source_close(&h->planes[i].source);
        mem_free(h->m, h->planes[i].last[0]);
        mem_free(h->m, h->planes[i].last[1]);
    }
    mem_free(h->m, h->raw);
    mem_free(h->m, h->plane);
}

status netcdf_heights_turn(netcdf_heights *h, uint32_t level) {
    status st = ST_OK;
    for (int i = 0; i < h->volumes && st == ST_OK && h->turned != level + 1; i++)
        st = turn_planes(h, &h->planes[i], level);
    h->turned = st == ST_OK ? level + 1 : 0;
    return st;
}

double netcdf_heights_at(const netcdf_heights *h, size_t column, uint32_t level) {
    double t[NETCDF_TERMS] = {0}, sum = 0;
    if (h->levels)
        return h->levels[level];
    for (int i = 0; i < h->volumes; i++)
        sum += plane_number(h, &h->planes[i], column, level);
    for (int i = 0; h->formula && i < NETCDF_TERMS; i++) {
        const netcdf_part *part = &h->parts[i];
        t[i] = part->levels ? part->levels[level]
               : part->map  ? (double)part->map[column]
                            : part->alone;
    }
    const double value = h->formula ? h->formula->value(t) : sum;
    return h->pressure ? netcdf_formula_height(value) : value;
}
