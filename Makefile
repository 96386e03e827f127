# Makefile of bitvox; `make help` lists the targets.
#
# Needs a C compiler, GNU make and a POSIX shell. OpenMP, or else POSIX threads, and zlib (for the program alone) are used
# where a test compile finds them; THREADS=posix takes no OpenMP, THREADS=0 and ZLIB=0 leave them out. Objects live in a
# folder named after a hash of the compiler and its flags, so other flags never mix with them: make CC=clang CFLAGS='-O0 -g' is always right, and so is going back.

CFLAGS ?= -O3
BUILD ?= build
UNITY_DIR ?= $(BUILD)/unity
OPENMP ?= 1
THREADS ?= $(OPENMP)
ZLIB ?= 1
SUFFIX ?= $(if $(findstring mingw,$(CC)),.exe)
WERROR ?= 0
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
DESTDIR ?=
PYTHON ?= python3
DEMO ?= fixtures/knot.ply

.SUFFIXES:
.SECONDARY:
.DELETE_ON_ERROR:
.PHONY: all help demo site wheels windows-wheel format format-check house python js js-page test-python test-js test test-other test-machines test-windows deps deps-proof deps-js deps-windows san san-memory san-threads abi golden matrix bare coverage mcdc fuzz analyze bench packaging deb install uninstall amalgamation clean force \
        print-folder print-needed golden-program library program test-programs sanitizer-probe fault-programs fuzz-programs bench-programs row-products

all: library program

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile
	@echo "  variables: CC CFLAGS CPPFLAGS LDFLAGS BUILD THREADS=posix|0 ZLIB=0 WERROR=1 V=1 (show commands)"
	@echo "             PREFIX LIBDIR DESTDIR (install)"

clean: ## remove everything that was built
	rm -rf $(BUILD)

ifneq ($(filter-out help clean,$(or $(MAKECMDGOALS),all)),)

# As many jobs as processors; a -j on the command line or another make's jobs win, and make clean all goes one by one.
ifeq ($(MAKELEVEL)$(filter clean,$(MAKECMDGOALS)),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
endif

# ---- What this compiler can do ----

comma := ,
sharp := \#
quote = '$(subst ','\'',$(1))'
# $(call compiles,FLAGS,LINES): "yes" when the program of these quoted lines compiles and links without a warning
compiles = $(shell mkdir -p $(BUILD) && probe=$(BUILD)/probe-$$$$ && { printf '%s\n' $(2) | \
    $(CC) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS) -Werror -x c - -o $$probe $(1) >/dev/null 2>&1 && echo yes; rm -f $$probe*; })
# $(call accepts,FLAGS): the flags, when the compiler takes them
accepts = $(if $(call compiles,$(1),'int main(void) { return 0; }'),$(1))

loose := $(filter -ffast-math -Ofast -funsafe-math-optimizations -fassociative-math -freciprocal-math \
    -ffinite-math-only -fno-signed-zeros -mfpmath=387,$(CC) $(CPPFLAGS) $(CFLAGS))
ifneq ($(loose),)
$(error $(loose) would change results; bitvox keeps its promises only without it)
endif

# OpenMP, and POSIX threads where there is none or THREADS=posix wants them.
workers :=
ifneq ($(THREADS),0)
ifeq ($(if $(filter posix,$(THREADS)),,$(call compiles,-fopenmp,'$(sharp)include <omp.h>' \
    'int main(void) { return omp_get_max_threads() < 1; }')),yes)
workers := -fopenmp
else ifeq ($(call compiles,-pthread,'$(sharp)include <pthread.h>' '$(sharp)if !defined(_REENTRANT) || defined(_WIN32)' '$(sharp)error none' \
    '$(sharp)endif' 'int main(void) { return pthread_join(pthread_self()$(comma) 0) == 0; }'),yes)
workers := -pthread
endif
endif

zlib :=
ifneq ($(ZLIB),0)
ifeq ($(call compiles,-lz,'$(sharp)include <zlib.h>' 'int main(void) { return zlibVersion() == 0; }'),yes)
zlib := -lz
endif
endif

# The house's flags come after the caller's, so an injected -std or -ffp-contract does not win.
# excess-precision: s390x computes floats in double without it; sse: 32-bit x86 would use the x87.
# math-errno and trapping-math change no value, they let sqrt and floor be single instructions.
# no-fma: gcc 12 fuses in vectors of add and subtract whatever the contraction says, where -march=native allows it.
exact := -ffp-contract=off $(call accepts,-mno-fma) $(call accepts,-fexcess-precision=fast) $(call accepts,-msse2 -mfpmath=sse) \
    $(call accepts,-fno-math-errno -fno-trapping-math)
