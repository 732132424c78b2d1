#!/bin/sh
# options.sh - every option of a verb does something, or is refused: a row an option, by which it is
# seen to; an option without a row fails. What to add: a verb's rows in a table below.
#
#   VERB | --option | KIND | what is run without it | what is added
#
# KIND: picture (the picture changes), stats (the counts of --json change), output (what is written
# to @out changes), says (standard output changes), fewer or more (lines, on both), makes FILE (it is written), exit N (so it ends, and
# without it well), shown TEST (tests/cli/TEST.sh shows it, where it runs this verb).
. tests/support/tap.sh

files() {
    "$leafcast" generate gyroid --dims 40,36,44 -o "$tmp/g.nrrd" -q
    "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
    "$leafcast" generate buckyball --tets --dims 11 --steps 4 --deform 0.4 -o "$tmp/m.mesh" -q
    "$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q --gradients
    echo '[{"fov": 30}, {"fov": 50}]' >"$tmp/path.json"
    echo '{"size": [8, 8]}' >"$tmp/script.json"
}

# once NAME KIND VERB ARGUMENT...: run it; what the kind looks at is in $tmp/NAME.
once() {
    name=$1
    kind=$2
    shift 2
    case $kind in
    picture) run "$leafcast" "$@" --size 40x30 -o "$tmp/seen.ppm" --force ;;
    stats) run "$leafcast" "$@" --size 40x30 --json ;;
    output) run "$leafcast" "$@" -o "$tmp/seen.out" --force ;;
    *) run "$leafcast" "$@" ;;
    esac
    case $kind in
    picture) cp "$tmp/seen.ppm" "$tmp/$name" ;;
    stats | says) sed 's/"[a-z_]*\(_s\|time\|rss_bytes\)":[^,}]*//; /"passes"\|"nodes"\|"cells"\|"roots"\|"read"\|"resident"\|"peak_budget\|"seconds"\|"open"\|"first_image"\|"load"\|"render"\|"write"\|"total"/d' \
        "$tmp/out" >"$tmp/$name" ;;
    output) cp "$tmp/seen.out" "$tmp/$name" ;;
    *) cat "$tmp/out" "$tmp/err" | wc -l >"$tmp/$name" ;;
    esac
}

differ() { ! cmp -s "$tmp/without" "$tmp/with"; }

row() { # row VERB OPTION KIND BASE ADDED
    title="$1 $5"
    # shellcheck disable=SC2086 # arguments
    case $3 in
    picture | stats | output | says)
        once without "${3%% *}" $1 $4
        before=$rc
        once with "${3%% *}" $1 $4 $5
        ok "$title: exit 0 with and without (got $before, $rc)" [ "$before$rc" = 00 ]
        ok "$title: the $3 changes" differ
        ;;
    fewer | more)
        once without "$3" $1 $4
        once with "$3" $1 $4 $5
        set -- "$3" "$(cat "$tmp/without")" "$(cat "$tmp/with")"
        [ "$1" = more ] || set -- more "$3" "$2"
        ok "$title: more or fewer lines ($2, $3)" [ "$rc" = 0 -a "$3" -gt "$2" ]
        ;;
    makes*)
        run "$leafcast" $1 $4 $5
        ok "$title: writes ${3#makes }" [ "$rc" = 0 -a -s "$tmp/${3#makes }" ]
        ;;
    exit*)
        run "$leafcast" $1 $4
        before=$rc
        run "$leafcast" $1 $4 $5
        ok "$title: exit ${3#exit }, without it 0" [ "$before $rc" = "0 ${3#exit }" ]
        ;;
    shown*)
        ok "$title: shown by ${3#shown }" grep -q -- "$2" "tests/cli/${3#shown }.sh"
        ;;
    *) ok "$title: a known kind, not $3" false ;;
    esac
}

