#!/bin/sh
# pictures.sh - where pictures go: formats, standard output, disks that are full, names that someone else has taken.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
helper=$(dirname "$leafcast")/../libexec/leafcast-write-image
run "$leafcast" generate gyroid --dims 40 -o "$tmp/g.nrrd"
exits "a volume" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
leaf=$tmp/g.leaf
draw() { "$leafcast" render "$leaf" --iso 128 --size 60x40 -q "$@"; }
head_is() { [ "$(head -c "$2" "$1" | od -An -c | tr -d ' \n')" = "$3" ]; }
left() { find "$tmp" -name '*.partial*' -o -name '*.tmp' | grep -q . && return 1 || return 0; }

# ---- formats ----
for name in a.png a.PNG a.ppm a.Ppm a.pfm; do
    exits "$name" 0 draw -o "$tmp/$name"
done
ok "PNG is one" head_is "$tmp/a.png" 4 '211PNG'
ok "letters of any case" cmp "$tmp/a.png" "$tmp/a.PNG"
ok "PPM is one" head_is "$tmp/a.ppm" 12 'P6\n6040\n255'
ok "of three bytes a pixel" [ "$(wc -c <"$tmp/a.ppm")" = $((13 + 60 * 40 * 3)) ]
ok "PFM is one" head_is "$tmp/a.pfm" 14 'PF\n6040\n-1.0\n'
ok "of three floats a pixel" [ "$(wc -c <"$tmp/a.pfm")" = $((14 + 60 * 40 * 12)) ]
exits "--format goes before the name's end" 0 draw --format ppm -o "$tmp/a.dat"
ok "as it says" cmp "$tmp/a.dat" "$tmp/a.ppm"
exits "an unknown format" 2 draw --format jpg -o "$tmp/x.png"
exits "an unknown end" 2 draw -o "$tmp/x.jpg"
for threads in 1 2 7; do
    exits "$threads threads" 0 draw --threads $threads -o "$tmp/t.png" --force
    ok "write the same bytes" cmp "$tmp/t.png" "$tmp/a.png"
done

# ---- without OpenImageIO's helper ----
mkdir "$tmp/bare"
cp "$(dirname "$leafcast")/../libexec/leafcast-render" "$tmp/bare/"
bare() { PATH=/usr/bin:/bin "$tmp/bare/leafcast-render" "$leaf" --iso 128 --size 60x40 -q "$@"; }
if [ -x /usr/bin/leafcast-write-image ]; then
    skip "no helper" "one is installed"
else
    for name in bare.png bare.ppm bare.pfm; do
        exits "$name without the helper" 0 bare -o "$tmp/$name"
        ok "is the same" cmp "$tmp/$name" "$tmp/a.${name#bare.}"
    done
    exits "EXR without it" 3 bare -o "$tmp/bare.exr"
    ok "says what is missing" says 'leafcast-write-image is not there'
fi

# ---- standard output ----
for format in png ppm pfm; do
    draw --format $format -o - >"$tmp/out.$format" 2>"$tmp/err"
    ok "$format on standard output" cmp "$tmp/out.$format" "$tmp/a.$format"
