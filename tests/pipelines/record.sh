#!/bin/sh
# RUN='sh tests/pipelines/record.sh LOG' -- note which stage makes which file, then run it.
log=$1; shift
tool=${1##*/} output=stdout
previous=
for word; do
  case $previous in -o | --json | --png | --sheet) output=${word##*/}; folder=${word%/*}; folder=${folder##*/};; esac
  previous=$word
done
[ $tool = cp ] && output=${3##*/} folder=frames
case $output in plan | report | stdout) ;; *) output=$folder/$output ;; esac
echo "$tool $output" >> "$log"
exec "$@"
