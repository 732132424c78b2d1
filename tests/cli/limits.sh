# limits.sh - verbs under small limits of the system: memory, stack, file sizes, descriptors,
# processes. Each ends well, or with exit status 4 and a reason; never by a signal, never hanging.
# shellcheck shell=sh
# marks: long
. tests/support/tap.sh
verbs=${LEAFCAST_BUILD:-$PWD/build/release}/libexec
chmod 755 "$tmp"

"$leafcast" generate marschner-lobb --dims 64 -o "$tmp/v.nrrd" &&
    "$leafcast" generate buckyball --tets --dims 12 -o "$tmp/m.mesh" &&
    "$leafcast" convert "$tmp/v.nrrd" -o "$tmp/v.leaf" >/dev/null &&
    "$leafcast" convert "$tmp/m.mesh" -o "$tmp/m.leaf" >/dev/null || exit 1

# limited LIMIT VALUE ENDS VERB ARGS... - run a verb under `ulimit LIMIT VALUE`; note how it ended
# unless that is one of ENDS, with words if it is not 0.
limited() {
    limit=$1 value=$2 ends=$3
    shift 3
    verb=$verbs/leafcast-$1
    shift
    rc=0
    # What it says goes through a pipe, which has no size.
    case $limit in
    nproc)
        said=$(timeout -k 1 60 prlimit --nproc="$value" $as "$verb" "$@" 2>&1 >/dev/null </dev/null) ||
            rc=$?
        ;;
    *)
        # shellcheck disable=SC3045 # dash and bash have these
        said=$( (ulimit "$limit" "$value" && exec timeout -k 1 60 "$verb" "$@") 2>&1 >/dev/null \
            </dev/null) || rc=$?
        ;;
    esac
    runs=$((runs + 1))
    case " $ends " in
    *" $rc "*) [ "$rc" = 0 ] || [ -n "$said" ] || bad="$bad silent:$limit:$value:$verb" ;;
    *) bad="$bad $rc:$limit:$value:${verb##*/}:$said" ;;
    esac
}

# every LIMIT VALUE ENDS - every verb under this limit.
every() {
    limited "$@" render "$tmp/v.leaf" --iso 127.5 --size 48x48 --threads 4 \
        --depth-f64 "$tmp/d.f64" --force
    limited "$@" render "$tmp/v.leaf" --iso 127.5 --size 48x48 --threads 2 --backend mapped \
        --depth-f64 "$tmp/d.f64" --force
    limited "$@" render "$tmp/m.leaf" --iso 0.5 --size 48x48 --threads 4 \
        --depth-f64 "$tmp/d.f64" --force
    limited "$@" convert "$tmp/v.nrrd" -o "$tmp/c.leaf" --threads 4 --force
    limited "$@" convert "$tmp/m.mesh" -o "$tmp/c.leaf" --threads 4 --force
    limited "$@" generate gyroid --dims 24 -o "$tmp/g.nrrd" --threads 4 --force
    limited "$@" resample "$tmp/m.mesh" --dims 20,20,20 -o "$tmp/r.nrrd" --threads 4 --force
    limited "$@" export "$tmp/v.leaf" --iso 127.5 -o "$tmp/r.ply" --threads 4 --force
    limited "$@" export "$tmp/m.leaf" -o "$tmp/r.vtu" --threads 4 --force
    limited "$@" info "$tmp/v.leaf"
    limited "$@" verify "$tmp/m.leaf" --threads 4
    limited "$@" probe "$tmp/v.leaf" --iso 127.5 --at 10,10
}

no_trouble() {
    [ -z "$bad" ]
}

# under NAME LIMIT ENDS VALUES...
under() {
    name=$1 what=$2 allowed=$3 bad='' runs=0
    shift 3
    for each; do
        every "$what" "$each" "$allowed"
    done
    ok "$name: $runs runs end with one of $allowed" no_trouble
    [ -z "$bad" ] || printf '%s\n' "$bad" | sed 's/^/# /'
}

# Sanitizers map terabytes: address space means nothing there.
case $verbs in
*sanitize* | *thread* | *fuzz*) skip "address space" "a sanitizer's build" ;;
*) under "address space" -v "0 4" 24000 32000 48000 64000 96000 160000 ;;
esac
# What libraries allocate: JSON, then blosc, which is loaded when it is needed. 127: not even leafcast is loaded.
mkdir "$tmp/b.zarr"
cat >"$tmp/b.zarr/.zarray" <<'X'
{"zarr_format": 2, "shape": [4, 4, 4], "chunks": [4, 4, 4], "dtype": "|u1", "order": "C", "filters": null,
 "compressor": {"id": "blosc", "cname": "lz4", "clevel": 5, "shuffle": 1, "blocksize": 0}, "fill_value": 0}
X
{
    printf '\002\001\002\001\100\000\000\000\100\000\000\000\120\000\000\000'
    printf 'leafcast%.0s' 1 2 3 4
    head -c 32 /dev/zero
} >"$tmp/b.zarr/0.0.0"
case $verbs in
*sanitize* | *thread* | *fuzz*) skip "data" "a sanitizer's build" ;;
*)
    if "$leafcast" convert "$tmp/b.zarr" -o "$tmp/c.leaf" --force >/dev/null 2>"$tmp/err"; then
        bad='' runs=0
        for each in 400 500 600 700 800 860 900 920 940 960 980 1000 1020 1040 1060 1080 1100 1120 1140 1160 1180 1200 1400; do
            limited -d $each "0 4 127" convert "$tmp/b.zarr" -o "$tmp/c.leaf" --threads 1 --force
        done
        ok "data: $runs runs of blosc end with one of 0 4" no_trouble
        [ -z "$bad" ] || printf '%s\n' "$bad" | sed 's/^/# /'
    else
        skip "data" "$(tail -n 1 "$tmp/err")"
    fi
    ;;
esac
under "stack" -s "0" 256 1024
under "file size" -f "0 4" 0 1 20
under "descriptors" -n "0 1 4" 6 7 8 10

# Processes of root are not limited: somebody who has no others.
as='setpriv --reuid=64321 --clear-groups'
rm -f "$tmp/d.f64" "$tmp/c.leaf" "$tmp/g.nrrd" "$tmp/r.nrrd"
if [ "$(id -u)" = 0 ] && chmod 777 "$tmp" &&
    prlimit --nproc=1 $as "$verbs/leafcast-info" "$tmp/v.leaf" >/dev/null 2>&1; then
    under "processes" nproc "0 4" 1 2 3 4 6
else
    skip "processes" "no user without others can run this build"
fi
finish
