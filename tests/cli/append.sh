#!/bin/sh
# append.sh - leafcast convert --append: what is added is what each step converted alone is; what cannot be added, or is
# killed on its way, leaves what was there.
. tests/support/tap.sh

out=$tmp/a.leaf
says() { grep -q -- "$1" "$tmp/err"; }
has() { "$leafcast" info "$out" | grep -q "^steps  *$1"; }
sum() { sha256sum <"$out"; }
unchanged() { [ "$(sum)" = "$before" ] && [ -z "$(find "$tmp" -name 'a.leaf?*')" ]; }
# The samples of a step, as bytes.
same_step() {
    "$leafcast" export "$out" --step "$1" -o "$tmp/got.npy" --force -q &&
        "$leafcast" export "$tmp/$2.leaf" -o "$tmp/want.npy" --force -q && cmp -s "$tmp/got.npy" "$tmp/want.npy"
}

i=0
for seed in 5 6 7; do
    "$leafcast" generate noise --dims 40,36,44 --seed "$seed" -o "$tmp/s$i.nrrd" -q
    "$leafcast" convert "$tmp/s$i.nrrd" -o "$tmp/s$i.leaf" -q
    i=$((i + 1))
done

# ---- growing ----

exits "what is not there is made" 0 "$leafcast" convert --append "$tmp/s0.nrrd" -o "$out" --times 0 --treelet 16
ok "says so" says 'a.leaf: 1 step added, 1 now'
exits "a step" 0 "$leafcast" convert --append "$tmp/s1.nrrd" -o "$out" --times 0.5
ok "says so" says 'a.leaf: 1 step added, 2 now'
exits "two at once" 0 "$leafcast" convert --append "$tmp/s2.nrrd" "$tmp/s1.nrrd" -o "$out" --times 2,3 --treelet 16
ok "all are there" has '4, times 0 .. 3'
exits "verify" 0 "$leafcast" verify "$out"
ok "nothing is beside it" [ -z "$(find "$tmp" -name 'a.leaf?*')" ]
for step in "0 s0" "1 s1" "2 s2" "3 s1"; do
    # shellcheck disable=SC2086 # split on purpose
    ok "step $step" same_step $step
done
exits "one that was made without" 0 "$leafcast" convert "$tmp/s0.nrrd" "$tmp/s1.nrrd" -o "$tmp/b.leaf" --compress zstd -q
out=$tmp/b.leaf
size=$(wc -c <"$out")
exits "grows, too" 0 "$leafcast" convert --append "$tmp/s1.nrrd" -o "$out" --times 7
ok "its steps stay numbered" says 'its steps are numbered: times are left out'
ok "three" has '3, times 0 .. 2'
ok "the last is there" same_step 2 s1
ok "and costs next to nothing" [ "$(wc -c <"$out")" -lt $((size + 20000)) ]
exits "verify" 0 "$leafcast" verify "$out"
cp "$out" "$tmp/copy.leaf"
printf x | dd of="$out" bs=1 seek=$(($(wc -c <"$out") - 6000)) conv=notrunc 2>/dev/null
exits "damage" 3 "$leafcast" verify "$out"
exits "is mended from a copy" 0 "$leafcast" verify "$out" --repair "$tmp/copy.leaf"
ok "to the same bytes" cmp -s "$out" "$tmp/copy.leaf"

# ---- what is no further step ----

out=$tmp/a.leaf
before=$(sum)
"$leafcast" generate noise --dims 40,36,45 -o "$tmp/large.nrrd" -q
"$leafcast" generate noise --dims 40,36,44 --type u16 -o "$tmp/u16.nrrd" -q
"$leafcast" generate noise --dims 8 --tets -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" -q
"$leafcast" convert --in-place "$tmp/s0.nrrd" -o "$tmp/i.leaf" -q
cp "$tmp/s0.nrrd" "$tmp/n.leaf"
while IFS='|' read -r name want options said; do
    # shellcheck disable=SC2046 # split on purpose
    exits "$name" "$want" "$leafcast" convert --append -o "$out" $(echo "$options" | sed "s|@|$tmp/|g")
    ok "says why" says "$said"
    ok "nothing changes" unchanged
