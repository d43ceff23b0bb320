#!/bin/sh
# looks.sh BIN_DIR -- `make compare` writes a page of two runs that loads no other file; its slider, flicker and film
# strip work in a browser. `make film` makes a film, or prints one line that names what is missing. The browser's part
# is skipped without chromium.
bin=$(cd "$1" && pwd) || exit 1
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "looks: $*" >&2; exit 1; }
run() { make -f Makefile.example "$@" BIN="$bin" FRAMES=0,3 SIZE=32x18 QUALITY=draft PHOTONS=2k POINTS='--point-count 300' SCENE=pipelines/scenes/S2_cornell_moving.glb > "$work/log" 2>&1; }
run demo OUT="$work/a" && run demo OUT="$work/b & <b>" PIXELS='--spp 1 --pixel-error 0' || bad "two runs: $(tail -3 "$work/log")"
grep -q '^\[1/[0-9]*\] 0:0' "$work/log" && grep -q ', pixels$' "$work/log" || bad "no words of progress: $(cat "$work/log")"
grep -q '^2 frames of 32x18.* CPU s' "$work/log" || bad "no last line: $(tail -3 "$work/log")"
run demo OUT="$work/w" METHOD=walkthrough || bad "a walkthrough of two frames: $(tail -3 "$work/log")"
grep -q '^METHOD=walkthrough: no frame is warped: light transport differs' "$work/log" || bad "a walkthrough that warps nothing: $(head -3 "$work/log")"
# Of measured pictures those of this plan count: 25 %, not the 90 % of a picture of another wish.
picture=$(sed -n 's/^ *"0003": "\([^"]*\)",*$/\1/p' "$work/a/plan.json")
printf '%s\n' "{\"picture\": \"pictures/0003-0.exr\", \"tried\": [{\"photons\": 0, \"aqm\": 0.9}]}," \
  "{\"picture\": \"$picture\", \"tried\": [{\"photons\": 0, \"aqm\": 0.25}]}" > "$work/a/measured.json"
last=$(progress=$PWD/pipelines/progress.sh && cd "$work/a" && BIN=$bin SIZE=32x18 OUT=. sh "$progress" end)
case $last in *'a viewer sees noise in 25.0 % of the pixels (make measure)'*) ;; *) bad "measured: $last";; esac
# Noise is the root mean square over the frames. A frame with more than ten times the noise of its preset is named.
said() { for file in "$work/a/filtered/$1-"*.json; do sed "s/\"noise.codes\": [^,]*/\"noise.codes\": $2/" "$file" > "$work/said" && cp "$work/said" "$file"; done; }
ends() { (progress=$PWD/pipelines/progress.sh && cd "$work/a" && BIN=$bin SIZE=32x18 QUALITY=$1 ERROR='' PIXELS='' OUT=. sh "$progress" end); }
said 0000 10; said 0003 26
last=$(ends draft)
case $last in *'noise, without bias, 19.7 of 255'*) ;; *) bad "not the root mean square of 10 and 26: $last";; esac
case $last in *warning*) bad "a warning in a draft with the noise of one: $last";; esac
case $last in *'; audit: '* | *'; no bias, '* | *'; not audited, '*) ;; *) bad "no audit, and no reason: $last";; esac
case $(ends final) in *'warning: noise is seen: frame 3 has 26 brightness steps of noise, most of it in layer '*' 0.9 are asked for; '*) ;; *) bad "no warning: $(ends final)";; esac
# The layer with the most noise decides what is advised.
edges() { for file in "$work/a/filtered/0003-"*.json; do sed 's/"noise.direct.codes": [^,]*/"noise.direct.codes": 25/; s/"noise.indirect.codes": [^,]*/"noise.indirect.codes": 1/' "$file" > "$work/said" && cp "$work/said" "$file"; done; }
edges
case $(ends final) in *'in layer direct, 0.9 are asked for; a smaller ERROR'*) ;; *) bad "no advice for direct light: $(ends final)";; esac
# A warning if all frames are black, none if one of them is.
case $(ends final) in *'all is black'*) bad "bright frames are said to be black";; esac
black() { for file in "$work/a"/raw/"$1"-*.json; do sed 's/"mean_radiance": [^,]*/"mean_radiance": 0/' "$file" > "$work/said" && cp "$work/said" "$file"; done; }
black 0000
case $(ends final) in *'all is black'*) bad "one black frame of two";; esac
black 0003
case $(ends final) in *'warning: all is black: the camera sees neither'*'SKY=1,1,1'*) ;; *) bad "nothing says that all is black: $(ends final)";; esac
run compare OUT="$work/a" OTHER="$work/b & <b>" && [ -s "$work/a/compare.html" ] || bad "compare: $(cat "$work/log")"
grep -o 'src=.\{9\}\|href=.\{9\}\|https\{0,1\}:\|url(' "$work/a/compare.html" | grep -v '^src="data:ima' | head -3 | grep . && bad 'the page asks for something outside'
run compare OUT="$work/a" OTHER="$work/none" && bad 'compare with nothing'
grep -q 'none: has no frames; OTHER=FOLDER names' "$work/log" || bad "compare with nothing: $(cat "$work/log")"

if command -v ffmpeg > /dev/null; then
  run film OUT="$work/a" && [ -s "$work/a/film.mp4" ] || bad "film: $(tail -3 "$work/log")"
  n=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "$work/a/film.mp4") && [ "${n%,}" = 2 ] || bad "the film has $n frames"
else
  run film OUT="$work/a" && bad 'film without ffmpeg'
  grep -q 'there is no ffmpeg; install it' "$work/log" || bad "film without ffmpeg: $(tail -1 "$work/log")"
fi

command -v chromium > /dev/null || { echo 'compare and film are right; the page in a browser: skipped, there is no chromium'; exit 0; }
# A script at the page's end moves the slider, presses keys, and stores the result in the title.
sed 's|</html>||' "$work/a/compare.html" > "$work/tried.html"
cat >> "$work/tried.html" << 'END'
<script>
addEventListener('load', () => setTimeout(() => {
  const seen = [], b = () => document.querySelector('section.shown img.b');
  const note = () => seen.push(document.querySelector('section.shown').dataset.frame + ' ' + b().style.clipPath);
  note();
  document.getElementById('split').value = 20;
  document.getElementById('split').dispatchEvent(new Event('input'));
  note();
  dispatchEvent(new Event('x'));
  document.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));
  note();
  document.dispatchEvent(new KeyboardEvent('keydown', {key: ' '}));
  note();
  document.getElementById('strip').firstChild.click();
  note();
  seen.push(b().naturalWidth + 'x' + b().naturalHeight + ', ' + document.getElementById('strip').children.length + ' in the strip');
  document.title = seen.join('; ');
}, 50));
</script>
END
want='0000 inset(0px 0px 0px 50%); 0000 inset(0px 0px 0px 20%); 0003 inset(0px 0px 0px 20%); 0003 inset(0px 0px 0px 100%); 0000 inset(0px 0px 0px 100%); 32x18, 2 in the strip'
timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$work/browser" --virtual-time-budget=400 --dump-dom "file://$work/tried.html" 2> /dev/null |
  grep -o '<title>[^<]*' > "$work/title"
[ "$(cat "$work/title")" = "<title>$want" ] || bad "the page in a browser: $(cat "$work/title")"
echo 'compare, its page in a browser, and film are right'
