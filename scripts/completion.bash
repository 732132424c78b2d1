# completion.bash - bash completes `leafcast VERB ...`. What there is to complete, a verb of leafcast's own
# says itself (--list-options): names of options, their values where they are words, files by suffix
# elsewhere. Others are not run: they complete files.

_leafcast_own() { "$1" --list-verbs own 2>/dev/null | grep -qxF -- "$2"; }

# What a verb lists: --name, -s, argument, class, text; divided by tabs.
_leafcast_list() { "$1" "$2" --list-options 2>/dev/null </dev/null; }

# The argument of an option (long or short) of such a list; nothing where it takes none.
_leafcast_argument() {
    awk -F '\t' -v option="$1" '$1 == option || ($2 != "" && $2 == option) { print $3; exit }'
}

# Words or files for an argument: a|b|c are words; NAME.png and F.leaf are files of that suffix.
_leafcast_value() {
    local form=$1 word=$2
    case $form in
    *'|'*) mapfile -t COMPREPLY < <(compgen -W "${form//|/ }" -- "$word") ;;
    *DIR*) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    *.[a-z]*)
        local suffix=${form##*.}
        suffix=${suffix%%[!a-z0-9]*}
        mapfile -t COMPREPLY < <(compgen -d -S / -- "$word"; compgen -f -X "!*.$suffix" -- "$word")
        ;;
    FILE* | INPUT* | MESH* | '') mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
    esac
}

_leafcast() {
    local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} verb=${COMP_WORDS[1]-}
    local before=${COMP_WORDS[COMP_CWORD - 1]} list form args
    COMPREPLY=()
    program=${program/#\~\//$HOME/}
    if [ "$COMP_CWORD" -eq 1 ] || { [ "$COMP_CWORD" -eq 2 ] && [ "$verb" = help ]; }; then
        mapfile -t COMPREPLY < <(compgen -W "help $("$program" --list-verbs 2>/dev/null)" -- "$word")
        return
    fi
    if ! _leafcast_own "$program" "$verb"; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        return
    fi
    list=$(_leafcast_list "$program" "$verb")
    args=$(printf '%s\n' "$list" | awk -F '\t' '$1 == "" { print $3; exit }')
    # `--name=` is three words to bash.
    [ "$word" != = ] || word=
    [ "$before" != = ] || before=${COMP_WORDS[COMP_CWORD - 2]}
    case $word in
    -*)
        mapfile -t COMPREPLY < <(compgen -W "$(printf '%s\n' "$list" | cut -f1)" -- "$word")
        return
        ;;
    esac
    form=
    case $before in
    -*) form=$(printf '%s\n' "$list" | _leafcast_argument "$before") ;;
    esac
    # What -o takes, the line of arguments says.
    case $before,$args in
    -o,*'-o '* | --output,*'-o '*) form=${args##*-o } ;;
    esac
    case $form in
    '' | '?'*) _leafcast_value "${args%% -o*}" "$word" ;;
    *) _leafcast_value "$form" "$word" ;;
    esac
}
complete -o filenames -F _leafcast leafcast