files
grid="$tmp/g.leaf --iso 120"
mesh="$tmp/m.leaf --iso 0.3"
sed "s|@grid|$grid|g; s|@mesh|$mesh|g; s|@|$tmp/|g" >"$tmp/table" <<'TABLE'
render|--format|says|@grid --size 8x8 -o -|--format pfm
render|--depth-f64|makes z|@grid --size 8x8|--depth-f64 @z
render|--stats|makes s|@grid --size 8x8|--stats @s
render|--fail-empty|exit 1|@g.leaf --iso 999 --size 8x8 --json|--fail-empty
render|--repeat|stats|@grid|--repeat 3
render|--iso-list|makes i_0001.png|@g.leaf --size 8x8 -o @i.png|--iso-list 100,120
render|--steps|makes t_0001.png|@mesh --size 8x8 -o @t.png|--steps 0:1
render|--camera-path|makes c_0001.png|@grid --size 8x8 -o @c.png|--camera-path @path.json
render|--turntable|makes u_0001.png|@grid --size 8x8 -o @u.png|--turntable 2
render|--script|says|@grid --size 8x8 --json|--script @script.json
render|--backend|shown render|
render|--schema|shown render_steps|
render|--treelet-limit|shown render|
render|--isa|stats|@grid|--isa scalar
render|--packets|stats|@mesh|--packets 4
render|--isopolygons|shown view|
render|--iso|picture|@grid|--iso 150 --opacity 0.4
render|--color|picture|@grid|--color red
render|--colour|picture|@grid|--colour red
render|--opacity|picture|@grid|--opacity 0.4
render|--layers|picture|@grid --opacity 0.4|--layers 1
render|--view|picture|@grid|--view close
render|--eye|picture|@grid|--eye 90,80,70
render|--look-at|picture|@grid|--look-at 5,5,5
render|--up|picture|@grid|--up 0,1,0
render|--fov|picture|@grid|--fov 30
render|--size|says|@grid --json|--size 8x9
render|--samples|picture|@grid|--samples 4
render|--shading|picture|@grid|--shading flat
render|--normals|picture|@grid|--normals analytic
render|--light|picture|@grid|--light 1,0,0
render|--point-light|picture|@grid|--point-light 90,0,0
render|--shadows|picture|@grid --light 1,0,0|--shadows
render|--ambient|picture|@grid|--ambient 0.7
render|--specular|picture|@grid --shading phong|--specular 0.9
render|--shininess|picture|@grid --shading phong|--shininess 3
render|--background|picture|@grid|--background navy
render|--field|exit 2|@mesh --size 8x8 --json|--field none
render|--step|picture|@mesh|--step 1
render|--clip-box|picture|@grid|--clip-box 0,0,0,20,36,44
render|--clip-plane|picture|@grid|--clip-plane 1,0,0,-15
render|--lod|picture|@grid|--lod 1
render|--preview|stats|@grid|--preview
render|--sweep|shown render|
render|--intersector|picture|@grid|--intersector midpoint
render|--output|makes o.png|@grid --size 8x8|--output @o.png
render|--quiet|fewer|@grid --size 8x8 -o @l.png --force|--quiet
render|--verbose|more|@grid --size 8x8 -o @l.png --force|--verbose
render|--threads|stats|@grid --threads 1|--threads 3
render|--memory|exit 4|@grid --size 8x8 --json|--memory 1K
render|--json|says|@grid --size 8x8 -o @j.png --force|--json
render|--force|shown render|
render|--help|shown help|
render|--help-all|shown help|
render|--usage|says|@grid --size 8x8 --json|--usage
render|--version|says|@grid --size 8x8 --json|--version
generate|--dims|output|gyroid --dims 9|--dims 10
generate|--type|output|gyroid --dims 9|--type f32
generate|--seed|output|noise --dims 9|--seed 2
generate|--spacing|output|gyroid --dims 9|--spacing 2
generate|--tets|output|gyroid --dims 9|--tets
generate|--deform|output|gyroid --dims 9 --tets|--deform 0.3
generate|--replicate|output|gyroid --dims 9 --tets|--replicate 2,1,1
generate|--steps|makes w_0001.mesh|gyroid --dims 9 --tets --deform 0.3 -o @w.mesh|--steps 2
generate|--output|makes q|gyroid --dims 9|--output @q
generate|--quiet|fewer|gyroid --dims 9 -o @l.nrrd --force -v|--quiet
generate|--verbose|more|gyroid --dims 9 -o @l.nrrd --force|--verbose
generate|--threads|shown generate|
generate|--memory|shown generate|
generate|--json|says|gyroid --dims 9 -o @j.nrrd --force|--json
generate|--force|shown generate|
generate|--help|shown help|
generate|--help-all|shown help|
generate|--usage|says|gyroid --dims 9 -o @j.nrrd --force|--usage
generate|--version|says|gyroid --dims 9 -o @j.nrrd --force|--version
TABLE
for kind in picture stats; do
    # shellcheck disable=SC2086 # arguments
    for name in without with; do
        once $name $kind render $grid
    done
    ok "$kind: the same when nothing is added" cmp -s "$tmp/without" "$tmp/with"
done
while IFS='|' read -r verb option kind base added; do
    row "$verb" "$option" "$kind" "$base" "${added:-$option}"
done <"$tmp/table"

for verb in $(cut -d'|' -f1 "$tmp/table" | sort -u); do
    "$leafcast" "$verb" --list-options | cut -f1 | grep . | sort >"$tmp/have"
    grep "^$verb|" "$tmp/table" | cut -d'|' -f2 | sort | comm -3 "$tmp/have" - >"$tmp/out"
    ok "$verb: a row for every option, and no other" [ ! -s "$tmp/out" ]
done
finish
