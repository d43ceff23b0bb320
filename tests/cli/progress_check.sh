# A bar is drawn only on a terminal, only when the work takes longer than a second, and is gone at the end.
command -v script > /dev/null || { echo 'skipped: no script(1), which makes a terminal'; exit 77; }
script -qec true /dev/null < /dev/null > /dev/null 2>&1 || { echo 'skipped: no terminal can be made here'; exit 77; }
failed=0
bad() { echo "$*"; failed=1; }
on_terminal() { script -qec "TERM=${terminal:-xterm} $1" /dev/null < /dev/null > seen 2>&1; }
slow='tool-probe s.glb --bytes 2MiB --pause 60000 -o a.out'   # 32 blocks of 60 ms: 1.9 s at least
has_bar() { grep -q 'tool-probe \[[#.]\{40\}\] *[0-9]* %' seen; }

on_terminal "$slow"; has_bar || bad "no bar on a terminal: $(cat seen)"
[ "$(tail -c 4 seen | od -An -tx1 | tr -d ' \n')" = 0d1b5b4b ] || bad "the bar is left behind: $(tail -c 20 seen | od -c)"
on_terminal "$slow --quiet"; has_bar && bad '--quiet draws a bar'
terminal=dumb on_terminal "$slow"; has_bar && bad 'a bar on a dumb terminal'
on_terminal "$slow 2> err"; has_bar && bad 'a bar though standard error is a file'
[ -s err ] && bad "words in a file: $(cat err)"
on_terminal 'tool-probe s.glb --bytes 128KiB -o a.out'; has_bar && bad 'a bar for a moment of work'
# The tools with long work give their progress.
for source in stages/trace_photons stages/build_records stages/gather_frames stages/compose_smoke stages/render_frame stages/compare_frames info/info_answer stages/planning; do
  grep -qE 'progress(_sink)?\(' "$HERE/../../tools/$source.cpp" || bad "$source says nothing of its progress"
done
exit $failed
