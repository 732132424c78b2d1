/* file_mark.h - whether a file is still the one that was opened.
 *
 * A mark holds a file's size, inode and time of last modification. It does not notice bytes that
 * change without a new time, as through a writable mapping of a file on tmpfs. Bytes in memory
 * (file_open_memory()) count as unchanged.
 */
#ifndef FORMATS_BASE_FILE_MARK_H
#define FORMATS_BASE_FILE_MARK_H

#include <stdint.h>

#include "formats/base/file.h"

typedef struct file_mark {
    uint64_t device, inode, size;
    int64_t modified_s, modified_ns;
} file_mark;

/* file_mark_take() - mark a whole file; call it right after it was opened. */
CHECKED status file_mark_take(const file *f, file_mark *mark);

/* file_mark_check() - ST_CORRUPT, with what changed, if the file has another size or time than its
 * mark, or if its name now belongs to another file. A file that has lost its name counts as
 * unchanged. Thread-safe. */
CHECKED status file_mark_check(const file *f, const file_mark *mark);

/* file_mark_check_name() - the same of its name alone: of a file that may grow. */
CHECKED status file_mark_check_name(const file *f, const file_mark *mark);

/* file_mark_compare() - ST_CORRUPT, with what differs, if a file has another size or time than one
 * of the same path had when `by` was made of it: `then`, of which the rest does not count. */
CHECKED status file_mark_compare(const file_mark *now, const file_mark *then, const char *path,
                                 const char *by);

/* file_mark_settle() - wait until any further write must give the file another time than the
 * mark's. That takes a tick of the clock at most, and only for a file that was written just now.
 * Call it before bytes are used in place. */
void file_mark_settle(const file_mark *mark);

#endif
