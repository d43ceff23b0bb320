#!/bin/sh
# follow.sh -- passes a finished picture on. stages.mk runs it inside OUT.
#
#     follow.sh made GOAL FILE RAW...  removes raw pictures as below; if the goal is demo, makes at once what now has
#                              all its inputs: filtered pictures, pictures with smoke, frames, previews. By itself
#                              make would first render the whole range.
#     follow.sh read RAW...    removes raw pictures that all their filtered pictures have read
#     follow.sh was_read RAW   true if all filtered pictures that read it are there: another make may have removed it
#
# The environment has PLAN, MAKE_FILES: the command that makes files of the plan, and CLAIMS: a folder of this make, so
# that two raw pictures of one window do not both filter it.
. "${0%/*}/ending.sh"
goals=
there() { [ -e "$1" ] || case " $goals " in *" $1 "*) ;; *) return 1;; esac; }

# Lines of the plan for files that are made from $1, or from files of an earlier line.
waiting() {
  awk -v file="$1" 'BEGIN { reached[file] }
    $1 == "pictures" { for (i = 3; i <= NF; ++i) follows[$i]; follows["shown"] }
    $2 == "|" && substr($1, 1, index($1, "/") - 1) in follows {
      for (i = 3; i <= NF; ++i) if ($i in reached) { sub(/:$/, "", $1); reached[$1]; print; break }
    }' "$PLAN"
}

next() {
  lines=$(waiting "$1")
  while read -r target _ inputs; do
    [ -n "$target" ] && [ ! -e "$target" ] || continue
    for input in $inputs; do there "$input" || continue 2; done
    [ -z "$CLAIMS" ] || mkdir "$CLAIMS/${target##*/}" 2> /dev/null || continue
    goals="$goals $target"
  done << END
$lines
END
  [ -z "$goals" ] || eval "ending $MAKE_FILES $goals"
  exit 0   # made.sh has noted what failed
}

# Prints "RAW READER" for each filtered picture that reads one of the raw pictures.
readers() {
  awk -v names="$*" 'BEGIN { split(names, list, " "); for (i in list) raw[list[i]] }
    /^filtered\// && $2 == "|" {
      sub(/:$/, "", $1)
      for (i = 3; i <= NF; ++i) if ($i in raw) print $i, $1
    }' "$PLAN"
}

read_by_all() {
  lines=$(readers "$@") all= kept=
  while read -r raw reader; do
    all="$all $raw"
    [ -e "$reader" ] || kept="$kept $raw"
  done << END
$lines
END
  for raw in $all; do case " $kept " in *" $raw "*) ;; *) rm -f "$raw";; esac; done
}

was_read() {
  filtered=$(readers "$1" | cut -d' ' -f2)
  for file in $filtered; do [ -e "$file" ] || return 1; done
  [ -n "$filtered" ]
}

case $1 in
  made) goal=$2 made=$3; shift 3
        [ $# = 0 ] || read_by_all "$@"
        [ "$goal" != demo ] || next "$made";;
  read) shift; read_by_all "$@";;
  was_read) was_read "$2";;
  *) echo "follow.sh: '$1' is none of made, read, was_read" >&2; exit 2;;
esac
