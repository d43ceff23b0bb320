# ending.sh -- ending COMMAND...: runs a command and ends it when this script gets a signal. Other scripts read this
# file.
#
# A shell acts on a signal only after its command has ended, so a script that is stopped would leave the command
# running. Therefore the command runs in the background.
child=
stop() { [ -z "$child" ] || { kill "$child"; wait "$child"; } 2> /dev/null; exit 130; }
trap stop INT TERM
ending() {
  "$@" &
  child=$! code=0
  wait "$child" || code=$?
  child=
  return $code
}
