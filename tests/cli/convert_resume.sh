#!/bin/sh
# convert_resume.sh - conversions of grids that end early, in any way, and go on with --resume to the same bytes.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
run "$leafcast" generate noise --dims 120,100,400 --type u16 -o "$tmp/g.nrrd"
run "$leafcast" generate gyroid --dims 100,80,300 --type f32 -o "$tmp/f.nrrd"
gzip -k "$tmp/f.nrrd"
for n in 1 2 3; do run "$leafcast" generate noise --dims 70,60,300 --seed $n -o "$tmp/s$n.nrrd"; done
out=$tmp/x.leaf

# left SHARE - what a run leaves whose output may have so many blocks of 512 bytes, saved whenever it can be.
limited() {
    blocks=$1
    shift
    # shellcheck disable=SC2016 # for the inner shell
    run sh -c 'ulimit -f "$1"; shift; exec "$@"' sh "$blocks" "$leafcast" convert "$@" -o "$out" --checkpoint 0
}
alone() { [ "$(find "$tmp" -maxdepth 1 -name 'x.leaf*' | wc -l)" = 1 ]; }

# goes_on NAME ARGUMENTS... - ends early at several sizes of the output, and goes on, at once and by and by.
goes_on() {
    name=$1
    shift
    run "$leafcast" convert "$@" -o "$tmp/good.leaf" --force
    size=$(($(wc -c <"$tmp/good.leaf") / 512))
    for eighths in 5 6 7; do
        one_in 2 || continue # each of them for other arguments
        limited $((size * eighths / 8)) "$@"
        ok "$name: $eighths/8 of the disk: exit 4 (got $rc)" [ "$rc" = 4 ]
        ok "tells how to go on" says 'the same command with --resume goes on'
        ok "there is no output" [ ! -e "$out" ]
        exits "going on" 0 "$leafcast" convert "$@" -o "$out" --resume
        ok "says from where" says 'x.leaf: goes on at [1-9][0-9]* %'
        ok "the same bytes" cmp "$tmp/good.leaf" "$out"
        ok "and nothing else" alone
        rm -f "$out"
    done
    for eighths in 5 6 7; do limited $((size * eighths / 8)) "$@" --resume; done
    exits "by and by" 0 "$leafcast" convert "$@" -o "$out" --resume
    ok "the same bytes" cmp "$tmp/good.leaf" "$out"
    rm -f "$out"
}
goes_on "a grid" "$tmp/g.nrrd"
goes_on "small treelets, no halo" "$tmp/g.nrrd" --treelet 16 --halo 0
goes_on "steps" "$tmp/s1.nrrd" "$tmp/s2.nrrd" "$tmp/s3.nrrd"
goes_on "little memory" "$tmp/g.nrrd" --memory 8M --threads 1

# What is done does not depend on memory and threads.
run "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/good.leaf" --force
size=$(($(wc -c <"$tmp/good.leaf") / 512))
limited $((size / 2)) "$tmp/g.nrrd" --memory 8M --threads 1
exits "with more memory" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --resume --threads 3
ok "the same bytes" cmp "$tmp/good.leaf" "$out"
rm "$out"
limited $((size / 2)) "$tmp/g.nrrd" --threads 3
exits "with less" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --resume --memory 8M --threads 1
ok "the same bytes" cmp "$tmp/good.leaf" "$out"
rm "$out"

