#!/bin/sh
# transcripts.sh - the README's commands work, and say what the README shows, but for the numbers.
. tests/support/tap.sh

exits "the README's transcripts are of this program" 0 scripts/transcripts --check
ok "there are some" [ "$(grep -c '^ok' "$tmp/out")" -ge 5 ]

# What the check notices.
page() { # page LINE...: a page with one transcript
    { echo '```console'; printf '%s\n' "$@"; echo '```'; } >"$tmp/page.md"
}
page '$ echo 12 of 30' '7 of 9'
exits "other numbers" 0 scripts/transcripts --check "$tmp/page.md"
page '$ echo 12 of 30' '7 in 9'
exits "other words" 1 scripts/transcripts --check "$tmp/page.md"
page '$ echo 1; echo 2 a' '1'
exits "a line too few" 1 scripts/transcripts --check "$tmp/page.md"
page '$ echo 1; echo b; echo 2 a' '1' '...' '2 a'
exits "lines left out, and said to be" 0 scripts/transcripts --check "$tmp/page.md"
page '$ echo "leafcast render: rendering: 38%, 0:07 left"; echo 1' '1'
exits "progress is passed over" 0 scripts/transcripts --check "$tmp/page.md"
page '$ echo 1; exit 3' '1'
exits "a command that fails" 1 scripts/transcripts --check "$tmp/page.md"
page '$ echo 12 of 30' '7 of 9'
exits "made anew" 0 scripts/transcripts "$tmp/page.md"
ok "has this run's numbers" grep -q '^12 of 30$' "$tmp/page.md"
finish
