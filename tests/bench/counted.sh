#!/bin/sh
# counted.sh FOLDER COMMAND [ARGUMENT...] -- runs COMMAND under callgrind; FOLDER/TOOL.PID says how many instructions it
# took. Tools of the list UNCOUNTED run alone, and all do where there is no valgrind.
log=$1
shift
case " $UNCOUNTED " in *" ${1##*/} "*) exec "$@" ;; esac
command -v valgrind > /dev/null || exec "$@"
exec valgrind --tool=callgrind --callgrind-out-file=/dev/null --log-file="$log/${1##*/}.%p" "$@"
