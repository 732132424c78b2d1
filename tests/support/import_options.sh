# import_options.sh - what the script tests of importers share. Sourced behind tap.sh:
#   import_files NAME MODULE LIBRARY [SCRIPT]   runs tests/support/import_NAME.py, or import_SCRIPT.py; without them it is skipped, visibly
#   import_options VERB INPUT [mesh]   the options that all importers have; mesh: it writes a mesh stream
# shellcheck shell=sh

import_files() {
    verb=$(dirname "$(readlink -f "$leafcast")")/../libexec/leafcast-import-$1
    [ -x "$verb" ] || { skip "import-$1" "no $3 here"; finish; }
    PYTHONDONTWRITEBYTECODE=1 python3 "tests/support/import_${4:-$1}.py" "$leafcast" "$tmp" "$data" \
        >"$tmp/results" 2>"$tmp/said"
    rc=$?
    [ $rc != 77 ] || { skip "import-$1" "no $2 here"; finish; }
    results
}

import_options() {
    suffix=${3:-nrrd}
    exits "to standard output" 0 "$leafcast" "$1" "$2"
    cp "$tmp/out" "$tmp/want.$suffix"
    exits "--output" 0 "$leafcast" "$1" "$2" --output "$tmp/o.$suffix" --quiet
    ok "is the same" cmp -s "$tmp/want.$suffix" "$tmp/o.$suffix"
    ok "--quiet says nothing" [ ! -s "$tmp/out" -a ! -s "$tmp/err" ]
    exits "an output that is there" 1 "$leafcast" "$1" "$2" -o "$tmp/o.$suffix"
    exits "--force --json" 0 "$leafcast" "$1" "$2" -o "$tmp/o.$suffix" --force --json
    ok "has what is in it" grep -qE '"(type|points)": ' "$tmp/out"
    exits "--json without a file" 2 "$leafcast" "$1" "$2" --json
    exits "--verbose" 0 "$leafcast" "$1" "$2" -o "$tmp/o.$suffix" --force --verbose
    ok "says what it took" [ -s "$tmp/err" ]
    exits "--memory 1K" 4 "$leafcast" "$1" "$2" --memory 1K
    exits "--list with an output" 2 "$leafcast" "$1" "$2" --list -o "$tmp/l.$suffix"
    exits "--tiles, as convert asks" 0 "$leafcast" "$1" "$2" --tiles
    [ -d "$2" ] || [ "$suffix" = mesh ] || ok "tells the fields of a file" grep -qa '^leafcast fields:={"fields":' "$tmp/out"
    "$leafcast" "$1" "$2" | "$leafcast" convert - -o "$tmp/o.leaf" -q
    exits "through a pipe into a treelet file" 0 "$leafcast" verify "$tmp/o.leaf"
}
