# Outputs are whole under their final name or not there at all.
failed=0
bad() { echo "$*"; failed=1; }
left() { find . -name '.*.tmp.*' | grep -q . && bad "$1: a temporary is left: $(ls -A)"; }

# A disk that runs full, for one output and for the second of two.
full_disk.sh 1024 tool-probe s.glb -o a.out --bytes 4MiB || failed=1
full_disk.sh 1024 tool-probe s.glb -o a.out --second b.out --bytes 4MiB --stats s.json || failed=1

# A folder that cannot be written is noticed before the work (which would take 16 s).
begin=$(date +%s)
mkdir closed && chmod a-w closed
target=closed/a.out
[ "$(id -u)" = 0 ] && target=/sys/a.out     # root may write anywhere but there
tool-probe s.glb -o $target --pause 1000000 2>errors.txt
[ $? = 3 ] && grep -q "$target: cannot create: " errors.txt || bad "closed folder: $(cat errors.txt)"
tool-probe s.glb -o a.out --stats $target --pause 1000000 2>errors.txt
[ $? = 3 ] && grep -q "$target: cannot create: " errors.txt || bad "--stats in a closed folder: $(cat errors.txt)"
[ $(($(date +%s) - begin)) -lt 5 ] || bad 'closed folder: noticed late'
[ -e a.out ] && bad 'closed folder for --stats: output made all the same'
left 'closed folder'

# An error after the output was opened leaves the old file as it is.
echo old >a.out
tool-probe s.glb -o a.out --work input-error 2>/dev/null
[ "$(cat a.out)" = old ] || bad 'an error changed the old output'
left 'an error'

# So does a limit of memory; sanitizers reserve more address space than any limit.
if ! ldd "$(command -v tool-probe)" | grep -q libasan; then
  tool-probe s.glb -o a.out --work memory --max-memory 300MiB 2>errors.txt
  [ $? = 3 ] && grep -q 'not enough memory within --max-memory 314572800 bytes' errors.txt || bad "memory: $(cat errors.txt)"
  [ "$(cat a.out)" = old ] || bad 'lack of memory changed the old output'
fi

# The new file has the mode of the old one; of a link, the file it points to is replaced.
chmod 640 a.out && ln -s a.out link.out
tool-probe s.glb -o link.out || bad 'link'
[ -L link.out ] && [ "$(tail -1 a.out)" = end ] || bad 'a link was replaced'
[ "$(stat -c %a a.out)" = 640 ] || bad "mode is $(stat -c %a a.out)"
# Devices and pipes are written in place.
tool-probe s.glb -o /dev/null || bad '/dev/null'
[ -c /dev/null ] || bad '/dev/null is no device any more'
# Files in /dev/shm are files: a shorter one replaces a longer one whole.
if [ -w /dev/shm ]; then
  shared=/dev/shm/outputs_check.$$
  tool-probe s.glb -o $shared --bytes 2MiB && tool-probe s.glb -o $shared || bad "$shared"
  [ "$(wc -c <$shared)" -lt 2097152 ] || bad "$shared: the old file's end is left"
  rm -f $shared
fi
mkfifo pipe
cat pipe >from_pipe & tool-probe s.glb -o pipe; wait
[ "$(tail -1 from_pipe)" = end ] || bad 'pipe'
tool-probe s.glb -o - >from_stdout && cmp -s from_stdout from_pipe || bad 'standard output differs'

# What a killed run left goes away; what a living one, another host or another target has, stays.
host=$(hostname)
sh -c 'exit 0' & dead=$!; wait $dead
sleep 30 & alive=$!
for name in .a.out.tmp.$host.$dead .a.out.tmp.$host.$alive .a.out.tmp.elsewhere.$dead .b.out.tmp.$host.$dead \
            .a.out.tmp.$host.x .a.out.tmp.$host.; do echo x >"$name"; done
tool-probe s.glb -o a.out || bad 'run beside temporaries'
kill $alive
[ "$(find . -name '.*.tmp.*' | wc -l)" = 5 ] || bad "temporaries: $(ls -A)"
[ -e .a.out.tmp.$host.$dead ] && bad 'the temporary of a dead process stays'
rm -f .*.tmp.*

# Two writers of one target: either one's file, whole.
tool-probe one.glb -o two.out --pause 3000 & tool-probe two.glb -o two.out --pause 3000; wait
[ "$(tail -1 two.out)" = end ] && head -1 two.out | grep -Eq 'one.glb|two.glb' || bad 'two writers'
left 'two writers'

# A name too long for the temporary's additions.
long=$(printf '%0250d' 0)
tool-probe s.glb -o "$long" && [ "$(tail -1 "$long")" = end ] || bad 'long name'

# Statistics and flush to zero; equal bytes for any number of threads.
for n in 1 2 3 7; do tool-probe s.glb -o t$n.out --threads $n --stats t$n.json; cmp t1.out t$n.out || failed=1; done
"${PYTHON:-python3}" - <<'END' || bad 'statistics'
import json
s = json.load(open("t3.json"))
assert list(s) == ["schema", "version", "tool", "tool_version", "command", "host", "exit_code", "threads", "cpu_s", "wall_s",
                   "peak_memory_bytes", "phases", "counts", "results"], list(s)
assert (s["schema"], s["version"], s["tool"], s["threads"], s["exit_code"]) == ("tempolux.stats", "1.1", "tool-probe", 3, 0)
assert s["command"].endswith("tool-probe s.glb"), s["command"]
assert s["counts"] == {"bytes": 1048576} and s["results"] == {"flush_to_zero": 1}
phase, = s["phases"]
assert phase["name"] == "write" and phase["parallel"] is True
assert 0 <= phase["cpu_s"] <= s["cpu_s"] and 0 < phase["wall_s"] <= s["wall_s"] < 60
assert 1e6 < s["peak_memory_bytes"] < 1e9
END
exit $failed
