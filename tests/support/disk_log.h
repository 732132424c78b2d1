/* disk_log.h - what this program does to the files of a folder, and what a disk may hold if all
 * ends in the midst of that.
 *
 * A program that uses this has open(), pwrite(), rename() and so on of its own, which note each
 * call and pass it on. A crash is replayed from the first `count` of them:
 *
 *   killed      the process ends: all of them have happened
 *   power lost  of each file, what was written before its last fsync() is there; of what came
 *               behind, any part in any order, a write perhaps in part. Names are as they were
 *               after some call: after the last fsync() of a folder, or later
 */
#ifndef TESTS_SUPPORT_DISK_LOG_H
#define TESTS_SUPPORT_DISK_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* disk_log_begin() - note what happens below this folder, from now on. disk_log_end() - no longer;
 * returns how many calls there were. disk_log_release() - forget them. */
void disk_log_begin(const char *folder);
size_t disk_log_end(void);
void disk_log_release(void);

/* What has happened: a file or folder is new; bytes were written to one, it was cut or extended, it
 * or (a descriptor of) a folder was synced; a name has become another, or (to: NULL) is no more.
 * Any thread. */
void disk_log_made(const char *path, bool folder);
void disk_log_written(int fd, uint64_t offset, const void *data, size_t size);
void disk_log_cut(int fd, uint64_t size);
void disk_log_synced(int fd);
void disk_log_moved(const char *from, const char *to);

/* disk_log_replay() - make the files that a crash after the first `count` calls leaves, below
 * another folder that is empty. seed: 0: killed; else power was lost, and chance does as it says.
 */
void disk_log_replay(size_t count, uint64_t seed, const char *folder);

#endif
