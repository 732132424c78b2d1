#!/bin/sh
# outputs.sh - every verb, every kind of output, and a hostile place to write it: a full disk, a limit on the size of
# files, a folder that takes nothing, symbolic links under the temporary names, a name that is "-".
#
# The small disks are tmpfs in a mount namespace of this script's own, which ends with it.
# marks: long
if [ -z "${OUTPUTS_ALONE-}" ]; then
    for how in "unshare -m" "unshare -rm"; do
        # shellcheck disable=SC2086 # split on purpose
        if $how sh -c 'mount -t tmpfs tmpfs /mnt' 2>/dev/null; then
            # shellcheck disable=SC2086
            OUTPUTS_ALONE=yes exec $how sh "$0"
        fi
    done
    OUTPUTS_ALONE=no
fi
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
in=$tmp/in
disk=$tmp/disk
mkdir "$in" "$disk"
run "$leafcast" generate noise --dims 100 --type u16 -o "$in/g.nrrd"
run "$leafcast" generate noise --dims 24 --tets -o "$in/m.mesh"
run "$leafcast" convert "$in/g.nrrd" -o "$in/g.leaf"
cp "$in/g.leaf" "$in/h.leaf"
ok "inputs are there" [ -s "$in/g.leaf" ]
awk 'BEGIN { srand(1); print 6000, 3, 0, 0
    for (i = 1; i <= 6000; i++) print i, rand(), rand(), rand() }' >"$in/p.node"

# What can be written: a line each, NAME:FILE:VERB WORDS, FILE being put behind the last word.
outputs() {
    cat <<LIST
generate a volume:a.nrrd:generate sphere --dims 160 -o
generate a mesh:a.mesh:generate sphere --dims 40 --tets -o
convert a volume:a.leaf:convert $in/g.nrrd -o
convert a volume, compressed:z.leaf:convert $in/g.nrrd --compress zstd:1 -o
convert a volume, spilling:s.leaf:convert $in/g.nrrd --memory 4M --threads 1 -o
convert a mesh:m.leaf:convert $in/m.mesh -o
convert a mesh, spilling:n.leaf:convert $in/m.mesh --memory 5M --threads 1 -o
repair:v.leaf:verify $in/g.leaf --repair $in/h.leaf -o
resample a mesh:r.nrrd:resample $in/m.mesh --dims 100 -o
export samples:x.vti:export $in/g.leaf -o
export a surface:x.ply:export $in/g.leaf --iso 30000 -o
depths:d.f64:render $in/g.leaf --iso 30000 --size 512,512 --depth-f64
statistics:stats.json:render $in/g.leaf --iso 30000 --size 16,16 --stats
PNG:p.png:render $in/g.leaf --iso 30000 --size 1600,1600 -o
PPM:p.ppm:render $in/g.leaf --iso 30000 --size 512,512 -o
PFM:p.pfm:render $in/g.leaf --iso 30000 --size 512,512 -o
a table:t.csv:bench intersectors $in/g.leaf --iso 30000 --form brief --runs 1 --ray-cells 100 -o
a plot:t.svg:bench intersectors $in/g.leaf --iso 30000 --form brief --runs 1 --ray-cells 100 --plot
LIST
    if "$leafcast" render "$in/g.leaf" --iso 30000 --size 16,16 -o "$tmp/probe.exr" >/dev/null 2>&1; then
        echo "EXR:p.exr:render $in/g.leaf --iso 30000 --size 512,512 -o"
    fi
    if "$leafcast" tetrahedralize "$in/p.node" -o - >/dev/null 2>&1; then
        echo "tetrahedralize:t.mesh:tetrahedralize $in/p.node -o"
    fi
}
outputs >"$tmp/list"
grep -q '^EXR' "$tmp/list" || skip "EXR" "no OpenImageIO here"
grep -q '^tetra' "$tmp/list" || skip "tetrahedralize" "no TetGen here"

# each FUNCTION - call it with NAME, FILE and the words, for each output.
each() {
    # Not by a pipe, which would count in a process of its own.
    while IFS=: read -r name file words <&3; do
        # shellcheck disable=SC2086 # split on purpose
        "$1" "$name" "$disk/$file" "$leafcast" $words "$disk/$file"
    done 3<"$tmp/list"
}
there() { ls -A "$disk"; }

fails_full() {
    name=$1
    shift 2
    exits "$name, $where" 4 "$@"
    ok "$name, $where: the reason is told" says 'No space left on device\|File too large'
    ok "$name, $where: nothing is left" [ "$(there)" = "$before" ]
}
fails_limited() {
    name=$1
    shift 2
    # The messages go through a pipe: the limit is on them, too.
    rc=0
    (ulimit -f 1 && "$@" 2>&1 >/dev/null </dev/null || echo "exit $?") | cat >"$tmp/err"
    ok "$name, a limit of one block: exit 4" says '^exit 4$'
    ok "$name, a limit of one block: the reason is told" says 'File too large'
    ok "$name, a limit of one block: nothing is left" [ -z "$(there)" ]
}
each fails_limited

fails_read_only() {
    name=$1
    shift 2
    exits "$name, a disk that is read-only" 1 timeout 20 "$@"
    ok "$name, a disk that is read-only: the reason is told" says 'Read-only file system'
}
if [ "$OUTPUTS_ALONE" = yes ]; then
    mount -t tmpfs -o size=300k tmpfs "$disk"
    where="a small disk"
    before=
    # Those whose outputs are larger than the disk.
    cp "$tmp/list" "$tmp/all"
    grep -v '^statistics\|^a table\|^a plot' "$tmp/all" >"$tmp/list"
    each fails_full
    cp "$tmp/all" "$tmp/list"
    dd if=/dev/zero of="$disk/filler" bs=4k 2>/dev/null
    where="a full disk"
    before=filler
    each fails_full
    rm "$disk/filler"
    mount -o remount,ro "$disk"
    each fails_read_only
    umount "$disk"
