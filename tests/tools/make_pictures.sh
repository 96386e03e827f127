#!/bin/sh
# make_pictures.sh [check] - docs/pictures: what each command makes of overlaps, holes, thin walls and crumbs, a body through
# contours on crossing planes, a wall with what it encloses, the labelled cells of a ball, a brain by thresholds, and what warnings
# are about.
# With check nothing is written: the pictures must be those that the program draws now, and small.
# BITVOX is the program [build/bitvox]; the brain needs volumes/ch2bet.nii.gz of BITVOX_SHARED [../shared]. Runs in the repository's
# root, works in a folder of its own.
set -eu
cd "$(dirname "$0")/../.."
: "${BITVOX:=build/bitvox}" "${BITVOX_SHARED:=../shared}"
root=$PWD
volumes=$(cd "$BITVOX_SHARED/volumes" 2>/dev/null && pwd) || volumes=
bitvox=$(cd "$(dirname "$BITVOX")" && pwd)/$(basename "$BITVOX")
most=40000 # bytes of a picture
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Two balls and a box that overlap, some triangles flipped; a ball with holes; a chair of slats; a star of acute edges.
python3 - "$root/tests/tools" <<'P'
import sys
sys.path.insert(0, sys.argv[1])
from made_meshes import *

m = box(ball(ball(Mesh(), (0, 0, 0), 1, 16), (1, 0, 0), 1, 16), (-0.4, -1.3, -0.4), (0.6, 1.3, 0.4))
flip(m, range(0, len(m.faces), 29)).write('overlaps.off')
ball(Mesh(), (0, 0, 0), 1, 16, keep=lambda i, j: (i + j) % 8 > 1 or i not in (5, 6, 9)).write('holes.off')
for name, mesh, *rest in made_meshes():
    if name in ('chair', 'star'):
        mesh.write({'chair': 'thin.off', 'star': 'acute.off'}[name])
box(Mesh(), (0.35, -2, 0.1), (0.65, 3, 0.4)).write('bar.off')
P

quiet() { "$bitvox" "$@" --quiet --threads 1; }
draw() { # NAME: of what the four have become
    quiet render "$1"_overlaps."$2" "$1"_holes."$2" "$1"_thin."$2" "$1"_acute."$2" -o raw.png --size 132x112
    python3 "$root/tests/tools/pack_png.py" raw.png "$1.png"
}

for m in overlaps holes thin acute; do
    cp $m.off input_$m.off
    quiet voxelize $m.off -o voxelize_$m.bvx --resolution 40
    quiet boolean difference $m.off bar.off -o boolean_$m.ply --resolution 40
    quiet repair $m.off -o repair_$m.ply --resolution 40
    quiet lod $m.off --solid -o lod_$m.ply --triangles 400 --samples 0
    quiet simplify $m.off -o simplify_$m.ply --triangles 400 --samples 0
done
draw input off
draw voxelize bvx
for command in boolean repair lod simplify; do draw $command ply; done

# A body through the contours of a sweep, which are drawn on it.
planes() { python3 -c "import sys; sys.path.insert(0, sys.argv[1]); from made_planes import *; $1" "$root/tests/tools"; }
planes "write_csl('sweep.csl', sweep())"
quiet sections sweep.csl -o sweep.off --cells 64
planes "paint('sweep.off', 'painted.off', sweep(), 0.006)"
quiet render painted.off -o raw.png --size 204x192 --from 1,-2,1.2
python3 "$root/tests/tools/pack_png.py" raw.png sweep.png

# A wall and what it encloses, with the same faces where they touch.
python3 >wall.csv <<'P'
from math import cos, pi, sin

print('section,position,loop,x,y,label')
for s in range(7):
    x, inner, outer = 0.5 * sin(s), 2.2 + 0.5 * sin(1.3 * s), 3.2 + 0.35 * sin(0.9 * s + 1)
    for loop, (label, r) in enumerate([(1, outer), (1, inner), (2, inner)]):
        for i in range(48):
            a = pi * i / 24
            print(f'{s},{1.2 * s:g},{loop},{x + r * cos(a):.4f},{r * (1 + 0.08 * cos(3 * a)) * sin(a):.4f},{label}')
