#!/bin/sh
# output_guard.sh - no verb writes over what it reads, or twice to one file, whatever the names and with --force:
# each verb with each form of input (tests/support/guard_forms.py), and with each of the files that belong to it. So
# does a host program of the library (tool_convert).
# marks: long
. tests/support/tap.sh
build=${LEAFCAST_BUILD:-$PWD/build/release}

says() { grep -q -- "$1" "$tmp/err"; }
# refused NAME COMMAND... - exit 2, a word about it, all files in the folder as they were, nothing new there. Where already
# the output's name says no, it is asked again by a name that says nothing, which is the same file.
refused() {
    refused_once "$@"
    ! says 'what is written is' || ! one_in 4 || plainly "$@"
}
plainly() {
    name=$1
    shift
    before=
    for word; do
        shift
        case $before in
        -o | --csv | --svg)
            ln -Lf "$word" "$word.same"
            word=$word.same
            link=$word
            ;;
        esac
        before=$word
        set -- "$@" "$word"
    done
    refused_once "$name, by another name" "$@"
    ok "$name: it is the guard that says so" says 'an input\|an output\|two outputs'
    rm -f "$link"
}
# all - each file here: which it is, how many names it has, its size, when it was written.
all() { find . -type d -print -o -printf '%p %i %n %s %T@\n'; }
refused_once() {
    name=$1
    shift
    before=$(all)
    exits "$name" 2 "$@"
    ok "$name: says so" says 'an input\|an output\|two outputs\|what is written is'
    ok "$name: all files are as before, nothing else is there" [ "$(all)" = "$before" ]
}

mkdir "$tmp/in" "$tmp/alias" "$tmp/forms"
python=$(python_with h5py)
PYTHONDONTWRITEBYTECODE=1 "${python:-python3}" tests/support/guard_forms.py "$tmp/forms" >"$tmp/table" 2>"$tmp/err"
ok "the forms are made" [ ! -s "$tmp/err" ]
# OpenVDB's is leafcast's own.
run "$leafcast" generate sphere --dims 6 -o "$tmp/v.nrrd"
run "$leafcast" convert "$tmp/v.nrrd" -o "$tmp/v.leaf"
exits "a file of OpenVDB" 0 "$leafcast" export "$tmp/v.leaf" -o "$tmp/forms/v.vdb"
printf 'import-vdb\tv.vdb\t\tv.vdb\n' >>"$tmp/table"
# An importer that this build has not (its library is not here, or not for sanitizers) reads nothing.
"$leafcast" --list-verbs >"$tmp/verbs"
awk -F'\t' 'NR == FNR { built[$1] = 1; next } !/^import-/ || $1 in built' "$tmp/verbs" "$tmp/table" >"$tmp/built"
mv "$tmp/built" "$tmp/table"

# ---- nothing is forgotten: readers are told by their tables, verbs by the front door ----
row() { cut -f1 "$tmp/table" | grep -qx -- "$1" || grep -q "^skip	$1	" "$tmp/table"; }
for reader in $(sed -n '/^static const [a-z_]*reader \*const readers/,/};/p' formats/grid/volume.c formats/mesh/mesh_input.c |
    grep -o '&[a-z_]*_reader' | tr -d '&'); do
    case $reader in
    imported_reader | mesh_imported_reader) ;; # these are the importers
    mesh_stream_reader) ;; # m.mesh, t_0000.mesh, .. below
    *) ok "guard_forms.py has a row for $reader" row "${reader%_reader}" ;;
    esac
done
for verb in $("$leafcast" --list-verbs); do
    case $verb in
    import-*) ok "guard_forms.py has a row for $verb" row "$verb" ;;
    bench | convert | export | probe | render | resample | slice | tetrahedralize | verify) ;; # below
    generate) ;; # reads nothing
    info | view)
        ok "$verb has no output" sh -c '! "$1" "$2" --list-options | grep -qE "^--(output|stats|svg|plot|[a-z]*-f64)	"' \
            - "$leafcast" "$verb"
        ;;
    *) ok "$verb, which is new, is tested here" false ;;
    esac
done

