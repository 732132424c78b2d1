/* render_picture.h - one picture of `leafcast render`: its files, drawing it, and what is said
 * about it. */
#ifndef RENDER_APP_RENDER_PICTURE_H
#define RENDER_APP_RENDER_PICTURE_H

#include "render/app/render_options.h"

/* render_picture_guard() - check that the outputs of one picture and the statistics are different
 * files. Pictures of a sequence differ by number. A line of a script may replace another's picture,
 * with --force. */
CHECKED status render_picture_guard(const render_options *o, const script_frame *frame);

/* render_picture_draw() - draw a checked picture, and say on stderr what it shows and took. Counts
 * it in job->drawn and job->empty. stats: out, as JSON; untouched on errors. */
CHECKED status render_picture_draw(const render_options *o, render_job *job,
                                   const script_frame *frame, json_t **stats);

#endif
