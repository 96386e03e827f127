#!/bin/sh
# bare.sh - build the core for a Cortex-M3 without an operating system, run it under an emulator, compare its golden line and
# say how much flash and RAM it took. Called by `make bare`. Exit status 77: a tool is missing.
set -eu
cd "$(dirname "$0")/../.."
out=${BUILD:-build}/bare
for tool in arm-none-eabi-gcc arm-none-eabi-size qemu-system-arm; do
    if ! command -v "$tool" >/dev/null 2>&1; then
        echo "$tool is missing (Debian: gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm)"
        exit 77
    fi
done
mkdir -p "$out"
flags='-std=c11 -Os -mcpu=cortex-m3 -mthumb -ffreestanding -DBVX_FREESTANDING -ffp-contract=off -fno-math-errno -fno-trapping-math
    -ffunction-sections -fdata-sections -Iinclude -Isrc -Itests'
sh src/amalgamate.sh "$out" >/dev/null
# shellcheck disable=SC2086
arm-none-eabi-gcc $flags -c "$out/bitvox.c" -o "$out/bitvox.o"
# shellcheck disable=SC2086
arm-none-eabi-gcc $flags -Wall -Wextra -c tests/bare/main.c -o "$out/main.o"
arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -nostartfiles -specs=nosys.specs -Wl,--gc-sections -T tests/bare/cortex_m3.ld \
    "$out/main.o" "$out/bitvox.o" -lm -o "$out/bare.elf"
if arm-none-eabi-nm "$out/bare.elf" | grep -E ' (malloc|_malloc_r|_sbrk|free)$'; then
    echo "FAIL the program has a heap"
    exit 1
fi
timeout 120 qemu-system-arm -M mps2-an385 -nographic -monitor none -serial none -semihosting-config enable=on,target=native \
    -kernel "$out/bare.elf" >"$out/printed" 2>&1 </dev/null || true
line=$(grep '^torus_32_bare ' "$out/printed" || true)
if [ -z "$line" ] || [ "$line" != "$(cat fixtures/golden/bare.txt)" ]; then
    echo "FAIL printed:"
    cat "$out/printed"
    echo "stored:"
    cat fixtures/golden/bare.txt
    exit 1
fi
echo "$line"
# The shape and the arena are this program's; what is left of RAM is the library's own.
arm-none-eabi-size "$out/bare.elf" | awk 'NR == 2 { printf "flash %d bytes, RAM %d bytes of which stack 16384\n", $1 + $2, $2 + $3 }'
arm-none-eabi-nm -S "$out/bare.elf" | awk '$4 == "arena" || $4 == "torus" { print $4, "array", "0x" $2 }'
sed -n 's/^arena /arena used: /p' "$out/printed"
