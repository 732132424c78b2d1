#!/bin/sh
# names.sh - names of any bytes: files, fields, data sets. JSON stays JSON, and a terminal is told nothing by a name.
# marks: long
. tests/support/tap.sh

hostile=$(printf 'a\377b\033[31mc\nd')
dir=$tmp/$hostile
mkdir "$dir"
# Neither escapes nor bytes that are no UTF-8 on standard output and error.
calm() {
    for f in out err; do
        ! LC_ALL=C grep -q "$(printf '\033')" "$tmp/$f" || return 1
        iconv -f UTF-8 -t UTF-8 "$tmp/$f" >/dev/null 2>&1 || return 1
    done
}
is_json() { python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$tmp/out"; }
# fine NAME STATUS COMMAND... - ends so, says nothing hostile; with --json, says JSON.
fine() {
    exits "$@"
    ok "$1: nothing hostile is printed" calm
    case " $* " in
        *" --json "*) ok "$1: JSON" is_json ;;
    esac
}

"$leafcast" generate sphere --dims 8 -o "$dir/a$hostile.nrrd"
tail -c 512 "$dir/a$hostile.nrrd" >"$dir/${hostile}_8x8x8_uint8.raw"
python3 - "$tmp" <<'PY'
import sys
folder = sys.argv[1] + "/"
name = b"a\xffb\x1b[31mc"
nodes = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n" \
    b"$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
data = b"$NodeData\n1\n\"%s\"\n1\n0\n3\n0\n1\n4\n1 0\n2 1\n3 2\n4 3\n$EndNodeData\n"
open(folder + "a.msh", "wb").write(nodes + data % name + data % b"other")
long = "\u00e4".encode() * 40   # 80 bytes: a cut at 63 falls into a character
open(folder + "long.msh", "wb").write(nodes + data % (b"x" + long))
open(folder + "a.vtk", "wb").write(
    b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
    b"CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS " + name + b" float 1\nLOOKUP_TABLE default\n0 1 2 3\n")
open(folder + "content.nrrd", "wb").write(
    b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ncontent: " + name + b"\n\n" + bytes(range(64)))
PY
for json in "" --json; do
    # shellcheck disable=SC2086 # no argument where it is empty
    for input in "$dir/a$hostile.nrrd" "$dir/${hostile}_8x8x8_uint8.raw" "$tmp/a.msh" "$tmp/long.msh" "$tmp/a.vtk" \
        "$tmp/content.nrrd"; do
        fine "convert $json" 0 "$leafcast" convert "$input" -o "$dir/x.leaf" --force $json
        fine "info $json" 0 "$leafcast" info "$dir/x.leaf" $json
        fine "info of an input $json" 0 "$leafcast" info "$input" $json
        fine "verify $json" 0 "$leafcast" verify "$dir/x.leaf" $json
    done
done
fine "convert --fields all" 0 "$leafcast" convert "$tmp/a.msh" --fields all -o "$dir/x.leaf" --force --json
ok "has both" grep -q '"a.b.\[31mc"' "$tmp/out"
fine "convert --field, as it is" 0 "$leafcast" convert "$tmp/a.msh" --field "$(printf 'a\377b\033[31mc')" \
    -o "$dir/x.leaf" --force --json
fine "render of such a field" 0 "$leafcast" render "$dir/x.leaf" --iso 1.5 --field "$(printf 'a\357\277\275b\357\277\275[31mc')" \
    --size 16x16 -o "$dir/x$hostile.png"
fine "convert of a field that is not there" 2 "$leafcast" convert "$tmp/a.msh" --field "$hostile" -o "$dir/x.leaf" --force
fine "resample" 0 "$leafcast" resample "$tmp/a.msh" --dims 4 -o "$dir/x$hostile.nrrd" --json
fine "convert" 0 "$leafcast" convert "$dir/a$hostile.nrrd" -o "$dir/x$hostile.leaf" --force
fine "render" 0 "$leafcast" render "$dir/x$hostile.leaf" --iso 128 --size 16x16 -o "$dir/y$hostile.png" --json
fine "probe" 0 "$leafcast" probe "$dir/x$hostile.leaf" --iso 128 --at 8,8 --json
fine "probe in words" 0 "$leafcast" probe "$dir/x$hostile.leaf" --iso 128 --at 8,8
for verb in info verify "convert -o $tmp/x" "resample -o $tmp/x" "tetrahedralize -o $tmp/x"; do
    # shellcheck disable=SC2086 # split on purpose
    fine "$verb of what is not there" 1 "$leafcast" $verb "$dir/none$hostile"
    # shellcheck disable=SC2086
    fine "$verb of what is not there" 1 "$leafcast" $verb "$dir/none$hostile" --json
done
fine "render of what is not there" 1 "$leafcast" render "$dir/none$hostile" --iso 1 -o "$tmp/x.png" --json
printf 'hello' >"$dir/h$hostile"
fine "an unknown format" 3 "$leafcast" convert "$dir/h$hostile" -o "$tmp/x.leaf" --json
finish
