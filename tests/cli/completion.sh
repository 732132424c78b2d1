#!/bin/sh
# completion.sh - bash completes verbs, options, their words and files; all that a verb lists.
# marks: plain, long
. tests/support/tap.sh

command -v bash >/dev/null || { skip "completion" "no bash here"; finish; }
files=$tmp/files
mkdir -p "$files/folder"
touch "$files/a.leaf" "$files/b.leaf" "$files/a.nrrd" "$files/p.png"
here=$PWD
cat >"$tmp/complete" <<'BASH'
# complete WORD...: what completes the last of these words, a line each
source "$1"
cd "$2" || exit 1
shift 2
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_leafcast
printf '%s\n' "${COMPREPLY[@]}" | sort
BASH
completes() { bash "$tmp/complete" "$here/scripts/completion.bash" "$files" "$leafcast" "$@" >"$tmp/out" 2>"$tmp/err"; }
gives() { # gives NAME "WORDS OF THE LINE" "COMPLETIONS"
    # shellcheck disable=SC2086 # words
    completes $2 ${4+"$4"}
    ok "$1" [ "$(tr '\n' ' ' <"$tmp/out")" = "$3 " -a ! -s "$tmp/err" ]
}

completes ""
"$leafcast" --help | sed -n 's/^  \([a-z0-9-]*\) .*/\1/p' >"$tmp/verbs"
{ cat "$tmp/verbs"; echo help; } | sort >"$tmp/want"
ok "all verbs" cmp -s "$tmp/want" "$tmp/out"
gives "the rest of a verb" "conv" "convert"
gives "a verb that is asked about" "help conv" "convert"
while read -r verb; do
    completes "$verb" --
    "$leafcast" "$verb" --help-all | grep -E '^ *(-[a-z], )?--' | grep -oE -- '--[a-z][a-z0-9-]*' | sort -u >"$tmp/want"
    ok "$verb: all options of --help-all" cmp -s "$tmp/want" "$tmp/out"
    ok "$verb: without a word on standard error" [ ! -s "$tmp/err" ]
done <"$tmp/verbs"
gives "the rest of an option" "render --iso-l" "--iso-list"
gives "treelet files" "render" "a.leaf b.leaf folder/" ""
gives "of which one" "verify a" "a.leaf"
gives "any input" "convert a" "a.leaf a.nrrd"
gives "what convert writes" "convert a.nrrd -o b" "b.leaf"
gives "pictures" "render a.leaf -o p" "p.png"
gives "likewise by the long name" "render a.leaf --output p" "p.png"
gives "and behind =" "render a.leaf --output = p" "p.png"
gives "words of an option" "render --shading p" "phong"
gives "all of them" "render --backend" "arena auto mapped" ""
gives "words behind =" "convert --build = s" "sah"
gives "a file behind options" "render --shadows b" "b.leaf"
gives "folders" "bench --out f" "folder"

program=$leafcast
# shellcheck disable=SC2088 # for the completion to expand
leafcast='~/leafcast'
home=$HOME
export HOME="$tmp"
ln -s "$program" "$tmp/leafcast"
gives "a program in the home folder" "render --iso-l" "--iso-list"
leafcast=$program
export HOME="$home"

# A verb of the user's, which notes that it was run.
printf '#!/bin/sh\ntouch "%s/ran"\n' "$tmp" >"$tmp/leafcast-mine"
chmod 755 "$tmp/leafcast-mine"
path=$PATH
PATH=$tmp:$PATH
gives "a verb on PATH" "min" "mine"
gives "takes files" "mine a" "a.leaf a.nrrd"
ok "and is not run" [ ! -e "$tmp/ran" ]
PATH=$path

root=$tmp/root
case ${LEAFCAST_BUILD:-$PWD/build/release} in
*/build/release)
    exits "make install" 0 make -s install DESTDIR="$root" PREFIX=/opt
    ok "installs both" [ -s "$root/opt/share/bash-completion/completions/leafcast" -a \
        -s "$root/opt/share/zsh/site-functions/_leafcast" ]
    ;;
*) skip "make install" "only the release build is installed" ;;
esac
if command -v zsh >/dev/null; then
    exits "zsh reads its own" 0 zsh -n scripts/completion.zsh
else
    skip "zsh reads its own" "no zsh here"
fi
finish
