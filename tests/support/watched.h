/* watched.h - whether a sanitizer watches this build. Tests that take long do less there: to find a
 * race, code need not run through what one thread does alone, and to find a wrong access, it need
 * not run as often as where numbers are compared. The release build's tests do all.
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

/* Another CPU, which CI emulates: references in long double take some thirty times as long there.
 * What compares bits does all. */
#ifdef __aarch64__
enum { EMULATED = 1 };
#else
enum { EMULATED = 0 };
#endif
enum { SLOW = WATCHED || EMULATED };

/* The first line of a test that takes long and has one thread, or whose threads other tests of its
 * file have, too: CONFIG=thread skips it. */
#define skip_under_thread()  \
    do {                     \
        if (WATCHED_THREADS) \
            skip();          \
    } while (0)

#endif
