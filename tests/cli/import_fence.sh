#!/bin/sh
# import_fence.sh - an importer's library behind its fence: what it cannot do, whatever it tries; how it ends
# when it crashes, hangs, is killed or runs out of memory, by itself and under convert and info.
# marks: long
. tests/support/tap.sh

build=${LEAFCAST_BUILD:-build/release}
tool=$build/tests/tool_importer
[ -x "$tool" ] || { skip "importers" "no tool_importer here"; finish; }
tool=$(readlink -f "$tool")
says() { grep -q -- "$1" "$tmp/err"; }
silent() { ! grep -q -- "$1" "$tmp/err"; }
absent() { [ -z "$(find "$tmp" -name "$1*")" ]; }
mkdir "$tmp/given" "$tmp/foreign" "$tmp/to" "$tmp/store"
echo something >"$tmp/given/F"
echo secret >"$tmp/foreign/S"
export TRIAL TRIAL_FOREIGN="$tmp/foreign/S" TRIAL_FOLDER="$tmp/foreign"
trial() { # trial WHAT COMMAND...
    TRIAL=$1
    shift
    "$@"
}

# ---- what is fenced ----
exits "it reads" 0 trial none "$tool" "$tmp/given/F" -o "$tmp/to/plain.nrrd" -v
if says 'is not kept from'; then
    skip "the fence" "$(sed -n 's/.*is not kept from/not from/p' "$tmp/err")"
else
    for out in "$tmp/to/o.nrrd" -; do
        run trial open-fence "$tool" "$tmp/given/F" -o "$out"
        grep '^right\|^wrong' "$tmp/err" >"$tmp/tried"
        while IFS= read -r line; do ok "-o ${out##*/}: ${line#*: }" [ "${line%%:*}" = right ]; done <"$tmp/tried"
        ok "all was tried" [ "$(wc -l <"$tmp/tried")" = "$(grep -c '^    {".*\(true\|false\)},$' tests/tools/tool_importer.c)" ]
        ok "and it went on" [ "$rc" = 0 ]
    done
    ok "nothing foreign is changed" [ "$(cat "$tmp/foreign/S")$(ls -A "$tmp/foreign")$(stat -c %a%u "$tmp/foreign/S")" = "secretS644$(id -u)" ]
    ok "nothing was made" [ "$(ls -A "$tmp/given")" = F ]
    ln -s ../given/F "$tmp/store/link"
    ln -s "$tmp/store" "$tmp/folder"
    for name in "$tmp/store/link" "$tmp/folder/link"; do
        exits "through a link: ${name#"$tmp/"}" 0 trial none "$tool" "$name" -o "$tmp/to/l.nrrd" --force
    done
    ln -s "$tmp/to" "$tmp/away"
    exits "an output's folder by a link" 0 trial none "$tool" "$tmp/given/F" -o "$tmp/away/m.nrrd"
    cd "$tmp/to" || exit 1
    exits "an output without a folder" 0 trial none "$tool" ../given/F -o n.nrrd
    exits "a name that a killed run left" 0 sh -c ': >k.nrrd.partial-1; "$0" ../given/F -o k.nrrd' "$tool"
    ok "is cleared away" [ ! -e k.nrrd.partial-1 ]
    mkfifo "$tmp/given/P"
    exits "a named pipe is not waited for" 1 timeout 60 "$tool" "$tmp/given/P"
    cd "$OLDPWD" || exit 1
fi

# ---- where the kernel has no such fence: it says so, reads all the same, and announces its files ----
cat >"$tmp/older.py" <<'PY'
"""older.py CALLS COMMAND...: a kernel without these system calls (x86-64)."""
import ctypes, os, platform, struct, sys
if platform.machine() != "x86_64":
    sys.exit(77)
calls = [int(n) for n in sys.argv[1].split(",")]
steps = [(0x20, 0, 0, 0)]
for n in calls:
    steps += [(0x15, 0, 1, n), (0x06, 0, 0, 0x00050000 | 38)]
