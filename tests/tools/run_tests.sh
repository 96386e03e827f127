#!/bin/sh
# run_tests.sh here|other|san|memory|threads|machines|windows - build and run the tests; the last line is "N passed, N failed[, N skipped]".
#     here   this compiler: unit, fault, golden, program, examples, checks of sources and libraries
#     other  the Python package in a clean environment, and what this machine and compiler do not show: golden values by other compilers and flags, faults and fuzzed readers under
#            sanitizers, golden values and what a machine changes on 32-bit x86 and on big-endian s390x
#     windows  the program by mingw under wine: every script of tests/program but the one of make install, golden values
#     machines  all unit tests and golden values on 32-bit x86 and on big-endian s390x (half an hour under an emulator)
#     san    unit, fault and fuzz tests under ASan, UBSan and the leak detector
#     memory   unit, golden and fuzz tests under clang's MSan, on one thread: memory that is read before it is written
#     threads  unit, golden and fuzz tests under clang's TSan on several threads, but for tests that count progress calls
#              (cmocka is not instrumented, so fault tests stay out)
# Called by make, which hands over compiler and flags. A row is one build of the library and the tests run with it.
set -u
cd "$(dirname "$0")/../.." || exit 1
tier=${1:-here}
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${CC:=cc}"
export BUILD CC
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
. tests/tools/counting.sh
. tests/tools/fuzz_targets.sh

sanitizers='-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer'
export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export MSAN_OPTIONS=exit_code=1:allocator_may_return_null=1 # its own exit code, 77, would read as skipped
export TSAN_OPTIONS=ignore_noninstrumented_modules=1:allocator_may_return_null=1
export CMOCKA_MESSAGE_OUTPUT=TAP
# Threads that spin at the end of a step take the processor from the tests beside them: half of the time of some.
export OMP_WAIT_POLICY=passive

mk() { "$MAKE_COMMAND" --no-print-directory -k -j "$jobs" "$@"; }

has() { command -v "$1" >/dev/null 2>&1; }

compiles() { # COMPILER AND FLAGS..., program on standard input
    "$@" -x c - -o "$logs/probe" >/dev/null 2>&1
}

# Unit tests of what a machine changes: the order of bytes, the width of sizes and of integers, vectors. All other stages are in its
# golden values.
machine_tests='test_3mf test_binvox test_bits test_bvx test_calls test_check_written test_cut_triangle test_decimal test_errors
    test_finite test_formats test_grid test_hash test_lattice test_lattice_json test_memory test_nrrd test_parts test_png_npy test_points
    test_position_type test_radix test_read_gltf test_read_npy test_read_obj test_read_off test_read_ply test_read_stl
    test_read_volume test_sample test_simd test_solid test_tables test_threads test_tree_file test_view test_vox test_vti
    test_write_field test_write_glb test_write_kept test_write_levels test_write_mesh test_write_off test_write_vdb test_write_vtu'
kept= # names of unit tests, or all

# ---- Rows: each is make with its settings ----

once=UNITS=16 # a fifth of the compiler's time less where nothing is compiled a second time

row_native() { mk "$@"; }
row_plain() { mk $once CFLAGS=-O0 THREADS=0 ZLIB=0 WERROR=1 "$@"; }
row_fast() { mk $once CFLAGS=-O3 WERROR=1 "$@"; }
row_clang() { mk $once CC=clang THREADS=posix CFLAGS=-O3 WERROR=1 "$@"; }
row_san() { mk $once THREADS=posix CFLAGS="-O1 -g1 $sanitizers" "$@"; }
row_memory() {
    mk $once CC=clang THREADS=0 ZLIB=0 CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=memory -fsanitize-memory-track-origins' "$@"
}
row_threads() {
    # GNU's OpenMP is not built to be seen by TSan.
    mk $once CC=clang THREADS=posix ZLIB=0 CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=thread' CPPFLAGS='-include tests/tools/more_threads.h' "$@"
}
row_i686() { mk $once CC="$i686" AR="$i686_ar" CFLAGS=-O1 LDFLAGS=-static THREADS=0 ZLIB=0 WERROR=1 "$@"; }
row_windows() { mk $once CC=x86_64-w64-mingw32-gcc AR=x86_64-w64-mingw32-ar CFLAGS=-O1 LDFLAGS=-static "$@"; }
row_s390x() {
    mk $once CC=s390x-linux-gnu-gcc AR=s390x-linux-gnu-ar CFLAGS=-O2 LDFLAGS=-static THREADS=0 ZLIB=0 WERROR=1 "$@"
}