done
draw -o - >"$tmp/out.any" 2>"$tmp/err"
ok "is PNG unless said otherwise" cmp "$tmp/out.any" "$tmp/a.png"
"$leafcast" render "$leaf" --iso-list 100,128,150 --size 60x40 -o "$tmp/q.png" -q
"$leafcast" render "$leaf" --iso-list 100,128,150 --size 60x40 -o - -q >"$tmp/out.many" 2>"$tmp/err"
ok "pictures of a sequence follow one another" sh -c 'cat "$1/q_0000.png" "$1/q_0001.png" "$1/q_0002.png" | cmp - "$1/out.many"' - "$tmp"
ok "no file is named -" [ ! -e - ]
draw --depth-f64 - >"$tmp/out.f64" 2>"$tmp/err"
draw --depth-f64 "$tmp/d.f64"
ok "distances too" cmp "$tmp/out.f64" "$tmp/d.f64"
exits "two outputs there" 2 draw -o - --depth-f64 -
exits "pictures and JSON there" 2 draw -o - --json
echo '{"output": "-"}' >"$tmp/script"
exits "nor has a script's line a picture there" 1 "$leafcast" render "$leaf" --iso 128 --script "$tmp/script"
ok "but its answer" grep -q "standard output is for a script's answers" "$tmp/out"
rc=0
{ draw --size 2000x2000 --format pfm -o - 2>"$tmp/err"; echo $? >"$tmp/rc"; } | head -c 10 >/dev/null
ok "a reader that leaves: exit 1 (got $(cat "$tmp/rc"))" [ "$(cat "$tmp/rc")" = 1 ]
cat >"$tmp/terminal.py" <<'PY'
import os, pty, sys
pid, fd = pty.fork()
if pid == 0:
    os.execvp(sys.argv[1], sys.argv[1:])
said = b""
try:
    while True:
        said += os.read(fd, 4096)
except OSError:
    pass
print(said.decode(errors="replace"))
sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
PY
exits "a terminal gets no picture" 2 python3 "$tmp/terminal.py" "$leafcast" render "$leaf" --iso 128 --size 60x40 -o - -q
ok "and is told so" grep -q 'standard output is a terminal' "$tmp/out"

# ---- opened before rays are traced ----
# A budget that holds no picture would be found next.
for out in "-o $tmp/no/x.png" "-o $tmp/no/x.ppm" "--depth-f64 $tmp/no/x.f64" "--json --stats $tmp/no/x.json"; do
    # shellcheck disable=SC2086 # flag and value
    exits "no folder: $out" 1 draw $out --size 3000x3000 --memory 5M
    ok "is found first" says "$tmp/no/x"
done

# ---- no room ----
# SIGXFSZ ends who does not ignore it.
for out in "-o $tmp/f.png" "-o $tmp/f.ppm" "-o $tmp/f.pfm" "--depth-f64 $tmp/f.f64" ${helper:+"-o $tmp/f.exr"}; do
    case $out in *.exr) [ -x "$helper" ] || continue ;; esac
    exits "over the largest size of a file: $out" 4 sh -c 'ulimit -f 8; exec "$0" render "$1" --iso 128 --view close --size 400x300 -q $2' \
        "$leafcast" "$leaf" "$out"
    ok "says why" says 'File too large'
    ok "leaves nothing" sh -c '[ ! -e "$1" ]' - "${out##* }"
done
ok "under no other name" left
for out in png ppm f64 json; do
    case $out in
    f64) what="--depth-f64 $tmp/small/f.f64" ;;
    json) what="--json --stats $tmp/small/f.json" ;;
    *) what="-o $tmp/small/f.$out" ;;
    esac
    mkdir -p "$tmp/small"
    rc=0
    unshare -m sh -c 'mount -t tmpfs -o size=64k none "$3" 2>/dev/null || exit 77
        head -c 61440 /dev/zero >"$3/full"; [ "$4" != json ] || cat /dev/zero >>"$3/full" 2>/dev/null
        "$0" render "$1" --iso 128 --view close --size 400x300 -q $2 2>&1
        rc=$?; ls "$3"; exit $rc' "$leafcast" "$leaf" "$what" "$tmp/small" $out >"$tmp/out" 2>"$tmp/err" || rc=$?
    if grep -q 'No space left' "$tmp/out"; then
        ok "a full disk, $out: exit 4 (got $rc)" [ "$rc" = 4 ]
        ok "leaves nothing" [ "$(tail -n 1 "$tmp/out")" = full ]
    elif [ $rc = 77 ] || ! unshare -m true 2>/dev/null; then
        skip "a full disk, $out" "may mount none here"
    else
        ok "a full disk, $out (got $rc)" false
    fi
done

