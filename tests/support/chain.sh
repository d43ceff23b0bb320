# light STEM COMMON: photons, points and records of a scene, by the tools alone: STEM.photons, .irradpoints, .irradcache.
# frame STEM COMMON: the picture that they light, STEM.exr. COMMON: the scene and options of all tools. Options of one
# tool stand in $of_photons, $of_points, $of_records, $of_pixels. Tools are those of $bin, or in PATH. For tests that
# source this file; tests/bench/pipeline.py has the same for Python.
light() {
  stem=$1; shift
  "${bin:+$bin/}photon-trace" "$@" $of_photons -o "$stem.photons" -q &&
  "${bin:+$bin/}irradcache-build" points "$@" --photons "$stem.photons" $of_points -o "$stem.irradpoints" -q &&
  "${bin:+$bin/}irradcache-build" records "$@" --points "$stem.irradpoints" $of_records -o "$stem.irradcache" -q
}
frame() {
  stem=$1; shift
  "${bin:+$bin/}frame-render" "$@" --irradcache "$stem.irradcache" --points "$stem.irradpoints" $of_pixels -o "$stem.exr" -q
}