build() { # ROW, GOALS...: sets $folder
    row=$1
    shift
    folder=$("row_$row" print-folder)
    check "$row/build $1" build_or_remove "$@"
}

# When something does not build, programs of an earlier build must not stand for it.
build_or_remove() { # GOALS...
    "row_$row" "$@" && return
    find "$folder/tests" -type f ! -name '*.[od]' -exec rm -f {} + 2>/dev/null
    "row_$row" "$@" >/dev/null 2>&1
    return 1
}

# ---- Programs beside each other: list_... prints a line for each, run_lines runs them all, count_... tells what came of them ----

# What takes longest comes first, so that no processor waits at the end for one that began late. Names and order matter for the time alone.
longest='s390x-golden---brief.log python-pytest-2.log python-pytest-1.log checks.log test_oblique test_program.sh test_section_faults
    san-corpus-fields.log test_level_faults test_levels.sh test_surface_voxels_faults test_writers test_algebra_faults test_add_option.py
    fuzz_contours test_warnings.py test_repair.sh test_must_reach.py test_stages test_queries test_level_meshes.sh python-wheels.log
    packaging.sh test_outputs.sh test_write_vdb test_winding test_install.sh test_reuse test_levels test_position_type test_simplify_parts
    test_read_obj test_commands.sh test_section_mend test_bodies test_volume_faults test_boolean.sh test_repair_thin test_files.sh
    windows-golden.log test_solid_same test_simplify test_repair i686-golden.log test_tree_file test_voxels.sh test_boolean test_labels'