done <<'ROWS'
another size|2|@large.nrrd --times 9|it has 40 x 36 x 45 samples, expected 40 x 36 x 44
another type|2|@u16.nrrd --times 9|its samples are u16, kept as u16, expected u8, kept as u8
another place|2|@s1.nrrd --times 9 --spacing 2,1,1|it lies elsewhere in the world, or has other spacings
other units|2|@s1.nrrd --times 9 --unit cm|its axes or units are not the file's
other axes|2|@s1.nrrd --times 9 --axes LPS|its axes or units are not the file's
no time|2|@s1.nrrd|it has no time: --times gives it
an early time|2|@s1.nrrd --times 3|its time 3 is not behind the last one, 3
other treelets|2|@s1.nrrd --times 9 --treelet 32|has treelets of 16 cells: --treelet asks for something else
no halo|2|@s1.nrrd --times 9 --halo 0|has a halo: --halo asks for something else
no levels|2|@s1.nrrd --times 9 --levels 1|has coarse levels: --levels asks for something else
compressed|2|@s1.nrrd --times 9 --compress zstd|has samples as they are: --compress asks for something else
--resume|2|@s1.nrrd --times 9 --resume|--append goes without
--in-place|2|@s1.nrrd --times 9 --in-place|--append goes without
--dry-run|2|@s1.nrrd --times 9 --dry-run|--append goes without
--force|2|@s1.nrrd --times 9 --force|--append goes without
a mesh|2|@m.mesh --times 9|it is a mesh, and the file is of none
--coarse|2|@m.mesh --coarse|--append goes without
itself|2|@a.leaf --times 9|a.leaf
ROWS
# A file that never grew stays what it is, too, when nothing is added.
cp "$tmp/s0.leaf" "$tmp/p.leaf"
for other in "p 2 asks.for.something.else" "m 2 it.is.a.grid,.and.the.file.is.of.none" "i 3 its.samples.lie.in.another.file" "n 3 expected.the.mark.of.a.treelet.file"; do
    # shellcheck disable=SC2086 # split on purpose
    set -- $other
    file=$tmp/$1.leaf
    sums=$(sha256sum <"$file")
    exits "to $1" "$2" "$leafcast" convert --append "$tmp/s1.nrrd" -o "$file" --treelet 16
    ok "says why" says "$3"
    ok "nothing changes" [ "$sums" = "$(sha256sum <"$file")" ]
done

ln -s "$tmp/nowhere.leaf" "$tmp/dangling.leaf"
exits "to a link that leads nowhere" 1 "$leafcast" convert --append "$tmp/s1.nrrd" -o "$tmp/dangling.leaf"
ok "says what it is" says 'dangling.leaf: a symbolic link that leads nowhere'
exits "over one" 1 "$leafcast" convert "$tmp/s1.nrrd" -o "$tmp/dangling.leaf"
ok "says so, too" says 'a symbolic link that leads nowhere (--force replaces it)'

# ---- what is told ----

size=$(wc -c <"$out")
exits "a step more" 0 "$leafcast" convert --append "$tmp/s1.nrrd" -o "$out" --times 9
added=$(($(wc -c <"$out") - size))
ok "tells how much it is" grep -q "^file  *[0-9.]* MiB, with $added bytes added, " "$tmp/out"
exits "in JSON, too" 0 "$leafcast" convert --append "$tmp/s1.nrrd" -o "$out" --times 10 --json
ok "of the file" grep -q "\"file_bytes\": $(wc -c <"$out")," "$tmp/out"
ok "of the step" grep -q "\"added_bytes\": $added," "$tmp/out"
mkdir "$tmp/two"
cp "$tmp/s0.nrrd" "$tmp/two/f_1.nrrd"
cp "$tmp/s1.nrrd" "$tmp/two/f_2.nrrd"
exits "a watch" 0 "$leafcast" convert --watch "$tmp/two/f_%d.nrrd" -o "$tmp/two.leaf" --settle 0 --until 2 --json
ok "tells each step in a line" [ "$(grep -c '^{.*}$' "$tmp/out")" = 2 ]
ok "and nothing else" [ "$(wc -l <"$tmp/out")" = 2 ]

# ---- killed, and read meanwhile ----

# Of each of 50 runs some part is done when it is killed: the first 49 parts of the time that one takes.
cat >"$tmp/kill.py" <<'END'
import json, subprocess, sys, time
program, out, *inputs = sys.argv[1:]
def steps():
    told = subprocess.run([program, "info", out, "--json"], capture_output=True)
    return json.loads(told.stdout)["steps"] if told.returncode == 0 else -1
def append(i):
    return subprocess.Popen([program, "convert", "--append", inputs[i % len(inputs)], "-o", out, "-q"])
began = time.monotonic()
append(1).wait()
took = time.monotonic() - began
had, bad, early = steps(), 0, 0
for i in range(50):
    run = append(i)
    time.sleep(took * i / 50)
    run.kill()
    run.wait()
    have = steps()
    bad += have not in (had, had + 1)
    early += have == had
    had = have
