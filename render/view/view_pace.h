/* view_pace.h - choose how coarse a picture must be to be drawn in time, by the times of earlier
 * ones.
 *
 * A grade is a fraction of the canvas and a level of detail. Grades are tried from the best down:
 * first fewer pixels, with cells of about a pixel's size; when pixels are few already, larger
 * cells, then those of the first level that is not slow. The estimated time of a picture is a third
 * of the quickest one lately, plus its pixels times a cost per level. Costs are learned from
 * pictures that were drawn; those of other levels keep their ratio to them. No clock is read here.
 */
#ifndef RENDER_VIEW_VIEW_PACE_H
#define RENDER_VIEW_VIEW_PACE_H

#include <stdbool.h>
#include <stdint.h>

enum { VIEW_PACE_LEVELS = 16, VIEW_SCALE_MAX = 32 };

/* What has to be drawn. */
typedef struct view_task {
    uint32_t width, height; /* of the canvas, in pixels */
    uint32_t levels;        /* number of levels of detail, at least 1 */
    double cells;           /* cells of level 0 in the width of a canvas pixel, about */
    double guess;           /* seconds per pixel before anything is known; above 0 */
    uint32_t slow; /* number of levels, from 0 on, that may have slower cells (tets) than others;
                      more than `levels` is all */
    double apart;  /* 1, or more: the time of slow levels relative to an estimate by others */
} view_task;

typedef struct view_grade {
    uint32_t scale; /* width and height are 1 / scale of the canvas; 1 to VIEW_SCALE_MAX */
    uint32_t level;
} view_grade;

/* What has been learned; zeroed: nothing yet. */
typedef struct view_pace {
    double cost[VIEW_PACE_LEVELS]; /* seconds per pixel; 0: unknown */
    double least;                  /* seconds of the quickest picture lately; 0: unknown */
    int grade; /* the last choice, as its place on the ladder; 0: the best, or none yet */
} view_pace;

/* view_pace_pixels() - returns the pixels of a picture of this grade. view_pace_seconds() - returns
 * the seconds that it is expected to take. */
double view_pace_pixels(const view_task *t, view_grade g);
double view_pace_seconds(const view_pace *p, const view_task *t, view_grade g);

/* view_pace_level() - returns the level whose cells are about as large as pixels at this scale.
 * view_pace_quick_level() - the same, or if that is slow the first one that is not, where there is
 * one. */
uint32_t view_pace_level(const view_task *t, uint32_t scale);
uint32_t view_pace_quick_level(const view_task *t, uint32_t scale);

/* view_pace_choose() - returns the best grade expected to take at most so many seconds, or the
 * coarsest. A grade better than the last choice must take clearly less, or pictures would flicker
 * between grades. view_pace_coarsest() - returns whether no grade is coarser than the last choice.
 * view_pace_coarser() - returns the best coarser grade that fits. */
view_grade view_pace_choose(view_pace *p, const view_task *t, double seconds);
bool view_pace_coarsest(const view_pace *p, const view_task *t);
view_grade view_pace_coarser(view_pace *p, const view_task *t, double seconds);

/* view_pace_learn() - learn that a picture of this grade took so many seconds. share: which part of
 * its pixels was drawn in this time; below 1 if drawing was given up. Less than a fiftieth counts
 * as a fiftieth. */
void view_pace_learn(view_pace *p, const view_task *t, view_grade g, double seconds, double share);

#endif