# ---- a temporary name that someone has guessed ----
echo precious >"$tmp/victim"
exits "links under names that are easy to guess" 0 sh -c 'for i in 0 1 2 3; do
        ln -s "$3/victim" "$2.partial-$$-$i"; ln -s "$3/victim" "$2.$$.tmp" 2>/dev/null; done
    exec "$0" render "$1" --iso 128 --size 60x40 -q -o "$2"' "$leafcast" "$leaf" "$tmp/l.png" "$tmp"
ok "are not followed" [ "$(cat "$tmp/victim")" = precious ]
ok "the picture is right" cmp "$tmp/l.png" "$tmp/a.png"
rm -f "$tmp"/l.png.*

# ---- planes are part of the budget ----
exits "8000 x 8000 within 50M" 4 "$leafcast" render "$leaf" --iso 128 --size 8000x8000 --memory 50M -o "$tmp/b.png" -q
ok "is refused with a number" says 'bytes would do'
peak() { # peak COMMAND...: exit status, then the most memory it held, in KiB
    python3 -c 'import os, resource, subprocess, sys
rc = subprocess.call(sys.argv[1:], stderr=subprocess.DEVNULL)
print(rc, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)' "$@"
}
held=$(peak "$leafcast" render "$leaf" --iso 128 --size 8000x8000 --memory 50M -o "$tmp/b.png" -q)
ok "before memory is taken ($held KiB)" [ "${held#4 }" -lt 51200 ]
need=$("$leafcast" render "$leaf" --iso 128 --size 1500x1500 --memory 5M -o "$tmp/b.png" -q 2>&1 | sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p')
exits "one byte less than what would do" 4 "$leafcast" render "$leaf" --iso 128 --size 1500x1500 --memory $((need - 1)) -o "$tmp/b.png" -q
exits "what would do" 0 "$leafcast" render "$leaf" --iso 128 --size 1500x1500 --memory "$need" -o "$tmp/b.png" -q
need_depth=$("$leafcast" render "$leaf" --iso 128 --size 1500x1500 --memory 5M --depth-f64 "$tmp/b.f64" -q 2>&1 | sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p')
ok "distances alone need no colours ($need_depth < $need)" [ $((need - need_depth)) -gt $((1500 * 1500 * 3)) ]
# An opaque background makes every pixel opaque: no plane of alpha, in memory or in the file.
clear=$("$leafcast" render "$leaf" --iso 128 --size 1500x1500 --memory 5M --background 0,0,0,0 -o "$tmp/clear.png" -q 2>&1 | sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p')
ok "an opaque picture has no alpha ($need < $clear)" [ $((clear - need)) = $((1500 * 1500 * 4)) ]

# ---- counts ----
cat >"$tmp/long.py" <<'PY'
import sys
open(sys.argv[1], "w").write("[" + ",".join(["{}"] * 70000) + "]")
PY
python3 "$tmp/long.py" "$tmp/path.json"
isos=$(awk 'BEGIN { for (i = 0; i < 60000; i++) printf "%s1", i ? "," : "" }')
exits "70000 views of 60000 isovalues" 2 "$leafcast" render "$leaf" --iso-list "$isos" --camera-path "$tmp/path.json" --size 8x8 -o "$tmp/n.png"
ok "are counted right" says '4200000000 pictures'

# ---- time ----
exits "statistics" 0 draw -o "$tmp/z.png" --stats "$tmp/z.json"
whole() {
    python3 -c 'import json, sys
t = json.load(open(sys.argv[1]))["time_s"]
sys.exit(not (0 < t["write"] and 0 < t["render"] and t["write"] + t["render"] <= t["total"]))' "$tmp/z.json"
}
ok "tell the whole time" whole
exits "a status line" 0 "$leafcast" render "$leaf" --iso 128 --size 60x40 -o "$tmp/y.png"
ok "too" says 'y.png: 60 x 40 in .* s: trace .* (load .*), write '
ok "nothing half-written is left" left
finish