# Other parameters, other inputs.
cp "$tmp/g.nrrd" "$tmp/h.nrrd"
limited $((size / 2)) "$tmp/h.nrrd" --unit mm --name it
exits "not asked to go on" 1 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --unit mm --name it
ok "both ways out are told" says 'x.leaf.unfinished: work that ended early is there, [0-9]* % done: --resume goes on with it, --force begins again'
exits "another unit" 2 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --name it --unit cm --resume
ok "is named" says '--unit was "mm" when the unfinished work began, and is "cm" now'
exits "a unit less" 2 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --name it --resume
ok "is named" says '--unit was "mm" when the unfinished work began, and is not given now'
exits "an option more" 2 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --name it --unit mm --origin 1,2,3 --resume
ok "is named" says '--origin was not given when the unfinished work began, and is "1,2,3" now'
exits "a flag more" 2 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --name it --unit mm --allow-empty --resume
ok "is named" says '--allow-empty was not given when the unfinished work began, and is given now'
exits "another input" 3 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --name it --unit mm --resume
ok "is named" says 'input .*/h.nrrd was ".* bytes, written at .*" when'
touch -d '2001-01-01' "$tmp/h.nrrd"
exits "an input that was written since" 3 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --name it --unit mm --resume
ok "is named" says 'input .*/h.nrrd was ".*" when the unfinished work began, and is ".* bytes, written at 978.*" now'
touch -r "$tmp/g.nrrd" "$tmp/h.nrrd"
ok "all of which changes nothing" [ -s "$tmp/x.leaf.unfinished/output" ]
exits "to begin again" 0 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --force
ok "the bytes without them" cmp "$tmp/good.leaf" "$out"
ok "and nothing else" alone
cp -p "$out" "$tmp/kept.leaf"
exits "another run, with --resume" 0 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume
ok "finds its output there" says 'x.leaf: is there already, whole, and written after its input: nothing is done'
exits "without it" 1 "$leafcast" convert "$tmp/h.nrrd" -o "$out"
ok "is refused" says 'exists already'
touch -d '2099-01-01' "$tmp/h.nrrd"
exits "an input that was written after" 1 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume
ok "is told" says 'x.leaf: is there already, and no unfinished work; but its input was written after it: --force makes it again, another -o leaves it'
touch -r "$tmp/g.nrrd" "$tmp/h.nrrd"
exits "another way" 1 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume --in-place
ok "is told" says 'but it was made without --in-place: --force'
exits "of standard input" 1 sh -c '"$1" convert - -o "$2" --resume <"$3"' sh "$leafcast" "$out" "$tmp/h.nrrd"
ok "is told" says 'but whether it is of standard input is not known: --force'
ok "all of which changes nothing" cmp "$tmp/kept.leaf" "$out"
head -c 5000 "$tmp/kept.leaf" >"$out"
exits "an output that is cut off" 3 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume
ok "is told" says 'x.leaf: is there already, and no unfinished work; but .*x.leaf: .*: --force makes it again'
ok "and stays" [ "$(wc -c <"$out")" = 5000 ]
ok "and nothing else" alone
mv "$tmp/kept.leaf" "$out"
exits "with --force, too" 0 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume --force
rm "$out"
exits "--resume without work to go on with" 0 "$leafcast" convert "$tmp/h.nrrd" -o "$out" --resume
ok "is a conversion" cmp "$tmp/good.leaf" "$out"
rm "$out"
exits "a negative --checkpoint" 2 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --checkpoint -1

# A run that ended between the output's name and the end of its work.
limited $((size / 2)) "$tmp/g.nrrd"
cp -r "$tmp/x.leaf.unfinished" "$tmp/copy"
run "$leafcast" convert "$tmp/g.nrrd" -o "$out" --resume
rm "$tmp/copy/output"
mv "$tmp/copy" "$tmp/x.leaf.unfinished"
exits "all was done" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --resume
ok "says so" says 'was complete already'
ok "leaves it" cmp "$tmp/good.leaf" "$out"
ok "and nothing else" alone
rm "$out"
for n in file folder link; do
    case $n in
    file) echo mine >"$tmp/x.leaf.unfinished" ;;
    folder) mkdir "$tmp/x.leaf.unfinished" && echo mine >"$tmp/x.leaf.unfinished/mine" ;;
    link) ln -s "$tmp" "$tmp/x.leaf.unfinished" ;;
    esac
    want=1
    [ $n = folder ] && want=0
    exits "a $n of the user's in the way" $want "$leafcast" convert "$tmp/g.nrrd" -o "$out" --force
    ok "stays" [ -e "$tmp/x.leaf.unfinished" ] || [ $n = folder ]
    [ $n = folder ] && ok "with what is in it" grep -q mine "$tmp/x.leaf.unfinished/mine"
    rm -rf "$tmp/x.leaf.unfinished" "$out"