print(bad, early, had)
END
for i in 0 1 2; do "$leafcast" generate noise --dims 90,100,110 --seed "$i" -o "$tmp/s$i.nrrd" -q --force; done
out=$tmp/k.leaf
exits "a file to be added to" 0 "$leafcast" convert --append "$tmp/s0.nrrd" -o "$out" --compress zstd
exits "50 runs are killed" 0 python3 "$tmp/kill.py" "$leafcast" "$out" "$tmp/s0.nrrd" "$tmp/s1.nrrd" "$tmp/s2.nrrd"
read -r bad early steps <"$tmp/out"
ok "all that was there is there" [ "$bad" = 0 ]
ok "$early came before the end" [ "$early" -gt 9 ]
for i in 0 2; do "$leafcast" convert "$tmp/s$i.nrrd" -o "$tmp/s$i.leaf" -q --force; done
exits "what is left is sound" 0 "$leafcast" verify "$out"
exits "and grows" 0 "$leafcast" convert --append "$tmp/s2.nrrd" -o "$out"
ok "by what it should" same_step "$steps" s2
ok "the first is what it was" same_step 0 s0
run find "$tmp" -name 'k.leaf?*'
ok "nothing is beside it" [ ! -s "$tmp/out" ]

# ---- as files come ----

mkdir "$tmp/run"
out=$tmp/w.leaf
for i in 0 1 2; do "$leafcast" generate noise --dims 40,36,44 --seed "$i" -o "$tmp/s$i.nrrd" -q --force; done
for i in 0 1 2; do "$leafcast" convert "$tmp/s$i.nrrd" -o "$tmp/s$i.leaf" -q --force; done
"$leafcast" convert --watch "$tmp/run/f_%d.nrrd" -o "$out" --until 12 --settle 0.2 -q 2>"$tmp/watched" &
pid=$!
# Some come whole, some in two parts, some of them while nobody watches.
for i in 1 2 3 4 5 6 7 8 9 10 11 12; do
    from=$tmp/s$((i % 3)).nrrd
    if [ $((i % 4)) = 1 ]; then
        head -c 30000 "$from" >"$tmp/run/f_$i.nrrd"
        sleep 0.1
        tail -c +30001 "$from" >>"$tmp/run/f_$i.nrrd"
    else
        cp "$from" "$tmp/run/f_$i.part"
        mv "$tmp/run/f_$i.part" "$tmp/run/f_$i.nrrd"
    fi
    if [ "$i" = 6 ]; then
        sleep 0.3
        kill -TERM "$pid"
        wait "$pid"
        ended=$?
        [ ! -e "$out" ] || cp "$out" "$tmp/half.leaf"
        "$leafcast" convert --watch "$tmp/run/f_%d.nrrd" -o "$out" --until 12 --settle 0.2 -q 2>"$tmp/watched" &
        pid=$!
    fi
done
ok "a signal ends it (got $ended)" [ "$ended" -gt 128 ]
wait "$pid"
rc=$?
ok "enough steps end it, too (got $rc)" [ "$rc" = 0 ]
ok "all have come" has '12, times 0 .. 11'
for i in 1 5 6 7 10 12; do
    ok "file $i is in its place" same_step $((i - 1)) s$((i % 3))
done
exits "verify" 0 "$leafcast" verify "$out"
exits "what has enough" 0 "$leafcast" convert --watch "$tmp/run/f_%d.nrrd" -o "$out" --until 3
echo nothing >"$tmp/run/f_13.nrrd"
exits "a file that cannot be read" 3 "$leafcast" convert --watch "$tmp/run/f_%d.nrrd" -o "$out" --settle 0
ok "is named" says 'f_13.nrrd'
ok "nothing is added" has 12
rm "$tmp/run/f_13.nrrd"
mkdir "$tmp/late"
cp "$tmp/s0.nrrd" "$tmp/late/f_1.nrrd"
cp "$tmp/s0.nrrd" "$tmp/late/f_3.nrrd"
"$leafcast" convert --watch "$tmp/late/f_*.nrrd" -o "$tmp/l.leaf" --settle 0 --until 3 -q 2>"$tmp/err" &
pid=$!
steps_of() { "$leafcast" info "$1" 2>/dev/null | sed -n 's/^steps  *\([0-9]*\).*/\1/p'; }
for _ in $(seq 1 100); do
    [ "$(steps_of "$tmp/l.leaf")" != 2 ] || break
    sleep 0.1
done
cp "$tmp/s1.nrrd" "$tmp/late/f_2.nrrd"
wait "$pid"
rc=$?
ok "a file that comes late ends it (got $rc)" [ "$rc" = 2 ]
ok "says behind which" says 'f_3.nrrd: a file before it came after it was added'
exits "several patterns" 2 "$leafcast" convert --watch "$tmp/s0.nrrd" "$tmp/s1.nrrd" -o "$out"
exits "times" 2 "$leafcast" convert --watch "$tmp/s0.nrrd" -o "$out" --times 3
exits "no watch" 2 "$leafcast" convert "$tmp/s0.nrrd" -o "$out" --until 3
ok "says so" says 'go with --watch'

finish
