/* render_sequence.h - the pictures that the flags of `leafcast render` describe: one, or a sequence
 * over isovalues, steps, views and turns. */
#ifndef RENDER_APP_RENDER_SEQUENCE_H
#define RENDER_APP_RENDER_SEQUENCE_H

#include "render/app/render_options.h"

/* render_sequence_run() - check all pictures, then draw them and write the statistics. Opens the
 * job. Settles o->steps, since "all" depends on the file. */
CHECKED status render_sequence_run(render_options *o, render_job *job);

#endif
