/* experiments.h - LINK_EXPERIMENTS; in a source links all experiments (frame/laboratory.h) to the
 * programs that it is part of.
 */
#ifndef RENDER_EXPERIMENTS_EXPERIMENTS_H
#define RENDER_EXPERIMENTS_EXPERIMENTS_H

struct laboratory;

extern const struct laboratory *const experiments_linked;

#define LINK_EXPERIMENTS                                                             \
    __attribute__((used)) static const struct laboratory *const *const experiments = \
        &experiments_linked

#endif
