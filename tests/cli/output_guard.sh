#!/bin/sh
# output_guard.sh - no verb writes over what it reads, or twice to one file, whatever the names and with --force.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
# refused NAME FILE COMMAND... - exit 2, a word about it, FILE as it was, nothing new in the folder.
refused() {
    name=$1
    kept=$2
    shift 2
    before=$(ls -A "$tmp/in")
    sum=$(cksum <"$kept")
    exits "$name" 2 "$@"
    ok "$name: says so" says 'an input\|an output\|two outputs'
    ok "$name: the file is as before" [ "$(cksum <"$kept")" = "$sum" ]
    ok "$name: nothing else is there" [ "$(ls -A "$tmp/in")" = "$before" ]
}

mkdir "$tmp/in" "$tmp/alias"
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
    refused "convert to its input as ${name##*/alias/}" s.nrrd "$leafcast" convert s.nrrd -o "$name" --force
done
refused "the same without --force" s.nrrd "$leafcast" convert s.nrrd -o s.nrrd
ok "from standard input" sh -c '! "$1" convert - -o s.nrrd --force <s.nrrd 2>"$2"' - "$leafcast" "$tmp/err"
ok "says so" says 's.nrrd: is the same file as standard input'
head -c 64 /dev/zero >raw.bin
printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: raw.bin\n' >d.nhdr
refused "the samples beside a header" raw.bin "$leafcast" convert d.nhdr -o raw.bin --force
printf 'NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = raw.bin\n' >d.mhd
refused "the same of MetaImage" raw.bin "$leafcast" convert d.mhd -o raw.bin --force
printf '0 1 2 3' >x.txt
refused "an axis' file" x.txt "$leafcast" convert raw.bin --dims 4,4,4 --type u8 --axis-x x.txt -o x.txt --force
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n' >p.node
printf '1 4 0\n1 1 2 3 4\n' >p.ele
refused "the other file of a pair" p.node "$leafcast" convert p.ele -o p.node --force
refused "and the other way round" p.ele "$leafcast" convert p.node -o p.ele --force
refused "a later step" t_0002.mesh "$leafcast" convert t_0000.mesh t_0001.mesh t_0002.mesh -o t_0002.mesh --force
exits "the first of a pair may have its name's neighbour" 0 "$leafcast" convert p.ele -o p.leaf --allow-empty
rm p.leaf

refused "resample a mesh" m.mesh "$leafcast" resample m.mesh -o m.mesh --force
refused "export a treelet file" m.leaf "$leafcast" export m.leaf -o "$tmp/alias/folder/m.leaf" --format vtu --force
refused "resample a treelet file" m.leaf "$leafcast" resample m.leaf -o "$tmp/alias/folder/m.leaf" --force
cp m.mesh left.nrrd.partial-1
exits "an input that is called as a temporary file is" 0 "$leafcast" resample left.nrrd.partial-1 -o left.nrrd
ok "stays" cmp m.mesh left.nrrd.partial-1
rm left.nrrd left.nrrd.partial-1
if "$leafcast" tetrahedralize p.node -o - >/dev/null 2>&1; then
    refused "tetrahedralize" p.node "$leafcast" tetrahedralize p.node --points -o p.node --force
else
    skip "tetrahedralize" "no TetGen here"
fi

shot() { "$leafcast" render s.leaf --iso 100 --size 16,16 "$@"; }
refused "depths over the volume" s.leaf shot --depth-f64 s.leaf --force
refused "statistics over the volume" s.leaf shot --stats "$tmp/alias/folder/s.leaf" --force
ln s.leaf "$tmp/alias/volume.png"
refused "a picture over the volume" s.leaf shot -o "$tmp/alias/volume.png" --force
refused "depths and statistics in one new file" s.leaf shot --depth-f64 new --stats "$tmp/alias/folder/new" --force
refused "a picture and depths in one new file" s.leaf shot -o k.png --depth-f64 k.png
# Time must grow with the pictures, not with their square: outputs of one picture are held against each other.
exits "a long sequence without a folder" 1 timeout 20 "$leafcast" render s.leaf --iso 100 --size 16,16 --turntable 100000 \
    -o no/x.png --depth-f64 no/x.f64
refused "statistics over a picture of a sequence" s.leaf "$leafcast" render s.leaf --iso-list 90,100 --size 16,16 \
    --depth-f64 d.f64 --stats d_0001.f64
printf '[{"eye": [50,10,10]}]' >path.json
refused "over the camera path" path.json shot --camera-path path.json --stats path.json --force
echo '{"depth_f64": "script"}' >script
run shot --script script --force
ok "over the script: exit 1" [ "$rc" = 1 ]
ok "the answer says so" grep -q 'is an input' "$tmp/out"
echo '{"depth_f64": "s.leaf"}' >script
run shot --script script --force
ok "a line over the volume: exit 1" [ "$rc" = 1 ]
ok "the answer says so" grep -q 'is an input' "$tmp/out"
measure() { "$leafcast" bench intersectors s.leaf --iso 100 --form brief --runs 1 --ray-cells 9 "$@"; }
refused "a table over the volume" s.leaf measure -o s.leaf --force
refused "a plot over the volume" s.leaf measure --plot "$tmp/alias/folder/s.leaf" --force
refused "a table and its plot in one new file" s.leaf measure -o both --plot ./both
printf '{"depth_f64": "a"}\n{"depth_f64": "a"}\n' >script
exits "a line may replace another's output" 0 shot --script script --force
finish
