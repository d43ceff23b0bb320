#!/bin/sh
# made.sh FILE... -- COMMAND... -- runs a command and looks whether it has made its files. All rules and scripts run the
# tools of the chain by it; scripts read this file and call made().
#
# An exit code of 0 is not enough: srun ends with 0 when its node is lost, and a wrapper in RUN may run nothing. So
# afterwards each FILE must
#   - be there, and not be the file that was there before: tools give a finished file its name, so its inode is new;
#   - be whole (tempolux-info --whole). The files of our tools are. A file that a user's program writes, or that a
#     wrapper copies from another machine, may be cut off. It is removed, or the next make would take it for finished.
#
# A command without its files is named in one line on stderr. If RUN is set, it is run again, up to RETRIES times: the
# next machine may be a better one. A tool that refused its input (2) or could not do it (3) has said why and is not run
# again. A command that is given up is noted in $FAILED, a file of this make, which does not try it once more. The exit
# code is the command's, or 3 if the command said 0. The environment has BIN, RUN, RETRIES, and WAIT: how many seconds a
# file of another machine may need to appear here, if RUN is set.
. "${0%/*}/ending.sh"
wanted='' instead='' may_differ='' lines='' keyed='' called=''

inodes() {   # inodes FILE... --: the inode of each file; "-": there is none
  while [ "$1" != -- ]; do
    if [ -e "$1" ]; then ls -di "$1" | sed 's/^ *//; s/ .*//'; else echo -; fi
    shift
  done
}

is_lost() {   # is_lost INODES FILE... --: sets `missing` to the first file that is not there, or is the old one
  missing=
  for inode in $1; do
    shift
    [ -e "$1" ] && { [ "$inode" = - ] || [ "$inode" != "$(inodes "$1" --)" ]; } || { missing=$1; return 0; }
  done
  return 1
}

is_cut_off() {   # is_cut_off FILE... --: sets `missing` to the first file without an end
  missing=
  while [ "$1" != -- ]; do
    whole=0
    "$BIN/tempolux-info" --whole "$1" > /dev/null 2>&1 || whole=$?
    [ $whole != 1 ] || { missing=$1; return 0; }
    shift
  done
  return 1
}

# Looks again and again while RUN may have written the file on another machine. A host that lists a folder asks the file
# server what is in it.
look_for() {   # look_for INODES FILE... --: sets `missing`
  tries=0
  while is_lost "$@" && [ -n "$RUN" ] && [ $tries -lt $((5 * ${WAIT:-5})) ]; do
    ending sleep .2
    case $missing in */*) ls "${missing%/*}";; *) ls;; esac > /dev/null 2>&1
    tries=$((tries + 1))
  done
  [ -z "$missing" ]
}

# not_made FILE TOOL WHY: the command is given up.
not_made() {
  [ -z "$FAILED" ] || printf '%s\t%s\t%s\n' "$@" >> "$FAILED"
  case $3 in 'ended with '[23]) return;; esac   # the tool has said why
  echo "$1: not made: $2 $3" >&2
}

# given_up FILE: true if this make has failed to make it.
given_up() { [ -s "$FAILED" ] && cut -f1 "$FAILED" | grep -qxF -- "$1"; }

tool_of() {   # tool_of COMMAND...: the tool of a command that may begin with the words of RUN
  for word; do case $word in "$BIN"/*) echo "${word##*/}"; return;; esac; done
  echo "${1##*/}"
}

show() {   # show COMMAND...: prints a command that can be typed
  for word; do case $word in *[!A-Za-z0-9_./:=,+%@-]*) printf "'%s' " "$word";; *) printf '%s ' "$word";; esac; done
  echo
}

