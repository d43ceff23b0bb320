#!/bin/sh
# `make report` writes a page about the user's scene: sh tests/pipelines/own_scene.sh BIN. Run at the top of the tree.
# A browser without network shows it: the slider moves the border of both pictures, curves have points, no request is
# made. That part is skipped without chromium.
bin=$1 failed=0
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
REPORT_CPU=2 make -s -f Makefile.example report BIN="$bin" SCENE=pipelines/scenes/S1_cornell.glb FRAMES=0 SIZE=32x18 OUT="$work/own" > "$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
page=$work/own/report/scene.html
[ -s "$page" ] || { cat "$work/log"; echo 'no page'; exit 1; }
grep -qE '(src|href)=["'"'"']?(https?:|//|file:)' "$page" && bad 'the page names another file'
for heading in 'Final, and the reference' Curves 'own account' Steadiness 'Where CPU seconds go' Commands; do
  grep -q "<h2>.*$heading" "$page" || bad "no part $heading"
done
grep -q 'make -f Makefile.example SCENE=.*S1_cornell.glb.*FRAMES=0 SIZE=32x18' "$page" || bad 'no command to copy'
command -v chromium > /dev/null || { echo 'the page in a browser: skipped, there is no chromium'; exit $failed; }
cat "$page" - > "$work/tried.html" << 'END'
<script>
addEventListener('load', () => setTimeout(() => {
  const slider = document.getElementById('s'), over = document.getElementById('o');
  slider.value = 20;
  slider.dispatchEvent(new Event('input'));
  document.title = [over.style.clipPath, over.naturalWidth + 'x' + over.naturalHeight, document.querySelectorAll('svg circle').length > 4,
    performance.getEntriesByType('resource').filter(r => !r.name.startsWith('data:')).length].join('; ');
}, 50));
</script>
END
timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$work/browser" --virtual-time-budget=400 --dump-dom "file://$work/tried.html" 2> /dev/null |
  grep -o '<title>[^<]*' > "$work/title"
[ "$(cat "$work/title")" = '<title>inset(0px 80% 0px 0px); 32x18; true; 0' ] || bad "the page in a browser: $(cat "$work/title")"
[ $failed = 0 ] && echo 'report, and its page in a browser, are right'
exit $failed
