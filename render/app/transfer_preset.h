/* transfer_preset.h - make transfer functions for a volume from its histogram alone.
 *
 * No values are built in. Otsu's threshold (1979) separates the background from the foreground; a
 * second one separates the dense part of that. Points lie at percentiles of the samples above these
 * thresholds. Extinctions are scaled by the average optical depth through the volume, so that
 * sparse volumes are visible and full ones can be seen through.
 */
#ifndef RENDER_APP_TRANSFER_PRESET_H
#define RENDER_APP_TRANSFER_PRESET_H

#include <stdbool.h>

#include "render/app/transfer_list.h"

/* transfer_preset_is() - returns whether there is a preset of this name. transfer_preset_names() -
 * returns all names, separated by '|': auto (the foreground, stronger the higher its value; colours
 * of viridis), ct (soft and dense tissue), mr (from dark to bright). */
bool transfer_preset_is(const char *name);
const char *transfer_preset_names(void);

/* transfer_preset_make() - make the preset of this name in two empty lists. length: of the volume's
 * diagonal in world units; with 0 all extinctions are 0. Works for any histogram: if no value is
 * finite, it makes one point of extinction 0. ST_NOMEM. */
CHECKED status transfer_preset_make(const char *name, const leafcast_histogram *h, double length,
                                    transfer_list *colours, transfer_list *extinctions);

#endif