longest_first() { # on standard input: lines
    awk -v names="$longest" 'BEGIN { n = split(names, name); for (i = 1; i <= n; i++) rank[name[i]] = i }
        {
            first = n + 1
            for (i = 1; i <= NF; i++) {
                base = $i
                sub(/.*\//, "", base)
                if (base in rank) first = rank[base]
            }
            print first, NR, $0
        }' | sort -k 1,1n -k 2,2n | cut -d ' ' -f 3-
}

run_lines() { # on standard input: LOG SECONDS COMMAND...
    longest_first | xargs -P "$jobs" -L 1 sh tests/tools/logged.sh
}

list_command() { # NAME, COMMAND...
    rm -f "$(log_of "$1").end"
    echo "$(log_of "$1") $allowed $(shift && echo "$*")"
}

names_of_kind() { # KIND: those that are kept
    for source in tests/"$1"/*.c; do
        name=$(basename "$source" .c)
        case " ${kept:-$name} " in *" $name "*) if [ -f "$source" ]; then echo "$name"; fi ;; esac
    done
}

list_kind() { # ROW, KIND, RUNNER
    for name in $(names_of_kind "$2"); do
        rm -f "$(log_of "$1/$2/$name").end"
        if [ -x "$folder/tests/$2/$name" ]; then list_command "$1/$2/$name" $3 "$folder/tests/$2/$name"; fi
    done
}

count_kind() { # ROW, KIND
    for name in $(names_of_kind "$2"); do count_log_of "$1/$2/$name"; done
}

count_log_of() { # NAME: of a program that counts its tests
    if [ -f "$(log_of "$1").end" ]; then
        # shellcheck disable=SC2046
        add_counts "$1" "$(log_of "$1")" $(cat "$(log_of "$1").end")
    else
        fail "$1: was not built"
    fi
}

run_kind() { # ROW, KIND, RUNNER
    list_kind "$1" "$2" "$3" | run_lines
    count_kind "$1" "$2"
}

list_golden() { # as run_golden
    golden_name="$1/golden" runner=$2
    shift 2
    if [ -x "$folder/tests/golden/golden" ]; then
        list_command "$golden_name${1:+ $*}" $runner "$folder/tests/golden/golden" "$@"
    fi
}

run_golden() { # ROW, RUNNER, ARGUMENTS...
    golden_name="$1/golden"
    runner=$2
    shift 2
    if [ -x "$folder/tests/golden/golden" ]; then
        # shellcheck disable=SC2086
        count "$golden_name${1:+ $*}" $runner "$folder/tests/golden/golden" "$@"
    else
        fail "$golden_name: was not built"
    fi
}

has_cmocka() {
    echo '#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
int main(void) { return 0; }' | compiles "$CC" -lcmocka
}

run_fault() { # ROW
    if has_cmocka; then
        build "$1" fault-programs
        run_kind "$1" fault ''
    else
        skip "$1/fault" "the library cmocka is missing"
    fi
}

# Random inputs, and the corpus that earlier runs under a fuzzer have left.
run_fuzz() { # ROW, RUNNER, PROGRAM ARGUMENTS OF THE RANDOM INPUTS...
    build "$1" fuzz-programs
    list_fuzz "$@" | run_lines
    count_fuzz "$1"
}

list_fuzz() { # as run_fuzz
    fuzz_row=$1 runner=$2
    shift 2
    for source in tests/fuzz/fuzz_*.c; do
        if [ ! -f "$source" ]; then continue; fi
        inputs=$* every=1
        case $source in
        */fuzz_algebra.c | */fuzz_levels.c) inputs=${dear_inputs:-$*} ;;
        */fuzz_volumes.c) if [ -n "${dear_inputs:-}" ]; then inputs=100; fi ;;
        */fuzz_contours.c) if [ -n "${dear_inputs:-}" ]; then inputs=5000; fi ;;
        */fuzz_fields.c) if [ -n "${dear_inputs:-}" ]; then every=3; fi ;;
        esac
        list_command "$fuzz_row/fuzz/$(basename "$source" .c)" $runner "$folder/${source%.c}" $inputs
        for target in $(fuzz_targets "$source"); do
            if [ "fuzz_$target" = "$(basename "$source" .c)" ]; then format=; else format=$target; fi
            list_command "$fuzz_row/corpus/$target" $runner "$folder/${source%.c}" $format \
                $(find "fixtures/fuzz/$target" -type f | sort | awk "NR % $every == 0")
        done
    done
}

count_fuzz() { # ROW
    for source in tests/fuzz/fuzz_*.c; do
        if [ ! -f "$source" ]; then continue; fi
        count_script "$1/fuzz/$(basename "$source" .c)"
        for target in $(fuzz_targets "$source"); do count_script "$1/corpus/$target"; done
    done
}

# Does this build find what it is for, and nothing where there is nothing?
sanitizer_finds() { # RUNNER, WHAT ITS REPORT SAYS, DEFECT
    probe=$folder/tests/tools/sanitizer_probe
    $1 "$probe" clean || return 1
    $1 "$probe" "$3" >"$logs/probe.log" 2>&1 && echo "the sanitizer is silent" && return 1
    grep "$2" "$logs/probe.log"
}

# Both sanitizers lay memory out their own way, which a kernel that places programs at random may prevent.
sanitized() { # ROW, REPORT, DEFECT, INPUTS OF EACH FUZZ PROGRAM
    if ! has clang; then
        skip "$1" "clang is missing (Debian: clang)"
        return
    fi
    export BVX_QUICK=1
    allow 1800
    runner=
    if has setarch && setarch "$(uname -m)" -R true 2>/dev/null; then runner="setarch $(uname -m) -R"; fi
    build "$1" test-programs sanitizer-probe
    check "$1/finds a defect made on purpose" sanitizer_finds "$runner" "$2" "$3"
    run_kind "$1" unit "$runner"
    run_golden "$1" "$runner" --portable
    run_golden "$1" "$runner" --threads 4
    run_fuzz "$1" "$runner" "$4"
}

