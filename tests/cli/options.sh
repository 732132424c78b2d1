#!/bin/sh
# options.sh - every option of a verb does something, or is refused: a row an option, by which it is
# seen to; an option without a row fails. What to add: a verb's rows in a table below.
#
#   VERB | --option | KIND | what is run without it | what is added
#
# KIND: picture (the picture changes), stats (the counts of --json change), output (what is written
# to @out changes), counts (what is counted in the table of --json changes), refused (it ends with exit 2; without it is
# not run), taken (it ends well: time alone changes; for probe nothing, as what draws a picture may be asked for one of
# its pixels), says (standard output changes), fewer or more (lines, on both), makes FILE (it is written), exit N (so it ends, and
# without it well), shown TEST (tests/cli/TEST.sh shows it, where it runs this verb, or its part in tests/support).
# marks: long
. tests/support/tap.sh

files() {
    "$leafcast" generate gyroid --dims 40,36,44 -o "$tmp/g.nrrd" -q
    "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
    cp "$tmp/g.leaf" "$tmp/g2.leaf"
    "$leafcast" generate buckyball --tets --dims 11 --steps 4 --deform 0.4 -o "$tmp/m.mesh" -q
    tail -c 63360 "$tmp/g.nrrd" >"$tmp/g_40x36x44_uint8.raw"
    printf '%s\n' x,y,z,heat,count 0,0,0,1,5 3,0,0,2,6 0,3,0,3,7 0,0,3,4,8 1,1,1,5,11 >"$tmp/p.csv"
    printf 'OFF 8 6 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n0 0 4\n4 0 4\n4 4 4\n0 4 4\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' >"$tmp/b.off"
    "$leafcast" convert "$tmp/m_0000.mesh" "$tmp/m_0001.mesh" -o "$tmp/m.leaf" -q --gradients
    echo '[{"fov": 30}, {"fov": 50}]' >"$tmp/path.json"
    echo '{"size": [8, 8]}' >"$tmp/script.json"
    echo '{"iso": [150], "fov": 20}' >"$tmp/state.json"
    for i in 2 10; do printf "P6 3 2 255\n$i$i%s" 123456789012345678 | head -c 29 >"$tmp/s$i.ppm"; done
    mkdir "$tmp/v"
    { printf '\0\0\0\2\0\0\0\3\0\0\0\4'; head -c 288 /dev/zero; } >"$tmp/p.xyz"
    { printf '\0\0\0\2\0\0\0\3\0\0\0\4'; head -c 496 /dev/zero; } >"$tmp/p.q"
    { printf '\0\0\0\2\0\0\0\3\0\0\0\4\0\0\0\1'; head -c 96 /dev/zero; } >"$tmp/p.f"
    tool_vdb=${LEAFCAST_BUILD:-build/release}/tests/tool_vdb
    [ ! -x "$tool_vdb" ] || "$tool_vdb" make "$tmp/v"
}

# once NAME KIND VERB ARGUMENT...: run it; what the kind looks at is in $tmp/NAME.
once() {
    name=$1
    kind=$2
    shift 2
    case $kind in
    picture) run "$leafcast" "$@" --size 40x30 -o "$tmp/seen.ppm" --force ;;
    stats) run "$leafcast" "$@" --size 40x30 --json ;;
    counts) run "$leafcast" "$@" --json ;;
    output) run "$leafcast" "$@" -o "$tmp/seen.out" --force ;;
    *) run "$leafcast" "$@" ;;
    esac
    case $kind in
    picture) cp "$tmp/seen.ppm" "$tmp/$name" ;;
    stats | says) sed 's/"[a-z_]*\(_s\|time\|rss_bytes\)":[^,}]*//; /"passes"\|"nodes"\|"cells"\|"roots"\|"read"\|"resident"\|"peak_budget\|"seconds"\|"open"\|"first_image"\|"load"\|"render"\|"write"\|"total"/d' \
        "$tmp/out" >"$tmp/$name" ;;
    counts) grep -E '"(file|volume|size|rays|runs|ray-cells|surfaces|surfaces %|.*/ray|roots|hits|missed|case|error|suite)"' "$tmp/out" |
        grep -v '"ns/' >"$tmp/$name" ;;
    output) cp "$tmp/seen.out" "$tmp/$name" ;;
    *) cat "$tmp/out" "$tmp/err" | wc -l >"$tmp/$name" ;;
    esac
}

# base KIND VERB ARGUMENT... - `once without`: run for the first of the rows that share it.
base() {
    kept=$tmp/base-$(echo "$@" | cksum | tr ' ' -)
    if [ ! -e "$kept" ]; then
        once without "$@"
        echo "$rc" >"$kept.rc"
        mv "$tmp/without" "$kept"
    fi
    cp "$kept" "$tmp/without"
    before=$(cat "$kept.rc")
}

differ() { ! cmp -s "$tmp/without" "$tmp/with"; }

