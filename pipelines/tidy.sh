#!/bin/sh
# tidy.sh FOLDER -- removes what killed runs have left in a folder and its subfolders: unfinished files,
# .NAME.tmp.HOST.PROCESS, of processes of this host that have ended, and of other hosts if a day old. A file that a
# process holds locked stays.
[ -d "$1" ] || { echo "$1: is no folder; name a folder of outputs" >&2; exit 2; }
find "$1" -type f -name '.?*.tmp.?*.[1-9]*' -exec sh -c '
  for file; do
    process=${file##*.} host=${file%.*}
    case $process in *[!0-9]* | ??????????*) continue;; esac
    if [ "${host##*.tmp.}" = "$(uname -n)" ]; then [ ! -d "/proc/$process" ]
    else [ -n "$(find "$file" -mtime +0)" ]; fi &&
      { ! command -v flock > /dev/null || flock -n "$file" true; } && rm -f "$file" && echo removed || echo kept
  done' sh {} + |
  awk '{ n[$1]++ }
    END { printf "removed %d unfinished files, kept %d that may still be written\n", n["removed"], n["kept"] }'