cd "$tmp/in" || exit 1
run "$leafcast" generate sphere --dims 20 -o s.nrrd
run "$leafcast" convert s.nrrd -o s.leaf
run "$leafcast" generate sphere --dims 6 --tets -o m.mesh
run "$leafcast" generate sphere --dims 6 --tets --deform 0.3 --steps 3 -o t.mesh
run "$leafcast" convert m.mesh -o m.leaf
ok "inputs are there" [ -s s.leaf ] && [ -s m.leaf ] && [ -s t_0002.mesh ]
ln -s "$tmp/in/s.nrrd" "$tmp/alias/soft"
ln s.nrrd "$tmp/alias/hard"
ln -s "$tmp/in" "$tmp/alias/folder"

for name in s.nrrd ./s.nrrd "$tmp/alias/soft" "$tmp/alias/hard" "$tmp/alias/folder/s.nrrd"; do
    refused "convert to its input as ${name##*/alias/}" "$leafcast" convert s.nrrd -o "$name" --force
done
refused "the same without --force" "$leafcast" convert s.nrrd -o s.nrrd
ln s.nrrd plain
ok "from standard input" sh -c '! "$1" convert - -o plain --force <s.nrrd 2>"$2"' - "$leafcast" "$tmp/err"
ok "says so" says 'plain: is the same file as standard input'
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n' >p.node
printf '1 4 0\n1 1 2 3 4\n' >p.ele
refused "the other file of a pair" "$leafcast" convert p.ele -o p.node --force
refused "and the other way round" "$leafcast" convert p.node -o p.ele --force
refused "a later step" "$leafcast" convert t_0000.mesh t_0001.mesh t_0002.mesh -o t_0002.mesh --force
exits "the first of a pair may have its name's neighbour" 0 "$leafcast" convert p.ele -o p.leaf --allow-empty
rm p.leaf

# ---- each form, each of its files ----
sums() { find . -type f -exec cksum {} + | sort; }
# over VERB ARGUMENT... - each of $files is refused as its output; where sanitizers watch the first and some of the others.
# -q: an importer is not asked what else there is; to start it takes long.
over() {
    for file in $files; do
        [ "$file" = "${files%% *}" ] || one_in 3 || continue
        refused "$given: $1 over $file" "$leafcast" "$@" -o "$file" --force -q
    done
}
# hosted GIVEN - the same by the library. What is read late is refused before, as no treelet file.
hosted() {
    [ -x "$build/tests/tool_convert" ] || { skip "$1: a host" "no tools for this CPU"; return; }
    host() { PATH=$build/libexec:$PATH "$build/tests/tool_convert" "$1" "$2"; }
    exits "$1: a host" 0 host "$1" "$tmp/host.leaf"
    rm -f "$tmp/host.leaf"
    for file in $files; do
        [ "$file" = "${files%% *}" ] || one_in 3 || continue
        sum=$(cksum <"$file")
        run host "$1" "$file"
        ok "$1: a host over $file" refused_by_library
        ok "$1: a host over $file: as before" [ "$(cksum <"$file")" = "$sum" ]
    done
}
refused_by_library() {
    case $rc in
    2) says 'an input' ;;
    8) says 'no treelet file' ;;
    *) false ;;
    esac
}
walk() { # walk READER GIVEN OPTIONS FILES
    reader=$1
    given=$2
    options=$3
    files=$4
    # shellcheck disable=SC2086 # options are words
    set -- "$given" $options
    all=$(sums)
    case $reader in
    surface)
        "$leafcast" tetrahedralize "$@" -o - >/dev/null 2>&1 || { skip "$given" "no TetGen here"; return; }
        over tetrahedralize "$@"
        return
        ;;
    mesh_*) over resample "$@" ;;
    import-*)
        suffix=nrrd
        case $reader in import-exodus | import-cgns) suffix=mesh ;; esac
        exits "$given: $reader" 0 "$leafcast" "$reader" "$@" -o "$tmp/form.$suffix" --force
        over "$reader" "$@"
        ;;
    esac
    exits "$given: convert" 0 "$leafcast" convert "$@" -o "$tmp/form.leaf" --force --allow-empty
    over convert "$@"
    [ "$options" ] || hosted "$given"
    if [ -d "$given" ]; then
        exits "$given: an output in it" 0 "$leafcast" convert "$@" -o "$given/0.leaf"
        exits "$given: once more" 0 "$leafcast" convert "$@" -o "$given/0.leaf" --force
        rm -f "$given/0.leaf"
    fi
    # shellcheck disable=SC2086 # options are words
    exits "$given: info" 0 "$leafcast" info "$given" ${options%% --axis*}
    ok "$given: all files are as before" [ "$(sums)" = "$all" ]
}
cd "$tmp/forms" || exit 1
while IFS= read -r line; do
    reader=$(echo "$line" | cut -f1)
    if [ "$reader" = skip ]; then
        skip "$(echo "$line" | cut -f2)" "$(echo "$line" | cut -f3)"
    else
        walk "$reader" "$(echo "$line" | cut -f2)" "$(echo "$line" | cut -f3)" "$(echo "$line" | cut -f4)"
    fi
