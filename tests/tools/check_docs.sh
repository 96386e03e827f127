#!/bin/sh
# check_docs.sh links|programs|commands|pictures - what README.md, CONTRIBUTING.md and docs/ say is so.
#     links     every link leads to a file that is here, and to a heading where it names one
#     programs  every C example is a whole program that compiles without a warning, runs and ends well
#     pictures  those of docs/pictures are what the program draws
#     commands  every line "bitvox ..." in a fence is run, in a folder that has the files that it names
# BUILD is where the program and the library are; CC compiles the examples.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${CC:=cc}"
build=$(cd "$BUILD" && pwd) || exit 1
work=$build/docs
pages=$(ls README.md CONTRIBUTING.md docs/*.md bindings/python/README.md 2>/dev/null)
mkdir -p "$work"

# A heading's anchor: lower case, no punctuation, hyphens for blanks.
anchors() { # PAGE
    sed -n '/^```/,/^```/!s/^##* //p' "$1" | tr 'A-Z' 'a-z' | tr -d '`.,:;()?!/'"'" | tr ' ' '-'
}

check_links() {
    bad=0
    for page in $pages; do
        folder=$(dirname "$page")
        for link in $(sed '/^```/,/^```/d' "$page" | grep -o '](\([^)]*\))' | sed 's/^](//; s/)$//'); do
            case $link in http*) continue ;; esac
            path=${link%%#*}
            anchor=
            case $link in *#*) anchor=${link#*#} ;; esac
            target=$page
            [ -z "$path" ] || target=$folder/$path
            if [ ! -e "$target" ]; then
                echo "$page: no file for the link $link"
                bad=1
            elif [ -n "$anchor" ] && ! anchors "$target" | grep -q -x -e "$anchor"; then
                echo "$page: no heading for the link $link"
                bad=1
            fi
        done
    done
    return $bad
}

check_programs() {
    rm -f "$work"/example_*
    # shellcheck disable=SC2086
    awk -v folder="$work" '/^```c$/ { on = 1; count++; next } /^```/ { on = 0 }
        on { print > (folder "/example_" count ".c") }' $pages
    [ -s "$work/example_1.c" ] || { echo "there is no C example"; return 1; }
    needed=$("${MAKE_COMMAND:-make}" -s print-needed)
    # shellcheck disable=SC2086
    for source in "$work"/example_*.c; do
        $CC -std=c99 -Wall -Wextra -Werror -Iinclude "$source" "$build/libbitvox.a" $needed -o "${source%.c}" &&
            "${source%.c}" >"$source.out" || { echo "$source fails"; return 1; }
    done
}

# Files under the names that the pages use, made of the bundled ones. Of numbers two are changed: the bundled volume has no
# bone at 1150, and 4096 voxels a side are too many for a test.
make_files() {
    run=$work/run
    rm -rf "$run"
    mkdir -p "$run"
    ln -s "$PWD/fixtures" "$run/fixtures"
    (
        cd "$run" || exit 1
        bitvox=$build/bitvox
        quiet() { "$bitvox" "$@" --quiet >made.txt 2>&1 || { echo "bitvox $*"; cat made.txt; exit 1; }; }

        cp fixtures/knot.ply closed.ply
        quiet simplify fixtures/knot.ply -o small.ply --triangles 3000
        for name in scan.stl part.obj part.stl part.ply broken.stl scan.ply stratocaster.ply dragon.ply.gz dragon_vrip_871414.ply.gz bunny_scan_69451.ply.gz; do
            quiet convert small.ply -o $name
        done
        quiet convert fixtures/terrain.ply -o now.stl
        quiet convert fixtures/terrain.ply -o terrain.stl
        quiet convert fixtures/terrain_quarry.ply -o plan.stl
        quiet voxelize small.ply -o body.bvx --resolution 64
        cp part.ply level_0.ply
        cp body.bvx part.bvx
        cp body.bvx before.bvx
        quiet morph erode body.bvx -o after.bvx
        quiet voxelize small.ply -o shell.vti --mode conservative --resolution 64
        quiet slice small.ply -o ore.csv --spacing 0.5
        quiet morph dilate body.bvx -o block.bvx
        quiet lod block.bvx -o block_%d.stl --levels 32
        mv block_0.stl block.stl
        sed 's/waves.raw/head.raw/' fixtures/waves.nhdr >head.nhdr
        cp fixtures/waves.raw head.raw
        cp fixtures/ball.xyz cloud.xyz
        quiet convert body.bvx -o atlas.nrrd

        # A mesh with colours.
        quiet convert small.ply -o plain.obj
        awk '/^v / { $0 = $0 " 1 0.5 " ($2 > 0) } { print }' plain.obj >painted.obj
        quiet convert painted.obj -o painted.ply
        quiet convert painted.obj -o helmet.glb
    )
}

check_commands() {
    make_files || return 1
    bad=0
    # shellcheck disable=SC2086
    awk '/^```/ { on = !on; next } on && /^(\$ )?bitvox [a-z]/ { sub(/^\$ /, ""); sub(/ +#.*/, ""); print }' $pages | sort -u |
        sed 's/--level 1150/--level 90/; s/--resolution 4096/--resolution 512/' >"$work/lines.txt"
    [ -s "$work/lines.txt" ] || { echo "there is no command"; return 1; }
    while IFS= read -r line; do
        (cd "$work/run" && PATH=$build:$PATH && export PATH && eval "$line" </dev/null) >"$work/said.txt" 2>&1 && continue
        echo "$line"
        tail -n 2 "$work/said.txt" | sed 's/^/    /'
        bad=1
    done <"$work/lines.txt"
    return $bad
}

case ${1:-} in
links) check_links ;;
programs) check_programs ;;
commands) check_commands ;;
pictures) BITVOX=$build/bitvox sh tests/tools/make_pictures.sh check ;;
*) echo "usage: check_docs.sh links|programs|commands|pictures" && exit 2 ;;
esac
