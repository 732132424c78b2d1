#!/bin/sh
# json.sh - --json of every verb: one document, laid out alike, whose keys are those of the verb's
# page; errors as JSON, too.
# marks: leaks, long
. tests/support/tap.sh

command -v python3 >/dev/null || { skip "--json" "no python3 here"; finish; }
mkdir "$tmp/keys"

cat >"$tmp/check.py" <<'PY'
"""check.py VERB KIND FILE KEYS PAGE: FILE is JSON of this KIND (document, lines, error), its keys
are in the PAGE; they are added to KEYS."""
import json, re, sys

verb, kind, path, keys, page, code = sys.argv[1:]
text = open(path).read()


def once(pairs):
    assert len(dict(pairs)) == len(pairs), "a key twice"
    return dict(pairs)


if kind == "lines":
    documents = [json.loads(line, object_pairs_hook=once) for line in text.splitlines()]
    assert len(documents) > 1
else:
    documents = [json.loads(text, object_pairs_hook=once)]
    lines = text.splitlines()
    assert lines[0] == "{" and lines[-1] == "}", "not indented"
    assert re.match('  "', lines[1]), "not indented by two blanks"
if kind == "error":
    error = documents[0]["error"]
    assert list(documents[0]) == ["error"] and list(error) == ["status", "exit", "message"], error
    assert error["exit"] == int(code) and error["message"], error
    sys.exit()
named = set()
section = ""
for line in open(page):
    section = line.split()[1] if line.startswith(".Sh ") else section
    if section == "JSON" and line.startswith(".It "):
        named.update(word for word in line.split()[1:] if word not in ("Li", ","))
for document in documents:
    for key in document:
        key = re.sub("^inside_.*", "inside_V", key) if verb == "probe" else key
        assert key in named, key + " is not in " + page
        print(key, file=open(keys, "a"))
PY

# json KIND VERB ARGUMENT...: what it prints is JSON of this kind.
json() {
    kind=$1
    verb=$2
    shift 2
    run "$leafcast" "$verb" "$@" --json
    status=$rc
    [ "$kind" = error ] || ok "$verb $*: exit 0 (got $rc)" [ "$rc" = 0 ]
    page=scripts/man/leafcast-$verb.1
    cp "$tmp/out" "$tmp/json"
    cp "$tmp/err" "$tmp/err.kept"
    ok "$verb $*: JSON" python3 "$tmp/check.py" "$verb" "$kind" "$tmp/json" "$tmp/keys/$verb" "$page" \
        "$status" 2>"$tmp/err"
}

