# Killed at any moment, no tool leaves a wrong file under its final name.
failed=0
kill_nine.sh 40 tool-probe s.glb -o a.out --second b.out --pause 1000 --bytes 4MiB || failed=1
exit $failed
