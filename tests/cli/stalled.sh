#!/bin/sh
# stalled.sh - pipes at whose other end nothing happens: the first signal ends every verb that waits for one, and a
# named pipe is refused at once where a file is needed.
. tests/support/tap.sh

stalled=$tmp/stalled
mkfifo "$stalled"
exec 8<>"$stalled" # a writer that writes nothing, and a reader that reads nothing
says() { grep -q -- "$1" "$tmp/err"; }
catches() { # whether process $1 handles SIGTERM by now
    mask=$(sed -n 's/^SigCgt:[[:space:]]*//p' "/proc/$1/status" 2>/dev/null)
    [ -n "$mask" ] && [ $((0x$mask & 0x4000)) != 0 ]
}
there() { kill -0 "$1" 2>/dev/null && ! grep -q '^State:.*Z' "/proc/$1/status" 2>/dev/null; }
tries() { # COMMAND...: whether it succeeds within 20 s
    n=0
    until "$@"; do
        n=$((n + 1))
        [ $n -lt 200 ] || return 1
        sleep 0.1
    done
}
gone() { ! there "$1"; }

# stops NAME SIGNAL INPUT OUTPUT COMMAND... - it waits until the signal ends it, with 128 + its number, and says so.
stops() {
    name=$1 signal=$2 input=$3 output=$4 number=15
    shift 4
    [ "$signal" = TERM ] || number=2
    env --default-signal=INT "$@" <"$input" >"$output" 2>"$tmp/err" &
    child=$!
    ok "$name: handles signals" tries catches $child
    sleep 0.5
    ok "$name: waits" there $child
    kill -s "$signal" $child
    tries gone $child || kill -KILL $child
    rc=0
    wait $child || rc=$?
    ok "$name: ends by the first SIG$signal (got $rc)" [ $rc = $((128 + number)) ]
    ok "$name: says so" says "stopped by signal"
}

"$leafcast" generate sphere --dims 16 -o "$tmp/a.nrrd"
"$leafcast" convert "$tmp/a.nrrd" -o "$tmp/a.leaf" >/dev/null
"$leafcast" generate sphere --tets --dims 24 -o "$tmp/a.mesh"
"$leafcast" convert "$tmp/a.mesh" -o "$tmp/mesh.leaf" >/dev/null
head -c 300 "$tmp/a.nrrd" >"$tmp/start"

for signal in TERM INT; do
    stops "convert -" "$signal" "$stalled" "$tmp/out" "$leafcast" convert - -o "$tmp/x.leaf"
    stops "a named pipe" "$signal" /dev/null "$tmp/out" \
        "$leafcast" convert "$stalled" -o "$tmp/x.leaf"
done
stops "resample -" TERM "$stalled" "$tmp/out" "$leafcast" resample - -o "$tmp/x.nrrd"
stops "tetrahedralize -" TERM "$stalled" "$tmp/out" \
    "$leafcast" tetrahedralize - --format csv -o "$tmp/x.mesh"
stops "render --script -" INT "$stalled" "$tmp/out" "$leafcast" render "$tmp/a.leaf" --iso 40 --script -
stops "render --script of a named pipe" TERM /dev/null "$tmp/out" \
    "$leafcast" render "$tmp/a.leaf" --iso 40 --script "$stalled"
ok "none of them leaves an output" [ -z "$(find "$tmp" -name 'x.*')" ]

# More than a pipe holds: 64 KiB.
stops "generate -o -" TERM /dev/null "$stalled" "$leafcast" generate sphere --dims 128 -o -
stops "generate --tets -o -" INT /dev/null "$stalled" "$leafcast" generate sphere --tets --dims 64 -o -
stops "resample -o -" TERM /dev/null "$stalled" "$leafcast" resample "$tmp/mesh.leaf" --dims 64 -o -
if [ -x "$(dirname "$leafcast")/../libexec/leafcast-tetgen" ]; then
    awk 'BEGIN { srand(3); for (i = 0; i < 9000; i++) print rand(), rand(), rand() }' >"$tmp/p.xyz"
    stops "tetrahedralize -o -" TERM /dev/null "$stalled" "$leafcast" tetrahedralize "$tmp/p.xyz" -o -
else
    skip "tetrahedralize -o -" "no TetGen"
fi

# What a pipe had to say comes through in pieces, and whole.
# shellcheck disable=SC2016
run sh -c '(head -c 100 "$2"; sleep 1; tail -c +101 "$2") | "$1" convert - -o "$3"' sh \
    "$leafcast" "$tmp/a.nrrd" "$tmp/late.leaf"
ok "a late writer is waited for" cmp "$tmp/late.leaf" "$tmp/a.leaf"
# shellcheck disable=SC2016
run sh -c '"$1" generate sphere --dims 128 -o - | (sleep 1; cat) >"$2"' sh "$leafcast" "$tmp/slow.nrrd"
"$leafcast" generate sphere --dims 128 -o "$tmp/fast.nrrd"
ok "a late reader gets it all" cmp "$tmp/slow.nrrd" "$tmp/fast.nrrd"

# Where a file is needed: at once, without waiting for a writer.
rm "$stalled"
exec 8>&-
mkfifo "$tmp/fifo.leaf"
fifo=$tmp/fifo.leaf
refused() { # refused NAME COMMAND...
    name=$1
    shift
    run timeout 20 "$@"
    ok "$name: refused (got $rc)" [ $rc = 1 -o $rc = 3 ]
    ok "$name: says what it is" says "$fifo: is a named pipe, expected"
}
refused "info" "$leafcast" info "$fifo"
refused "verify" "$leafcast" verify "$fifo"
refused "render" "$leafcast" render "$fifo" --iso 1 -o "$tmp/x.png"
refused "render --path" "$leafcast" render "$tmp/a.leaf" --iso 40 --camera-path "$fifo" -o "$tmp/x_%d.png"
refused "probe" "$leafcast" probe "$fifo" --point 1,1,1
refused "bench" "$leafcast" bench time "$fifo" --iso 1
for axis in x y z; do
    refused "--axis-$axis" "$leafcast" convert "$tmp/a.nrrd" --axis-$axis "$fifo" -o "$tmp/x.leaf"
done
exits "a folder" 3 "$leafcast" convert "$tmp" -o "$tmp/x.leaf"
ok "is named as one" says "a folder without a file of a known format"
exits "a device" 1 "$leafcast" convert /dev/zero -o "$tmp/x.leaf"
ok "is named as one" says "is a device"
exits "a folder as a treelet file" 3 "$leafcast" info "$tmp"
ok "is named as one" says "a folder without a file of a known format"
finish
