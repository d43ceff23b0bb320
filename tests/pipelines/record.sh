#!/bin/sh
# RUN='sh tests/pipelines/record.sh LOG' -- note which stage makes which file, then run it.
log=$1; shift
tool=${1##*/} output=stdout
previous=
for word; do
  case $previous in -o | --json | --png | --sheet) output=${word##*/}; folder=${word%/*}; folder=${folder##*/};; esac
  previous=$word
done
[ $tool = scene-plan ] && exec "$@"   # looks at every run
output=$(echo "$output" | sed 's/-[0-9a-f]\{10\}//')   # without its key
output=$(echo "$output" | sed 's|^[.]\(.*\)[.]tmp[.].*|\1|')
case $output in report | stdout | sheet.png) ;; *) output=$folder/$output ;; esac
echo "$tool $output" >> "$log"
exec "$@"
