#!/bin/sh
# scene-plan refuses invalid requests with the right exit code and words: sh tests/pipelines/plan_refuses.sh BIN
# Run at the top of the tree; BIN is the folder with the tools.
bin=$1
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
source=pipelines/scenes/S2_cornell_moving.glb failed=0

# refuses CODE WORDS ARGUMENT...: expects one line on standard error that contains WORDS, and no plan.mk.
refuses() {
  code=$1 words=$2; shift 2
  "$bin/scene-plan" "$@" > "$work/stdout" 2> "$work/stderr"
  got=$?
  if [ $got = "$code" ] && [ "$(wc -l < "$work/stderr")" = 1 ] && grep -q "$words" "$work/stderr" &&
      [ ! -s "$work/stdout" ] && [ ! -e "$work/plan/plan.mk" ]; then echo "ok: $words"
  else echo "FAILED: scene-plan $*: exit $got instead of $code, or not the line '$words' alone:"; cat "$work/stderr"; failed=1
  fi
}

python3 tests/pipelines/edit_gltf.py "$source" "$work/no-camera.glb" drop cameras
python3 tests/pipelines/edit_gltf.py "$source" "$work/no-light.glb" emission 0
refuses 2 'Include > Cameras' "$work/no-camera.glb" --camera Kamera -o "$work/plan"
refuses 2 'Include > Punctual Lights' "$work/no-light.glb" -o "$work/plan"
refuses 2 'no camera.*Kamera' "$source" --camera Kamera -o "$work/plan"
refuses 2 'only letters, digits' "$source" --words 'pixels:$(x)' -o "$work/plan"
refuses 2 'frames' "$source" --frames 5-x -o "$work/plan"
refuses 2 "'foo' is no channel group" "$source" --channels RGBA,foo -o "$work/plan"
refuses 2 "frames need RGBA" "$source" --channels Z,N -o "$work/plan"
: > "$work/file"
refuses 3 'cannot create this folder' "$source" -o "$work/file/plan"
exit $failed