done

# Pipes: what is done is passed over, and compared.
# begin_pipe FILE ARGUMENTS... - a run that gets three quarters of a file, and has saved its state twice.
begin_pipe() {
    file=$1
    shift
    mkfifo "$tmp/pipe"
    "$leafcast" convert - -o "$out" --checkpoint 0 "$@" <"$tmp/pipe" >"$tmp/out" 2>"$tmp/err" &
    pid=$!
    exec 7>"$tmp/pipe"
    rm "$tmp/pipe"
    head -c $(($(wc -c <"$file") * 3 / 4)) "$file" >&7
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        [ ! -s "$tmp/x.leaf.unfinished/state-1" ] || return 0
        sleep 0.25
    done
    return 1
}
end_pipe() {
    kill "-$1" "$pid"
    rc=0
    wait "$pid" 2>/dev/null || rc=$?
    exec 7>&-
}
# piped NAME FILE ARGUMENTS...
piped() {
    name=$1
    file=$2
    shift 2
    run "$leafcast" convert "$file" -o "$tmp/whole.leaf" --force "$@"
    ok "$name: begins" begin_pipe "$file" "$@"
    end_pipe KILL
    # shellcheck disable=SC2016 # for the inner shell
    exits "goes on" 0 sh -c 'f=$1; shift; exec "$@" <"$f"' sh "$file" "$leafcast" convert - -o "$out" --resume "$@"
    ok "says from where" says 'goes on at [1-9][0-9]* %'
    ok "the same bytes" cmp "$tmp/whole.leaf" "$out"
    rm "$out"
}
piped "raw samples" "$tmp/g.nrrd"
piped "compressed" "$tmp/g.nrrd" --compress zstd
piped "packed floats, some missing" "$tmp/f.nrrd.gz" --compress zstd:3 --missing 0
ok "a pipe" begin_pipe "$tmp/g.nrrd"
end_pipe TERM
ok "stopped by the user: exit 5 (got $rc)" [ "$rc" = 5 ]
ok "says how to go on" says 'stopped by signal 15 (Terminated): the same command with --resume goes on'
cp "$tmp/g.nrrd" "$tmp/other.nrrd"
printf 'x' | dd of="$tmp/other.nrrd" bs=1 seek=3000 conv=notrunc 2>/dev/null
exits "another stream" 3 sh -c '"$1" convert - -o "$2" --resume <"$3"' sh "$leafcast" "$out" "$tmp/other.nrrd"
ok "is refused" says 'the input has changed: its first [0-9]* slices are not those'
exits "a file in its place" 3 "$leafcast" convert "$tmp/g.nrrd" -o "$out" --resume
exits "the same" 0 sh -c '"$1" convert - -o "$2" --resume <"$3"' sh "$leafcast" "$out" "$tmp/g.nrrd"
ok "the same bytes" cmp "$tmp/good.leaf" "$out"
rm "$out"

# Killed at any time.
early=0
for n in 1 2 3 4 5 6 7 8; do
    one_in 3 || continue
    "$leafcast" convert "$tmp/g.nrrd" -o "$out" --checkpoint 0 --compress zstd -q --threads 1 &
    pid=$!
    sleep "0.0$n"
    kill -9 $pid 2>/dev/null && early=$((early + 1))
    wait $pid 2>/dev/null
    [ -e "$out" ] || run "$leafcast" convert "$tmp/g.nrrd" -o "$out" --compress zstd --resume
    [ -e "$tmp/z.leaf" ] || run "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/z.leaf" --compress zstd
    ok "killed: the same bytes" cmp "$tmp/z.leaf" "$out"
    rm -rf "$out" "$tmp/x.leaf.unfinished"
done
finish
