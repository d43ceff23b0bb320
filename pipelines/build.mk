# build.mk -- building, testing, installing: goals of Makefile.example that need no scene. build.md is its page.
PACKAGES = g++ cmake ninja-build ccache pkg-config libembree-dev libopenexr-dev libopenimageio-dev libtinygltf-dev \
  libcli11-dev nlohmann-json3-dev libgtest-dev libbenchmark-dev libnanoflann-dev libxxhash-dev libpng-dev \
  libjpeg62-turbo-dev libdraco-dev libmeshoptimizer-dev libwebp-dev libopenvdb-dev libboost-iostreams-dev libfftw3-dev \
  gnuplot-nox python3 git make
INSTALL = apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $(PACKAGES)
deps: # Debian: packages that are missing are installed, by root only. Elsewhere they are yours to provide.
	@command -v dpkg-query > /dev/null || exit 0; \
	test $$(dpkg-query -W -f '$${db:Status-Status}\n' $(PACKAGES) 2> /dev/null | grep -cx installed) -ge $(words $(PACKAGES)) || \
	if test $$(id -u) = 0; then $(INSTALL); else echo 'packages are missing; as root: $(INSTALL)' >&2; exit 1; fi
configured: deps ; @test -f build/release/build.ninja || cmake --preset release
build: configured ; @cmake --build --preset release --target tools
build_all: configured ; @cmake --build --preset release
TOOLS = $(addprefix $(BIN)/,scene-plan photon-trace photonmap-split irradcache-build frame-render ibr-warp st-filter tempolux-info aqm-compare error-report volume-compose gather-temporal)
$(if $(filter file,$(origin BIN)),$(filter-out $(if $(DRY),$(wildcard $(TOOLS))),$(TOOLS))): build ; @:
check: build_all # all tests; those skipped are counted and named
	@ctest --preset release -j 2; code=$$?; sh tests/skipped.sh build/release/Testing/Temporary/LastTest.log; exit $$code
bench: build_all ; python3 -B tests/bench/bench.py --out $(OUT)/bench $(if $(PEERS),--peers) # error against time, required figures, into RESULTS.md
report-papers: build ; python3 -B tests/bench/papers.py $(BIN) $(OUT)/papers # figures of the papers with our numbers
ablation: configured ; python3 -B tests/bench/ablation.py --out $(OUT)/bench --page docs/results/ablation.md # what each idea of the samplers is worth
stress: build ; python3 -B tests/stress/stress.py --bin $(BIN) $(STRESS) # extreme cases; STRESS=--long for some hours more
asan: deps ; cmake --preset asan && cmake --build --preset asan && ctest --preset asan
tsan: deps ; cmake --preset tsan && cmake --build --preset tsan --target tools && sh tests/pipelines/tsan.sh build/tsan/bin # a short chain under ThreadSanitizer
fuzz: PACKAGES += clang libclang-rt-dev
fuzz: deps ; sh tests/fuzz/run.sh # hostile input for every reader, each for FUZZ_SECONDS=60
install: configured ; cmake --build --preset release --target tools manual && cmake --install build/release --prefix $(PREFIX)
tidy: $(BIN)/scene-plan ; $< --tidy $(OUT) # unfinished files of killed runs
help:
	@sed -n '/^#/!q; s/^# //p' $(firstword $(MAKEFILE_LIST))
clean: # what this file has made, and nothing else that may lie in OUT
	rm -rf build $(addprefix $(OUT)/,options plan report exposure sheet.png)
	find $(STAGES:%=$(OUT)/%) -maxdepth 1 -regextype egrep -regex '.*/[0-9]+(_[a-z]+)?\.(exr|png|json|photons|paths|irrad[a-z]*|meshirrad|lightgrid|radsamples)' \
	  -delete 2> /dev/null; rmdir $(STAGES:%=$(OUT)/%) $(OUT) 2> /dev/null || true
