/* leaf_compare.h - whether an index of samples that lie elsewhere gives the payloads of a file with
 * all. */
#ifndef TESTS_SUPPORT_LEAF_COMPARE_H
#define TESTS_SUPPORT_LEAF_COMPARE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/leaf_file.h"

/* A treelet that was loaded from the index, and the bytes read for it. */
typedef void leaf_compared(const leaf_file *index, uint32_t treelet, uint64_t read);

/* leaf_compare() - compare all payloads of two files, and which are implied. Fails the test where
 * they differ. limit: bytes that reading the index may take; 0: any. each: called for all treelets;
 * NULL: not. Returns the bytes read for those whose samples lie elsewhere. */
uint64_t leaf_compare(const char *whole, const char *index, size_t limit, leaf_compared *each);

/* leaf_compare_open() - open a file, or fail the test. */
leaf_file *leaf_compare_open(mem *m, const char *path);

#endif