done <"$tmp/table"
cd "$tmp/in" || exit 1

refused "resample a mesh" "$leafcast" resample m.mesh -o m.mesh --force
refused "export a treelet file" "$leafcast" export m.leaf -o "$tmp/alias/folder/m.leaf" --format vtu --force
refused "resample a treelet file" "$leafcast" resample m.leaf -o "$tmp/alias/folder/m.leaf" --force
cp s.leaf copy.leaf
refused "repair over the damaged file" "$leafcast" verify s.leaf --repair copy.leaf -o "$tmp/alias/folder/s.leaf" --force
refused "repair over the copy" "$leafcast" verify s.leaf --repair copy.leaf -o copy.leaf --force
ln s.leaf "$tmp/alias/volume.leaf"
refused "repair from the file itself" "$leafcast" verify s.leaf --repair "$tmp/alias/volume.leaf"
rm copy.leaf
cp m.mesh left.nrrd.partial-1
exits "an input that is called as a temporary file is" 0 "$leafcast" resample left.nrrd.partial-1 -o left.nrrd
ok "stays" cmp m.mesh left.nrrd.partial-1
rm left.nrrd left.nrrd.partial-1
if "$leafcast" tetrahedralize p.node -o - >/dev/null 2>&1; then
    refused "tetrahedralize" "$leafcast" tetrahedralize p.node --points -o p.node --force
else
    skip "tetrahedralize" "no TetGen here"
fi

refused "a surface over the volume" "$leafcast" export s.leaf --iso 100 -o s.leaf --format ply --force
refused "a slice over the volume" "$leafcast" slice s.leaf --axis x --format ppm -o s.leaf --force
refused "a slice's statistics over the volume" "$leafcast" slice s.leaf --axis x -o x.png --stats s.leaf --force
refused "a probe's plot over the volume" "$leafcast" probe s.leaf --iso 100 --at 5,5 --segments --svg s.leaf --force
shot() { "$leafcast" render s.leaf --iso 100 --size 16,16 "$@"; }
refused "depths over the volume" shot --depth-f64 s.leaf --force
refused "statistics over the volume" shot --stats "$tmp/alias/folder/s.leaf" --force
ln s.leaf "$tmp/alias/volume.png"
refused "a picture over the volume" shot -o "$tmp/alias/volume.png" --force
refused "depths and statistics in one new file" shot --depth-f64 new --stats "$tmp/alias/folder/new" --force
refused "a picture and depths in one new file" shot -o k.png --depth-f64 k.png
# Time must grow with the pictures, not with their square: outputs of one picture are held against each other.
exits "a long sequence without a folder" 1 timeout 20 "$leafcast" render s.leaf --iso 100 --size 16,16 --turntable 100000 \
    -o no/x.png --depth-f64 no/x.f64
refused "statistics over a picture of a sequence" "$leafcast" render s.leaf --iso-list 90,100 --size 16,16 \
    --depth-f64 d.f64 --stats d_0001.f64
printf '[{"eye": [50,10,10]}]' >path.json
refused "over the camera path" shot --camera-path path.json --stats path.json --force
echo '{"depth_f64": "script"}' >script
run shot --script script --force
ok "over the script: exit 1" [ "$rc" = 1 ]
ok "the answer says so" grep -q 'is an input' "$tmp/out"
echo '{"depth_f64": "s.leaf"}' >script
run shot --script script --force
ok "a line over the volume: exit 1" [ "$rc" = 1 ]
ok "the answer says so" grep -q 'is an input' "$tmp/out"
measure() { "$leafcast" bench intersectors s.leaf --iso 100 --form brief --runs 1 --ray-cells 9 "$@"; }
refused "a table over the volume" measure -o s.leaf --force
refused "a plot over the volume" measure --plot "$tmp/alias/folder/s.leaf" --force
refused "a table and its plot in one new file" measure -o both --plot ./both
printf '{"depth_f64": "a"}\n{"depth_f64": "a"}\n' >script
exits "a line may replace another's output" 0 shot --script script --force
finish
