#include "formats/leaf/leaf_chain.h"

static uint32_t led_to(const leaf_layout *l, uint32_t p, uint32_t entry) {
    const leaf_series s = leaf_layout_series(l, p);
    return leaf_series_payload(&s, entry - 1);
}

uint32_t leaf_chain_home(const leaf_layout *l, const leaf_links *links, uint32_t p) {
    return links->same && links->same[p] ? led_to(l, p, links->same[p]) : p;
}

int leaf_chain_of(const leaf_layout *l, const leaf_links *links, uint32_t p,
                  uint32_t chain[LEAF_CHAIN_MAX]) {
    int count = 1;
    chain[0] = leaf_chain_home(l, links, p);
    for (; links->bases && links->bases[chain[count - 1]]; count++)
        chain[count] = led_to(l, chain[count - 1], links->bases[chain[count - 1]]);
    return count;
}