row() { # row VERB OPTION KIND BASE ADDED
    [ "$1" != "bench peers" ] || one_in 3 || return 0 # other libraries, which take long to start
    title="$1 $5"
    # shellcheck disable=SC2086 # arguments
    case $3 in
    picture | stats | output | counts | says)
        base "${3%% *}" $1 $4
        once with "${3%% *}" $1 $4 $5
        ok "$title: exit 0 with and without (got $before, $rc)" [ "$before$rc" = 00 ]
        ok "$title: the $3 changes" differ
        ;;
    fewer | more)
        base "$3" $1 $4
        once with "$3" $1 $4 $5
        set -- "$3" "$(cat "$tmp/without")" "$(cat "$tmp/with")"
        [ "$1" = more ] || set -- more "$3" "$2"
        ok "$title: more or fewer lines ($2, $3)" [ "$rc" = 0 -a "$3" -gt "$2" ]
        ;;
    makes*)
        run "$leafcast" $1 $4 $5
        ok "$title: writes ${3#makes }" [ "$rc" = 0 -a -s "$tmp/${3#makes }" ]
        ;;
    taken)
        run "$leafcast" $1 $4 $5
        ok "$title: taken" [ "$rc" = 0 ]
        ;;
    refused*)
        run "$leafcast" $1 $4 $5
        ok "$title: refused, with words" [ "$rc" = 2 -a "$(grep -c -- "${3#refused }" "$tmp/err")" -ge 1 ]
        ;;
    exit*)
        run "$leafcast" $1 $4
        before=$rc
        run "$leafcast" $1 $4 $5
        ok "$title: exit ${3#exit }, without it 0" [ "$before $rc" = "0 ${3#exit }" ]
        ;;
    shown*)
        ok "$title: shown by ${3#shown }" grep -qs -- "$2" "tests/cli/${3#shown }.sh" \
            "tests/support/${3#shown }.sh" "tests/support/${3#shown }.py"
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
render|--rgba-f64|makes rgba|@g.leaf --tf auto --size 8x8|--rgba-f64 @rgba
render|--error-f64|makes errors|@g.leaf --tf auto --size 8x8|--error-f64 @errors
render|--value-f64|makes value|@g.leaf --project max --size 8x8|--value-f64 @value
render|--write-tf|makes tf|@g.leaf --tf auto --size 8x8|--write-tf @tf
render|--stats|makes s|@grid --size 8x8|--stats @s
render|--certify|stats|@g.leaf --tf auto --size 16x16|--certify
render|--allow-missing|shown lost_treelets|
render|--follow-links|shown scene_file|
render|--progressive|stats|@grid -o @pg.png --force|--progressive
render|--fail-empty|exit 1|@g.leaf --iso 999 --size 8x8 --json|--fail-empty
render|--repeat|stats|@grid|--repeat 3
render|--iso-list|makes i_0001.png|@g.leaf --size 8x8 -o @i.png|--iso-list 100,120
render|--steps|makes t_0001.png|@mesh --size 8x8 -o @t.png|--steps 0:1
render|--camera-path|makes c_0001.png|@grid --size 8x8 -o @c.png|--camera-path @path.json
render|--frames|makes k_0003.png|@grid --size 8x8 -o @k.png --camera-path @path.json|--frames 4
render|--turntable|makes u_0001.png|@grid --size 8x8 -o @u.png|--turntable 2
render|--state|picture|@grid|--state @state.json
render|--script|says|@grid --size 8x8 --json|--script @script.json
render|--backend|shown render_budgets|
render|--schema|shown render_steps|
render|--treelet-limit|shown render_budgets|
render|--isa|stats|@grid|--isa scalar
render|--packets|stats|@mesh|--packets 4
render|--isopolygons|shown view|
render|--traversal|stats|@m.leaf --project mean|--traversal tree
render|--iso|picture|@grid|--iso 150 --opacity 0.4
render|--colour|picture|@grid|--colour red
render|--colour-by|picture|@grid|--colour-by @m.leaf
render|--opacity|picture|@grid|--opacity 0.4
render|--tf|picture|@g.leaf --colour-map grey|--tf ct
render|--colour-map|picture|@g.leaf --tf auto|--colour-map plasma
render|--window|picture|@g.leaf --colour-map plasma|--window 100,120
render|--opacity-length|picture|@g.leaf --opacity 90:0,200:0.5|--opacity-length 9
render|--error|shown media|
render|--homogeneous|picture|@g.leaf --tf auto|--homogeneous 1000
render|--shade-medium|picture|@g.leaf --tf auto|--shade-medium
render|--project|picture|@g.leaf --colour-map grey|--project max
render|--legend|shown media|
render|--annotate|shown annotate|
render|--title|shown annotate|
render|--unit|shown annotate|
render|--font|shown annotate|
render|--medium|picture|@g.leaf --tf auto|--medium steps=3
render|--layers|picture|@grid --opacity 0.4|--layers 1
render|--view|picture|@grid|--view close
render|--eye|picture|@grid|--eye 90,80,70
render|--look-at|picture|@grid|--look-at 5,5,5
render|--up|picture|@grid|--up 0,1,0
render|--fov|picture|@grid|--fov 30
render|--ortho|picture|@grid|--ortho 60
render|--and|picture|@grid|--and @mesh
render|--size|says|@grid --json|--size 8x9
render|--samples|picture|@grid|--samples 4
render|--shading|picture|@grid|--shading flat
render|--normals|picture|@grid|--normals analytic
render|--light|picture|@grid|--light 1,0,0
render|--point-light|picture|@grid|--point-light 90,0,0
render|--shadows|picture|@grid --light 1,0,0|--shadows
render|--light-samples|picture|@grid --light 1,0,0,9 --shadows|--light-samples 3
render|--occlusion|picture|@grid|--occlusion 9
render|--reflect|picture|@grid|--reflect 0.4
render|--refract|picture|@grid --opacity 0.5|--refract 1.5
render|--ambient|picture|@grid|--ambient 0.7
render|--specular|picture|@grid --shading phong|--specular 0.9
render|--shininess|picture|@grid --shading phong|--shininess 3
render|--background|picture|@grid|--background navy
render|--field|exit 2|@mesh --size 8x8 --json|--field none
render|--step|picture|@mesh|--step 1
render|--time|shown interpolate|
render|--interpolate|shown interpolate|
render|--clip-box|picture|@grid|--clip-box 0,0,0,20,36,44
render|--caps|picture|@grid --clip-plane -1,0,0,15|--caps
render|--clip-plane|picture|@grid|--clip-plane 1,0,0,-15
render|--lod|picture|@grid|--lod 1
render|--preview|stats|@grid --lod pixel|--preview
render|--sweep|shown render_budgets|
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
generate|--curvilinear|output|gyroid --dims 9|--curvilinear warp
generate|--deform|output|gyroid --dims 9 --tets|--deform 0.3
generate|--replicate|output|gyroid --dims 9 --tets|--replicate 2,1,1
generate|--shape|output|plant -o @b.ply --force|--shape bush
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
bench|--against|refused has no counts|walk @grid|--against @none
bench|--baselines|refused has no counts|walk @grid|--baselines @none
bench|--data|refused file already|walk @grid --size 16x16 --runs 1|--data @
bench|--scratch|refused file already|walk @grid --size 16x16 --runs 1|--scratch @s
bench|--form|refused brief or full|walk @grid --size 16x16 --runs 1|--form long
bench|--largest|refused figure414|frames|--largest 64
bench|--out|makes d/walk.csv|walk @grid --size 16x16 --runs 1|--out @d
bench|--plot|makes p.svg|walk @grid --size 16x16 --runs 1|--plot @p.svg
bench|--tf|refused is for media|walk @grid|--tf auto
bench|--ray-cells|counts|intersectors noise --runs 1 --ray-cells 90|--ray-cells 80
bench|--runs|refused needs one|kernel @grid --size 8x8|--runs 2
bench|--iso|counts|walk @grid --size 16x16 --runs 1 --opacity 0.5|--iso 150
bench|--colour|refused --colour: bench walk would not change|walk @grid --size 16x16 --runs 1|--colour red
bench|--colour-by|refused --colour-by: bench walk|walk @grid --size 16x16 --runs 1|--colour-by @m.leaf
bench|--opacity|counts|walk @grid --size 16x16 --runs 1|--opacity 0.4
bench|--layers|refused --layers: bench frames|frames @grid --size 8x8 --runs 1|--layers 1
bench|--view|counts|walk @grid --size 16x16 --runs 1|--view close
bench|--eye|counts|walk @grid --size 16x16 --runs 1|--eye 90,80,70
bench|--look-at|counts|walk @grid --size 16x16 --runs 1|--look-at 5,5,5
bench|--up|counts|walk @grid --size 16x16 --runs 1|--up 0,1,0
bench|--fov|counts|walk @grid --size 16x16 --runs 1|--fov 20
bench|--ortho|refused --ortho: bench walk|walk @grid --size 16x16 --runs 1|--ortho 30
bench|--size|counts|frames @grid --size 8x8 --runs 1|--size 9x9
bench|--samples|refused --samples: bench walk|walk @grid --size 16x16 --runs 1|--samples 4
bench|--shading|refused --shading: bench walk|walk @grid --size 16x16 --runs 1|--shading flat
bench|--normals|refused --normals: bench walk|walk @grid --size 16x16 --runs 1|--normals analytic
bench|--ambient|refused --ambient: bench walk|walk @grid --size 16x16 --runs 1|--ambient 0.5
bench|--specular|refused --specular: bench walk|walk @grid --size 16x16 --runs 1|--specular 0.5
bench|--shininess|refused --shininess: bench walk|walk @grid --size 16x16 --runs 1|--shininess 4
bench|--background|refused --background: bench walk|walk @grid --size 16x16 --runs 1|--background red
bench|--light|refused --light: bench frames|frames @grid --size 8x8 --runs 1|--light 1,0,0
bench|--point-light|refused --point-light: bench frames|frames @grid --size 8x8 --runs 1|--point-light 1,0,0
bench|--light-samples|refused --light-samples|walk @grid --size 16x16 --runs 1|--light-samples 3
bench|--occlusion|refused --occlusion: bench walk|walk @grid --size 16x16 --runs 1|--occlusion 9
bench|--reflect|refused --reflect: bench walk|walk @grid --size 16x16 --runs 1|--reflect 0.4
bench|--refract|refused --refract: bench walk|walk @grid --size 16x16 --runs 1|--refract 1.5
bench|--shadows|counts|walk @grid --size 16x16 --runs 1 --light 1,0,0|--shadows
bench|--field|refused first field|walk @grid --size 16x16 --runs 1|--field 0
bench|--step|refused first field|walk @grid --size 16x16 --runs 1|--step 1
bench|--time|refused would not change|walk @grid --size 16x16 --runs 1|--time 1
bench|--interpolate|refused would not change|walk @grid --size 16x16 --runs 1|--interpolate
bench|--clip-box|counts|walk @grid --size 16x16 --runs 1|--clip-box 0,0,0,20,36,44
bench|--clip-plane|counts|walk @grid --size 16x16 --runs 1|--clip-plane 1,0,0,-15
bench|--lod|counts|walk @grid --size 16x16 --runs 1|--lod 1
bench|--preview|refused --preview: bench walk|walk @grid --size 16x16 --runs 1|--preview
bench|--sweep|refused --sweep: bench walk|walk @grid --size 16x16 --runs 1|--sweep
bench|--intersector|refused --intersector: bench walk|walk @grid --size 16x16 --runs 1|--intersector midpoint
bench|--output|makes w.csv|walk @grid --size 16x16 --runs 1|--output @w.csv
bench|--threads|shown bench_baselines|
bench|--json|says|walk @grid --size 16x16 --runs 1|--json
bench|--memory|refused --memory: is for streaming|walk @grid --size 16x16 --runs 1|--memory 64M
bench|--force|shown bench_baselines|
bench|--quiet|refused no suite|nonsense|--quiet
bench|--verbose|more|walk @grid --size 16x16 --runs 1|--verbose
bench|--help|shown help|
bench|--help-all|shown help|
bench|--usage|says|walk @grid --size 16x16 --runs 1|--usage
bench|--version|says|walk @grid --size 16x16 --runs 1|--version
bench peers|--media|shown peers|
bench peers|--tf|shown peers|
bench peers|--isa|refused expected sse42|@grid --size 8x8 --runs 1|--isa scalar
bench peers|--picture|shown peers|
bench peers|--plot|shown peers|
bench peers|--runs|shown peers|
bench peers|--step|refused number|@grid --size 8x8 --runs 1|--step x
bench peers|--time|refused would not change|@grid --size 8x8 --runs 1|--time 1
bench peers|--interpolate|refused would not change|@grid --size 8x8 --runs 1|--interpolate
bench peers|--iso|refused one isosurface|@grid --size 8x8 --runs 1|--iso 150
bench peers|--colour|refused a name such as|@grid --size 8x8 --runs 1|--colour redd
bench peers|--opacity|counts|@grid --size 8x8 --runs 1|--opacity 0.5
bench peers|--eye|shown peers|
bench peers|--look-at|shown peers|
bench peers|--size|shown peers|
bench peers|--view|refused either --view or --eye|@grid --size 8x8 --runs 1 --eye 90,80,70|--view close
bench peers|--up|refused number|@grid --size 8x8 --runs 1|--up x
bench peers|--fov|refused --fov|@grid --size 8x8 --runs 1|--fov 0
bench peers|--ortho|refused --ortho|@grid --size 8x8 --runs 1|--ortho 40
bench peers|--ambient|refused --ambient|@grid --size 8x8 --runs 1|--ambient 2
bench peers|--samples|refused one ray a pixel|@grid --size 8x8 --runs 1|--samples 4
bench peers|--colour-by|refused --colour-by: bench peers would not change|@grid --size 8x8 --runs 1|--colour-by @m.leaf
bench peers|--layers|counts|@grid --size 8x8 --runs 1 --opacity 0.5|--layers 1
bench peers|--specular|refused --specular: bench peers would not change|@grid --size 8x8 --runs 1|--specular 0.5
bench peers|--shininess|refused --shininess: bench peers would not change|@grid --size 8x8 --runs 1|--shininess 4
bench peers|--background|refused --background: bench peers would not change|@grid --size 8x8 --runs 1|--background red
bench peers|--sweep|refused --sweep: bench peers would not change|@grid --size 8x8 --runs 1|--sweep
bench peers|--intersector|refused --intersector: bench peers would not change|@grid --size 8x8 --runs 1|--intersector midpoint
bench peers|--shading|refused shade diffuse|@grid --size 8x8 --runs 1|--shading flat
bench peers|--normals|refused smooth normals|@grid --size 8x8 --runs 1|--normals analytic
bench peers|--light|shown peers|
bench peers|--point-light|shown peers|
bench peers|--light-samples|refused --light-samples|@grid --size 8x8 --runs 1|--light-samples 3
bench peers|--occlusion|refused --occlusion: bench peers would not change|@grid --size 8x8 --runs 1|--occlusion 9
bench peers|--reflect|refused --reflect: bench peers would not change|@grid --size 8x8 --runs 1|--reflect 0.4
bench peers|--refract|refused --refract: bench peers would not change|@grid --size 8x8 --runs 1|--refract 1.5
bench peers|--shadows|counts|@grid --size 8x8 --runs 1 --light 1,0,0|--shadows
bench peers|--field|refused first field|@grid --size 8x8 --runs 1|--field 0
bench peers|--clip-box|refused all of the surface|@grid --size 8x8 --runs 1|--clip-box 0,0,0,20,36,44
bench peers|--clip-plane|refused all of the surface|@grid --size 8x8 --runs 1|--clip-plane 1,0,0,-15
bench peers|--lod|refused all of the surface|@grid --size 8x8 --runs 1|--lod 1
bench peers|--preview|refused all of the surface|@grid --size 8x8 --runs 1|--preview
bench peers|--output|shown peers|
bench peers|--threads|shown peers|
bench peers|--memory|shown peers|
bench peers|--json|shown peers|
bench peers|--force|shown peers|
bench peers|--quiet|shown peers|
bench peers|--verbose|shown peers|
bench peers|--help|shown help|
bench peers|--help-all|shown help|
bench peers|--usage|taken||--usage
bench peers|--version|taken||--version
render|--axes|shown world|
slice|--axes|shown world|
probe|--axes|shown world|
probe|--at|says|@grid --size 16x16 --at 8,8|--at 9,8
probe|--ray|shown probe|
probe|--point|shown probe|
probe|--hits|shown probe|
probe|--segments|shown probe|
probe|--csv|shown probe|
probe|--svg|shown probe|
probe|--force|shown probe|
probe|--iso|says|@grid --size 16x16 --at 8,8|--iso 150
probe|--view|says|@grid --size 16x16 --at 8,8|--view close
probe|--eye|says|@grid --size 16x16 --at 8,8|--eye 90,80,70
probe|--look-at|says|@grid --size 16x16 --at 8,8|--look-at 19,17,20
probe|--up|says|@grid --size 16x16 --at 8,8|--up 0,1,0.2
probe|--fov|says|@grid --size 16x16 --at 8,8|--fov 20
probe|--ortho|says|@grid --size 16x16 --at 8,8|--ortho 60
probe|--size|says|@grid --size 16x16 --at 8,8|--size 17x17
probe|--clip-plane|says|@grid --size 16x16 --at 8,8|--clip-plane 1,0,0,-25
probe|--clip-box|says|@grid --size 16x16 --at 8,8|--clip-box 0,0,0,20,36,44
probe|--samples|refused one ray|@grid --size 16x16 --at 8,8|--samples 4
probe|--colour|taken|@grid --size 16x16 --at 8,8|--colour red
probe|--opacity|taken|@grid --size 16x16 --at 8,8|--opacity 0.4
probe|--colour-by|says|@grid --size 16x16 --at 8,8|--colour-by @m.leaf
probe|--layers|taken|@grid --size 16x16 --at 8,8|--opacity 0.4 --layers 1
probe|--ambient|taken|@grid --size 16x16 --at 8,8|--ambient 0.4
probe|--background|taken|@grid --size 16x16 --at 8,8|--background red
probe|--light|taken|@grid --size 16x16 --at 8,8|--light 1,0,0
probe|--point-light|taken|@grid --size 16x16 --at 8,8|--point-light 90,0,0
probe|--light-samples|taken|@grid --size 16x16 --at 8,8|--shadows --light 1,0,0,9 --light-samples 3
probe|--occlusion|taken|@grid --size 16x16 --at 8,8|--occlusion 9
probe|--reflect|taken|@grid --size 16x16 --at 8,8|--reflect 0.4
probe|--refract|taken|@grid --size 16x16 --at 8,8 --opacity 0.5|--refract 1.5
probe|--shadows|taken|@grid --size 16x16 --at 8,8|--shadows --light 1,0,0
probe|--shading|taken|@grid --size 16x16 --at 8,8|--shading flat
probe|--specular|taken|@grid --size 16x16 --at 8,8|--shading phong --specular 0.4
probe|--shininess|taken|@grid --size 16x16 --at 8,8|--shading phong --shininess 4
probe|--normals|taken|@grid --size 16x16 --at 8,8|--normals analytic
probe|--lod|taken|@grid --size 16x16 --at 8,8|--lod 1
probe|--intersector|taken|@grid --size 16x16 --at 8,8|--intersector midpoint
probe|--preview|taken|@grid --size 16x16 --at 8,8|--preview
probe|--sweep|taken|@grid --size 16x16 --at 8,8|--sweep
probe|--field|refused no field|@mesh --size 16x16 --at 8,8|--field none
probe|--step|says|@mesh --size 16x16 --at 8,8|--step 1
probe|--time|shown interpolate|
probe|--interpolate|shown interpolate|
probe|--memory|exit 4|@grid --size 16x16 --at 8,8|--memory 1K
probe|--json|says|@grid --size 16x16 --at 8,8|--json
probe|--quiet|taken|@grid --size 16x16 --at 8,8|--quiet
probe|--verbose|more|@grid --size 16x16 --at 8,8|--verbose
probe|--help|shown help|
probe|--help-all|shown help|
probe|--usage|says|@grid --size 16x16 --at 8,8|--usage
probe|--version|says|@grid --size 16x16 --at 8,8|--version
slice|--axis|output|@g.leaf --size 60x50 --format ppm|--axis x
slice|--at|output|@g.leaf --size 60x50 --format ppm|--at 11
slice|--index|output|@g.leaf --size 60x50 --format ppm|--index 3
slice|--plane|output|@g.leaf --size 60x50 --format ppm|--plane 1,1,0,-30
slice|--origin|output|@g.leaf --size 60x50 --format ppm --u 9,0,0 --v 0,9,1 --origin 1,1,1|--origin 2,1,1
slice|--u|output|@g.leaf --size 60x50 --format ppm --origin 1,1,1 --v 0,9,1 --u 9,0,0|--u 9,0,1
slice|--v|output|@g.leaf --size 60x50 --format ppm --origin 1,1,1 --u 9,0,0 --v 0,9,1|--v 0,9,2
slice|--line|output|@g.leaf --size 60x50 --format ppm --sweep 0,0,9 --line 1,1,1;9,9,1|--line 1,1,1;9,8,1
slice|--sweep|output|@g.leaf --size 60x50 --format ppm --line 1,1,1;9,9,1 --sweep 0,0,9|--sweep 0,1,9
slice|--size|output|@g.leaf --size 60x50 --format ppm|--size 9x8
slice|--nearest|output|@g.leaf --size 60x50 --format ppm --size 9x8|--nearest
slice|--level|output|@g.leaf --size 60x50 --format ppm --size 9x8|--level 1
slice|--field|refused no field|@m.leaf --json|--field none
slice|--step|output|@m.leaf --size 60x50 --format ppm|--step 1
slice|--time|shown interpolate|
slice|--interpolate|shown interpolate|
slice|--window|output|@g.leaf --size 60x50 --format ppm|--window 50,200
slice|--colour-map|output|@g.leaf --size 60x50 --format ppm|--colour-map viridis
slice|--tf|output|@g.leaf --size 60x50 --format ppm|--tf auto
slice|--legend|output|@g.leaf --size 60x50 --format ppm --size 200x200|--legend
slice|--iso|output|@g.leaf --size 60x50 --format ppm|--iso 120
slice|--colour|output|@g.leaf --size 60x50 --format ppm --iso 120|--colour red
slice|--format|output|@g.leaf --size 60x50 --format ppm|--format pfm
slice|--value-f64|makes zz|@g.leaf|--value-f64 @zz
slice|--stats|makes ss|@g.leaf|--stats @ss
slice|--output|makes so.png|@g.leaf|--output @so.png
slice|--threads|says|@g.leaf --json --threads 1|--threads 3
slice|--memory|exit 4|@g.leaf --json|--memory 1K
slice|--json|says|@g.leaf -o @sj.png --force|--json
slice|--force|exit 0|@g.leaf -o @sf.png --force|
slice|--quiet|fewer|@g.leaf -o @sq.png --force|--quiet
slice|--verbose|more|@g.leaf -o @sq.png --force|--verbose
slice|--help|shown help|
slice|--help-all|shown help|
slice|--usage|says|@g.leaf -o @sq.png --force|--usage
slice|--version|says|@g.leaf -o @sq.png --force|--version
info|--iso|says|@g.leaf|--iso 120
info|--steps|refused no step 7|@g.leaf --iso 120|--steps 7
info|--follow-links|shown named_files|
info|--allow-missing|shown absent_parts|
info|--quick|fewer|@g.nrrd|--quick
info|--field|refused no array|@m_0000.mesh|--field none
info|--dims|says|@g_40x36x44_uint8.raw|--dims 36,40,44
info|--type|says|@g_40x36x44_uint8.raw|--type i8
info|--big-endian|says|@g_40x36x44_uint8.raw --dims 20,36,44 --type u16|--big-endian
view|--port|shown view_server|
view|--address|shown view_server|
view|--open|shown view_server|
view|--isa|shown view_server|
view|--token-file|shown view_server|
view|--follow-links|shown view_scene|
view|--threads|refused --threads|@g.leaf|--threads none
view|--memory|shown view_server|
view|--quiet|shown view_server|
view|--verbose|shown view_server|
view|--help|shown help|
view|--help-all|shown help|
view|--usage|taken||--usage
view|--version|taken||--version
info|--solution|says|@p.xyz|--solution @p.q
info|--functions|says|@p.xyz|--functions @p.f
info|--to|refused expected netCDF|@p.xyz|--to sphere
info|--plot3d|refused expected once|@p.xyz|--plot3d nonsense
info|--skip|shown inputs|
info|--threads|taken|@g.nrrd|--threads 2
info|--memory|shown inputs|
info|--json|says|@g.leaf|--json
info|--quiet|taken|@g.leaf|--quiet
info|--verbose|more|@g.leaf|--verbose
info|--help|shown help|
info|--help-all|shown help|
info|--usage|says|@g.leaf|--usage
info|--version|says|@g.leaf|--version
verify|--threads|taken|@g.leaf|--threads 3
verify|--memory|exit 4|@g.leaf|--memory 1K
verify|--json|says|@g.leaf|--json
verify|--quiet|fewer|@g.leaf --verbose|--quiet
verify|--verbose|more|@g.leaf|--verbose
verify|--repair|says|@g.leaf|--repair @g2.leaf
verify|--output|makes vo.leaf|@g.leaf --repair @g2.leaf|--output @vo.leaf
verify|--force|shown verify_repair|
verify|--help|shown help|
verify|--help-all|shown help|
verify|--usage|says|@g.leaf|--usage
verify|--version|says|@g.leaf|--version
export|--format|output|@g.leaf --format raw|--format nrrd
export|--box|output|@g.leaf --format raw|--box 0,0,0,9,9,9
export|--level|output|@g.leaf --format raw|--level 1
export|--iso|output|@g.leaf --format ply --iso 120|--iso 130
export|--floats|output|@g.leaf --format ply --iso 120|--floats
export|--field|exit 2|@m.leaf -o @f.vtu --force|--field none
export|--step|output|@m.leaf --format vtu|--step 1
export|--output|makes x.nrrd|@g.leaf|--output @x.nrrd
export|--threads|shown export|
export|--memory|exit 4|@g.leaf -o @m.nrrd --force|--memory 1K
export|--json|says|@g.leaf -o @m.nrrd --force|--json
export|--force|exit 0|@g.leaf -o @m.nrrd --force|
export|--quiet|fewer|@g.leaf -o @m.nrrd --force --verbose|--quiet
export|--verbose|more|@g.leaf -o @m.nrrd --force|--verbose
export|--help|shown help|
export|--help-all|shown help|
export|--usage|says|@g.leaf -o @m.nrrd --force|--usage
export|--version|says|@g.leaf -o @m.nrrd --force|--version
resample|--dims|output|@m.leaf --dims 7|--dims 8
resample|--spacing|output|@m.leaf|--spacing 3
resample|--bounds|output|@m.leaf --dims 7|--bounds 1,1,1,6,6,6
resample|--field|shown inputs|
resample|--step|output|@m.leaf --dims 7|--step 1
resample|--component|shown inputs|
resample|--cells-to-points|shown inputs|
resample|--by-corners|shown whole_cells|
resample|--whole-cells|shown whole_cells|
resample|--to|refused it would change nothing|@m.leaf -o @m.nrrd --force|--to sphere
resample|--exaggerate|refused it would change nothing|@m.leaf -o @m.nrrd --force|--exaggerate 2
resample|--solution|refused it would change nothing|@m.leaf -o @m.nrrd --force|--solution q
resample|--functions|refused it would change nothing|@m.leaf -o @m.nrrd --force|--functions f
resample|--plot3d|refused it would change nothing|@m.leaf -o @m.nrrd --force|--plot3d text
resample|--follow-links|refused it would change nothing|@m.leaf -o @m.nrrd --force|--follow-links
resample|--allow-missing|refused it would change nothing|@m.leaf -o @m.nrrd --force|--allow-missing
resample|--output|makes r.nrrd|@m.leaf --dims 7|--output @r.nrrd
resample|--threads|shown resample|
resample|--memory|exit 4|@m.leaf --dims 7 -o @m.nrrd --force|--memory 1K
resample|--json|says|@m.leaf --dims 7 -o @m.nrrd --force|--json
resample|--force|exit 0|@m.leaf --dims 7 -o @m.nrrd --force|
resample|--quiet|fewer|@m.leaf --dims 7 -o @m.nrrd --force --verbose|--quiet
resample|--verbose|more|@m.leaf --dims 7 -o @m.nrrd --force|--verbose
resample|--help|shown help|
resample|--help-all|shown help|
resample|--usage|says|@m.leaf --dims 7 -o @m.nrrd --force|--usage
resample|--version|says|@m.leaf --dims 7 -o @m.nrrd --force|--version
tetrahedralize|--field|output|@p.csv|--field count
tetrahedralize|--format|refused no format|@p.csv -o @fm.mesh|--format none
tetrahedralize|--points|output|@b.off|--points
tetrahedralize|--max-volume|output|@b.off|--max-volume 0.5
tetrahedralize|--quality|output|@b.off --max-volume 2|--quality 1.2
tetrahedralize|--timeout|shown tetrahedralize|
tetrahedralize|--threads|taken|@p.csv -o @pt.mesh|--threads 1
tetrahedralize|--memory|shown tetrahedralize|
tetrahedralize|--json|says|@p.csv -o @pj.mesh --force|--json
tetrahedralize|--force|exit 0|@p.csv -o @pf.mesh --force|
tetrahedralize|--output|makes po.mesh|@p.csv|--output @po.mesh
tetrahedralize|--quiet|fewer|@p.csv -o @pq.mesh --force --verbose|--quiet
tetrahedralize|--verbose|more|@p.csv -o @pq.mesh --force|--verbose
tetrahedralize|--help|shown help|
tetrahedralize|--help-all|shown help|
tetrahedralize|--usage|says|@p.csv -o @pq.mesh --force|--usage
tetrahedralize|--version|says|@p.csv -o @pq.mesh --force|--version
import-hdf5|--axes|shown import_hdf5|
import-hdf5|--component|shown import_hdf5|
import-hdf5|--field|shown import_hdf5|
import-hdf5|--follow-links|shown named_files|
import-hdf5|--allow-missing|shown absent_parts|
import-hdf5|--list|shown import_hdf5|
import-hdf5|--step|shown import_hdf5|
import-netcdf|--field|shown import_netcdf|
import-netcdf|--indices|shown import_netcdf|
import-netcdf|--stack-time|shown import_netcdf|
import-netcdf|--follow-links|shown named_files|
import-netcdf|--allow-missing|shown absent_parts|
import-netcdf|--list|shown import_netcdf|
import-netcdf|--step|shown import_netcdf|
import-netcdf|--to|shown import_places|
import-netcdf|--exaggerate|shown import_places|
import-exodus|--by-corners|shown import_exodus|
import-exodus|--cells-to-points|shown import_exodus|
import-exodus|--field|shown import_exodus|
import-exodus|--follow-links|shown named_files|
import-exodus|--allow-missing|shown absent_parts|
import-exodus|--list|shown import_exodus|
import-exodus|--step|shown import_exodus|
import-cgns|--by-corners|shown import_cgns|
import-cgns|--cells-to-points|shown import_cgns|
import-cgns|--field|shown import_cgns|
import-cgns|--follow-links|shown named_files|
import-cgns|--allow-missing|shown absent_parts|
import-cgns|--list|shown import_cgns|
import-cgns|--step|shown import_cgns|
import-cgns|--zones|shown import_cgns|
import-dicom|--allow-gaps|shown import_dicom|
import-dicom|--component|shown import_dicom|
import-dicom|--field|shown import_dicom|
import-dicom|--list|shown import_dicom|
import-dicom|--step|shown import_dicom|
import-images|--spacing|output|@s2.ppm @s10.ppm|--spacing 2,3,4
import-images|--field|output|@s2.ppm @s10.ppm|--field G
import-images|--component|output|@s2.ppm @s10.ppm|--component 1
import-images|--step|shown import_images|
import-images|--as-given|output|@s10.ppm @s2.ppm|--as-given
import-images|--list|says|@s2.ppm @s10.ppm|--list
import-images|--memory|exit 4|@s2.ppm @s10.ppm -o @si.nrrd --force|--memory 100
import-images|--json|says|@s2.ppm @s10.ppm -o @sj.nrrd --force|--json
import-images|--force|exit 0|@s2.ppm @s10.ppm -o @sf.nrrd --force|
import-images|--output|makes so.nrrd|@s2.ppm @s10.ppm|--output @so.nrrd
import-images|--quiet|fewer|@s2.ppm @s10.ppm -o @sq.nrrd --force --verbose|--quiet
import-images|--verbose|more|@s2.ppm @s10.ppm -o @sv.nrrd --force|--verbose
import-images|--help|shown help|
import-images|--help-all|shown help|
import-images|--usage|says|@s2.ppm @s10.ppm -o @su.nrrd --force|--usage
import-images|--version|says|@s2.ppm @s10.ppm -o @su.nrrd --force|--version
import-vdb|--field|output|@v/blosc.vdb|--field int32
import-vdb|--component|output|@v/blosc.vdb --field vec3s|--component 3
import-vdb|--box|output|@v/blosc.vdb|--box 0,0,0,4,4,4
import-vdb|--pad|output|@v/blosc.vdb|--pad 1
import-vdb|--list|says|@v/sphere.vdb|--list
import-vdb|--memory|exit 4|@v/none.vdb -o @vi.nrrd --force|--memory 100K
import-vdb|--json|says|@v/sphere.vdb -o @vj.nrrd --force|--json
import-vdb|--force|exit 0|@v/sphere.vdb -o @vf.nrrd --force|
import-vdb|--output|makes vo.nrrd|@v/sphere.vdb|--output @vo.nrrd
import-vdb|--quiet|fewer|@v/sphere.vdb -o @vq.nrrd --force --verbose|--quiet
import-vdb|--verbose|more|@v/sphere.vdb -o @vv.nrrd --force|--verbose
import-vdb|--help|shown help|
import-vdb|--help-all|shown help|
import-vdb|--usage|says|@v/sphere.vdb -o @vu.nrrd --force|--usage
import-vdb|--version|says|@v/sphere.vdb -o @vu.nrrd --force|--version
TABLE
for verb in import-cgns import-dicom import-exodus import-hdf5 import-netcdf; do
    for option in output quiet verbose memory json force; do echo "$verb|--$option|shown import_options|"; done
    printf '%s|--%s|%s\n' $verb help 'shown help|' $verb help-all 'shown help|' $verb usage 'taken||--usage' $verb version 'taken||--version'
