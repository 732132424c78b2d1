#!/bin/sh
# help.sh - every verb's help: a page for most people with an example, all of it on another.
# marks: plain, long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/${2:-out}"; }
long() { grep -oE -- '(^|[ ,])--[a-z][a-z0-9-]*' "$1" | tr -d ' ,' | sort -u; }
within() { [ -z "$(long "$1" | while read -r o; do long "$2" | grep -qx -- "$o" || echo "$o"; done)" ]; }
same() { [ "$(cat "$1")" = "$(cat "$2")" ]; }

verbs=$("$leafcast" --help | sed -n 's/^  \([a-z0-9-]*\) .*/\1/p')
ok "there are verbs" [ "$(echo "$verbs" | wc -w)" -ge 8 ]
for verb in $verbs "bench peers"; do
    # shellcheck disable=SC2086 # bench peers are two words
    set -- $verb
    exits "$verb --help" 0 "$leafcast" "$@" --help
    cp "$tmp/out" "$tmp/basic"
    ok "$verb: ends with a line" [ -z "$(tail -c 1 "$tmp/basic")" ]
    sed '/^Example:/,$d' "$tmp/basic" >"$tmp/options"
    ok "$verb: at most 16 options" [ "$(long "$tmp/options" | wc -l)" -le 16 ]
    ok "$verb: one example, of the verb" [ "$(grep -c "^  leafcast $verb " "$tmp/basic")" = 1 ]
    exits "$verb -h" 0 "$leafcast" "$@" -h
    ok "$verb: is the same" same "$tmp/out" "$tmp/basic"
    exits "$verb --help-all" 0 "$leafcast" "$@" --help-all
    cp "$tmp/out" "$tmp/all"
    ok "$verb: holds what --help holds, and more" within "$tmp/options" "$tmp/all"
    ok "$verb: more of it" [ "$(wc -l <"$tmp/all")" -gt "$(wc -l <"$tmp/basic")" ]
    exits "$verb --list-options" 0 "$leafcast" "$@" --list-options
    cut -f1 "$tmp/out" | grep . | sort -u >"$tmp/listed"
    grep -E '^ *(-[a-z], )?--' "$tmp/all" | grep -oE -- '--[a-z][a-z0-9-]*' | sort -u >"$tmp/named"
    ok "$verb: lists the options of --help-all" same "$tmp/listed" "$tmp/named"
    ok "$verb: those of experiments come last" [ "$(awk '/^ Experiments:/ { e = NR }
        /^ [A-Z].*:$/ && !/Experiments/ && e { print "late" }' "$tmp/all")" = "" ]
    ok "$verb: no heading without options" [ "$(awk '/^ [A-Z]/ { if (h) print; h = 1 }
        / --/ { h = 0 }' "$tmp/all")" = "" ]
done
exits "help VERB" 0 "$leafcast" help render
"$leafcast" render --help >"$tmp/basic"
ok "is the verb's" same "$tmp/out" "$tmp/basic"
"$leafcast" render --help-all >"$tmp/all"
for name in isa treelet-limit packets isopolygons schema intersector; do
    ok "render: --$name is an experiment" [ "$(awk '/^ Experiments:/ { e = 1 }
        e && /--'"$name"'=/ { print "yes" }' "$tmp/all")" = yes ]
done
"$leafcast" convert --help-all >"$tmp/all"
ok "convert: --build is one" [ "$(awk '/^ Experiments:/ { e = 1 } e && /--build=/ { print "yes" }' \
    "$tmp/all")" = yes ]
exits "options that would change nothing" 2 "$leafcast" verify -o x y.leaf
ok "are refused by name" says 'no --output' err

full() { "$leafcast" render --help >/dev/full; }
[ ! -c /dev/full ] || exits "help that cannot be written" 4 full
exits "--version" 0 "$leafcast" render --version
ok "tells it" says '^leafcast [0-9]*\.[0-9]*\.[0-9]*$'
finish
