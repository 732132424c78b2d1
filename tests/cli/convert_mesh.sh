#!/bin/sh
# convert_mesh.sh - leafcast convert of meshes: flags, exit codes, what it says and leaves behind.
. tests/support/tap.sh

in=$tmp/bucky.mesh
out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/$2"; }
left() { [ "$(find "$tmp" -name '*.leaf*' | wc -l)" = "$1" ]; }
run "$leafcast" generate buckyball --tets --dims 32 -o "$in"

exits "a mesh stream" 0 "$leafcast" convert "$in" -o "$out"
ok "tells what came in" says '^input  *32768 points, 178746 tets$' out
ok "tells the field" says '^field  *buckyball$' out
ok "tells the file's size" says '^file .* bytes a tet$' out
ok "tells the mesh" says '^mesh  *178746 tets, 32768 vertices, [1-9][0-9]* treelets$' out
ok "at most 20 bytes a tet" awk '/^file/ { exit !($4 < 20) }' "$tmp/out"
ok "says nothing else" [ ! -s "$tmp/err" ]
ok "leaves one file" left 1
exits "verify" 0 "$leafcast" verify "$out"
exits "an existing output" 1 "$leafcast" convert "$in" -o "$out"
ok "and the way out is told" says '--force' err
for how in "--threads 1" "--threads 3 --memory 9M" "--memory 7M" "--json"; do
    # shellcheck disable=SC2086 # split on purpose
    exits "convert $how" 0 "$leafcast" convert "$in" -o "$tmp/b.leaf" --force $how
    ok "gives the same bytes" cmp -s "$out" "$tmp/b.leaf"
done
ok "--json counts" says '"tets": 178746' out
ok "from a pipe" sh -c '"$1" generate buckyball --tets --dims 32 -o - | "$1" convert - -o "$2" --force >"$3"' - "$leafcast" "$tmp/b.leaf" "$tmp/out"
ok "the same bytes" cmp -s "$out" "$tmp/b.leaf"
exits "zstd" 0 "$leafcast" convert "$in" -o "$tmp/z.leaf" --compress zstd:5
exits "verify it" 0 "$leafcast" verify "$tmp/z.leaf"
ok "it is smaller" [ "$(wc -c <"$tmp/z.leaf")" -lt "$(wc -c <"$out")" ]
exits "small treelets" 0 "$leafcast" convert "$in" -o "$tmp/c.leaf" --treelet-tets 500 --leaf-tets 4
ok "makes more of them" [ "$(sed -n 's/^mesh.* \([0-9]*\) treelets/\1/p' "$tmp/out")" -gt 400 ]
exits "verify them" 0 "$leafcast" verify "$tmp/c.leaf"
exits "treelets too large" 2 "$leafcast" convert "$in" -o "$tmp/d.leaf" --treelet-tets 16385
rm -f "$tmp"/*.leaf

exits "--dry-run" 0 "$leafcast" convert "$in" --dry-run
ok "tells input, memory, spilling" [ "$(grep -c '^input\|^memory\|^spilled' "$tmp/out")" = 3 ]
ok "writes nothing" left 0
exits "too little memory" 4 "$leafcast" convert "$in" -o "$out" --memory 1M
ok "says how much would do" says 'this mesh needs [0-9]* MiB' err
ok "leaves nothing" left 0
exits "less than this mesh needs" 4 "$leafcast" convert "$in" -o "$out" --memory 3M --threads 2
least=$(sed -n 's/.*this mesh needs \([0-9]*\) MiB.*/\1/p' "$tmp/err")
exits "what was said to do" 0 "$leafcast" convert "$in" -o "$out" --memory "${least}M" --threads 2
head -c 2000000 "$in" >"$tmp/short.mesh"
exits "a mesh cut short" 3 "$leafcast" convert "$tmp/short.mesh" -o "$out" --force
ok "names the file" says 'short.mesh' err
exits "a mesh cut short, and a good file there" 3 "$leafcast" convert "$tmp/short.mesh" -o "$out" --force
ok "which stays" "$leafcast" verify "$out" -q
rm -f "$out"

# Nothing but one flat tet and one with a vertex twice; TetGen, ids from 1.
printf '4 3 1 0\n1 0 0 0 5\n2 1 0 0 6\n3 0 1 0 7\n4 1 1 0 8\n' >"$tmp/flat.node"
printf '2 4 0\n1 1 2 3 4\n2 1 2 2 4\n' >"$tmp/flat.ele"
exits "a flat mesh" 0 "$leafcast" convert "$tmp/flat.ele" -o "$out"
ok "is kept and counted" says '^kept  *1 flat tets, 0 inverted ones$' out
ok "what is left out, too" says '^left out  *1 tets with a vertex twice' out
exits "verify it" 0 "$leafcast" verify "$out"
exits "a field that is not there" 2 "$leafcast" convert "$tmp/flat.ele" -o "$out" --force --field heat
ok "is named" says 'heat' err

# Stopped by a signal in the middle of it: nothing is left. Its input has no end.
rm -f "$tmp"/*.leaf
mkfifo "$tmp/endless"
"$leafcast" convert - -o "$out" <"$tmp/endless" >"$tmp/out" 2>"$tmp/err" &
child=$!
(printf 'LEAFCAST MESH 1\npoints: 4000000000\ntets: 1\n\n' && cat /dev/zero) 2>"$tmp/cat" \
    >"$tmp/endless" &
feeder=$!
sleep 0.3
ok "while it reads, nothing stands under the final name" [ ! -e "$out" ]
kill -TERM $child
rc=0
wait $child || rc=$?
kill $feeder 2>"$tmp/kill"
ok "a signal ends it with 128 + its number (got $rc)" [ $rc = 143 ]
ok "and leaves nothing behind" left 0
ok "and is told" says 'signal 15' err

finish
