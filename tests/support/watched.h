/* watched.h - which accesses a sanitizer watches in this build. What takes long does less there: a
 * step that finds races need not count through what one thread does, nor one that finds wrong
 * accesses to memory go through the same code as often as one that compares numbers.
 */
#ifndef TESTS_SUPPORT_WATCHED_H
#define TESTS_SUPPORT_WATCHED_H

#ifdef __SANITIZE_THREAD__
enum { WATCHED_THREADS = 1 };
#else
enum { WATCHED_THREADS = 0 };
#endif
#ifdef __SANITIZE_ADDRESS__
enum { WATCHED_MEMORY = 1 };
#else
enum { WATCHED_MEMORY = 0 };
#endif
enum { WATCHED = WATCHED_THREADS || WATCHED_MEMORY };

/* At the head of a test that takes long and has one thread, or whose threads another test of its
 * file has, too. */
#define watched_alone()      \
    do {                     \
        if (WATCHED_THREADS) \
            skip();          \
    } while (0)

#endif