cd "$tmp" || exit 1
ln -s "$OLDPWD/scripts" scripts
json document generate gyroid --dims 20 -o g.nrrd
json document generate drop --dims 9 --steps 2 -o d.nrrd
json document generate buckyball --tets --dims 9 --steps 2 --deform 0.2 -o b.mesh
json document convert g.nrrd -o g.leaf
json document convert g.nrrd --dry-run
json document convert g.nrrd --in-place -o place.leaf
json document convert g.nrrd --levels 1 -o bare.leaf
json document convert b_0000.mesh b_0001.mesh -o b.leaf
json document convert b_0000.mesh --dry-run
json document convert g.nrrd --append -o grown.leaf
json lines convert --watch 'd_%04d.nrrd' -o watched.leaf --settle 0 --until 2
json document generate gyroid --curvilinear warp --dims 9 -o c.vts
json document convert c.vts -o c.leaf
json document convert c.vts --dry-run
printf 'OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n' >t.off
json document convert t.off -o t.leaf
json document convert t.off --dry-run
json document info t.off
json document info t.leaf
json document export t.leaf -o t.ply
json document info c.vts
json document info c.leaf
printf '\0\0\0\2\0\0\0\3\0\0\0\4' | tee p.xyz >p.q
head -c 288 /dev/zero >>p.xyz
head -c 496 /dev/zero >>p.q
json document info p.xyz --solution p.q
json document verify g.leaf
cp g.leaf g2.leaf
json document verify g.leaf --repair g2.leaf -o g3.leaf
json document info g.leaf --iso 120
json document info b.leaf --iso 0.3
json document info g.nrrd
json document info place.leaf
json document info bare.leaf
json document info b_0000.mesh
printf 'OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n' >t.off
json document info t.off
"$leafcast" convert d_0000.nrrd d_0001.nrrd -o d.leaf -q
json document probe d.leaf --point 3,3,3 --time 0.5 --interpolate
json document slice d.leaf --time 0.5 --interpolate -o s.ppm --force
json document render d.leaf --iso 100 --time 0.5 --interpolate --size 16x16
json document probe g.leaf --iso 120 --at 500,500
json document probe g.leaf --ray -1,9,9,1,0,0 --segments
json document probe g.leaf --iso 120 --point 3,3,3
json document probe g.leaf --iso 120 --point 3,3,3 --colour-by b.leaf
json document probe b.leaf --iso 0.3 --point 3,3,3 --step 1
json document slice g.leaf -o s.ppm --force
json document slice b.leaf --step 1 --line "2,2,2;6,6,2" --sweep 0,0,3
json document render g.leaf --iso 120 --size 16x16 -o g.png
json document render g.leaf --iso 120 --size 16x16 -o g.png --force --colour-by b.leaf
json document render b.leaf --iso 0.3 --size 16x16 --step 1 --packets 4
json lines render g.leaf --iso-list 100,120 --size 16x16
json document resample b_0000.mesh -o b.nrrd
json document export g.leaf -o x.nrrd
json document export g.leaf --iso 120 -o x.stl
json document export b.leaf -o x.vtu
json document export c.leaf -o c.vtu
json document bench steps g.leaf --iso 120 --size 16x16 --runs 1
printf '%s\n' 0,0,0 1,0,0 0,1,0 0,0,1 1,1,1 >points.csv
"$leafcast" --help | grep -q '^  tetrahedralize' &&
    json document tetrahedralize points.csv -o points.mesh
printf '%s\n' '{"iso": 120, "size": [8, 8]}' '{"sighs": 1}' >script
run "$leafcast" render g.leaf --script script
ok "a script: a line each, without --json, too" [ "$(grep -c '^{.*}$' out)" = 2 ]
ok "an error of the same form" [ "$(grep -c '"error":{"status":"usage","exit":2,' out)" = 1 ]

# What a page names comes from some run, so that pages keep up. Of info, a volume's keys are all
# in the page of whoever reads them.
for verb in keys/*; do
    verb=${verb#keys/}
    sed -n '/^\.Sh JSON/,/^\.Sh EXIT/p' "scripts/man/leafcast-$verb.1" | grep '^\.It' | tr ' ' '\n' |
        grep -v -e '^\.It$' -e '^Li$' -e '^,$' | sort -u >named
    sort -u "keys/$verb" | comm -23 named - >out
    ok "$verb: its page names nothing that is not there" [ ! -s out ]
done

for verb in generate convert verify info probe slice render resample export bench; do
    json error "$verb" --no-such-option
    ok "$verb: a slip: exit 2" [ "$status" = 2 ]
    ok "$verb: and in words, on standard error" grep -q "^leafcast $verb: unrecognized" err.kept
done
for verb in convert verify info slice render resample export; do
    case $verb in
    verify | info | slice) json error "$verb" absent.leaf ;;
    render) json error render absent.leaf --iso 1 -o x.png ;;
    export) json error export absent.leaf -o y.nrrd ;;
    resample) json error resample absent.mesh -o x.nrrd ;;
    *) json error "$verb" absent.nrrd -o x.leaf ;;
    esac
    ok "$verb: no input: exit 1 or 3" [ "$status" = 1 -o "$status" = 3 ]
done
json error convert g.nrrd -o h.leaf --memory 1
ok "no memory: exit 4" [ "$status" = 4 ]
json error generate gyroid --dims 9 -o -
run "$leafcast" render g.leaf --siez 3x3
ok "a slip gets advice" grep -q "did you mean '--size'" err
run "$leafcast" render g.leaf "--$(printf '%9000s' '' | tr ' ' z)"
ok "what is too long is cut, and that is said" grep -q 'that message is longer, and was cut' err
run "$leafcast" render g.leaf --zzzzzz
ok "but no silly one" [ "$(grep -c 'did you mean' err)" = 0 ]
finish