done >>"$tmp/table"
for kind in picture stats; do
    # shellcheck disable=SC2086 # arguments
    for name in without with; do
        once $name $kind render $grid
    done
    ok "$kind: the same when nothing is added" cmp -s "$tmp/without" "$tmp/with"
done
"$leafcast" --list-verbs own >"$tmp/own"
[ -e "$tmp/v/sphere.vdb" ] || sed -i '/^import-vdb$/d' "$tmp/own"
while IFS='|' read -r verb option kind base added; do
    if ! grep -qx "${verb%% *}" "$tmp/own"; then
        skip "$verb $option" "its library is not here"
        continue
    fi
    row "$verb" "$option" "$kind" "$base" "${added:-$option}"
done <"$tmp/table"

{ cat "$tmp/own"; echo bench peers; } | sort >"$tmp/here"
cut -d'|' -f1 "$tmp/table" | sort -u | comm -12 - "$tmp/here" >"$tmp/verbs"
# Of convert it is inputs.sh that walks through all options.
ok "every verb" [ "$(comm -3 "$tmp/here" "$tmp/verbs" | tr -d '\t\n')" = convert ]
while read -r verb; do
    # shellcheck disable=SC2086 # bench peers are two words
    "$leafcast" $verb --list-options | cut -f1 | grep . | sort >"$tmp/have"
    grep "^$verb|" "$tmp/table" | cut -d'|' -f2 | sort | comm -3 "$tmp/have" - >"$tmp/out"
    ok "$verb: a row for every option, and no other" [ ! -s "$tmp/out" ]
