/* cli_options.h - a verb's table of options as its help and its completion show it.
 *
 * One table, three views: what most people need (--help), all options with experiments last
 * (--help-all), and one line per option for the shell's completion (--list-options). A flag in the
 * option's row says which view shows it.
 */
#ifndef FORMATS_BASE_CLI_OPTIONS_H
#define FORMATS_BASE_CLI_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdio.h>

/* For the flags of a struct argp_option, beside argp's own. */
enum {
    CLI_BASIC = 0x1000,     /* shown by --help, too */
    CLI_EXPERIMENT = 0x2000 /* shown last by --help-all */
};

typedef enum cli_view { CLI_VIEW_BASIC, CLI_VIEW_ALL, CLI_VIEW_USAGE } cli_view;

/* cli_options_listed() - whether a list of names separated by blanks has this name. list may be
 * NULL. */
bool cli_options_listed(const char *list, const char *name);

/* cli_options_name() - spell an option's name as tables do: '-' for '_', "colour" for "color". Help
 * and manuals use one spelling; the command line takes both. Cuts it to `room` bytes.
 * cli_options_same() - returns whether a name, spelt as tables do, names this option. */
void cli_options_name(const char *given, char *out, size_t room);
bool cli_options_same(const char *name, const char *option);

/* cli_options_spelt() - a copy of the table with a hidden alias behind each option that has another
 * spelling. It lives as long as the process. NULL: no memory. */
const struct argp_option *cli_options_spelt(const struct argp_option *table);

/* cli_options_help() - print the help of a verb. The options of its children count as its own,
 * except those of the list `without`. The table's doc has up to three parts, separated by \v: what
 * the verb does; what --help prints behind the options, such as an example; what only --help-all
 * prints there. */
void cli_options_help(const struct argp *table, const char *without, const char *command,
                      cli_view view, FILE *out);

/* cli_options_list() - print a line per option, with tabs between: --name, -s or nothing, its
 * argument or nothing, one of basic, more, experiment, alias, and the text of the help. The first
 * line describes the arguments; its name is empty. Hidden options are left out. */
void cli_options_list(const struct argp *table, const char *without, FILE *out);

/* cli_options_nearest() - find the long option that an unknown name probably meant. The name ends
 * at a quote, a '=' or its NUL. Returns false where no option is similar. */
bool cli_options_nearest(const struct argp *table, const char *name, char *near, size_t room);

#endif