# Examples in C are programs, those of the command line are scripts that take the program from BITVOX.
names_of_examples() {
    for source in tests/examples/*.c tests/examples/*.sh; do
        if [ -f "$source" ]; then echo "$source"; fi
    done
}

list_examples() {
    for source in $(names_of_examples); do
        case $source in
        *.c) list_command "example/$(basename "$source" .c)" "$folder/${source%.c}" ;;
        *) list_command "example/$(basename "$source")" sh "$source" ;;
        esac
    done
}

count_examples() {
    for source in $(names_of_examples); do count_script "example/$(basename "$source" .c)"; done
}

# Scripts get the program in BITVOX; they count their own checks or stand for one by their exit status. They run beside each other.
list_program() {
    for script in tests/program/*.sh tests/program/*.py; do
        rm -f "$(log_of "program/$(basename "$script")").end"
        case $script in
        *.sh) interpreter=sh ;;
        *) interpreter=python3 ;;
        esac
        if [ -f "$script" ] && has $interpreter; then list_command "program/$(basename "$script")" $interpreter "$script"; fi
    done
}

count_program() {
    for script in tests/program/*.sh tests/program/*.py; do
        if [ -f "$script" ]; then count_script "program/$(basename "$script")"; fi
    done
}

count_script() { # NAME
    script_log=$(log_of "$1")
    if [ ! -f "$script_log.end" ]; then
        skip "$1" "its interpreter is missing"
        return
    fi

    read -r status seconds <"$script_log.end"
    if [ -n "$(counts_of "$script_log")" ]; then
        add_counts "$1" "$script_log" "$status" "$seconds"
    elif [ "$status" = 77 ]; then
        skip "$1" "$(tail -n 1 "$script_log")"
    elif [ "$status" = 0 ]; then
        pass "$1"
    else
        fail "$1" "$script_log"
    fi
}

# The Python package, built and installed in a clean virtual environment; then its tests, in groups that run beside each other.
python_parts=
prepare_python() {
    sh tests/tools/logged.sh "$(log_of python)" "${PYTHON_SECONDS:-1500}" sh tests/tools/test_python.sh prepare
}

list_python() {
    for part in $python_parts; do
        (allowed=${PYTHON_SECONDS:-1500} && list_command "python $part" sh tests/tools/test_python.sh $(echo "$part" | tr - ' '))
    done
}

count_python() {
    count_script python
    for part in $python_parts; do count_script "python $part"; done
}

# A locale whose decimal point is a comma, for the tests that show that it changes nothing.
make_locale() {
    [ -d "$BUILD/locale/de_DE.UTF-8" ] && return
    mkdir -p "$BUILD/locale"
    localedef -i de_DE -f UTF-8 "$BUILD/locale/de_DE.UTF-8" >"$logs/locale.log" 2>&1 || rm -rf "$BUILD/locale"
}

# ---- Tiers ----

# The program that is tested is a copy, since one of the scripts makes and installs it anew.
build_tested() { # GOALS...
    build native "$@"
    mkdir -p "$BUILD/tested"
    cp -f "$BUILD/bitvox" "$BUILD/tested/bitvox"
    BITVOX=$(cd "$BUILD/tested" && pwd)/bitvox
    export BITVOX
}

build_here() {
    if has_cmocka; then fault=fault-programs; else fault=; fi
    build_tested all test-programs $fault
    native=$folder
    if [ "$CC ${CFLAGS:-}" = "cc -O3" ]; then check 'native/no warnings' no_warnings "$(log_of 'native/build all')"; fi
}

# Of the library and the program, file by file at the level that users build with; rows with UNITS see fewer kinds.
no_warnings() { ! grep -E '^(src|include)/.*warning:' "$1"; }

list_here() {
    list_kind native unit ''
    if [ -n "$fault" ]; then list_kind native fault ''; fi
    list_golden native '' --threads 1 --portable
    list_golden native '' --threads 8
    list_examples
    list_program
    list_command gltf sh tests/tools/test_gltf.sh "$native"
    list_command checks sh tests/tools/check_house.sh "$native"
}

tests_here() {
    list_here | run_lines
    count_kind native unit
    if [ -n "$fault" ]; then count_kind native fault; else skip native/fault "the library cmocka is missing"; fi
    count_log_of 'native/golden --threads 1 --portable'
    count_log_of 'native/golden --threads 8'
    count_examples
    count_program
    count_script gltf
}

count_checks() {
    read -r status seconds <"$(log_of checks).end"
    add_script checks "$(log_of checks)" "$status"
}

# The larger builds of the tier run beside the others, so that no processor waits where one ends; build finds them made and says how they went.
build_beside() {
    for row in san clang plain; do
        case $row in
        san) goals="fuzz-programs $fault" ;;
        *) goals=row-products ;;
        esac
        # shellcheck disable=SC2086
        if [ $row != clang ] || has clang; then "row_$row" $goals; fi
    done >"$logs/beside.log" 2>&1
}

build_other_compilers() { # sets $compilers
    compilers=
    for row in plain fast clang; do
        if [ $row = fast ] && [ "$CC ${CFLAGS:-}" = "cc -O3" ]; then continue; fi # that was the native row
        if [ $row = clang ] && ! has clang; then
            skip clang "clang is missing"
            continue
        fi
        goals=row-products
        if [ $row = clang ]; then goals="$goals $(row_clang print-folder)/tests/unit/test_threads"; fi # the POSIX pool
        build $row $goals
        compilers="$compilers $row"
    done
}

# Without optimisation the long rows take a minute: another compiler and two machines have their bits, and make matrix does them all.
brief_golden() { if [ "$1" = plain ]; then echo --brief; fi; } # ROW

list_other_compilers() {
    for row in $compilers; do
        folder=$(row_$row print-folder)
        list_golden $row '' $(brief_golden $row)
        if [ $row = clang ]; then list_command clang/unit/test_threads "$folder/tests/unit/test_threads"; fi
    done
}

count_other_compilers() {
    for row in $compilers; do
        count_log_of "$row/golden$(brief_golden $row | sed 's/^/ /')"
        if [ $row = clang ]; then count_log_of clang/unit/test_threads; fi
    done
}

# 32-bit x86 and big-endian s390x, statically linked; BVX_QUICK=1 asks long tests to be brief. i686_folder and s390x_folder are empty
# where a machine is left out.
build_machines() { # whole: all unit tests and golden values
    i686= i686_folder= s390x_folder= kept_on_machines= brief_on_s390x=
    if [ "$1" != whole ]; then
        kept_on_machines=$(echo $machine_tests) brief_on_s390x=--brief
        skip machines "all unit tests but $(echo $machine_tests | wc -w); make test-machines runs them"
    fi
    if has i686-linux-gnu-gcc; then
        i686=i686-linux-gnu-gcc i686_ar=i686-linux-gnu-ar
    elif echo 'int main(void) { return 0; }' | compiles "$CC" -m32 -static; then
        i686="$CC -m32" i686_ar=ar
    fi
    if [ -n "$i686" ]; then
        emulator=
        echo 'int main(void) { return 0; }' | compiles $i686 -static
        "$logs/probe" 2>/dev/null || emulator=qemu-i386
        if [ -n "$emulator" ] && ! has $emulator; then
            skip i686 "$emulator is missing and 32-bit programs do not run here"
        else
            build_units i686
            i686_folder=$folder
        fi
    else
        skip i686 "no compiler for 32-bit x86"
    fi

    if ! has s390x-linux-gnu-gcc; then
        skip s390x "s390x-linux-gnu-gcc is missing"
    elif ! has qemu-s390x; then
        skip s390x "qemu-s390x is missing"
    else
        build_units s390x
        s390x_folder=$folder
    fi
}

build_units() { # ROW: sets $folder
    folder=$("row_$1" print-folder)
    kept=$kept_on_machines
    # shellcheck disable=SC2046
    build "$1" golden-program $(for name in $(names_of_kind unit); do echo "$folder/tests/unit/$name"; done)
    kept=
}

list_machines() {
    kept=$kept_on_machines
    folder=$i686_folder
    if [ -n "$folder" ]; then
        list_kind i686 unit "$emulator"
        list_golden i686 "$emulator"
    fi
    folder=$s390x_folder
    if [ -n "$folder" ]; then
        list_kind s390x unit qemu-s390x
        list_golden s390x qemu-s390x $brief_on_s390x
    fi
    kept=
}

count_machines() {
    kept=$kept_on_machines
    if [ -n "$i686_folder" ]; then
        count_kind i686 unit
        count_log_of i686/golden
    fi
    if [ -n "$s390x_folder" ]; then
        count_kind s390x unit
        count_log_of "s390x/golden${brief_on_s390x:+ $brief_on_s390x}"
    fi
    kept=
}

# The program for Windows under wine. Scripts get a command that starts it; what wine lacks they skip and say so. windows_folder is empty
# where there is no wine. The folder of wine's settings is made by its first start, beside what is built next, as that takes long.
build_windows() {
    windows_folder=
    if ! has x86_64-w64-mingw32-gcc || ! has wine; then
        skip windows "mingw or wine is missing (Debian: gcc-mingw-w64-x86-64 libz-mingw-w64-dev wine wine64; make deps-windows)"
        return
    fi
    mkdir -p "$BUILD/windows"
    windows=$(cd "$BUILD/windows" && pwd)
    export WINEDEBUG=-all WINEPREFIX="$windows/wine"
    folder=$(row_windows print-folder)
    build windows "$folder/bitvox.exe" "$folder/tests/golden/golden"
    if [ ! -f "$folder/bitvox.exe" ]; then return; fi
    windows_folder=$folder
    printf '#!/bin/sh\nexec sh "%s/tests/tools/under_wine.sh" "%s" "$@"\n' "$PWD" "$(cd "$folder" && pwd)/bitvox.exe" >"$windows/bitvox"
    rm -f "$folder/bitvox.exe.again"
    chmod +x "$windows/bitvox"
    # By itself the server of wine leaves three seconds after its last program, and the next one waits for a new server. This one stays
    # while the rest is built and the tests run, and leaves after half an hour without a program.
    {
        if has wineserver; then wineserver -p1800; fi
        wine "$folder/bitvox.exe" --version
        echo "status $?"
    } >"$logs/wineserver" 2>&1 </dev/null &
    wine_starts=$!
}

program_starts() { tail -n 1 "$logs/wineserver" | grep -x 'status 0' || { cat "$logs/wineserver"; return 1; }; }

list_windows() { # brief: the scripts that take a minute at most
    if [ -z "$windows_folder" ]; then return; fi
    wait $wine_starts
    folder=$windows_folder
    rm -f "$(log_of windows/golden).end"
    if [ -f "$folder/tests/golden/golden.exe" ]; then list_command windows/golden wine "$folder/tests/golden/golden.exe"; fi
    for script in $(windows_scripts "$1"); do
        list_command "windows/$(basename "$script")" env SYSTEM=windows "BITVOX=$windows/bitvox" sh "$script"
    done
}

windows_scripts() { # brief
    for script in tests/program/*.sh; do
        if [ -z "$(windows_lacks "$1/$script")" ]; then echo "$script"; fi
    done
}

windows_lacks() { # TIER/SCRIPT: prints why the script is left out
    case $1 in
    */test_install.sh) echo "make install puts libraries of this system" ;;
    brief/*/test_program.sh | brief/*/test_levels.sh | brief/*/test_level_meshes.sh | brief/*/test_voxels.sh | brief/*/test_commands.sh | \
        brief/*/test_repair.sh | brief/*/test_boolean.sh)
        echo "make test-windows runs it"
        ;;
    esac
}

count_windows() { # brief
    if [ -z "$windows_folder" ]; then return; fi
    check 'windows/the program starts' program_starts
    count_log_of windows/golden
    for script in tests/program/*.sh; do
        why=$(windows_lacks "$1/$script")
        if [ -n "$why" ]; then skip "windows/$(basename "$script")" "$why"; else count_script "windows/$(basename "$script")"; fi
    done
    if has wineserver; then wineserver -k >>"$logs/wineserver" 2>&1 </dev/null || true; fi
    if [ -s "$windows_folder/bitvox.exe.again" ]; then
        echo "note  windows: wine left before the program began and was started again: $(wc -l <"$windows_folder/bitvox.exe.again") times"
    fi
}

if [ $tier = here ]; then sh tests/tools/deps.sh first; fi
make_locale
if [ -d "$BUILD/locale" ]; then
    LOCPATH=$(cd "$BUILD/locale" && pwd)
    export LOCPATH
fi

case $tier in
here)
    # Packages of the system are fetched while the library compiles, and installed when nothing does.
    sh tests/tools/deps.sh fetch &
    fetching=$!
    trap 'kill $fetching 2>/dev/null; exit 130' INT TERM
    build_here
    wait $fetching
    sh tests/tools/deps.sh
    tests_here
    count_checks
    ;;
other)
    # All is built first and then runs from one line, so that no processor waits at the end. The Python package's tools are fetched and
    # its wheel is compiled meanwhile: one waits for the network, the other does not.
    sh tests/tools/get_unity.sh "${UNITY_DIR:-$BUILD/unity}"
    build_tested all
    prepare_python &
    python_beside=$!
    BVX_QUICK=1
    export BVX_QUICK
    allow 1800 # every allocation of the long stages, several times slower than without sanitizers; all golden rows under an emulator
    if has_cmocka; then fault=fault-programs; else fault=; fi
    build_beside &
    beside=$!
    trap 'kill $beside $python_beside 2>/dev/null; exit 130' INT TERM
    build_windows
    build_machines brief
    wait $beside
    wait $python_beside
    if [ "$(cut -d ' ' -f 1 "$(log_of python).end")" != 77 ]; then python_parts='wheels pytest-1 pytest-2'; fi
    build san fuzz-programs $fault
    san=$folder
    build_other_compilers
    {
        folder=$san
        if [ -n "$fault" ]; then list_kind san fault ''; fi
        dear_inputs=30 # of 300 where each runs whole chains of stages, 100 of volumes, 5,000 of 20,000 contours, a third of the fields' corpus; make san runs all
        list_fuzz san ''
        list_machines
        list_other_compilers
        list_python
        list_command 'add an option' python3 tests/tools/test_add_option.py
        list_command 'projects that use CMake' sh tests/tools/packaging.sh quick
        list_windows brief
    } >"$logs/lines"
    run_lines <"$logs/lines"
    if [ -n "$fault" ]; then count_kind san fault; else skip san/fault "the library cmocka is missing"; fi
    count_fuzz san
    count_machines
    count_python
    count_script 'add an option'
    count_script 'projects that use CMake'
    count_windows brief
    count_other_compilers
    ;;
windows)
    build_windows
    list_windows whole >"$logs/lines"
    run_lines <"$logs/lines"
    count_windows whole
    ;;
machines)
    BVX_QUICK=1
    export BVX_QUICK
    allow 1800
    sh tests/tools/get_unity.sh "${UNITY_DIR:-$BUILD/unity}"
    build_machines whole
    list_machines | run_lines
    count_machines
    ;;
san)
    build san test-programs
    run_kind san unit ''
    run_fault san
    run_golden san ''
    run_fuzz san ''
    ;;
memory)
    sanitized memory 'use-of-uninitialized-value' memory 300
    ;;
threads)
    if ! echo 'int main(void) { return 0; }' | compiles clang -pthread -fsanitize=thread; then
        skip threads "clang has no thread sanitizer (Debian: clang)"
        finish
        exit
    fi
    export OMP_NUM_THREADS=4
    sanitized threads 'data race' race 100
    ;;
*)
    echo "run_tests: no tier named $tier" >&2
    exit 2
    ;;
esac
finish
