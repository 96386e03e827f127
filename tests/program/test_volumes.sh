#!/bin/sh
# test_volumes.sh [PROGRAM] - scalar volumes by the bitvox program: levels, ranges, labels, and the files that hold them. PROGRAM is
# build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]".
# Runs in the repository's root, works in a folder of its own; VOLUMES is the folder of real volumes [../shared/volumes].
set -u
. tests/tools/program_checks.sh
fixtures=$root/fixtures
volumes=${VOLUMES:-$root/../shared/volumes}
case $volumes in
/*) ;;
*) volumes=$root/$volumes ;;
esac

same() { # NAME, FILE, FILE
    if cmp -s "$2" "$3"; then ok "$1"; else not_ok "$1" "$2 and $3 differ"; fi
}

waves=$fixtures/waves.nhdr labels=$fixtures/labels.npy

# ---- levels and ranges ----
gives 'a mesh of a level' 0 'closed, manifold' voxelize "$waves" -o level.ply --level 120
gives 'its report' 0 '"volume": {"type": "u8", "size": \[48, 40, 32\], "least": 0, "greatest": 184, "nan": 0, "infinite": 0}' \
    voxelize "$waves" -o level2.ply --level 120 --json
gives 'the report says that it is closed' 0 '"closed": true, "manifold": true' voxelize "$waves" -o level2.ply --level 120 --json
gives 'a grid of a level' 0 'voxels      3643 set' voxelize "$waves" -o level.bvx --level 120
gives 'a range is the same' 0 '3643 set' voxelize "$waves" -o range.bvx --range 120,
same 'grids of level and range' level.bvx range.bvx
gives 'a range with both ends' 0 'set' voxelize "$waves" -o both.bvx --range 119.5,130
gives 'a range without a low end' 0 'set' voxelize "$waves" -o under.bvx --range ,119.5
gives 'below is the other side' 0 'set' voxelize "$waves" -o below.bvx --level 119.5 --below
same 'grids of below and a range' under.bvx below.bvx
gives 'a window' 0 'dims        10 x 20 x 16' voxelize "$waves" -o window.bvx --level 120 --window 20,10,8,30,30,24
gives 'a window of the grid is that of the volume' 0 'dims' convert level.bvx -o window2.bvx --window 20,10,8,30,30,24
same 'they are equal' window.bvx window2.bvx
gives 'nothing in the range' 1 'the range holds no sample' voxelize "$waves" -o none.ply --level 250
gives 'levels of detail of a volume' 0 'written: lod_0.ply, lod_1.ply' lod "$waves" -o lod_%d.ply --level 120 --levels 24,12
gives 'faces of a volume' 0 'faces' faces "$waves" -o faces.ply --range 120,
gives 'a picture of a volume' 0 'picture.png' render "$waves" -o picture.png --level 120

# ---- samples alone ----
gives 'a raw file' 0 '3643 set' voxelize "$fixtures/waves.raw" -o raw.bvx --shape 48,40,32 --sample-type u8 --voxel-size 1,1,1.25 --level 120
same 'its grid is that of the head' raw.bvx level.bvx
gives 'a raw file without shape' 2 'holds bare samples' voxelize "$fixtures/waves.raw" -o raw.bvx --level 120
gives 'a raw file of another shape' 1 'but the file has 61440' voxelize "$fixtures/waves.raw" -o raw.bvx --shape 48,40,33 --sample-type u8 --level 120
gives 'options of raw files for others' 2 'is for .raw files' voxelize "$waves" -o raw.bvx --level 120 --skip 5

# ---- labels ----
gives 'one label' 0 'closed, manifold' voxelize "$labels" -o seven.stl --label 7
# Three labels that are one double: 2^53 and one more, and two more.
# shellcheck disable=SC2059
for k in 0 1 2; do printf "\\00$k\\0\\0\\0\\0\\0\\040\\0"; done >wide.raw
for type in i64 u64; do
    gives "a label of 64 bits, $type" 0 '1 set' voxelize wide.raw -o wide.bvx --shape 3,1,1 --sample-type $type --label 9007199254740993
done
gives 'a number without labels' 2 'voxelize writes one' voxelize "$labels" -o part_%d.stl --label 1
# The side-car of a volume tells its place.
"$program" voxelize "$labels" -o placed.npy --label 1 >out 2>err </dev/null
cp "$labels" beside.npy
cp placed.npy.json beside.npy.json
gives 'a volume beside a side-car' 0 'triangles' voxelize beside.npy -o part.ply --label 1

# ---- refusals ----
gives 'two choices' 2 'exclude each other' voxelize "$waves" -o a.bvx --level 5 --range 1,2
gives 'below alone' 2 'needs --level' voxelize "$waves" -o a.bvx --below --range 1,2
gives 'a range of nothing' 2 'two numbers' voxelize "$waves" -o a.bvx --range ,
gives 'options of meshes' 2 'is for meshes' voxelize "$waves" -o a.bvx --level 5 --resolution 40
gives 'a grid without a choice' 2 'choose voxels of a volume' voxelize level.bvx -o a.npy
cp "$waves" lost.nhdr
gives 'a data file that is not there' 1 'waves.raw' voxelize lost.nhdr -o a.bvx --level 5
for name in "$fixtures/waves.raw" ../waves.raw sub/../../waves.raw '..'; do
    sed "s|^data file:.*|data file: $name|" "$waves" >away.nhdr
    gives "samples in $name" 1 'only files in its own folder or below' voxelize away.nhdr -o a.bvx --level 5
done
mkdir -p sub/..below
cp "$fixtures/waves.raw" sub/..below/waves.raw
sed 's|^data file:.*|data file: sub/..below/./waves.raw|' "$waves" >below.nhdr
gives 'samples in a folder below' 0 'set' voxelize below.nhdr -o below.bvx --level 5
cp "$fixtures/waves.raw" many.raw # 61,440 bytes, named often
{ printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 48 40 64000\nencoding: raw\ndata file: LIST\n' && for _ in 1 2 3 4 5 6 7 8; do echo many.raw; done; } >many.nhdr
gives 'data files that are too much together' 1 'bytes are more than the 15[0-9]* bytes that --memory-limit leaves for it' voxelize many.nhdr -o a.bvx --level 5 --memory-limit 200000
gives 'data files that leave nothing of the limit' 1 'is to fit into the 0 bytes that --memory-limit' voxelize many.nhdr -o a.bvx --level 5 --memory-limit $((61440 + $(wc -c <many.nhdr)))
if ls a.* >/dev/null 2>&1; then not_ok 'nothing is left behind' "$(ls a.*)"; else ok 'nothing is left behind'; fi

# ---- parts ----
# Level 80 of the waves has parts of 12688, 44 and 1 voxels.
gives 'the largest part' 0 '"parts": {"kept": 1, "dropped": 2, "voxels_kept": 12688, "voxels_dropped": 45}' voxelize "$waves" -o kept.bvx --level 80 --keep-largest 1 --json
gives 'one part, by components too' 0 '12688  100.000%' components kept.bvx
gives 'parts of some size' 0 'kept        2 of 3 parts; 1 voxels went' voxelize "$waves" -o kept.bvx --level 80 --least-part 44
gives 'levels of parts of some size' 0 'written: kept_0.ply, kept_1.ply' lod "$waves" -o kept_%d.ply --level 80 --levels 24,12 --samples 0 --least-part 44
gives 'levels of parts of no size' 1 'the grid is empty' lod "$waves" -o kept_%d.ply --level 80 --levels 24,12 --samples 0 --least-part 20000
gives 'levels of parts of a mesh by samples' 2 '--least-part is for --method collapse, and --levels for edge-ratio' lod "$fixtures/knot.ply" -o kept_%d.ply --levels 24,12 --least-part 44
gives 'the largest part of a mesh by samples' 2 '--keep-largest is for --method collapse, and --levels for edge-ratio' lod "$fixtures/knot.ply" -o kept_%d.ply --levels 24,12 --keep-largest 1
gives 'parts of no size' 0 'the result is empty' voxelize "$waves" -o kept.bvx --level 80 --least-part 20000
run voxelize "$waves" -o all.obj --level 80
gives 'the surface of the largest part' 0 'kept.obj: 14488 triangles, closed, manifold, volume 15497.2, 1 surface' voxelize "$waves" -o kept.obj --level 80 --keep-largest 1
grep '^v ' all.obj | sort >all.txt
grep '^v ' kept.obj | sort >kept.txt
if [ "$(wc -l <kept.txt)" -gt 7000 ] && [ -z "$(comm -13 all.txt kept.txt)" ]; then ok 'its vertices are where they were'
else not_ok 'its vertices are where they were' "$(comm -13 all.txt kept.txt | wc -l) others"; fi
gives 'the surface of a range' 0 '2 surfaces' voxelize "$waves" -o kept.ply --range 80,184 --least-part 40
gives 'below a level' 0 'kept        1 of ' voxelize "$waves" -o kept.ply --level 20 --below --keep-largest 1
gives 'no surface is left' 1 'each of the 3 parts has fewer voxels than --least-part' voxelize "$waves" -o none.ply --level 80 --least-part 20000
gives 'nothing to drop is no change' 0 '14680 triangles' voxelize "$waves" -o kept.ply --level 80 --least-part 1
run voxelize "$waves" -o grid.bvx --level 80
for command in 'convert -o kept.bvx' 'faces -o kept.ply' 'lod -o kept.ply --levels 16' 'render -o kept.png --size 64x48'; do
    gives "parts of a volume: $command" 0 '"dropped": 2' ${command%% *} "$waves" ${command#* } --level 80 --keep-largest 1 --json
    gives "parts of a grid: $command" 0 '"dropped": 2' ${command%% *} grid.bvx ${command#* } --keep-largest 1 --json
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 2 2 2\nv 5 2 2\nv 2 5 2\nv 2 2 5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n' >grid_mesh.obj
gives 'parts of voxels of a mesh' 0 'kept        1 of 2 parts' voxelize grid_mesh.obj -o kept.bvx --resolution 40 --keep-largest 1
gives 'parts of a cloud' 0 'kept        1 of ' voxelize "$fixtures/ball.xyz" -o kept.bvx --spacing 0.05 --keep-largest 1
gives 'parts of a mesh' 2 '--keep-largest is for grids and volumes' convert "$fixtures/knot.ply" -o x.ply --keep-largest 1
gives 'parts of distances' 2 'are for voxels' voxelize "$fixtures/knot.ply" -o x.nrrd --mode field --least-part 5

# ---- packed samples ----
if "$program" info "$fixtures/knot.ply.gz" 2>&1 | grep -q 'without zlib'; then
    skip 'gzip samples' 'made without zlib'
elif command -v gzip >/dev/null 2>&1; then
    { printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 48 40 32\nspacings: 1 1 1.25\naxis mins: 0 0 0\nencoding: gzip\n\n' && gzip -c "$fixtures/waves.raw"; } >packed.nrrd
    gives 'gzip samples' 0 '3643 set' voxelize packed.nrrd -o packed.bvx --level 120
    same 'their grid' packed.bvx level.bvx
    gzip -c "$fixtures/waves.raw" >other.raw.gz
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 48 40 32\nspacings: 1 1 1.25\naxis mins: 0 0 0\nencoding: gzip\ndata file: other.raw.gz\n' >apart.nhdr
    gives 'gzip samples in another file' 0 '3643 set' voxelize apart.nhdr -o apart.bvx --level 120
    same 'their grid too' apart.bvx level.bvx
    gives 'what is other than 0 without a choice' 0 'set' voxelize apart.nhdr -o all.bvx
    head -c 3000 packed.nrrd >cut.nrrd
    gives 'gzip samples cut short' 1 'damaged' voxelize cut.nrrd -o cut.bvx --level 120
    { printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 48 40 32\nspacings: 1 1 1.25\naxis mins: 0 0 0\nencoding: raw\n\n' && cat "$fixtures/waves.raw"; } >plain.nrrd
    gives 'a grid' 0 'set' convert plain.nrrd -o plain.bvx
    gives 'a grid of gzip samples' 0 'set' convert packed.nrrd -o packed_grid.bvx
    same 'the same grid' packed_grid.bvx plain.bvx
    gives 'a window of a grid' 0 'set' convert plain.nrrd -o plain_part.bvx --window 3,5,7,40,30,20
    gives 'a window of a grid of gzip samples' 0 'set' convert packed.nrrd -o packed_part.bvx --window 3,5,7,40,30,20
    same 'the same window' packed_part.bvx plain_part.bvx
    gives 'gzip samples beside a grid' 0 'the same' compare packed.nrrd plain.bvx
    gives 'a grid of gzip samples cut short' 1 'cut.nrrd: NRRD: the packed samples are damaged' components cut.nrrd -o cut.bvx
    gives 'a window beyond a grid of gzip samples' 1 'are not inside the file' convert packed.nrrd -o x.bvx --window 0,0,0,49,40,32
    gives 'gzip samples beyond the memory limit' 1 'the volume would take 61440 bytes' convert packed.nrrd -o x.bvx --memory-limit 40K
    sed 's/: gzip/: bzip2/' packed.nrrd >bzip.nrrd
    gives 'another packer of a grid' 1 'compressed or hex samples' convert bzip.nrrd -o x.bvx
fi

# ---- .vti with blocks of zlib ----
if ! has python3; then
    skip 'packed .vti' 'python3 is missing'
elif "$program" info "$fixtures/knot.ply.gz" 2>&1 | grep -q 'without zlib'; then
    skip 'packed .vti' 'made without zlib'
else
    cat >vti.py <<'P'
import base64, struct, sys, zlib

def pack(data, block, head, big):
    parts = [data[i:i + block] for i in range(0, len(data), block)]
    packed = [zlib.compress(p) for p in parts]
    last = len(parts[-1]) % block if parts else 0
    return struct.pack(('>' if big else '<') + head * (3 + len(parts)), len(parts), block, last, *map(len, packed)), b''.join(packed)

def write(name, how, head='I', big=False, block=4000):
    data = open(sys.argv[1], 'rb').read()
    values = data if not big else data
    b64 = lambda h, p: base64.b64encode(h) + base64.b64encode(p)
    arrays = [('first', 'Float32', struct.pack(('>' if big else '<') + '61440f', *range(61440))), ('waves', 'UInt8', values)]
    tags, tail = b'', b''
    for label, kind, plain in arrays:
        h, p = pack(plain, block, head, big)
        body = b64(h, p) if how != 'raw' else h + p
        if how == 'binary':
            tags += b'<DataArray type="%s" Name="%s" format="binary">\n  %s\n</DataArray>' % (kind.encode(), label.encode(), body)
        else:
            tags += b'<DataArray type="%s" Name="%s" format="appended" offset="%d"/>' % (kind.encode(), label.encode(), len(tail))
            tail += body
    out = b'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" byte_order="%s" header_type="%s" compressor="vtkZLibDataCompressor">\n' % (
        b'BigEndian' if big else b'LittleEndian', b'UInt64' if head == 'Q' else b'UInt32')
    out += b'<ImageData WholeExtent="0 48 0 40 0 32" Origin="0 0 0" Spacing="1 1 1.25"><Piece Extent="0 48 0 40 0 32"><CellData Scalars="waves">'
    out += tags + b'</CellData></Piece></ImageData>'
    if how != 'binary':
        out += b'<AppendedData encoding="%s">_' % (b'raw' if how == 'raw' else b'base64') + tail + b'</AppendedData>'
    open(name, 'wb').write(out + b'</VTKFile>\n')

write('raw.vti', 'raw')
write('whole.vti', 'raw', block=61440)
write('wide.vti', 'raw', 'Q', block=1000)
write('big.vti', 'raw', 'I', True)
write('base64.vti', 'base64')
write('inline.vti', 'binary', 'Q')
raw = open('raw.vti', 'rb').read()
at = raw.index(b'>_') + 2
second = int(raw.split(b'offset="')[2].split(b'"')[0])
open('cut.vti', 'wb').write(raw[:len(raw) - 400])
open('damaged.vti', 'wb').write(raw[:at + second + 100] + b'XXXX' + raw[at + second + 104:])
open('many.vti', 'wb').write(raw[:at + second] + b'\xff\xff\xff\x7f' + raw[at + second + 4:])
open('bomb.vti', 'wb').write(raw[:at + second + 4] + b'\xff\xff\xff\x7f' + raw[at + second + 8:])
open('lz4.vti', 'wb').write(raw.replace(b'vtkZLibDataCompressor', b'vtkLZ4DataCompressor'))
P
    holds 'packed .vti are made' python3 vti.py "$fixtures/waves.raw"
    for name in raw whole wide big base64 inline; do
        gives "blocks of zlib: $name" 0 '3643 set' voxelize $name.vti -o vti.bvx --level 120
        same "their grid: $name" vti.bvx level.bvx
    done
    gives 'blocks of zlib: what is not 0' 0 'set' convert raw.vti -o vti.npy
    gives 'blocks of zlib: samples' 0 'u8, from 0 to 184' info inline.vti
    gzip -c raw.vti >again.vti.gz
    gives 'blocks of zlib in gzip' 0 '3643 set' voxelize again.vti.gz -o vti.bvx --level 120
    gives 'blocks cut short' 1 'cut.vti: VTI: ' voxelize cut.vti -o a.bvx --level 120
    gives 'a damaged block' 1 'a packed block is damaged' voxelize damaged.vti -o a.bvx --level 120
    gives 'more blocks than bytes' 1 'more blocks than the file has bytes for' voxelize many.vti -o a.bvx --level 120
    gives 'blocks larger than they can be' 1 'hold more than they can' voxelize bomb.vti -o a.bvx --level 120
    gives 'blocks beyond the memory limit' 1 'the volume would take 61440 bytes' voxelize whole.vti -o a.bvx --level 120 --memory-limit 150K
    gives 'another packer' 1 'the data is compressed' voxelize lz4.vti -o a.bvx --level 120
    if ls a.* >/dev/null 2>&1; then not_ok 'nothing is left of them' "$(ls a.*)"; else ok 'nothing is left of them'; fi
fi

# ---- real data ----
if [ -f "$volumes/vtk_headsq_quarter.tar.gz" ] && tar -xzf "$volumes/vtk_headsq_quarter.tar.gz" 2>/dev/null; then
    gives 'the CT head from its slices' 0 'closed, manifold' voxelize headsq/quarter.nhdr -o head.stl --level 1150
else
    skip 'the CT head from its slices' "no $volumes/vtk_headsq_quarter.tar.gz"
fi

# ---- info of several files, and of samples alone ----

gives 'samples alone' 0 'u8, from 0 to 184; 13225 are 0' info "$fixtures/waves.raw" --shape 48,40,32 --sample-type u8
gives 'of another shape' 1 'but the file has 61440' info "$fixtures/waves.raw" --shape 48,40,33 --sample-type u8
gives '--shape of a mesh' 2 'is for volumes' info "$knot" --shape 4,4,4
gives 'two files' 0 'dims        48 x 40 x 32' info "$knot" "$waves"
holds 'the first of them too' grep -q 'triangles ' out
run info "$knot" lost.ply "$waves" --json
if [ $status = 1 ] && grep -q '"done": 2, "failed": 1, "files": \[{"input": ' out; then ok 'a list of reports, one of a failure'
else not_ok 'a list of reports, one of a failure' "status $status: $(cut -c 1-120 out)"; fi

counts