steps.append((0x06, 0, 0, 0x7FFF0000))
code = b"".join(struct.pack("HBBI", *s) for s in steps)
code = ctypes.create_string_buffer(code, len(code))
class Program(ctypes.Structure):
    _fields_ = [("count", ctypes.c_ushort), ("steps", ctypes.c_void_p)]
libc = ctypes.CDLL(None, use_errno=True)
if libc.prctl(38, 1, 0, 0, 0) or libc.prctl(22, 2, ctypes.byref(Program(len(steps), ctypes.addressof(code)))):
    sys.exit(77)
os.execv(sys.argv[2], sys.argv[2:])
PY
older() { python3 "$tmp/older.py" "$@"; }
run trial none older 444,317 "$tool" "$tmp/given/F" -o "$tmp/to/older.nrrd" -v
if [ $rc = 77 ]; then
    skip "older kernels" "they are played by filters of x86-64"
else
    ok "without Landlock and seccomp it reads (got $rc)" [ $rc = 0 ]
    ok "says so" says 'not kept from files or system calls'
    ok "the same" cmp "$tmp/to/plain.nrrd" "$tmp/to/older.nrrd"
    exits "quietly" 0 trial none older 444,317 "$tool" "$tmp/given/F" -o "$tmp/to/older.nrrd" --force
    ok "but for -v" silent 'kept from'
    exits "over its input" 2 trial none older 444,317 "$tool" "$tmp/given/F" -o "$tmp/given/F" --force
    exits "without Landlock" 0 trial none older 444 "$tool" "$tmp/given/F" -o "$tmp/to/older.nrrd" --force -v
    ok "says so" says 'not kept from files'
fi

# ---- how it ends ----
# A folder of a front door's own: there it is the importer of a format.
mkdir "$tmp/door"
for verb in convert info; do cp "$build/libexec/leafcast-$verb" "$tmp/door/$verb"; done
ln -s "$tool" "$tmp/door/leafcast-import-hdf5"
printf '\211HDF\r\n\032\n' >"$tmp/F.h5"
bare() { # bare VERB ARGUMENT...
    verb=$1
    shift
    PATH=/usr/bin:/bin "$tmp/door/$verb" "$@"
}
# ends TRIAL CODE UNDER WORDS: by itself, and under convert, where another code may hold.
ends() {
    exits "$1" "$2" trial "$1" "$tool" "$tmp/F.h5" -o "$tmp/x.nrrd"
    [ "$2" -gt 4 ] || ok "$1: says so" says "$4"
    exits "$1 under convert" "$3" trial "$1" bare convert "$tmp/F.h5" -o "$tmp/x.leaf" --allow-empty
    ok "$1: convert says so" says "$4"
    ok "$1: nothing is left" [ ! -e "$tmp/x.leaf" -a ! -e "$tmp/x.nrrd" ]
    rm -f "$tmp"/x.*
}
for when in open read last; do
    ends $when-crash 3 3 'likely malformed'
    ends $when-abort 3 3 'likely malformed'
    ends $when-leave 3 3 'likely malformed'
    ends $when-none 3 3 'says it is malformed'
    ends $when-die 137 4 'killed over this file (signal 9)'
    ends $when-stop 143 1 'stopped by signal 15\|signal 15'
done 2>/dev/null
case $build in
*sanitize* | *thread*) skip "memory" "a sanitizer has an allocator of its own" ;;
*)
    for when in open read last; do
        ends $when-take-all 4 4 'ran out of memory'
        ends $when-ask 4 4 'got no memory'
    done
    exits "info" 4 trial read-take-all bare info "$tmp/F.h5"
    ;;
