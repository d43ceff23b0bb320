# ending.sh -- ending COMMAND...: runs a command that ends when this script is told to. Read by scripts beside it.
#
# A shell acts on a signal when its command has ended: one that is stopped would leave the command running. The command runs in the background.
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