P
quiet sections wall.csv --label all --touching shared -o body_%d.off --cells 48
quiet render body_1.off body_2.off -o raw.png --size 250x175 --from 1,-2,1.4
python3 "$root/tests/tools/pack_png.py" raw.png bodies.png

# Cells of a ball without an eighth, each a label.
python3 <<'P'
import random
import struct

n, r = 48, random.Random(4)
seeds = [(n / 2,) * 3] + [tuple(n / 2 + r.gauss(0, n / 6) for _ in range(3)) for _ in range(11)]
labels = bytearray()
for i in range(n**3):
    at = [i % n + 0.5, i // n % n + 0.5, i // n // n + 0.5]
    inside = sum((a - n / 2) ** 2 for a in at) < (0.44 * n) ** 2 and min(at) < n / 2
    labels.append(1 + min(range(len(seeds)), key=lambda k: sum((a - b) ** 2 for a, b in zip(at, seeds[k]))) if inside else 0)
head = "{'descr': '|u1', 'fortran_order': True, 'shape': (%d, %d, %d), }" % (n, n, n)
open('cells.npy', 'wb').write(b'\x93NUMPY\x01\x00' + struct.pack('<H', 118) + head.ljust(117).encode() + b'\n' + labels)
P
quiet labels cells.npy -o stairs.glb --staircase
quiet labels cells.npy -o smooth.glb
quiet labels cells.npy -o fewer.glb --triangles 1500
quiet render stairs.glb smooth.glb fewer.glb -o raw.png --size 110x105 --from 3,2.2,2
python3 "$root/tests/tools/pack_png.py" raw.png labels.png

# Fluid, grey and white matter of a brain by thresholds, the lower part of it, each in its colour.
brain=
if [ -f "$volumes/ch2bet.nii.gz" ]; then
    brain=brain
    python3 - "$volumes/ch2bet.nii.gz" <<'P'
import gzip
import struct
import sys
from bisect import bisect

data = gzip.open(sys.argv[1]).read()
head = "{'descr': '|u1', 'fortran_order': True, 'shape': (%d, %d, %d), }" % struct.unpack_from('<3h', data, 42)
samples = data[int(struct.unpack_from('<f', data, 108)[0]):]
labels = samples.translate(bytes(bisect([1, 70, 101], value) for value in range(256)))
open('brain.npy', 'wb').write(b'\x93NUMPY\x01\x00' + struct.pack('<H', 118) + head.ljust(117).encode() + b'\n' + labels)
P
    quiet labels brain.npy -o brain_%s.ply --window 0,0,0,181,217,88
    python3 <<'P'
import struct

vertices, faces = [], []
for label, colour in enumerate(((90, 140, 200), (200, 120, 110), (240, 230, 200)), 1):
    head, _, body = open(f'brain_{label}.ply', 'rb').read().partition(b'end_header\n')
    count, n = int(head.split(b'element vertex ')[1].split()[0]), len(vertices)
    vertices += [body[i:i + 12] + bytes(colour) for i in range(0, 12 * count, 12)]
    faces += [struct.pack('<BIII', 3, a + n, b + n, c + n) for _, a, b, c in struct.iter_unpack('<BIII', body[12 * count:])]
rows = ['float ' + name for name in 'xyz'] + ['uchar ' + name for name in ('red', 'green', 'blue')]
head = ['ply', 'format binary_little_endian 1.0', f'element vertex {len(vertices)}', *('property ' + row for row in rows),
        f'element face {len(faces)}', 'property list uchar uint vertex_indices', 'end_header\n']
open('brain.ply', 'wb').write(b''.join(['\n'.join(head).encode(), *vertices, *faces]))
P
    quiet render brain.ply -o raw.png --size 200x144 --from 3,-2,1.6
    python3 "$root/tests/tools/pack_png.py" raw.png brain.png
fi

# Warnings: a mesh, what became of it, and that the warning was there.
python3 - "$root/tests/tools" <<'P'
import sys
from math import cos, sin

sys.path.insert(0, sys.argv[1])
from made_meshes import *


def whole(keep=lambda i, j: True):
    return ball(Mesh(), (0, 0, 0), 1, 16, keep=keep)


plates = box(box(Mesh(), (-20, -15, -1), (20, 15, 1)), (-20, -1, -10), (20, 1, 10))
box(plates, (-1, -15, -10), (1, 15, 10)).write('plates.off')
ball(whole(), (2.1, 0, 0), 1, 16).write('apart.off')
n = 24
grid = [(x / n, y / n, 0.2 * sin(5 * x / n) * cos(4 * y / n)) for x in range(n + 1) for y in range(n + 1)]
first = [x * (n + 1) + y for x in range(n) for y in range(n)]
Mesh().add(grid, [t for a in first for t in ([a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1])]).write('sheet.off')
whole(lambda i, j: i > 5).write('bowl.off')
balls = Mesh()
for i in range(3):
    ball(balls, (1.1 * i, 0.7 * (i % 2), 0), 0.8, 8)
balls.write('balls.off')
room = box(Mesh(), (0, 0, 0), (3, 4, 2), True)
room.faces = [f for f in room.faces if any(room.points[i][1] != 0 for i in f)]
room.write('room.off')
ball(whole(), (0, 0, 0), 0.6, 16).write('nested.off')
ball(whole(lambda i, j: not (7 <= i < 9 and 24 <= j < 26)), (1.7, 0, 0), 1, 16).write('leaking.off')
flip(whole(lambda i, j: (i * 7 + j) % 37 != 0), range(0, 900, 61)).write('torn.off')
P
warning() { # BVX_WARN_..., COMMAND ...
    code=$1
    shift
    "$bitvox" "$@" --threads 1 >said 2>&1
    grep -q "\[BVX_WARN_$code\]" said || { cat said && echo "no BVX_WARN_$code: $*" && exit 1; }
}
pair() { # NAME, BEFORE, AFTER, OPTIONS ...
    name=$1
    shift
    quiet render "$@" -o raw.png --size 120x100
    python3 "$root/tests/tools/pack_png.py" raw.png "warn_$name.png"
}
warning THIN_LOST voxelize acute.off -o thin.bvx --resolution 16
pair thin acute.off thin.bvx
warning THICKER repair plates.off -o thicker.ply --resolution 16
pair thicker plates.off thicker.ply
warning JOINED repair apart.off -o one.ply --resolution 20
pair joined apart.off one.ply
warning SHELLS repair sheet.off -o shell.ply --resolution 24
pair shells sheet.off shell.ply
warning LIDS repair bowl.off -o lid.ply --resolution 48
pair lids bowl.off lid.ply
warning LEVEL_VOLUME lod balls.off -o level_%d.ply --triangles 14 --samples 0
pair level balls.off level_0.ply
warning TURNED repair room.off -o block.ply --resolution 32
pair turned room.off block.ply
warning ROWS voxelize torn.off -o rows.bvx --resolution 40 --fill parity
pair rows torn.off rows.bvx
warning NESTED voxelize nested.off -o hollow.bvx --resolution 48
quiet voxelize nested.off -o solid.bvx --resolution 48 --fill nonzero
pair nested hollow.bvx solid.bvx --cut y=0
warning LEAKS voxelize leaking.off -o leaked.bvx --resolution 48 --fill flood
quiet voxelize leaking.off -o voted.bvx --resolution 48 --fill vote
pair leaks leaked.bvx voted.bvx --cut y=0
quiet voxelize torn.off -o near.bvx --resolution 24 --padding 1
warning ENDS morph dilate near.bvx -o ends.bvx --steps 5
pair ends near.bvx ends.bvx

warnings=$(printf 'warn_%s ' thin thicker joined shells lids level turned rows nested leaks ends)

bad=0
for picture in input voxelize boolean repair lod simplify sweep bodies labels $brain $warnings; do
    if [ "$(wc -c <$picture.png)" -gt $most ]; then
        echo "$picture.png has $(wc -c <$picture.png) bytes, more than $most"
        bad=1
    fi
    if [ "${1-}" != check ]; then
        mkdir -p "$root/docs/pictures"
        cp $picture.png "$root/docs/pictures/$picture.png"
    elif ! python3 "$root/tests/tools/pack_png.py" same $picture.png "$root/docs/pictures/$picture.png"; then
        echo "docs/pictures/$picture.png is not what the program draws: sh tests/tools/make_pictures.sh"
        bad=1
    fi
done
exit $bad
