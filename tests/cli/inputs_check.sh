# What a run reads, it does not destroy: an output that would take an input's place is refused, under whatever name.
failed=0
bad() { echo "$*"; failed=1; }
scenes=$HERE/../../pipelines/scenes
cp "$scenes/S1_cornell.glb" S.glb
ln -s S.glb link.glb
# keeps FILE COMMAND...: exit 2, one line with FILE's name, FILE as it was, nothing left over.
keeps() {
  file=$1; shift
  before=$(cksum <"$file")
  "$@" >out.txt 2>errors.txt
  code=$?
  [ $code = 2 ] || bad "exit $code, not 2: $*"
  grep -q 'this run reads it' errors.txt && [ "$(wc -l <errors.txt)" = 1 ] || bad "$*: $(cat errors.txt)"
  [ "$(cksum <"$file")" = "$before" ] || bad "$file was destroyed: $*"
  find . -name '.*.tmp.*' | grep -q . && bad "a temporary is left: $*"
}
tiny="--size 8x6 --rays 4"
for output in S.glb ./S.glb "$PWD/S.glb" link.glb; do keeps S.glb photon-trace S.glb --photons 1k -o "$output"; done
keeps S.glb photon-trace link.glb --photons 1k -o S.glb
keeps S.glb photon-trace S.glb --photons 1k -o p.photons --stats S.glb
photon-trace S.glb --photons 1k -o p.photons -q || bad 'photons'
keeps S.glb frame-render S.glb --size 8x6 --spp 1 -o f.exr --depfile S.glb
keeps p.photons frame-render S.glb --size 8x6 --spp 1 --photons p.photons -o p.photons
keeps p.photons irradcache-build points S.glb --photons p.photons --point-count 100 -o p.photons
irradcache-build points S.glb --photons p.photons --point-count 100 -o p.irradpoints -q || bad 'points'
keeps p.irradpoints irradcache-build records S.glb --points p.irradpoints $tiny -o p.irradpoints
irradcache-build records S.glb --points p.irradpoints $tiny -o c.irradcache -q || bad 'records'
frame-render S.glb --size 8x6 --spp 1 -o f.exr -q && cp f.exr g.exr || bad 'frame'
keeps c.irradcache frame-render S.glb --size 8x6 --spp 1 --irradcache c.irradcache -o c.irradcache
keeps f.exr aqm-compare f.exr g.exr --json f.exr
keeps g.exr aqm-compare f.exr g.exr --difference g.exr
keeps f.exr frame-render S.glb --size 8x6 --spp 1 --mask f.exr --base g.exr -o f.exr
mkdir plan && cp S.glb plan/plan.mk
keeps plan/plan.mk scene-plan plan/plan.mk -o plan
keeps S.glb photon-trace S.glb --photons 1k -o q.photons --depfile S.glb
cp p.photons p.csv
keeps p.csv tempolux-info p.csv --export p.csv
keeps f.exr tempolux-info --png f.exr f.exr
[ -e q.photons ] && bad 'an output beside the refused one was made'

# Read whole before anything is written, these two may give their place to what is made from them.
frame-render S.glb --size 8x6 --spp 1 --mask f.exr --base g.exr -o g.exr -q || bad '--base b -o b'
# A copy is another file, a device is none.
cp S.glb copy.glb && photon-trace S.glb --photons 1k -o copy.glb -q || bad 'a copy'
photon-trace S.glb --photons 1k -o /dev/null -q || bad '/dev/null'
exit $failed