else
    skip "full disks" "mount is not allowed here"
    skip "a disk that is read-only" "mount is not allowed here"
fi

# What would take for ever finds its output taken at once.
for words in "generate noise --dims 8000 -o" "generate noise --tets --dims 400 -o" "resample $in/m.mesh --dims 3000 -o" \
    "render $in/g.leaf --iso 30000 --size 4000,4000 --repeat 1000 --stats" \
    "render $in/g.leaf --iso 30000 --size 4000,4000 --repeat 1000 --depth-f64" \
    "bench intersectors $in/g.leaf --iso 30000 --form full --runs 900 --plot"; do
    echo mine >"$disk/taken"
    # shellcheck disable=SC2086 # split on purpose
    exits "taken: $words" 1 timeout 20 "$leafcast" $words "$disk/taken"
    ok "says so" says 'exists'
    # shellcheck disable=SC2086
    exits "no folder: $words" 1 timeout 20 "$leafcast" $words "$disk/none/x"
    ok "says so" says 'No such file'
    ok "it is as before" [ "$(cat "$disk/taken")" = mine ]
done
rm "$disk/taken"

# Symbolic links under all temporary names that can be guessed lead to what must not be written.
echo precious >"$tmp/victim"
passes_links() {
    name=$1
    file=$2
    shift 2
    for i in 1 2 3 4 5 6 7 8; do
        ln -s "$tmp/victim" "$file.partial-$i"
    done
    exits "$name, links in the way" 0 "$@"
    ok "$name, links in the way: it is there" [ -f "$file" ] && [ ! -L "$file" ]
    ok "$name, links in the way: nothing is written through them" [ "$(cat "$tmp/victim")" = precious ]
    ok "$name, links in the way: nothing else is there" [ "$(there | wc -l)" = 9 ]
    rm -f "$disk"/*
    # A link under the final name is replaced, not followed.
    ln -s "$tmp/victim" "$file"
    exits "$name, a link under its name" 1 "$@"
    exits "$name, a link under its name, --force" 0 "$@" --force
    ok "$name: the link is replaced" [ ! -L "$file" ]
    ok "$name: what it led to is as before" [ "$(cat "$tmp/victim")" = precious ]
    rm -f "$disk"/*
}
each passes_links

# No file is ever named "-".
cd "$disk" || exit 1
exits "convert -o -" 2 "$leafcast" convert "$in/g.nrrd" -o -
ok "says why" says 'a treelet file cannot go to standard output'
exits "statistics to -" 2 "$leafcast" render "$in/g.leaf" --iso 30000 --stats -
exits "a table to -" 2 "$leafcast" bench intersectors "$in/g.leaf" -o -
exits "a plot to -" 2 "$leafcast" bench intersectors "$in/g.leaf" --plot -
for words in "generate sphere --dims 8 -o" "generate sphere --dims 8 --tets -o" "resample $in/m.mesh --dims 8 -o"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "$words -" 0 "$leafcast" $words -
    ok "it is on standard output" [ -s "$tmp/out" ]
done
ok "there is no file -" [ -z "$(there)" ]
exits "./- is a file" 0 "$leafcast" generate sphere --dims 8 -o ./-
ok "it is there" [ -s ./- ]
rm ./-

# Standard output that takes nothing, or is closed.
full_out() {
    rc=0
    "$@" >/dev/full 2>"$tmp/err" </dev/null || rc=$?
}
for words in "--help" "--version" "convert --help" "convert --version" "info $in/g.leaf" "info $in/g.leaf --json" \
    "verify $in/g.leaf" "verify $in/g.leaf --json" "convert $in/g.nrrd --dry-run" "convert $in/g.nrrd --dry-run --json" \
    "convert $in/m.mesh -o x.leaf --force" "generate sphere --dims 8 -o -" "resample $in/m.mesh --dims 8 -o x.nrrd --force" \
    "probe $in/g.leaf --iso 30000 --point 50,50,50" "render $in/g.leaf --iso 30000 --size 16,16 --json --depth-f64 x.f64 --force" \
    "render $in/g.leaf --iso 30000 --size 16,16 -o - --format png" \
    "bench intersectors $in/g.leaf --iso 30000 --form brief --runs 1 --ray-cells 100"; do
    # shellcheck disable=SC2086 # split on purpose
    full_out "$leafcast" $words
    ok "$words >/dev/full: exit 4 (got $rc)" [ "$rc" = 4 ]
    ok "says why" says 'No space left on device\|I/O error'
done
rm -f "$disk"/*
"$leafcast" generate sphere --dims 8 -o kept.nrrd
sh -c '"$1" generate sphere --dims 8 -v -o closed.nrrd 0<&- >&- 2>&-' - "$leafcast"
ok "closed descriptors: messages are not written into the output" cmp kept.nrrd closed.nrrd
rm closed.nrrd
# The output would be opened as descriptor 2.
sh -c '"$1" generate sphere --dims 8 -v -o closed.nrrd 2>&-' - "$leafcast"
ok "standard error closed: messages are not written into the output" cmp kept.nrrd closed.nrrd
sh -c '"$1" convert kept.nrrd -o closed.leaf 0<&- >&- 2>&-' - "$leafcast"
ok "results that go nowhere are a failure" [ $? = 1 ]
exits "but not in the treelet file" 0 "$leafcast" verify closed.leaf
finish
