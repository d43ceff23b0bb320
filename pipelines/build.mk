# build.mk -- building, testing, installing: goals of Makefile.example that need no scene. build.md is its page.
PACKAGES = g++ cmake ninja-build ccache pkg-config libembree-dev libopenexr-dev libopenimageio-dev libtinygltf-dev \
  libcli11-dev nlohmann-json3-dev libgtest-dev libbenchmark-dev libnanoflann-dev libxxhash-dev libpng-dev \
  libjpeg62-turbo-dev libdraco-dev libmeshoptimizer-dev libwebp-dev libavif-dev libopenvdb-dev \
  libboost-iostreams-dev libseccomp-dev libfftw3-dev gnuplot-nox python3 git make
INSTALL = apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $(PACKAGES)
deps: # installs missing packages on Debian, by root only; elsewhere provide them yourself
	@command -v dpkg-query > /dev/null || exit 0; \
	there=$$(dpkg-query -W -f '$${db:Status-Status}\n' $(PACKAGES) 2> /dev/null | grep -cx installed); \
	test $$there -ge $(words $(PACKAGES)) || \
	if test $$(id -u) = 0; then $(INSTALL); else echo 'packages are missing; as root: $(INSTALL)' >&2; exit 1; fi
in_top = cd "$$TOP" &&
configured: deps ; @$(in_top) { test -f build/release/build.ninja || cmake --preset release; }
build: configured ; @$(in_top) cmake --build --preset release --target tools
build_all: configured ; @$(in_top) cmake --build --preset release
check: build_all # all tests; skipped tests are counted and named
	@$(in_top) ctest --preset release -j 3; code=$$?; \
	sh tests/skipped.sh build/release/Testing/Temporary/LastTest.log; exit $$code
# Measurements. They use the programs of this tree and write to OUT. tests/bench/evidence.py has the words of PARTS.
evidence: PACKAGES += valgrind
evidence: configured # the figures of RESULTS.md, by canaries what is stale of them; HOURS=1: as many as fit
	@$(in_top) cmake --build --preset release --target tools bench_programs
	$(in_top) python3 -B tests/bench/evidence.py --out "$$OUT/bench" --parts='$(PARTS)' --hours='$(or $(HOURS),0)'
peers: # other renderers, from PyPI into build/peers: nothing of the product needs them
	$(in_top) sh tests/bench/peers/install.sh build/peers
asan: deps
	$(in_top) cmake --preset asan && cmake --build --preset asan && ctest --preset asan
tsan: deps # a short chain under ThreadSanitizer
	$(in_top) cmake --preset tsan && cmake --build --preset tsan --target tools
	$(in_top) sh tests/pipelines/tsan.sh build/tsan/bin
fuzz: PACKAGES += clang libclang-rt-dev
fuzz: deps # hostile input for every reader, each for FUZZ_SECONDS=60
	$(in_top) sh tests/fuzz/run.sh
programs: configured
	$(in_top) cmake --build --preset release --target tools manual
install: programs
	$(in_top) cmake --install build/release --prefix '$(PREFIX)'
deb: PACKAGES += dpkg-dev
deb: programs # a Debian package
	$(in_top) cpack --config build/release/CPackConfig.cmake -B build/release/deb
help:
	@sed -n '/^names :=/q; s/^# //p; /^[A-Z_]* *=/p' "$$TOP/Makefile.example"
clean: # removes what was built here and what was made in OUT, and nothing else
	@sh "$$TOP/pipelines/clean.sh"
