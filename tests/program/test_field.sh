#!/bin/sh
# test_field.sh [PROGRAM] - distance fields by the bitvox program: voxelize --mode field. PROGRAM is build/bitvox, or what BITVOX
# names. One line a check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the
# repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
meshes=$root/../shared/meshes

warns() { # WORDS, ARGUMENTS...: status 0 and a warning with these words
    words=$1
    shift
    run "$@"
    if [ $status = 0 ] && grep -q "^bitvox: warning: .*$words" err; then ok "warned: $words"; else not_ok "warned: $words" "status $status"; fi
}

says() { grep -q -E -e "$1" out; } # PATTERN

cat >box.obj <<'OBJ'
v 0 0 0
v 4 0 0
v 0 4 0
v 4 4 0
v 0 0 4
v 4 0 4
v 0 4 4
v 4 4 4
f 1 3 4
f 1 4 2
f 5 6 8
f 5 8 7
f 1 2 6
f 1 6 5
f 3 7 8
f 3 8 4
f 1 5 7
f 1 7 3
f 2 4 8
f 2 8 6
OBJ
grep -v '^f 2 8 6' box.obj >open.obj
sed 's/^f 2 8 6/f 2 6 8/' box.obj >flipped.obj

# ---- formats ----

works 'voxelize --mode field to NRRD' voxelize box.obj -o box.nrrd --mode field --spacing 1 --half-width 1
holds 'the sign is told' says '^  sign +parity, 64 centres inside$'
holds 'the padding is the half-width' says '^  dims +6 x 6 x 6$'
holds 'the half-width is told' says '^  field +distances within 1$'
holds 'NRRD of floats' grep -q -a '^type: float$' box.nrrd
holds 'its origin is a centre' grep -q -a '^space origin: (-0.5,-0.5,-0.5)$' box.nrrd
works 'to VTI' voxelize box.obj -o box.vti --mode field --spacing 1 --half-width 1
holds 'point data' grep -q -a '<PointData Scalars="distance">' box.vti
works 'vectors of doubles' voxelize box.obj -o vectors.vti --mode field --spacing 1 --half-width 1 --vectors --value-type f64
holds 'vectors are told' says '^  field +vectors within 1$'
holds 'three doubles a point' grep -q -a 'type="Float64" Name="vector" NumberOfComponents="3"' vectors.vti
works 'to NPY' voxelize box.obj -o box.npy --mode field --spacing 1 --half-width 1
holds 'NPY has a side-car' grep -q '"spacing"' box.npy.json
holds '128 bytes and 216 floats' test "$(wc -c <box.npy)" = $((128 + 216 * 4))
works 'another padding' voxelize box.obj -o pad.npy --mode field --spacing 1 --half-width 1 --padding 0
holds 'the padding asked for' says '^  dims +4 x 4 x 4$'
works 'every centre' voxelize box.obj -o all.npy --mode field --spacing 1 --half-width 0
holds 'every centre has a distance' says '100 % of all$'

# ---- the numbers, by another program ----

if has python3; then
    cat >check.py <<'PY'