# enum-float-conversion: limits are enums here, and clang since 16 warns where one meets a double, which is exact.
strict := -std=c99 -pedantic -Wall -Wextra -Wshadow -Wconversion $(call accepts,-Wno-enum-float-conversion)
base := $(CPPFLAGS) $(CFLAGS) $(strict) $(exact) -fPIC -fvisibility=hidden -MMD -MP -Iinclude -Isrc
libs := $(workers) -lm
# What others link with the archive: GNU's library by its name, which other compilers find too.
needed := $(if $(call compiles,$(filter -fopenmp,$(workers)),'$(sharp)if !defined(_OPENMP) || defined(__clang__)' '$(sharp)error by flag' \
    '$(sharp)endif' 'int main(void) { return 0; }'),-lgomp -pthread,$(workers)) -lm

# Before 1.0 a minor version may change the interface, so it is part of the soname.
number = $(shell sed -n 's/^.define BVX_VERSION_$(1) //p' include/bitvox.h)
version := $(call number,MAJOR).$(call number,MINOR).$(call number,PATCH)
soname := libbitvox.so.$(call number,MAJOR)$(if $(filter 0,$(call number,MAJOR)),.$(call number,MINOR))
threads := $(call accepts,-pthread)
link_shared := -shared $(call accepts,-Wl$(comma)-soname$(comma)$(soname))

key := $(CC) $(shell $(CC) --version 2>/dev/null | head -n 1) $(base) $(LDFLAGS) $(libs) $(zlib) $(WERROR) $(CORE_FLAGS)$(if $(UNITS), units $(UNITS))
folder := $(BUILD)/$(shell printf '%s' $(call quote,$(key)) | cksum | cut -d ' ' -f 1)

# ---- Files ----

