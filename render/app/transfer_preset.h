/* transfer_preset.h - transfer functions for a volume about which nothing is known but its
 * histogram.
 *
 * No values are built in. Otsu's threshold (1979) parts the background from what stands out, and
 * once more, of that, what is dense; points lie at percentiles of the samples above these. How
 * strong it all is follows from what a way through the volume shall swallow on average, so that
 * sparse things are seen and full ones can be seen through.
 */
#ifndef RENDER_APP_TRANSFER_PRESET_H
#define RENDER_APP_TRANSFER_PRESET_H

#include <stdbool.h>

#include "render/app/transfer_list.h"

/* transfer_preset_is() - whether there is one of this name. transfer_preset_names() - of all,
 * divided by '|': auto (what stands out, the more the further; colours of viridis), ct (soft and
 * dense tissue), mr (from the dim to the bright). */
bool transfer_preset_is(const char *name);
const char *transfer_preset_names(void);

/* transfer_preset_make() - the preset of this name, into empty lists. length: of the volume's
 * diagonal, world units; 0: its extinctions are 0. Of any histogram: where no value is finite, one
 * point that swallows nothing. ST_NOMEM. */
CHECKED status transfer_preset_make(const char *name, const leafcast_histogram *h, double length,
                                    transfer_list *colours, transfer_list *extinctions);

#endif
