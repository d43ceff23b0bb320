# expect CODE WORDS COMMAND...: exits so, and says these words in its one line of at most $longest bytes; "" for no word
# at all. Nothing stays of what is refused: no file made.*. For tests that source this file and end with `exit $failed`; bad WORDS says what failed.
failed=0
bad() { echo "$*"; failed=1; }
expect() {
  code=$1 words=$2; shift 2
  rm -f made.*
  "$@" >out.txt 2>errors.txt
  got=$?
  [ $got = "$code" ] || bad "exit $got, not $code: $*: $(cat errors.txt)"
  if [ -z "$words" ]; then [ -s errors.txt ] && bad "$*: $(cat errors.txt)"
  else grep -q -- "$words" errors.txt && [ "$(wc -l <errors.txt)" = 1 ] || bad "not '$words': $*: $(cut -c1-300 errors.txt)"
  fi
  [ "$(wc -c <errors.txt)" -lt "${longest:-4096}" ] || bad "$*: $(wc -c <errors.txt) bytes of message"
  [ "$code" = 0 ] || [ ! -e "$(echo made.*)" ] || bad "left an output: $*"
}
