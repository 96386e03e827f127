#!/bin/sh
# test_components.sh [PROGRAM] - the components command, and voxelize on clouds of points, on blocks whose parts, cavities and counts
# are known by hand. PROGRAM is build/bitvox, or what BITVOX names. The last line is "N passed, N failed[, N skipped]". Runs in the
# repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

# A box of whole voxels as OBJ; corners are counted on from $vertices.
vertices=0
box() { # X, Y, Z, SIDE
    for z in 0 "$4"; do for y in 0 "$4"; do for x in 0 "$4"; do echo "v $(($1 + x)) $(($2 + y)) $(($3 + z))"; done; done; done
    for face in '1 3 4' '1 4 2' '5 6 8' '5 8 7' '1 2 6' '1 6 5' '3 7 8' '3 8 4' '1 5 7' '1 7 3' '2 4 8' '2 8 6'; do
        # shellcheck disable=SC2086
        set -- $face
        echo "f $(($1 + vertices)) $(($2 + vertices)) $(($3 + vertices))"
    done
    vertices=$((vertices + 8))
}

# Three parts: 7 x 7 x 7 with a cavity of 3 x 3 x 3; 4 x 4 x 4 that meets 2 x 2 x 2 at a corner alone.
{ box 0 0 0 7; vertices=8; box 2 2 2 3; vertices=16; box 10 0 0 4; vertices=24; box 14 4 4 2; } >parts.obj
works 'the parts' voxelize parts.obj -o parts.bvx --spacing 1 --quiet

says() { # NAME, PATTERN, ARGUMENTS...: the report of the parts holds the pattern
    says_name=$1 says_pattern=$2
    shift 2
    run components parts.bvx "$@" --json
    if [ $status = 0 ] && grep -q -e "$says_pattern" out; then ok "$says_name"; else not_ok "$says_name" "no $says_pattern in $(cat out)"; fi
}

is_set() { # NAME, FILE, VOXELS
    is_count=$("$program" info "$2" --json 2>err | sed -n 's/.*"set": \([0-9]*\).*/\1/p')
    if [ "$is_count" = "$3" ]; then ok "$1"; else not_ok "$1" "$is_count voxels, not $3"; fi
}

leaves() { # NAME, VOXELS, ARGUMENTS...: the grid that components writes
    leaves_name=$1 leaves_count=$2
    shift 2
    rm -f left.bvx
    run components parts.bvx -o left.bvx --quiet "$@"
    is_set "$leaves_name" left.bvx "$leaves_count"
}

# ---- what is there ----
says 'three parts through faces' '"count": 3, .*"cavities": 1, "tunnels": 0, "euler": 4'
says 'two parts through corners' '"count": 2, ' --connectivity 26
says 'three parts through edges' '"count": 3, ' --connectivity 18
says 'the first part' '{"number": 1, "voxels": 316, "first": \[0, 0, 0\], "low": \[0, 0, 0\], "size": \[7, 7, 7\]}'
says 'the last part' '{"number": 3, "voxels": 8, "first": \[14, 4, 4\], "low": \[14, 4, 4\], "size": \[2, 2, 2\]}'
gives 'a table' 0 '316 *81.443%' components parts.bvx

# ---- what is kept ----
leaves 'all of it' 388
leaves 'the largest' 316 --keep-largest 1
leaves 'the two largest' 380 --keep-largest 2
leaves 'parts of 9 voxels' 380 --at-least 9
leaves 'parts of 8 voxels' 388 --at-least 8
leaves 'by a seed' 64 --seed 13,3,3
leaves 'by two seeds' 72 --seed 13,3,3,15,5,5
leaves 'by a seed and corners' 72 --seed 13,3,3 --connectivity 26
leaves 'without the cavity' 415 --fill-cavities
leaves 'the largest without its cavity' 343 --keep-largest 1 --fill-cavities
says 'what was dropped' '"dropped": 2, "voxels_dropped": 72' --keep-largest 1
says 'what was filled' '"filled": 27, "cavities": 0' --fill-cavities
leaves 'a seed that holds nothing' 0 --seed 3,3,3

# ---- refusals ----
rm -f left.bvx
gives 'a seed beyond the grid' 1 'seed' components parts.bvx -o left.bvx --seed 16,0,0
gives 'two numbers of a seed' 2 'three' components parts.bvx -o left.bvx --seed 1,2
gives 'a connectivity that is none' 2 '6' components parts.bvx -o left.bvx --connectivity 7
gives 'a mesh' 2 'parts.obj' components parts.obj -o left.bvx
if [ -e left.bvx ]; then not_ok 'nothing is left behind' "$(ls)"; else ok 'nothing is left behind'; fi

# ---- clouds ----
# The points of a cube's six faces, half a voxel in, one hole of a voxel in the low face along z; one voxel twice.
{
    for z in 0 1 2 3 4; do for y in 0 1 2 3 4; do for x in 0 1 2 3 4; do
        case $x$y$z in
        220) ;;
        *[04]*) echo "$x.5 $y.5 $z.5" ;;
        esac
    done; done; done
    echo '0.25 0.25 0.25'
} >cube.xyz
works 'voxels with points' voxelize cube.xyz -o points.bvx --spacing 1 --quiet
is_set 'each point one voxel' points.bvx 97
works 'voxels with two points' voxelize cube.xyz -o twice.bvx --spacing 1 --minimum 2 --quiet
is_set 'two points one voxel' twice.bvx 1
gives 'a body that the hole drains' 0 'set' voxelize cube.xyz -o open.bvx --spacing 1 --body
is_set 'a body that the hole drains' open.bvx 97
works 'a body with the hole closed' voxelize cube.xyz -o closed.bvx --spacing 1 --body --close-gaps 1 --quiet
is_set 'a body with the hole closed' closed.bvx 125
works 'the ball' voxelize "$root/fixtures/ball.xyz" -o ball.bvx --spacing 0.1 --body --close-gaps 1 --quiet
gives 'the ball is one part' 0 'parts *1, ' components ball.bvx
refuses 2 'output-origin needs -o' components ball.bvx --output-origin 1,2,3 # it said "(null) is not a mesh"
refuses 2 'output-origin is for meshes; x.bvx is not a mesh' components ball.bvx -o x.bvx --output-origin 1,2,3
: >empty.xyz
gives 'a cloud without points' 1 'empty.xyz' voxelize empty.xyz -o none.bvx --spacing 1

counts
