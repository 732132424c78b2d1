#compdef leafcast
# completion.zsh - zsh completes `leafcast VERB ...`, by what a verb of leafcast's own says of itself
# (--list-options). Others are not run: they complete files.

_leafcast_value() {
    local form=$1
    case $form in
    *'|'*) compadd -- ${(s:|:)form} ;;
    *DIR*) _files -/ ;;
    *.[a-z]*) local suffix=${${form##*.}%%[^a-z0-9]*}; _files -g "*.$suffix" ;;
    FILE* | INPUT* | MESH* | '') _files ;;
    *) _message "$form" ;;
    esac
}

_leafcast() {
    local verb=${words[2]} word=${words[CURRENT]} before=${words[CURRENT-1]} args form name letter
    local line argument text
    local -a options own
    if (( CURRENT == 2 )) || [[ CURRENT -eq 3 && $verb == help ]]; then
        compadd help ${(f)"$(${~words[1]} --list-verbs 2>/dev/null)"}
        return
    fi
    own=(${(f)"$(${~words[1]} --list-verbs own 2>/dev/null)"})
    (( ${own[(Ie)$verb]} )) || { _files; return; }
    while IFS= read -r line; do
        name=${line%%$'\t'*}
        line=${line#*$'\t'}; letter=${line%%$'\t'*}
        line=${line#*$'\t'}; argument=${line%%$'\t'*}
        text=${line##*$'\t'}
        [[ -n $name ]] || { args=$argument; continue; }
        options+=("$name:$text")
        [[ $before == $name || ( -n $letter && $before == $letter ) ]] && form=$argument
    done < <(${~words[1]} $verb --list-options 2>/dev/null </dev/null)
    [[ ( $before == -o || $before == --output ) && $args == *'-o '* ]] && form=${args##*-o }
    if [[ $word == -* ]]; then
        _describe option options
    elif [[ -n $form && $form != '?'* ]]; then
        _leafcast_value $form
    else
        _leafcast_value ${args%% -o*}
    fi
}
_leafcast "$@"
