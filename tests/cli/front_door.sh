#!/bin/sh
# front_door.sh - leafcast VERB: finds its own verbs, then those on PATH; help, version, slips.
. tests/support/tap.sh

mkdir "$tmp/bin" "$tmp/libexec" "$tmp/user"
cp "$leafcast" "$tmp/bin/leafcast"
verb() { # verb FILE TEXT: a verb that says TEXT and its arguments
    cat >"$1" <<SCRIPT
#!/bin/sh
[ "\${1-}" != --help ] || { printf "Usage: x [OPTION]\\n           [MORE]\\nDoes\\n$2. More.\\n"; exit; }
echo $2 "\$#" "\$@"
exit 5
SCRIPT
    chmod +x "$1"
}
verb "$tmp/libexec/leafcast-convert" own
verb "$tmp/user/leafcast-convert" foreign
verb "$tmp/user/leafcast-polish" user
PATH=$tmp/user:$PATH
door=$tmp/bin/leafcast
says() { grep -q -- "$1" "$tmp/$2"; }

exits "a verb's exit status is passed on" 5 "$door" convert "a b" -o c
ok "its arguments are untouched, its own come first" says '^own 3 a b -o c$' out
exits "a verb on PATH" 5 "$door" polish x
ok "is run" says '^user 1 x$' out
exits "help" 0 "$door" --help
ok "lists own verbs with their line" says '^  convert *Does own$' out
ok "lists the user's" says '^  polish .*user/leafcast-polish' out
ok "lists a shadowed verb once" [ "$(grep -c '^  convert' "$tmp/out")" = 1 ]
exits "help VERB" 0 "$door" help convert
ok "is the verb's own" says 'own. More.' out
exits "version" 0 "$door" --version
ok "says it" says '^leafcast [0-9]*\.[0-9]*\.[0-9]*$' out
ok "and what is left out" says '^without: .*import-vdb (OpenVDB)' out
: >"$tmp/libexec/leafcast-import-vdb"
chmod +x "$tmp/libexec/leafcast-import-vdb"
exits "version with a library" 0 "$door" --version
ok "says what is in" says '^with: import-vdb (OpenVDB)$' out
rm "$tmp/libexec/leafcast-import-vdb"
exits "a slip" 2 "$door" covnert
ok "is told" says "no verb 'covnert'; did you mean 'convert'" err
exits "an unknown verb" 2 "$door" zzz
ok "gets no silly suggestion" [ "$(grep -c 'did you mean' "$tmp/err")" = 0 ]
exits "no verb" 2 "$door"
ok "prints nothing on standard output" [ ! -s "$tmp/out" ]
exits "no path as a verb" 2 "$door" ../convert

ln -s "$door" "$tmp/link"
ln -s link "$tmp/chain"
exits "called through links" 5 "$tmp/chain" convert
ok "finds its own verbs" says '^own 0' out
mkdir "$tmp/libexec/leafcast"
mv "$tmp/libexec/leafcast-convert" "$tmp/libexec/leafcast"
exits "the installed layout" 5 "$door" convert
ok "finds its own verbs there" says '^own 0' out
finish
