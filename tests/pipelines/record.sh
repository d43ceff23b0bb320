#!/bin/sh
# RUN='sh tests/pipelines/record.sh LOG' -- notes which stage makes which file, then runs the command.
log=$1; shift
tool=${1##*/} output=stdout
previous=
for word; do
  case $previous in -o | --json | --png | --sheet) output=${word##*/}; folder=${word%/*}; folder=${folder##*/};; esac
  previous=$word
done
case "$tool $*" in scene-plan\ * | *\ --digest\ * | *\ --account\ *) exec "$@";; esac   # run each time and are not noted
output=$(echo "$output" | sed 's/-[0-9a-f]\{10\}//')   # the name without its key
output=$(echo "$output" | sed 's|^[.]\(.*\)[.]tmp[.].*|\1|')
case $output in report | stdout | sheet.png) ;; *) output=$folder/$output ;; esac
echo "$tool $output" >> "$log"
exec "$@"
