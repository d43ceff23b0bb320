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
exit $failed
