#!/bin/sh
# RUN='sh tests/pipelines/record.sh LOG' -- note which stage makes which file, then run it.
log=$1; shift
tool=${1##*/} output=
previous=
for word; do
  case $previous in -o | --json | --png | --sheet) output=${word##*/}; folder=${word%/*}; folder=${folder##*/};; esac
  previous=$word
done
[ "$output" = plan ] || output=$folder/$output
echo "$tool $output" >> "$log"
exec "$@"