import struct, sys
def floats(name, skip):
    data = open(name, "rb").read()[skip:]
    return struct.unpack("<%df" % (len(data) // 4), data)
d = floats("box.npy", 128)
def true(x, y, z): # the box 0..4 at centres -0.5 .. 4.5
    c = [x - 0.5, y - 0.5, z - 0.5]
    o = [max(-v, 0.0, v - 4) for v in c]
    out = sum(v * v for v in o) ** 0.5
    return out if out > 0 else -min(min(v, 4 - v) for v in c)
for z in range(6):
    for y in range(6):
        for x in range(6):
            t = true(x, y, z)
            want = t if abs(t) <= 1 else (1.0 if t > 0 else -1.0)
            assert abs(d[(z * 6 + y) * 6 + x] - want) < 1e-6, (x, y, z)
nrrd = open("box.nrrd", "rb").read()
assert nrrd[nrrd.index(b"\n\n") + 2:] == open("box.npy", "rb").read()[128:]
vti = open("box.vti", "rb").read()
at = vti.index(b"\n    _") + 6
assert struct.unpack("<Q", vti[at:at + 8])[0] == 864 and vti[at + 8:at + 8 + 864] == open("box.npy", "rb").read()[128:]
PY
    holds 'all numbers are those of a box, in all formats' python3 check.py
    run voxelize box.obj -o x.npy --mode field --spacing 1 --json
    holds 'the report' python3 -c 'import json
r = json.load(open("out"))
f = r["field"]; assert f["sign"] == "parity" and f["half_width"] == 3 and f["inside"] == 64 and f["values"] == r["set"] < 1000, f
assert f["vectors"] is False and f["value_type"] == "f32"
assert r["lattice"]["dims"] == [10, 10, 10] and r["warnings"] == []'
else
    skip 'the numbers by another program' 'python3 is missing'
fi

# ---- signs ----

for sign in parity nonzero normal winding vote none; do
    works "--sign $sign" voxelize "$knot" -o $sign.npy --mode field --resolution 40 --sign $sign
    holds "$sign is told" says "^  sign +$sign"
    works "$sign on one thread" voxelize "$knot" -o again.npy --mode field --resolution 40 --sign $sign --threads 1
    holds "$sign: threads do not show" cmp $sign.npy again.npy
done
for sign in winding vote; do holds "$sign is exact on a closed mesh" cmp $sign.npy parity.npy; done
run voxelize open.obj -o x.npy --mode field --spacing 1
holds 'an open mesh takes winding numbers' says '^  sign +winding'
run voxelize flipped.obj -o x.npy --mode field --spacing 1
holds 'a flipped triangle is turned' says '^  sign +parity'
run voxelize box.obj -o x.npy --mode field --resolution 3,5,7
holds 'stretched voxels' says '^  dims +9 x 11 x 13$'

# ---- windows ----

warns 'only these voxels' voxelize box.obj -o part.nrrd --mode field --spacing 1 --window 1,2,3,6,5,6
holds 'a window of the field' says '^  dims +5 x 3 x 3$'
works 'a far away lattice' voxelize box.obj -o x.npy --mode field --spacing 1 --origin 0,0,0
warns "no voxel's centre is within" voxelize box.obj -o x.npy --mode field --spacing 1 --half-width 1 --padding 9 --window 0,0,0,3,3,3

# ---- refusals ----

rm -f x.*
refuses 2 'fields are written as .npy, .nrrd, .vti, .vdb or .nvdb' voxelize box.obj -o x.bvx --mode field
refuses 2 'is for solids' voxelize box.obj -o x.npy --mode field --fill vote
refuses 2 'is for fields' voxelize box.obj -o x.npy --sign vote
refuses 2 'is for fields' voxelize box.obj -o x.npy --mode thin --vectors
refuses 2 'is for fields' voxelize box.obj -o x.npy --half-width 2
refuses 2 'is for fields' voxelize box.obj -o x.npy --value-type f64
refuses 2 '--half-width' voxelize box.obj -o x.npy --mode field --half-width -1
refuses 2 '--half-width' voxelize box.obj -o x.npy --mode field --half-width inf
refuses 2 'one of: auto, parity, nonzero, vote' voxelize box.obj -o x.npy --mode field --sign inside
refuses 2 'one of: f32, f64' voxelize box.obj -o x.npy --mode field --value-type f16
refuses 1 'limit' voxelize "$knot" -o x.npy --mode field --memory-limit 3M
printf 'v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n' >line.obj
refuses 1 'area' voxelize line.obj -o x.npy --mode field --resolution 8

# ---- real meshes ----

if [ -d "$meshes" ]; then
    works 'a scan with holes' voxelize "$meshes/bunny_scan_69451.ply.gz" -o bunny.npy --mode field --resolution 96
    holds 'it takes winding numbers' says '^  sign +winding, [0-9]{6} centres inside$'
    works 'sharp edges' voxelize "$meshes/fandisk.obj.gz" -o normal.npy --mode field --resolution 96 --sign normal
    works 'by the solid' voxelize "$meshes/fandisk.obj.gz" -o exact.npy --mode field --resolution 96
    if cmp -s normal.npy exact.npy; then not_ok 'normals are wrong at sharp edges' 'the fields are the same'; else ok 'normals are wrong at sharp edges'; fi
else
    skip 'real meshes' '../shared/meshes is missing'
fi

counts
