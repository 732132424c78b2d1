#!/bin/sh
# terminal.sh - on a terminal: a progress bar is drawn and is gone where results stand; -q, -v, -vv.
# marks: long
. tests/support/tap.sh

command -v python3 >/dev/null || { skip "a terminal" "no python3 here"; finish; }
cat >"$tmp/screen.py" <<'PY'
"""screen.py RAW SCREEN COMMAND...: run it on a terminal of its own. RAW: the bytes it got; SCREEN:
what stands there in the end."""
import os, pty, subprocess, sys, threading

# A terminal whose last writer is gone may end before all that was written has been read. So this end
# of it stays open, and behind the command's last byte it gets one of ours: what comes before that
# byte is all there is.
END = b"\0"


def run(command):
    ours, its = pty.openpty()
    child = subprocess.Popen(command, stdin=its, stdout=its, stderr=its, start_new_session=True,
                             env={**os.environ, "TERM": "xterm"})
    threading.Thread(target=lambda: (child.wait(), os.write(its, END))).start()
    raw = b""
    while not raw.endswith(END):
        raw += os.read(ours, 65536)
    return raw[:-len(END)], child.returncode


def screen(raw):
    """Carriage returns, ends of lines, and `erase to the end of the line`."""
    lines, column, at = [""], 0, 0
    text = raw.decode(errors="replace")
    while at < len(text):
        if text.startswith("\033[K", at):
            lines[-1] = lines[-1][:column]
            at += 3
            continue
        if text[at] == "\r":
            column = 0
        elif text[at] == "\n":
            lines.append("")
            column = 0
        else:
            lines[-1] = lines[-1][:column].ljust(column) + text[at] + lines[-1][column + 1:]
            column += 1
        at += 1
    return "\n".join(lines)


raw, code = run(sys.argv[3:])
open(sys.argv[1], "wb").write(raw)
open(sys.argv[2], "w").write(screen(raw))
sys.exit(code)
PY
on_terminal() { # what stands there in the end is shown if a test fails
    run python3 "$tmp/screen.py" "$tmp/raw" "$tmp/screen" "$@"
    cp "$tmp/screen" "$tmp/out"
}
bars() { grep -c '\[[#.]*\] *[0-9]*%' "$1"; }

# A job that takes as long as it must for a bar to be drawn, which is after 0.3 s.
n=160
while :; do
    on_terminal "$leafcast" generate noise --dims $n --threads 1 -o "$tmp/v.nrrd" --force --json
    [ "$rc" = 0 ] || break
    [ "$(bars "$tmp/raw")" = 0 ] && [ $n -lt 640 ] || break
    n=$((n * 2))
done
ok "a long job draws a bar" [ "$(bars "$tmp/raw")" -gt 0 ]
ok "no bar stays" [ "$(bars "$tmp/screen")" = 0 ]
ok "results begin their line" [ "$rc" = 0 -a "$(grep -c '^{$' "$tmp/screen")" = 1 ]
on_terminal "$leafcast" convert "$tmp/v.nrrd" -o "$tmp/v.leaf" --threads 1
ok "convert: results, and no bar" [ "$rc" = 0 -a "$(bars "$tmp/screen")" = 0 -a \
    "$(grep -c '^file ' "$tmp/screen")" = 1 ]
on_terminal "$leafcast" verify "$tmp/v.leaf" --threads 1
ok "verify: likewise" [ "$rc" = 0 -a "$(bars "$tmp/screen")" = 0 -a \
    "$(grep -c "^$tmp/v.leaf: sound" "$tmp/screen")" = 1 ]
on_terminal "$leafcast" generate noise --dims $n --threads 1 -o "$tmp/v.nrrd" --force -q
ok "with -q there is nothing at all" [ "$rc" = 0 -a ! -s "$tmp/raw" ]
on_terminal "$leafcast" generate noise --dims $n --threads 1 -o "$tmp/v.nrrd" --force -v
ok "with -v stages, costs, and no bar" [ "$rc" = 0 -a "$(bars "$tmp/screen")" = 0 -a \
    "$(grep -c ' s of CPU' "$tmp/screen")" = 1 -a "$(grep -c ' s: generating' "$tmp/screen")" = 1 ]

# ---- how much is said ----
"$leafcast" generate gyroid --dims 20 -o "$tmp/g.nrrd" -q
"$leafcast" generate buckyball --tets --dims 9 -o "$tmp/m.mesh" -q
"$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" -q
said() { # said ARGUMENT...: how many lines it writes on standard error
    run "$leafcast" "$@"
    [ "$rc" = 0 ] && wc -l <"$tmp/err"
}
while read -r verb arguments; do
    arguments=$(echo "$arguments" | sed "s|@|$tmp/|g")
    # shellcheck disable=SC2086 # arguments
    {
        quiet=$(said "$verb" $arguments -q)
        normal=$(said "$verb" $arguments)
        more=$(said "$verb" $arguments -v)
        most=$(said "$verb" $arguments -vv)
    }
    ok "$verb: -q says nothing, -v more, -vv even more ($quiet, $normal, $more, $most)" \
        [ "$quiet" = 0 -a "$more" -gt "$normal" -a "$most" -gt "$more" ]
done <<'TABLE'
generate gyroid --dims 20 -o @x.nrrd --force
convert @g.nrrd -o @x.leaf --force
convert @m.mesh -o @y.leaf --force
verify @g.leaf
info @g.leaf
render @g.leaf --iso 120 --size 16x16 -o @x.png --force
probe @g.leaf --iso 120 --at 500,500
resample @m.mesh -o @y.nrrd --force
export @g.leaf -o @y.vti --force
export @g.leaf --iso 120 -o @y.ply --force
bench steps @g.leaf --iso 120 --size 16x16 --runs 1
TABLE
for verb in generate convert resample export verify; do
    case $verb in
    generate) set -- gyroid --dims 20 -o "$tmp/x.nrrd" --force ;;
    convert) set -- "$tmp/g.nrrd" -o "$tmp/x.leaf" --force ;;
    resample) set -- "$tmp/m.mesh" -o "$tmp/y.nrrd" --force ;;
    export) set -- "$tmp/g.leaf" -o "$tmp/y.raw" --force ;;
    verify) set -- "$tmp/g.leaf" ;;
    esac
    run "$leafcast" "$verb" "$@" -q
    ok "$verb -q: no summary" [ "$rc" = 0 -a ! -s "$tmp/out" ]
done
run "$leafcast" info "$tmp/g.leaf" -q
ok "info -q: what was asked for" [ -s "$tmp/out" ]
finish
