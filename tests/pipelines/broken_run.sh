#!/bin/sh
# RUN='sh tests/pipelines/broken_run.sh FOLDER WHAT WHICH' -- runs commands, and spoils one of them. FOLDER/N/command
# holds the words of the Nth command.
#
#     lost     ends with 0 without running
#     killed   is killed with -9 after it has begun
#     cut      its file loses its second half, as if a wrapper had copied it badly
#     late     its file is seen a second later, as on a shared folder
#     failing  ends with 1 without running; with a kind as WHICH: all commands of this kind
#
# WHICH is a number, or the kind of the command: its tool and the folder or the option of what it makes, such as
# frame-render:raw. Of a kind the first command is spoiled.
folder=$1 what=$2 which=$3; shift 3
number=1
until mkdir "$folder/$number" 2> /dev/null; do number=$((number + 1)); done
kind=${1##*/}: output= previous=
for word; do
  case $previous in -o | --png | --sheet) output=$word;; --json) case $word in /* | [a-z]*/*) output=$word;; esac;; esac
  previous=$word
done
case ${1##*/},$output in
  scene-plan,*) kind=scene-plan;;
  *,*/*) place=${output%/*} place=${place##*/}; case $place in *.try.*) place=walk;; esac; kind=$kind$place;;
  *,?*) kind=${kind}sheet;;
  *,) kind=${kind}exposure;;
esac
case " $* " in *" --digest "*) kind=${1##*/}:digest;; *" --account "*) kind=${1##*/}:account;; esac
case $2 in */job.sh) kind=job:;; esac
case $output in *.part.*) kind=$kind-part;; *.raw.exr) kind=$kind-raw;; esac
case " $* " in *" --map static "*) kind=$kind-static;; *" --map dynamic "*) kind=$kind-dynamic;; *" --update "*) kind=$kind-update;; esac
{ echo "$kind"; echo "$*"; } > "$folder/$number/command"
spoiled=
case $which in
  "$number") spoiled=yes;;
  "$kind") [ "$what" = failing ] || mkdir "$folder/spoiled" 2> /dev/null && spoiled=yes;;
esac
[ -n "$spoiled" ] || exec "$@"
[ -d "$folder/spoiled" ] || mkdir "$folder/spoiled"
echo "$kind" > "$folder/spoiled/kind"
case $what in
  lost) exit 0;;
  failing) exit 1;;
  killed) "$@" & kill -9 $!; wait $!; exit;;
  cut) "$@" && head -c "$(($(wc -c < "$output") / 2))" "$output" > "$folder/half" && cat "$folder/half" > "$output";;
  late) "$@" && mv "$output" "$output.late" && { (sleep 1; mv "$output.late" "$output") > /dev/null 2>&1 & };;
esac
