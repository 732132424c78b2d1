/* naive_family.h - the samples of compressed treelets, a family at a time, from section 10 of
 * formats/FORMAT.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_FAMILY_H
#define TESTS_SUPPORT_NAIVE_FAMILY_H

#include "tests/support/naive_leaf.h"

/* naive_family_read() - the samples of a family, `count` treelets from `first` on: the children of
 * the treelet `parent`, or the root by itself (parent: -1). held: for each of them, its samples as
 * they are in a raw payload; the caller frees them, also after an error. Returns NULL, or what is
 * wrong. */
const char *naive_family_read(const naive_leaf *leaf, long parent, long first, long count,
                              unsigned char **held);

/* naive_family_value() - the bits of a value as a sample of the file's type: those of payloads
 * without bytes. */
void naive_family_value(const naive_leaf *leaf, const naive_treelet *t, unsigned char bytes[4]);

/* naive_family_is_value() - whether the directory would tell a payload of `count` samples that has
 * bytes: it should have none then. */
bool naive_family_is_value(const naive_leaf *leaf, const naive_treelet *t,
                           const unsigned char *bytes, uint64_t count);

#endif
