/* crash.h - a library that crashes over a malformed file: a word and an exit code instead.
 *
 * What is told apart: a lack of memory and of time end as other lacks of a resource do, other
 * crashes as malformed input does. Behind crash_done() all is said, and a crash takes nothing
 * of it back.
 */
#ifndef PREP_IMPORT_CRASH_H
#define PREP_IMPORT_CRASH_H

/* crash_begin() - before the libraries' own start: one that crashes then ends the program with a
 * word, and exit code 1 or 4. */
void crash_begin(void);

/* crash_watch() - from now on SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT and SIGXCPU print "leafcast
 * VERB: PATH: LIBRARY crashed while reading it; ..", or why, and end the program with exit code 3
 * or 4. Outputs that are not complete stay under their temporary names. */
void crash_watch(const char *verb, const char *library, const char *path);

/* crash_done() - from now on the same signals print a warning and end it with this exit code. */
void crash_done(int code);

#endif