# What the command for a file needs, in words of RUN: sets `memory`, such as 380M, and `time`, such as 0:01:01. $NEED
# has the megabytes and seconds of a job. $NEEDS is a file with the megabytes and seconds of one command by folder
# (jobs.sh needs). A file of no stage, such as a preview, gets as much as the largest command. Before there is a plan,
# a command gets 1 GB and half an hour.
need_of() {   # need_of FILE TIMES: twice as much, so many times
  need=${NEED:-$( { cat "$NEEDS" || echo; } 2> /dev/null | awk -v folder="${1%%/*}" '
    $1 == folder { memory = $2; time = $3; exit }
    $2 > memory { memory = $2 }
    $3 > time { time = $3 }
    END { print memory ? memory " " time : "1024 1800" }')}
  memory=$((${need% *} << $2))M time=$((${need#* } << $2))
  time=$(printf '%d:%02d:%02d' $((time / 3600)) $((time % 3600 / 60)) $((time % 60)))
}

# The command of made()'s arguments: run_it N WORD1 ... WORDN -- COMMAND...
run_it() {
  printed=${lines:+$2}
  shift $(($1 + 2))
  case $RUN in *'{'*)
    need_of "$named" $doubled
    left=$(set -f; set -- $RUN; echo $#)
    for word; do
      shift
      [ $((left -= 1)) -lt 0 ] ||
        word=$(echo "$word" | sed "s/{mem}/$memory/g; s/{time}/$time/g; s/{threads}/${THREADS:-$(nproc)}/g")
      set -- "$@" "$word"
    done;;
  esac
  [ -z "$V" ] || show "$@" >&2
  if [ -n "$printed" ]; then ending "$@" > "$printed"; else ending "$@"; fi
}
name_it() { shift $(($1 + 2)); echo "${called:-$(tool_of "$@")}"; }

# Sets `why` to the reason if the command, which ended with the code $1, has not made its files; else to "".
judge() {   # judge CODE INODES FILE... --
  judged=$1 why=; shift
  case $judged in
    0) ;;
    1) [ -n "$may_differ" ] || why='ended with 1';;
    2) # Another make may have made the file and removed an input.
       [ -n "$1" ] && ! is_lost "$@" || why='ended with 2'; return 0;;
    1[3-9]?) why="was ended by signal $((judged - 128))";;
    *) why="ended with $judged";;
  esac
  [ -z "$why" ] || return 0
  if [ -n "$lines" ]; then
    [ "$(wc -l < "$2")" -ge "$lines" ] || why="ended with $judged and has not printed its answer"
    return 0
  fi
  if ! look_for "$@"; then
    [ -z "$instead" ] || [ ! -e "$instead" ] || return 0
    case $missing in raw/*) ! sh "${0%/*}/follow.sh" was_read "$missing" || return 0;; esac
    why="ended with $judged, but $missing is not there${RUN:+; RUN has lost the command}"
    return 0
  fi
  shift
  ! is_cut_off "$@" || { why="ended with $judged, but $missing was cut off and is removed"; rm -f "$missing"; }
}

# worth_again ROUND CODE: whether a command without its files runs again.
worth_again() {
  case $2 in [23]) return 1;; esac
  [ -n "$RUN" ] && [ "$1" -lt "${RETRIES:-2}" ]
}

# made FILE... -- COMMAND... Variables: `wanted`: the file that messages name where FILE is a temporary one;
# `may_differ`: not empty if exit code 1 is an answer (aqm-compare); `instead`: a file for which FILE is made and that
# another make may have made, and removed FILE; `lines`: FILE gets what the command prints, at least so many lines;
# `keyed`: not empty if a FILE that was there before is right, as its name says what it is; `called`: the name of the
# command.
made() {
  files_wanted=0 round=0 doubled=0
  for word; do [ "$word" != -- ] || break; files_wanted=$((files_wanted + 1)); done
  named=${wanted:-$1}
  ! given_up "$named" || return 3
  while :; do
    old=$(inodes "$@") ended=0
    [ -z "$keyed" ] || old=$(echo "$old" | sed 's/.*/-/')
    run_it $files_wanted "$@" || ended=$?
    judge $ended "$old" "$@"
    [ -n "$why" ] || return $((ended == 1))
    worth_again $round $ended || break
    round=$((round + 1))
    # Killed or lost: perhaps for want of memory or time. Other codes may be those of a queue that has refused so much.
    case $ended in 0 | 1[3-9]?) doubled=$((doubled + 1));; esac
    echo "$named: not made: $(name_it $files_wanted "$@") $why; it is run again ($round of ${RETRIES:-2})" >&2
  done
  not_made "$named" "$(name_it $files_wanted "$@")" "$why"
  [ $ended -gt 1 ] || ended=3
  return $ended
}

# answer LINES -- COMMAND...: sets `answered` to what the command prints, if it prints at least so many lines. It is in
# the file $part meanwhile. `wanted` is the file for which the answer is needed.
answer() {
  lines=$1 answer_code=0 answered=; shift
  made "$part" "$@" || answer_code=$?
  lines=
  [ $answer_code != 0 ] || answered=$(cat "$part")
  rm -f "$part"
  return $answer_code
}

# finished FILE: with RUN, words about the command that has made it.
finished() {
  [ -z "$RUN" ] || [ -n "$V" ] || [ -z "$PROGRESS" ] || sh "$PIPELINES/progress.sh" say "$1"
}

case ${0##*/} in
  made.sh)
    . "${0%/*}/claim.sh"
    trap let_go EXIT
    hold "$@" || exit 0
    case $1 in raw/*) ! sh "${0%/*}/follow.sh" was_read "$1" || exit 0;; esac   # by another make
    made "$@" && finished "$1";;
esac
