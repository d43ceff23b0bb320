# claim.sh -- of all commands that are to make a file, in all makes on all machines that see OUT, one makes it while the
# others wait. Other scripts read this file and ending.sh.
#
# A process claims a file by a second file in state/, which holds one line: HOST PROCESS BEAT. While the process lives,
# it adds 1 to BEAT every five seconds. A claim is void if its process has ended, which the same host can see, or if the
# line stays the same for half a minute, since the host is then gone. So the clocks of machines need not agree. Claims
# only save work: if two commands make a file at once, the file is right, too, because each writes a whole file under
# another name and then renames it.
held='' beating='' host=''

take() { (set -C; : > "$held") 2> /dev/null; }

is_void() {
  text=$(cat "$held" 2> /dev/null)
  [ "$text" = "$seen" ] && [ -n "$since" ] || { seen=$text since=$(date +%s); }
  process=${text#* }
  case $text in "$host "*) [ -d "/proc/${process% *}" ] || return 0;; esac
  [ $(($(date +%s) - since)) -ge 30 ]
}

is_ours() { line=; read -r line < "$held"; case $line in "$host $$ "*) ;; *) return 1;; esac; } 2> /dev/null

beat() {
  trap stop INT TERM
  number=0
  while ending sleep 5 && kill -0 $$ && is_ours; do
    number=$((number + 1))
    echo "$host $$ $number" > "$held"
  done
}

# hold FILE... --: true if this command is to make the files; false if they are there, as another one has made them.
hold() {
  held=state/.${1%%/*}-${1##*/}.claim host=$(uname -n) since='' seen='' tries=0 slept=0
  until take; do
    if [ ! -e "$held" ]; then
      tries=$((tries + 1))
      [ $tries -lt 9 ] || { held=; break; }   # no file can be made here
    elif is_void; then rm -f "$held"
    else
      ending sleep 1
      slept=$((slept + 1))
      [ $slept != 10 ] || echo "$1: waits for ${seen%% *}, process ${process% *}, which makes it" >&2
    fi
  done
  [ -z "$held" ] || { echo "$host $$ 0" > "$held"; } 2> /dev/null
  for file; do
    [ "$file" != -- ] || break
    [ -e "$file" ] || { begin_to_beat; return 0; }
  done
  let_go
  return 1
}

begin_to_beat() {
  [ -n "$held" ] || return 0
  trap - TERM   # a signal before beat() has its trap would be lost
  beat > /dev/null 2>&1 8>&- & beating=$!
  trap stop TERM
}

let_go() {
  [ -z "$held" ] || ! is_ours || rm -f "$held"
  [ -z "$beating" ] || { kill "$beating" && wait "$beating"; } 2> /dev/null || :
  held='' beating=''
}
