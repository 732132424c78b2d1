/* cli_options.h - a verb's table of options as its help and its completion show it.
 *
 * One table, three views: what most people need (--help), all of it with experiments last
 * (--help-all), and a line an option for the shell's completion (--list-options). What is shown
 * where is said by a flag in the option's row.
 */
#ifndef FORMATS_BASE_CLI_OPTIONS_H
#define FORMATS_BASE_CLI_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdio.h>

/* For the flags of a struct argp_option, beside argp's own. */
enum {
    CLI_BASIC = 0x1000,     /* in --help, too */
    CLI_EXPERIMENT = 0x2000 /* last in --help-all */
};

typedef enum cli_view { CLI_VIEW_BASIC, CLI_VIEW_ALL, CLI_VIEW_USAGE } cli_view;

/* cli_options_listed() - whether a list of names divided by blanks, or NULL, has this one. */
bool cli_options_listed(const char *list, const char *name);

/* cli_options_name() - an option's name as tables have it, of one that may have '_' for '-' and
 * "color" for "colour": help and manuals have one spelling, and both are taken. Cut to room.
 * cli_options_same() - whether a name is that of an option, so read. */
void cli_options_name(const char *given, char *out, size_t room);
bool cli_options_same(const char *name, const char *option);

/* cli_options_spelt() - the table, with a hidden alias behind each option that has another
 * spelling. For the life of the process; NULL: no memory. */
const struct argp_option *cli_options_spelt(const struct argp_option *table);

/* cli_options_help() - the help of a verb, whose children's options count as its own, but for those
 * of the list `without`. The table's doc has up to three parts, divided by \v: what the verb does;
 * what --help says behind the options, such as an example; what only --help-all says there. */
void cli_options_help(const struct argp *table, const char *without, const char *command,
                      cli_view view, FILE *out);

/* cli_options_list() - a line an option, divided by tabs: --name, -s or nothing, its argument or
 * nothing, one of basic, more, experiment, alias, and the text of the help. First comes the line
 * of the arguments, whose name is empty. Hidden options are left out. */
void cli_options_list(const struct argp *table, const char *without, FILE *out);

/* cli_options_nearest() - the long option that was likely meant by an unknown name (which ends at a
 * quote, a '=' or its end); false where none is near. */
bool cli_options_nearest(const struct argp *table, const char *name, char *near, size_t room);

#endif
