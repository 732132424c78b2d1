#include "render/view/view_pace.h"

#include <math.h>

/* A grade better than the last is chosen only if it takes at most this share of the time. */
#define CLEARLY 0.65
/* Cost of a level that was never drawn, relative to the next finer (COARSER) or coarser (FINER)
 * one. */
#define COARSER 0.65
#define FINER   2.0
/* A drawn level costs at most FINER_MOST times the next coarser one. With each picture its cost
 * moves towards FINER times, by the share NEARER. So levels that were given up, or slowed by other
 * programs, are tried again. */
#define FINER_MOST  4.0
#define NEARER      0.02
#define SHARE_LEAST 0.02
/* ALWAYS: share of the quickest picture's time that every picture takes. FORGET: the growth of that
 * time with each picture. Even if all time went with pixels, a better grade would stay in time. */
#define ALWAYS (1.0 / 3.0)
#define FORGET 1.05
#define RISE   1.25 /* the most by which one picture raises a cost */

/* Scales, and how many levels coarser than at a pixel's size. Doubling a pixel's width leaves a
 * quarter of the pixels; doubling a cell's leaves half of the cells. So both go together, pixels
 * first. quick: where that level is slow, the next one that is not. */
typedef struct rung {
    uint32_t scale, level;
    bool quick;
} rung;

static const rung LADDER[] = {
    {1, 0, false}, {2, 0, false}, {3, 0, false}, {4, 0, false}, {4, 1, false}, {4, 1, true},
    {6, 0, false}, {6, 1, true},  {8, 0, false}, {8, 1, true},  {8, 2, true},  {8, 3, true},
    {12, 2, true}, {12, 3, true}, {16, 3, true}, {24, 3, true}, {32, 3, true}};
enum { GRADES = (int)(sizeof LADDER / sizeof *LADDER) };

double view_pace_pixels(const view_task *t, view_grade g) {
    const uint32_t width = (t->width + g.scale - 1) / g.scale;
    return (double)width * ((t->height + g.scale - 1) / g.scale);
}

static uint32_t level_at_most(const view_task *t, uint32_t level) {
    const uint32_t most = t->levels < VIEW_PACE_LEVELS ? t->levels - 1 : VIEW_PACE_LEVELS - 1;
    return level < most ? level : most;
}

uint32_t view_pace_level(const view_task *t, uint32_t scale) {
    const double cells = t->cells * scale;
    return cells >= 2.0 ? level_at_most(t, (uint32_t)fmin(log2(cells), VIEW_PACE_LEVELS)) : 0;
}

static bool is_slow(const view_task *t, uint32_t level) {
    return t->apart > 1.0 && level < t->slow;
}

static uint32_t quick_from(const view_task *t, uint32_t level) {
    const uint32_t quick = level_at_most(t, t->slow);
    return is_slow(t, level) && !is_slow(t, quick) ? quick : level;
}

uint32_t view_pace_quick_level(const view_task *t, uint32_t scale) {
    return quick_from(t, view_pace_level(t, scale));
}

static view_grade grade_at(const view_task *t, int place) {
    const rung *r = &LADDER[place];
    const uint32_t level = level_at_most(t, view_pace_level(t, r->scale) + r->level);
    return (view_grade){r->scale, r->quick ? quick_from(t, level) : level};
}

static bool is_same(view_grade a, view_grade b) {
    return a.scale == b.scale && a.level == b.level;
}

/* ---- Costs ---- */

/* Returns what a level's cells cost relative to those of a coarse level. */
static double apart(const view_task *t, uint32_t level) {
    return is_slow(t, level) ? t->apart : 1.0;
}

/* Returns whether two levels have cells of one kind, so that the time of one predicts the
 * other's. */
static bool alike(const view_task *t, uint32_t a, uint32_t b) {
    return apart(t, a) == apart(t, b);
}

/* Estimate a level's cost from the nearest level with a known cost; of two, from the finer one. */
static double cost_of(const view_pace *p, const view_task *t, uint32_t level) {
    const double cells = apart(t, level);
    for (uint32_t away = 0; away < VIEW_PACE_LEVELS; away++) {
        if (away <= level && p->cost[level - away] > 0.0)
            return p->cost[level - away] * pow(COARSER, away) * cells / apart(t, level - away);
        if (level + away < VIEW_PACE_LEVELS && p->cost[level + away] > 0.0)
            return p->cost[level + away] * pow(FINER, away) * cells / apart(t, level + away);
    }
    return t->guess * cells;
}

double view_pace_seconds(const view_pace *p, const view_task *t, view_grade g) {
    return ALWAYS * p->least + cost_of(p, t, g.level) * view_pace_pixels(t, g);
}

/* Average a new cost with the old one; a higher one counts bit by bit, as other programs take time,
 * too. A picture that was given up is known to be too slow: take its cost in full. The view has
 * changed for all levels, so scale all their costs. */
void view_pace_learn(view_pace *p, const view_task *t, view_grade g, double seconds, double share) {
    const double before = p->cost[g.level];
    if (!(seconds > 0.0))
        return;
    if (share >= 1.0)
        p->least = p->least > 0.0 ? fmin(seconds, FORGET * p->least) : seconds;
    const double rest = fmax(seconds - ALWAYS * p->least, ALWAYS * seconds);
    const double now = rest / (view_pace_pixels(t, g) * fmax(share, SHARE_LEAST));
    const bool given_up = share < 1.0 && now > before;
    const double known = fmin(0.5 * (now + before), RISE * before);
    const double cost = before == 0.0 || given_up ? now : known;
    for (uint32_t i = 0; i < VIEW_PACE_LEVELS && before > 0.0; i++)
        p->cost[i] *= alike(t, i, g.level) ? cost / before : 1.0;
    p->cost[g.level] = cost;
    for (uint32_t i = 0; i < VIEW_PACE_LEVELS; i++) {
        const uint32_t finer = i < g.level ? g.level - i : 0;
        const double usual = apart(t, i) / apart(t, g.level) * cost * pow(FINER, finer);
        if (alike(t, i, g.level))
            p->cost[i] = fmin(p->cost[i], cost * pow(FINER_MOST, finer));
        p->cost[i] -= NEARER * fmax(p->cost[i] - usual, 0.0);
    }
}

/* ---- Choosing ---- */

static view_grade choose_from(view_pace *p, const view_task *t, double seconds, int first) {
    const int last = p->grade;
    int place = first;
    while (place < GRADES - 1) {
        const double room = place < last ? CLEARLY * seconds : seconds;
        if (view_pace_seconds(p, t, grade_at(t, place)) <= room)
            break;
        place++;
    }
    p->grade = place;
    return grade_at(t, place);
}

view_grade view_pace_choose(view_pace *p, const view_task *t, double seconds) {
    return choose_from(p, t, seconds, 0);
}

/* Returns the next place on the ladder with another grade; GRADES: there is none. */
static int next_place(const view_pace *p, const view_task *t) {
    const view_grade now = grade_at(t, p->grade);
    int next = p->grade + 1;
    while (next < GRADES && is_same(grade_at(t, next), now))
        next++;
    return next;
}

bool view_pace_coarsest(const view_pace *p, const view_task *t) {
    return next_place(p, t) == GRADES;
}

view_grade view_pace_coarser(view_pace *p, const view_task *t, double seconds) {
    const int next = next_place(p, t);
    return choose_from(p, t, seconds, next < GRADES ? next : GRADES - 1);
}
