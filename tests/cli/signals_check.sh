# A signal ends a tool as the shell expects and leaves nothing behind.
failed=0
for pair in HUP:1 INT:2 TERM:15 XCPU:24; do
  signal=${pair%:*}
  # An asynchronous job of sh ignores INT; env gives it back.
  env --default-signal=INT,HUP tool-probe s.glb -o a.out --second b.out --bytes 64MiB --pause 20000 & process=$!
  sleep 0.3
  [ "$(find . -name '.*.tmp.*' | wc -l)" = 2 ] || { echo "$signal: no temporaries before: $(ls -A)"; failed=1; }
  kill -$signal $process
  wait $process 2>/dev/null
  code=$?
  [ $code = $((128 + ${pair#*:})) ] || { echo "$signal: exit $code"; failed=1; }
  [ -z "$(ls -A)" ] || { echo "$signal: left $(ls -A)"; failed=1; }
done
# What was ignored at the start stays ignored.
env --ignore-signal=HUP tool-probe s.glb -o a.out --pause 30000 & process=$!
sleep 0.2
kill -HUP $process
wait $process || { echo "an ignored HUP ended the tool: $?"; failed=1; }
[ "$(tail -1 a.out)" = end ] || { echo 'no output after an ignored HUP'; failed=1; }
# Who reads the text has seen enough: no word, the code of PIPE. Where that is ignored it is a write that failed.
{ sleep 0.2; env --default-signal=PIPE tempolux-info --help 2> errors; echo $? > code; } | true
[ "$(cat code)" = 141 ] && [ ! -s errors ] || { echo "a reader that left: $(cat code) $(cat errors)"; failed=1; }
{ sleep 0.2; env --ignore-signal=PIPE tempolux-info --help 2> errors; echo $? > code; } | true
[ "$(cat code)" = 3 ] && grep -q 'standard output: write failed: Broken pipe' errors ||
  { echo "a reader that left, PIPE ignored: $(cat code) $(cat errors)"; failed=1; }
exit $failed
