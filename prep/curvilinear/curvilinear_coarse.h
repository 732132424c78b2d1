/* curvilinear_coarse.h - makes what stands for a set of a curvilinear grid in previews (leaf.h,
 * COARSE): the same grid with fewer nodes (curvilinear_thinned.h), whose thin layers stay, and
 * in its file a regular grid, whose media and projections are soon drawn. Of a size that is asked
 * for, a regular one alone.
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_COARSE_H
#define PREP_CURVILINEAR_CURVILINEAR_COARSE_H

#include "prep/curvilinear/curvilinear_convert.h"

/* curvilinear_coarse_share() - a guess at their share of a conversion's time, for progress alone.
 */
double curvilinear_coarse_share(const curvilinear_options *o);

/* curvilinear_coarse_embed() - put one for each set into w, which must be settled. output, o, p: of
 * the conversion. */
CHECKED status curvilinear_coarse_embed(mem *m, leaf_writer *w, const char *output,
                                        const curvilinear_options *o, const progress *p);

#endif