done <"$tmp/verbs"

# A colour is written in one way, and read in two: whatever option has one in its name.
: >"$tmp/coloured"
while read -r verb; do
    # shellcheck disable=SC2086 # bench peers are two words
    {
        "$leafcast" $verb --list-options
        "$leafcast" $verb --help-all
        cat "scripts/man/leafcast-$(echo $verb | tr ' ' -).1"
    } >"$tmp/words" 2>/dev/null
    ok "$verb: one spelling of colour" [ "$(grep -ci 'color' "$tmp/words")" = 0 ]
    # shellcheck disable=SC2086
    "$leafcast" $verb --list-options | cut -f1 | grep colour >"$tmp/names"
    while read -r option; do
        other=$(echo "$option" | sed 's/colour/color/')
        # shellcheck disable=SC2086
        run "$leafcast" $verb "$other"
        ok "$verb $other: taken, but for its value" grep -q "requires an argument" "$tmp/err"
        echo "$verb $other" >>"$tmp/coloured"
    done <"$tmp/names"
done <"$tmp/here"
ok "several have one" [ "$(wc -l <"$tmp/coloured")" -ge 5 ]
paint() { # paint NAME ARGUMENT...: a picture, $tmp/NAME
    name=$1
    shift
    "$leafcast" "$@" --force -q -o "$tmp/$name"
}
paint a.ppm render "$tmp/g.leaf" --iso 120 --colour red --size 16x16
paint b.ppm render "$tmp/g.leaf" --iso 120 --color=red --size 16x16
paint c.ppm render "$tmp/g.leaf" --iso 120 --size 16x16
ok "the same colour by either" cmp -s "$tmp/a.ppm" "$tmp/b.ppm"
ok "and one at all" test "$(cksum <"$tmp/a.ppm")" != "$(cksum <"$tmp/c.ppm")"
for key in color colour; do
    echo "{\"$key\": \"red\", \"tf\": \"auto\", \"${key}_map\": \"plasma\", \"output\": \"$tmp/$key.ppm\"}"
done | "$leafcast" render "$tmp/g.leaf" --iso 120 --size 16x16 --script - --force -q >/dev/null 2>&1
ok "in a script, too" cmp -s "$tmp/color.ppm" "$tmp/colour.ppm"
finish
