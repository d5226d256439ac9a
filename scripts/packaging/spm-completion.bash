# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Completion of spm-servo, spm-bake and spm-bench. Asks the programs themselves for their commands
# and options (--help), so that it knows what the installed version knows. Needs bash 4 and nothing
# else. Goes to /etc/bash_completion.d, or is sourced from ~/.bashrc.

# Commands in the help of a program, a line each.
_spm_commands() {
  "$1" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z0-9-]*\).*/\1/p'
}

# Long options in the help of a program's command, a line each.
_spm_options() {
  "$@" --help 2>/dev/null | sed -n 's/^  \(-[a-zA-Z],\)\{0,1\}\(--[a-z][a-z0-9-]*\).*/\2/p'
}

# Words that an option takes, a line each: "--form sparse|full" has two. Those with a part to be
# filled in, as in "sphere:RADIUS", end with their colon; a capital one ("N") is no word.
_spm_words() {
  local option=$1
  shift
  "$@" --help 2>/dev/null |
    sed -n "s/^  \(-[a-zA-Z],\)\{0,1\}$option \([^ ]*|[^ ]*\).*/\2/p" |
    tr '|' '\n' | sed -n 's/^\([a-z][a-z0-9-]*:\{0,1\}\).*/\1/p'
}

_spm_complete() {
  local program=$1 current=$2 previous=$3
  local command="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then
      command=${COMP_WORDS[i]}
      break
    fi
  done
  COMPREPLY=()
  if [[ -z $command ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_spm_commands "$program") --help --version" -- "$current")
    return
  fi
  # "--form=sp" comes as three words.
  if [[ $current == "=" ]]; then
    current=""
  elif [[ $previous == "=" ]] && ((COMP_CWORD >= 2)); then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  if [[ $previous == --* ]]; then
    mapfile -t COMPREPLY < <(
      compgen -W "$(_spm_words "$previous" "$program" "$command")" -- "$current")
    # A word that still wants its part: no blank after it.
    if ((${#COMPREPLY[@]} == 1)) && [[ ${COMPREPLY[0]} == *: ]]; then
      compopt -o nospace 2>/dev/null
    fi
    ((${#COMPREPLY[@]} > 0)) && return
  fi
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_spm_options "$program" "$command")" -- "$current")
  fi
  # Otherwise the names of files, by -o default below.
}

complete -o default -F _spm_complete spm-servo spm-bake spm-bench