esac
exits "info" 3 trial read-crash bare info "$tmp/F.h5"
exits "info" 4 trial read-die bare info "$tmp/F.h5"
(
    # shellcheck disable=SC3045 # dash and bash have these
    ulimit -S -t 1
    exits "time" 4 trial read-spin "$tool" "$tmp/F.h5" -o "$tmp/x.nrrd"
    ok "says so" says 'too much CPU time'
    exits "time under convert" 4 trial read-spin bare convert "$tmp/F.h5" -o "$tmp/x.leaf"
    ok "says so, too" says 'too much CPU time'
    # shellcheck disable=SC3045
    ulimit -t 2
    exits "time with no more to have" 4 trial read-spin "$tool" "$tmp/F.h5" -o "$tmp/x.nrrd"
    ok "is told before the system ends it" says 'too much CPU time'
    exit $tap_failed
) >"$tmp/timed"
ok "a hang takes so much CPU time, and no more" [ $? = 0 ]
grep '^not\|^#' "$tmp/timed"

# ---- what comes behind the output takes nothing back ----
exits "an import" 0 trial none "$tool" "$tmp/F.h5" -o "$tmp/want.nrrd"
exits "a conversion" 0 trial none bare convert "$tmp/F.h5" -o "$tmp/want.leaf" --allow-empty
for what in close-crash close-abort end-crash end-abort; do
    exits "$what" 0 trial $what "$tool" "$tmp/F.h5" -o "$tmp/got.nrrd" --force
    ok "warns" says 'nothing of the output is missing'
    ok "is complete" cmp "$tmp/got.nrrd" "$tmp/want.nrrd"
    exits "$what under convert" 0 trial $what bare convert "$tmp/F.h5" -o "$tmp/got.leaf" --force --allow-empty
    ok "is complete, too" cmp "$tmp/got.leaf" "$tmp/want.leaf"
done
exits "an error stays one" 2 trial end-crash "$tool" "$tmp/F.h5" -o "$tmp/F.h5" --force
exits "a list" 0 trial end-crash "$tool" "$tmp/F.h5" --list
ok "is told" grep -q '^all' "$tmp/out"

# ---- each importer with less and less memory: it reads, or says that it has none ----
case $build in
*sanitize* | *thread*) ;;
*)
    mkdir "$tmp/forms"
    python=$(python_with h5py)
    PYTHONDONTWRITEBYTECODE=1 "${python:-python3}" tests/support/guard_forms.py "$tmp/forms" >"$tmp/table"
    run "$leafcast" generate sphere --dims 6 -o "$tmp/v.nrrd"
    run "$leafcast" convert "$tmp/v.nrrd" -o "$tmp/v.leaf"
    run "$leafcast" export "$tmp/v.leaf" -o "$tmp/forms/v.vdb"
    printf 'import-vdb\tv.vdb\t\tv.vdb\n' >>"$tmp/table"
    cd "$tmp/forms" || exit 1
    for f in "$(dirname "$(readlink -f "$leafcast")")"/../libexec/leafcast-import-*; do
        verb=${f##*/leafcast-}
        given=$(sed -n "s/^$verb	\([^	]*\)		.*/\1/p" "$tmp/table" | head -n 1)
        suffix=nrrd
        case $verb in import-exodus | import-cgns) suffix=mesh ;; esac
        [ -n "$given" ] || { skip "$verb" "no file of it here"; continue; }
        for kib in 1000 2000 4000 16000 40000 60000 80000 100000; do
            # 127: it is not even loaded.
            run sh -c 'ulimit -d $1; exec "$2" "$3" -o "$4" --force' sh $kib "$f" "$given" "$tmp/low.$suffix"
            ok "$verb with $kib KiB (got $rc)" [ $rc = 0 -o $rc = 4 -o $rc = 127 ]
            run sh -c 'ulimit -d $1; exec "$2" convert "$3" -o "$4" --force' sh $kib "$leafcast" "$given" "$tmp/low.leaf"
            ok "convert with it, and $kib KiB (got $rc)" [ $rc = 0 -o $rc = 4 ]
        done
    done
    ;;
esac
finish
