# aqm-compare: figures known on paper, exit codes, refusals that name the place and the remedy.
exr() { "${PYTHON:-python3}" "$HERE/make_exr.py" "$@"; }
try() { echo "> $*"; aqm-compare "$@"; echo "exit $?"; }
scene='@tempolux:identity.lights=aa @tempolux:identity.materials=bb'
exr x.exr 32x16 R=0.75 G=0.75 B=0.75 $scene
exr r.exr 32x16 R=0.5 G=0.5 B=0.5 $scene
exr a.exr 32x16 R=0.25 G=0.25 B=0.25 $scene
exr walls.exr 32x16 'R=1.03|0.97' 'G=1.03|0.97' 'B=1.03|0.97' 'id.object:id=1|2' $scene
exr ones.exr 32x16 R=1 G=1 B=1 Z=2 indirect.R=0 indirect.G=0 indirect.B=0 $scene
exr other.exr 32x16 R=1 G=1 B=1 @tempolux:identity.lights=cc @tempolux:identity.materials=bb
exr stranger.exr 32x16 R=1 G=1 B=1
exr small.exr 16x16 R=1 G=1 B=1 $scene
exr right.exr 32x16 'mask=0|1'
exr hole.exr 32x16 'R=nan|1.5' G=1.5 B=1.5 $scene

# x - r = 1/4 everywhere; with halves .25 and .5, (x-r1)(x-r2) = 1/8 and their own noise is 1/8.
try x.exr r.exr
try x.exr --reference-halves a.exr r.exr
try a.exr r.exr --halves
# relMSE relative to a frame of 1 instead of r = .5, whose mean still softens: (1/16) / (1 + .0025); small.exr does not fit
try x.exr r.exr --relative-to ones.exr --json out.json --quiet; sed -n '/"relmse":/{p;q}' out.json; grep relative_to out.json
try x.exr r.exr --relative-to small.exr
# a whole image without bias, and two objects with 3 %
try walls.exr ones.exr
try hole.exr ones.exr --mask right.exr
# large figures keep their columns
exr huge.exr 32x16 'R=1e20|0.5' 'G=1e20|0.5' 'B=1e20|0.5' $scene
try huge.exr r.exr
# machines: JSON alone on standard output, words on standard error
aqm-compare x.exr r.exr --json - 2>/dev/null |
  "${PYTHON:-python3}" -c 'import json,sys; t=json.load(sys.stdin)["total"]; print(t["rmse"], t["bias"], t["objects"])'
try x.exr r.exr --quiet --json out.json; ls out.json
# thresholds: 1 means that the frame fails, nothing else
try x.exr r.exr --quiet --fail-above 0.25
try x.exr r.exr --quiet --fail-above 0.24
# what --except leaves out may be anything: the left half, then all
exr left.exr 32x16 'why:id=64|0'
exr all.exr 32x16 why:id=1
try hole.exr ones.exr --except left.exr
try hole.exr ones.exr --except all.exr
# sequences: x alternates between .75 and .25 over .5: flicker 1/2
for f in 00 02; do cp x.exr s.$f.exr; cp r.exr t.$f.exr; done
for f in 01 03; do cp a.exr s.$f.exr; cp r.exr t.$f.exr; done
try s.##.exr t.%02d.exr --frames 0-3 --difference d.##.png
ls d.*
try s.##.exr r.exr --frames 0-1 --quiet --difference e.##.exr; aqm-compare e.01.exr a.exr --quiet --fail-above 0.5; echo "exit $?"
# what a viewer sees. A plane and the same brighter: frequency 0, not seen. A plane and one whose right half is brighter by 10 %: the
# edge is seen, and so is what lies within a few pixels of it.
exr plane.exr 64x32 R=0.5 G=0.5 B=0.5 id.object:id=7
exr brighter.exr 64x32 R=0.55 G=0.55 B=0.55 id.object:id=7
exr step.exr 64x32 'R=0.5|0.55' 'G=0.5|0.55' 'B=0.5|0.55' 'id.object:id=7|8'
exr still.exr 64x32 forward.u=0 forward.v=0 backward.u=0 backward.v=0 speed=0 valid:id=3
exr fast.exr 64x32 forward.u=40 forward.v=0 backward.u=-40 backward.v=0 speed=30 valid:id=3
exr unknown.exr 64x32 forward.u=0 forward.v=0 backward.u=0 backward.v=0 speed=0 valid:id=0
aqm() { echo "> $*"; aqm-compare "$@" --exposure 0 | sed -n '/AQM/,/display/p'; }
aqm plane.exr plane.exr --metric aqm
aqm plane.exr brighter.exr --metric aqm
aqm step.exr plane.exr --flow still.exr
aqm step.exr plane.exr --flow unknown.exr
aqm step.exr plane.exr --flow fast.exr
aqm step.exr plane.exr --flow fast.exr --eye fixed --fps 48
aqm step.exr plane.exr --metric aqm --display hdr
try step.exr plane.exr --quiet --flow still.exr --fail-above 5% --exposure 0
try step.exr plane.exr --quiet --flow fast.exr --fail-above 5% --eye fixed --exposure 0
try step.exr plane.exr --quiet --metric aqm --fail-above 90% --exposure 0
aqm-compare step.exr plane.exr -q --flow still.exr --json a.json -o p.exr; aqm-compare plane.exr step.exr -q --flow still.exr -o q.exr --threads 2
tempolux-info --diff p.exr q.exr | grep -w equal
grep -A3 '"aqm"' a.json | head -4; grep '"version"' a.json
for f in 00 01; do cp step.exr m.$f.exr; cp still.exr f.$f.exr; done
aqm m.##.exr plane.exr --frames 0-1 --flow f.##.exr -o m.##.png; ls m.*.png
# error figures load nothing of FFTW
mapped() { LD_DEBUG=files aqm-compare "$@" -q 2>&1 | grep -c 'calling init.*fftw'; }
echo "FFTW loaded without and with: $(mapped plane.exr step.exr) $(mapped plane.exr step.exr --metric aqm)"
# refusals of it
try step.exr plane.exr --flow small.exr
try step.exr plane.exr --metric aqm --layer id.object
try m.##.exr plane.exr --frames 0-1 -o m.png
try step.exr plane.exr -o m.jpg
try step.exr plane.exr --metric aqm --exposure bright
try step.exr plane.exr --metric aqm --eye closed
try x.exr r.exr --flow still.exr
# refusals
try x.exr
try x.exr r.exr --reference-halves a.exr r.exr
try x.exr --reference-halves a.exr a.exr
try x.exr r.exr --metric ssim
try x.exr small.exr
try x.exr ones.exr --layer indirect
try ones.exr x.exr --layer Z
try hole.exr ones.exr
try walls.exr other.exr --quiet
try walls.exr other.exr --allow-stale
try ones.exr stranger.exr
try s.##.exr t.##.exr
try x.exr r.exr --frames 0-3
try s.##.exr t.##.exr --frames 3-4
try x.exr r.exr --fail-above -1
try x.exr r.exr --fail-above nan
try x.exr r.exr --difference d.jpg
try x.exr r.exr --json no/such/folder/out.json
try no-such.exr r.exr
ls -A | grep tmp || echo 'nothing left behind'