cli_sources := $(sort $(wildcard src/cli_*/*.c))
core_sources := $(sort $(filter-out $(cli_sources),$(wildcard src/*/*.c)))
unit_tests := $(sort $(wildcard tests/unit/test_*.c))
fault_tests := $(sort $(wildcard tests/fault/test_*.c))
golden_tests := $(wildcard tests/golden/golden.c)
fuzz_tests := $(sort $(wildcard tests/fuzz/fuzz_*.c))
examples := $(sort $(wildcard tests/examples/*.c))
bench_parts := $(addprefix tests/bench/,bench.c bench_models.c parity_loop.c box_triangle_loop.c paper_refine.c)
benches := $(filter-out $(bench_parts),$(sort $(wildcard tests/bench/*.c)))

built = $(patsubst %.c,$(folder)/%$(1),$(2))
own_flags := $(addprefix src/core/,openmp.c threads.c processors.c)
# UNITS=N, for builds that are made once: the library in N sources that include the others, so that headers are read less often.
ifeq ($(UNITS),)
core_objects := $(call built,.o,$(core_sources))
else
# A test stands in for the heap.
alone := $(own_flags) src/core/heap.c
units := $(shell sh tests/tools/make_units.sh $(folder)/src $(UNITS) $(filter-out $(alone),$(core_sources)))
core_objects := $(units:.c=.o) $(call built,.o,$(alone))
# There gcc sees through calls from file to file, and takes what only a failure leaves unset for used.
units_quiet := $(call accepts,-Wno-maybe-uninitialized)
endif
cli_objects := $(call built,.o,$(cli_sources))
archive := $(folder)/libbitvox.a

say = $(if $(V),,@echo "  $(1)  $(2)";)
link = $(call say,LINK,$@) $(CC) $(CFLAGS) $(LDFLAGS)

# ---- Libraries and program ----

library: $(BUILD)/libbitvox.a $(BUILD)/libbitvox.so ## build/libbitvox.a and build/libbitvox.so
program: $(if $(cli_sources),$(BUILD)/bitvox$(SUFFIX)) ## build/bitvox

# A product is copied out of the folder only when it differs.
$(BUILD)/libbitvox.a $(BUILD)/libbitvox.so $(BUILD)/bitvox$(SUFFIX): $(BUILD)/%: $(folder)/% force
	@cmp -s $< $@ || cp -f $< $@
	@$(if $(filter %.so,$@),ln -sf $(@F) $(BUILD)/$(soname))

# Rewritten when a source is added or removed, so that the library is made anew then.
$(folder)/sources: force
	@mkdir -p $(@D); echo '$(core_sources)' | cmp -s - $@ || echo '$(core_sources)' >$@

$(archive): $(core_objects) $(folder)/sources
	$(call say,AR  ,$@) rm -f $@ && $(AR) rcs $@ $(core_objects)

$(folder)/libbitvox.so: $(core_objects) $(folder)/sources
	$(link) $(link_shared) $(core_objects) -o $@ $(libs)

$(folder)/bitvox$(SUFFIX): $(cli_objects) $(archive)
	$(link) $(cli_objects) $(archive) -o $@ $(libs) $(zlib) $(threads)

# Make hands a target's variables on to what it is made from; flags is set for all sources, so none come from a test.
# CORE_FLAGS is for the core alone: counts of coverage without those of the tests' slow oracles.
$(folder)/src/%: errors = -Werror
$(folder)/src/%: flags = $(CORE_FLAGS)
$(call built,.o,$(own_flags)): flags = $(workers) $(CORE_FLAGS)
# The program's own code waits for files and the library: not worth a slow build.
$(cli_objects): flags = $(if $(zlib),-DBVX_HAVE_ZLIB) $(threads) $(brisk)

$(folder)/%.o: %.c
	@mkdir -p $(@D)
	$(call say,CC  ,$<) $(CC) $(base) $(flags) $(if $(filter-out 0,$(WERROR)),$(errors)) -c $< -o $@

$(units:.c=.o): %.o: %.c
	$(call say,CC  ,$<) $(CC) $(base) $(units_quiet) $(flags) $(if $(filter-out 0,$(WERROR)),$(errors)) -c $< -o $@

# ---- Test programs (linked with the static library, so that they reach internal functions too) ----

# They run once: what a slow build of them would save, it costs three times over.
unity_defines := -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64
brisk := $(if $(filter -O2 -O3,$(CFLAGS)),-O1)
$(folder)/tests/%: flags = -Itests $(brisk)
$(folder)/tests/unit/%: flags = -Itests -isystem $(UNITY_DIR) $(unity_defines) $(brisk)
$(folder)/tests/unit/test_threads.o: flags = -Itests -isystem $(UNITY_DIR) $(unity_defines) $(brisk) $(workers)
$(folder)/tests/fuzz/%: flags = -Itests -DBVX_FUZZ_MAIN $(brisk)
$(folder)/tests/bench/%: flags = -Itests
$(folder)/tests/fault/%: test_libs = -lcmocka

test-programs: $(call built,,$(unit_tests) $(golden_tests) $(examples))
sanitizer-probe: $(call built,,tests/tools/sanitizer_probe.c)
fault-programs: $(call built,,$(fault_tests))
fuzz-programs: $(call built,,$(fuzz_tests))
bench-programs: $(call built,,$(benches))

# What a row of the tests compiles to see that it does; the published products stay as they are.
row-products: $(archive) $(folder)/libbitvox.so $(if $(cli_sources),$(folder)/bitvox) $(call built,,$(golden_tests))

# A row of the matrix needs no more than this.
golden-program: $(call built,,$(golden_tests))

$(UNITY_DIR)/unity.c:
	@sh tests/tools/get_unity.sh $(UNITY_DIR)

$(folder)/unity.o: $(UNITY_DIR)/unity.c
	@mkdir -p $(@D)
	$(call say,CC  ,$<) $(CC) $(base) $(unity_defines) -w -c $< -o $@

$(call built,.o,$(unit_tests)): | $(UNITY_DIR)/unity.c

$(folder)/tests/unit/%: $(folder)/tests/unit/%.o $(folder)/unity.o $(archive)
	$(link) $^ -o $@ $(libs)

$(call built,,$(benches)): %: %.o $(call built,.o,$(bench_parts)) $(archive)
	$(link) $^ -o $@ $(libs)

$(folder)/tests/%: $(folder)/tests/%.o $(archive)
	$(link) $^ -o $@ $(test_libs) $(libs)

-include $(patsubst %.c,$(folder)/%.d,$(core_sources) $(cli_sources) $(unit_tests) $(fault_tests) $(golden_tests) \
    $(fuzz_tests) $(examples) $(benches) $(bench_parts)) $(units:.c=.d)

print-folder:
	@echo $(folder)

print-needed:
	@echo $(needed)

# ---- Packaging ----

# Static linking needs what the library was built with. A list of CMake has semicolons.
empty :=
in_prefix = $(if $(filter $(PREFIX)/%,$(1)),$${prefix}$(1:$(PREFIX)%=%),$(1))
found_by := $(BUILD)/bitvox.pc $(BUILD)/bitvoxConfig.cmake $(BUILD)/bitvoxConfigVersion.cmake
$(found_by): $(BUILD)/%: src/%.in include/bitvox.h force
	@sed -e 's|@BITVOX_LIBS@|$(subst $(empty) ,;,$(strip $(needed)))|' -e 's|@CMAKE_INSTALL_FULL_INCLUDEDIR@|$(PREFIX)/include|' \
	    -e 's|@PROJECT_VERSION@|$(version)|' -e 's|@PROJECT_VERSION_MAJOR@|$(call number,MAJOR)|' \
	    -e 's|@PROJECT_VERSION_MINOR@|$(call number,MINOR)|' -e 's|@CMAKE_SIZEOF_VOID_P@||' \
	    -e 's|@CMAKE_INSTALL_PREFIX@|$(PREFIX)|' -e 's|@PC_LIBDIR@|$(call in_prefix,$(LIBDIR))|' \
	    -e 's|@PC_INCLUDEDIR@|$${prefix}/include|' -e 's|@PC_CFLAGS@||' -e 's|@PC_LIBS@||' \
	    -e 's|@PC_PRIVATE@|$(strip $(needed))|' $< >$@.made
	@cmp -s $@.made $@ || cp $@.made $@; rm -f $@.made

# What the program says about itself.
pages := $(BUILD)/bitvox.1 $(BUILD)/bitvox.bash
$(BUILD)/bitvox.1: $(BUILD)/bitvox
	@$(BUILD)/bitvox help --man >$@
$(BUILD)/bitvox.bash: $(BUILD)/bitvox
	@$(BUILD)/bitvox help --bash-completion >$@

put = $(call say,INSTALL,$(DESTDIR)$(2)) mkdir -p $(call quote,$(DESTDIR)$(dir $(2))) && install -m $(3) $(1) $(call quote,$(DESTDIR)$(2))
completions := $(PREFIX)/share/bash-completion/completions

install: all $(found_by) $(pages) ## library, header, bitvox.pc, CMake's files, program, man page, completion
	$(call put,include/bitvox.h,$(PREFIX)/include/bitvox.h,644)
	$(call put,include/bitvox_io.h,$(PREFIX)/include/bitvox_io.h,644)
	$(call put,$(BUILD)/libbitvox.a,$(LIBDIR)/libbitvox.a,644)
	$(call put,$(BUILD)/libbitvox.so,$(LIBDIR)/libbitvox.so.$(version),755)
	@ln -sf libbitvox.so.$(version) $(call quote,$(DESTDIR)$(LIBDIR)/$(soname))
	@ln -sf $(soname) $(call quote,$(DESTDIR)$(LIBDIR)/libbitvox.so)
	$(call put,$(BUILD)/bitvox.pc,$(LIBDIR)/pkgconfig/bitvox.pc,644)
	$(call put,$(BUILD)/bitvoxConfig.cmake,$(LIBDIR)/cmake/bitvox/bitvoxConfig.cmake,644)
	$(call put,$(BUILD)/bitvoxConfigVersion.cmake,$(LIBDIR)/cmake/bitvox/bitvoxConfigVersion.cmake,644)
	$(call put,$(BUILD)/bitvox,$(PREFIX)/bin/bitvox,755)
	$(call put,$(BUILD)/bitvox.1,$(PREFIX)/share/man/man1/bitvox.1,644)
	$(call put,$(BUILD)/bitvox.bash,$(completions)/bitvox,644)

uninstall: ## remove what install put there
	rm -f $(addprefix $(DESTDIR),$(PREFIX)/include/bitvox.h $(PREFIX)/include/bitvox_io.h $(addprefix $(LIBDIR)/,libbitvox.a libbitvox.so $(soname) \
	    libbitvox.so.$(version) pkgconfig/bitvox.pc cmake/bitvox/bitvoxConfig.cmake \
	    cmake/bitvox/bitvoxConfigVersion.cmake) $(PREFIX)/bin/bitvox $(PREFIX)/share/man/man1/bitvox.1 $(completions)/bitvox)

python: ## build/python/wheel: a wheel of the Python package (pip, which fetches what the build needs)
	@mkdir -p $(BUILD)/python
	$(PYTHON) -m pip wheel --quiet --no-deps -w $(BUILD)/python/wheel bindings/python && ls $(BUILD)/python/wheel/*.whl

windows-wheel: ## a wheel for Windows by mingw, tried under wine (Maven fetches a Python for Windows)
	@BUILD=$(BUILD) PYTHON=$(PYTHON) sh tests/tools/windows_wheel.sh

site: ## build/site: the pages of the Python package (an installed bitvox, mkdocs-material, mkdocstrings[python], nbclient, ipykernel)
	$(PYTHON) bindings/python/docs/build.py $(BUILD)/site

wheels: ## manylinux and musllinux wheels, the first tried where there is no compiler (pip fetches auditwheel; musl-gcc)
	@BUILD=$(BUILD) PYTHON=$(PYTHON) sh tests/tools/wheels.sh

test-python: program ## the Python package alone, in a clean virtual environment
	@BUILD=$(BUILD) PYTHON=$(PYTHON) BITVOX=$(abspath $(BUILD)/bitvox) sh tests/tools/test_python.sh

js: $(BUILD)/js/package/bitvox.js ## build/js/package: the npm package, WebAssembly in one module (Emscripten's emcc and Node: make deps-js)

$(BUILD)/js/package/bitvox.js: $(core_sources) $(wildcard src/*/*.h include/*.h bindings/js/*.* bindings/js/src/*)
	@for tool in node $(or $(EMCC),emcc); do command -v $$tool >/dev/null 2>&1 || { echo "make js: $$tool is missing; \
	    it is in Debian's packages emscripten and nodejs, which make deps-js installs as root"; exit 1; }; done
	$(call say,EMCC,$@) mkdir -p $(@D) && node bindings/js/build.mjs $(BUILD)/js

js-page: js ## build/js/page: the page, files for any file server (npm fetches three.js and esbuild)
	@BUILD=$(BUILD) sh tests/tools/test_js.sh page

test-js: deps-js program ## the npm package: golden rows, types, samples under node and in Chromium (npm fetches what that needs)
	@if command -v node >/dev/null 2>&1 && command -v $(or $(EMCC),emcc) >/dev/null 2>&1; then $(MAKE) --no-print-directory js; fi
	@BUILD=$(BUILD) BITVOX=$(abspath $(BUILD)/bitvox) sh tests/tools/test_js.sh || [ $$? = 77 ]

deb: ## build/debian: Debian packages of library and program (debhelper; lintian looks at them)
	@BUILD=$(BUILD) sh tests/tools/debian.sh

packaging: all ## projects that use the library: CMake by make and Ninja, gcc, clang, mingw; pkg-config; vcpkg; Conan; parts as one file (ROWS=cmake: these alone)
	@BUILD=$(BUILD) MAKE_COMMAND='$(MAKE_COMMAND)' sh tests/tools/packaging.sh $(ROWS)

amalgamation: ## build/bitvox.c and both headers: the library as one source file (PARTS="solid levels": what these calls need, in build/parts)
	@sh src/amalgamate.sh $(BUILD)$(if $(PARTS),/parts $(call quote,$(PARTS))) && echo "$(BUILD)$(if $(PARTS),/parts)/bitvox.c $(BUILD)$(if $(PARTS),/parts)/bitvox.h"

# ---- Running ----

environment = MAKE_COMMAND='$(MAKE_COMMAND)' $(foreach v,BUILD UNITY_DIR CC CPPFLAGS CFLAGS LDFLAGS OPENMP THREADS ZLIB,\
    $(v)=$(call quote,$($(v))))

demo: program ## a chain of meshes from a bundled fixture, with a table and a picture
	@mkdir -p $(BUILD)/demo
	$(BUILD)/bitvox lod $(DEMO) -o $(BUILD)/demo/level_%d.ply
	$(BUILD)/bitvox render $(DEMO) $(BUILD)/demo/level_*.ply -o $(BUILD)/demo/levels.png --from 1,-2,3
	@echo "meshes: $(BUILD)/demo/level_*.ply, picture: $(BUILD)/demo/levels.png"

deps: ## install what the tests need (apt, as root)
	@BUILD=$(BUILD) sh tests/tools/deps.sh

deps-proof: ## and what matrix, fuzz, coverage, mcdc, analyze, abi and the sanitizers need
	@BUILD=$(BUILD) sh tests/tools/deps.sh proof

deps-windows: deps ## and what the tests of the program for Windows need: mingw, wine
	@BUILD=$(BUILD) sh tests/tools/deps.sh windows

deps-js: ## and what the npm package needs: emscripten, nodejs, chromium
	@BUILD=$(BUILD) sh tests/tools/deps.sh js

test: ## the library and the program by this compiler (20 minutes of processor time); ends with "N passed, N failed"
	@$(environment) sh tests/tools/run_tests.sh here

test-other: deps-windows ## the Python package, other compilers, 32-bit x86, big-endian s390x, sanitizers, a part of test-windows
	@$(environment) sh tests/tools/run_tests.sh other

test-windows: deps-windows ## the program for Windows under wine: every script and golden values (mingw, wine)
	@$(environment) sh tests/tools/run_tests.sh windows

test-machines: deps ## every unit test on 32-bit x86 and big-endian s390x (long)
	@$(environment) sh tests/tools/run_tests.sh machines

san: ## unit, fault and fuzz tests under ASan and UBSan
	@$(environment) sh tests/tools/run_tests.sh san

san-memory: ## unit, golden and fuzz tests under MSan (clang)
	@$(environment) sh tests/tools/run_tests.sh memory

san-threads: ## unit, golden and fuzz tests under TSan, all on several threads (clang)
	@$(environment) sh tests/tools/run_tests.sh threads

abi: library ## header by every standard, symbols, offsets here and on other machines, types against the stored ones (REWRITE=1: store)
	@BUILD=$(BUILD) CC=$(call quote,$(CC)) sh tests/tools/abi.sh $(if $(filter-out 0,$(REWRITE)),rewrite,full)

matrix: ## golden values by every compiler, flag and machine that is here (half an hour; MATRIX=row,row: only these; DEPS=1: deps-proof first)
	@$(environment) MATRIX=$(call quote,$(MATRIX)) DEPS=$(DEPS) sh tests/tools/matrix.sh

bare: ## the core on a Cortex-M3 without operating system, under an emulator
	@BUILD=$(BUILD) sh tests/tools/bare.sh

coverage: ## branches of src/ that the quick tests take (gcovr)
	@BUILD=$(BUILD) UNITY_DIR=$(UNITY_DIR) MAKE_COMMAND='$(MAKE_COMMAND)' sh tests/tools/coverage.sh

mcdc: ## conditions that decide in the predicates and tables, each by itself (clang-19)
	@BUILD=$(BUILD) UNITY_DIR=$(UNITY_DIR) MAKE_COMMAND='$(MAKE_COMMAND)' sh tests/tools/mcdc.sh

analyze: ## cppcheck, clang-tidy, clang's and gcc's analyzers, stack of every function (TOOLS="tidy gcc")
	@BUILD=$(BUILD) sh tests/tools/analyze.sh

fuzz: ## contracts under a coverage-guided fuzzer (clang; SECONDS_EACH=60 JOBS=1 TARGETS="stl solids" KEEP=1)
	@BUILD=$(BUILD) MAKE_COMMAND='$(MAKE_COMMAND)' SECONDS_EACH=$(or $(SECONDS_EACH),60) TARGETS='$(TARGETS)' JOBS=$(or $(JOBS),1) KEEP=$(KEEP) sh tests/tools/fuzz.sh

format: ## write all C sources by .clang-format (clang-format 14)
	@sh tests/tools/format.sh write

format-check: ## name the lines that it would write otherwise
	@sh tests/tools/format.sh check

house: ## figures of the sources, room by room: paragraphs, comments, lengths of files and functions
	@python3 tests/tools/house.py

golden: $(call built,,$(golden_tests)) $(BUILD)/libbitvox.so ## recompute golden files and show what changed
	@sh tests/tools/rewrite_golden.sh $(call built,,$(golden_tests)) $(BUILD)

bench: bench-programs program ## speed, memory and quality beside other libraries (pip, in build/bench/venv)
	@BUILD=$(BUILD) BENCHES=$(folder)/tests/bench sh tests/bench/run.sh

bench-pages: ## put the tables of the last bench into README.md and docs/measured.md
	@cp $(BUILD)/bench/report.json docs/measured.json
	@python3 tests/bench/page.py fill docs/measured.json README.md docs/measured.md

endif
