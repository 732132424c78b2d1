/* view_pace.h - how coarse a picture must be to be there in time, by the time that others took.
 *
 * A grade is a fraction of the canvas and a level of detail. Grades are tried from the best one
 * down: first fewer pixels, each with cells that are about its size; where these are few already,
 * larger cells. The time of a picture is taken to be a third of that of the quickest one lately,
 * whatever is drawn, and the rest to go with its pixels, at a cost for each level that is learned:
 * from pictures that were drawn, and for the other levels by what they had cost beside this one. No
 * clock is read here.
 */
#ifndef RENDER_VIEW_VIEW_PACE_H
#define RENDER_VIEW_VIEW_PACE_H

#include <stdbool.h>
#include <stdint.h>

enum { VIEW_PACE_LEVELS = 16, VIEW_SCALE_MAX = 32 };

/* What is to be drawn. */
typedef struct view_task {
    uint32_t width, height; /* of the canvas */
    uint32_t levels;        /* of detail that there are, 1 at least */
    double cells;           /* of level 0 in the width of a pixel of the canvas, about */
    double guess;           /* seconds a pixel, before anything is known; above 0 */
    double apart; /* 1; or more: level 0 is of other cells, tets, and takes so many times what the
                     other levels' times make of it */
} view_task;

typedef struct view_grade {
    uint32_t scale; /* 1 / scale of the canvas: 1 to VIEW_SCALE_MAX */
    uint32_t level;
} view_grade;

/* What has been learned; zeroed: nothing. */
typedef struct view_pace {
    double cost[VIEW_PACE_LEVELS]; /* seconds a pixel; 0: not known */
    double least;                  /* seconds of the quickest picture lately; 0: not known */
    int grade;                     /* that was chosen last, by its place; 0: the best, or none */
} view_pace;

/* view_pace_pixels() - of a picture of this grade. view_pace_seconds() - that it will take. */
double view_pace_pixels(const view_task *t, view_grade g);
double view_pace_seconds(const view_pace *p, const view_task *t, view_grade g);

/* view_pace_level() - the one whose cells are about as large as pixels, at this scale.
 * view_pace_quick_level() - that, or the next one where it is of tets that take their time. */
uint32_t view_pace_level(const view_task *t, uint32_t scale);
uint32_t view_pace_quick_level(const view_task *t, uint32_t scale);

/* view_pace_choose() - the best grade that takes so many seconds at most, or the coarsest. One that
 * is better than the last chosen must take clearly less, or pictures would change from grade to
 * grade. view_pace_coarsest() - whether there is none that is coarser than the last chosen.
 * view_pace_coarser() - the best of those that fits. */
view_grade view_pace_choose(view_pace *p, const view_task *t, double seconds);
bool view_pace_coarsest(const view_pace *p, const view_task *t);
view_grade view_pace_coarser(view_pace *p, const view_task *t, double seconds);

/* view_pace_learn() - a picture of this grade took so many seconds, and this share of its pixels
 * is there: 1, or less where it was given up; less than a fiftieth counts as that. */
void view_pace_learn(view_pace *p, const view_task *t, view_grade g, double seconds, double share);

#endif
