#!/usr/bin/env python3
"""test_peers.py [PROGRAM] - what the bitvox program writes, read by other libraries, and what they read, beside it.

Every mesh of ../shared/meshes is converted to OBJ, PLY, OFF and GLB and compared, triangle by triangle, with trimesh's own
reading of the original; grids are read back by numpy, trimesh, PyVista and pynrrd. One line a check, "ok NAME" or
"not ok NAME"; the last line is "N passed, N failed[, N skipped]". Without trimesh or without the meshes nothing can be
compared: exit status 77. PROGRAM is build/bitvox, or what BITVOX names.
"""
import gzip
import io
import json
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import trimesh
except ImportError as error:
    print(f'{error.name} is missing')
    sys.exit(77)

MESHES = os.path.join('..', 'shared', 'meshes')
if not os.path.isdir(MESHES):
    print(f'{MESHES} is missing')
    sys.exit(77)

PROGRAM = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.environ.get('BITVOX', 'build/bitvox'))
TEXT_MOST = 130_000  # triangles of a mesh that goes through the slow readers of text
counts = {'passed': 0, 'failed': 0, 'skipped': 0}


def check(name, good, why=''):
    counts['passed' if good else 'failed'] += 1
    print(f'{"ok" if good else "not ok"} {name}')
    if not good:
        print(f'# {why}')


def skip(name, why):
    counts['skipped'] += 1
    print(f'ok {name} # SKIP {why}')


def bitvox(*arguments):
    """The report of a run; a run that fails ends the tests, since nothing after it means anything."""
    done = subprocess.run([PROGRAM, *arguments, '--json'], capture_output=True, text=True)
    if done.returncode != 0:
        print(f'not ok bitvox {" ".join(arguments)}\n# {done.stderr.strip()}')
        counts['failed'] += 1
        finish()
    return json.loads(done.stdout)


def finish():
    more = f', {counts["skipped"]} skipped' if counts['skipped'] else ''
    print(f'{counts["passed"]} passed, {counts["failed"]} failed{more}')
    sys.exit(counts['failed'] != 0)


# ---- meshes ----

def open_bytes(path):
    return gzip.open(path, 'rb') if path.endswith('.gz') else open(path, 'rb')


def kind_of(path):
    return os.path.splitext(path[:-3] if path.endswith('.gz') else path)[1][1:].lower()


def by_trimesh(path):
    """Corners of the triangles of a file, n x 3 x 3, as trimesh reads it, nothing merged."""
    with open_bytes(path) as file:
        mesh = trimesh.load(io.BytesIO(file.read()), file_type=kind_of(path), process=False, maintain_order=True,
                            skip_materials=True, force='mesh')
    return np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces)], len(mesh.vertices)


def by_plyfile(path):
    """The same by plyfile: polygons are fans, which the convex ones of these files are to us too."""
    import plyfile
    with open_bytes(path) as file:
        data = plyfile.PlyData.read(file)
    v = data['vertex']
    xyz = np.stack([np.asarray(v[a], np.float64) for a in 'xyz'], axis=1)
    names = [p.name for p in data['face'].properties]
    lists = data['face'][names[0] if 'vertex_indices' not in names else 'vertex_indices']
    fans = [(f[0], f[i], f[i + 1]) for f in lists for i in range(1, len(f) - 1)]
    return xyz[np.asarray(fans, np.int64)], len(xyz)


def canonical(corners):
    """Triangles in an order of their own, each from its least corner on: what does not depend on how a file lists them."""
    corners = corners + 0.0  # -0 is 0
    order = np.lexsort(corners.transpose(2, 0, 1)[::-1], axis=1)[:, 0]
    turned = corners[np.arange(len(corners))[:, None], (order[:, None] + np.arange(3)) % 3].reshape(len(corners), 9)
    return turned[np.lexsort(turned.T[::-1])]


def same(a, b, kind):
    """As numbers of the file's type: STL and these PLY files hold floats, which text tells by fewer digits than a double's."""
    if kind in ('stl', 'ply'):
        a, b = (np.asarray(v, np.float32).astype(np.float64) for v in (a, b))
    if len(a) != len(b):
        return False, f'{len(a)} triangles, not {len(b)}'
    if np.array_equal(a, b):
        return True, ''
    a, b = canonical(a), canonical(b)
    return np.array_equal(a, b), f'{np.count_nonzero((a != b).any(axis=1))} of {len(a)} triangles differ, by {abs(a - b).max()} at most'


def volume_of(corners):
    a, b, c = (corners[:, i] - corners.reshape(-1, 3).mean(axis=0) for i in range(3))
    return float(np.einsum('ij,ij->i', a, np.cross(b, c)).sum() / 6)


def check_glb(name, path, wanted):
    """f32, of doubles about the centre, which a node carries."""
    scene = trimesh.load(path, process=False)
    mesh = scene.to_geometry() if hasattr(scene, 'to_geometry') else scene.dump(concatenate=True)
    got = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces)]
    size = np.ptp(wanted.reshape(-1, 3), axis=0).max()
    low, high = wanted.min(axis=(0, 1)), wanted.max(axis=(0, 1))
    off = max(abs(got.min(axis=(0, 1)) - low).max(), abs(got.max(axis=(0, 1)) - high).max())
    scale = max(abs(low).max(), abs(high).max())
    check(f'{name}: GLB has its bounds', len(got) == len(wanted) and off <= 1e-6 * size + 1e-14 * scale, f'{len(got)} triangles, {off} off')
    a, b = volume_of(got), volume_of(wanted)
    check(f'{name}: GLB has its volume', abs(a - b) <= 1e-5 * size ** 3, f'{a}, not {b}')


def check_mesh(path, work):
    name = os.path.basename(path)
    kind = kind_of(path)
    wanted, vertices = by_trimesh(path)
    info = bitvox('info', path)['meshes'][0]
    listed = info['triangles'] + info['collapsed']
    check(f'{name}: as many triangles', listed == len(wanted), f'{listed}, not {len(wanted)}')
    if kind == 'stl':  # three vertices a triangle there, welded where bits are equal here
        vertices = len(np.unique(np.asarray(wanted, np.float32).reshape(-1, 3), axis=0))
    if kind == 'obj':  # trimesh repeats those with several texture coordinates
        with open_bytes(path) as file:
            vertices = sum(line.startswith(b'v ') for line in file)
    check(f'{name}: as many vertices', info['vertices'] + info['unused_vertices'] == vertices,
          f'{info["vertices"]} and {info["unused_vertices"]} unused, not {vertices}')
    exact = wanted if kind in ('obj', 'off') else wanted.astype(np.float32).astype(np.float64)
    low, high = exact.min(axis=(0, 1)), exact.max(axis=(0, 1))
    check(f'{name}: its bounds', info['low'] == list(low) and info['high'] == list(high), f'{info["low"]}, not {low}')
    if kind == 'ply':
        try:
            good, why = same(by_plyfile(path)[0], wanted, kind)
            check(f'{name}: plyfile reads what trimesh reads', good, why)
        except ImportError:
            skip(f'{name}: plyfile', 'plyfile is missing')
    for target in ('ply', 'obj', 'off', 'glb'):
        if target in ('obj', 'off') and len(wanted) > TEXT_MOST:
            continue
        out = os.path.join(work, f'mesh.{target}')
        as_it_comes = ['--input-up', 'y'] if kind == 'stl' and target in ('obj', 'glb') else []  # .stl has z up, these y
        bitvox('convert', path, '-o', out, *as_it_comes)
        if target == 'glb':
            check_glb(name, out, wanted)
            continue
        got, count = by_trimesh(out)
        good, why = same(got, wanted, kind)
        check(f'{name}: {target.upper()} is the same, triangle by triangle', good, why)
        if target != 'obj':  # trimesh drops vertices of OBJ that no face uses
            check(f'{name}: {target.upper()} has as many vertices', count == vertices, f'{count}, not {vertices}')


# ---- grids ----

def check_grids(work):
    mesh = os.path.join('fixtures', 'knot.ply')
    path = {e: os.path.join(work, f'grid.{e}') for e in ('npy', 'binvox', 'vti', 'nrrd', 'vox', 'bvx')}
    report = bitvox('voxelize', mesh, '-o', path['npy'], '--resolution', '70', '--padding', '2')
    for ending in ('binvox', 'vti', 'nrrd', 'vox', 'bvx'):
        bitvox('convert', path['npy'], '-o', path[ending])
    lattice = report['lattice']
    origin, spacing = np.array(lattice['origin']), np.array(lattice['spacing'])
    voxels = np.load(path['npy'])
    check('numpy: bool, axes x y z', voxels.dtype == bool and list(voxels.shape) == lattice['dims'], f'{voxels.dtype} {voxels.shape}')
    check('numpy: as many voxels', int(voxels.sum()) == report['set'], voxels.sum())
    with open(path['npy'] + '.json', encoding='utf-8') as file:
        side = json.load(file)
    check('the side-car is the lattice', side['origin'] == lattice['origin'] and side['spacing'] == lattice['spacing'], side)
    check_binvox(path['binvox'], work, voxels, origin, spacing)
    check_vti(path['vti'], voxels, origin, spacing)
    check_nrrd(path['nrrd'], voxels, origin, spacing)
    check_foreign(work, voxels)


def check_binvox(path, work, voxels, origin, spacing):
    """trimesh's loader takes cubes alone, but its parser and its runs take any shape: x slowest, then z, then y."""
    from trimesh.exchange import binvox
    from trimesh.voxel import encoding
    with open(path, 'rb') as file:
        data, shape, translate, scale = binvox.parse_binvox(file)
    x, y, z = shape
    dense = encoding.RunLengthEncoding(data, dtype=bool).dense.reshape(x, z, y).transpose(0, 2, 1)
    check('trimesh: .binvox has the same voxels', np.array_equal(dense, voxels), dense.shape)
    check('trimesh: .binvox lies at the low corner', np.allclose(translate, origin, rtol=1e-6, atol=0) and np.isclose(scale / max(shape), spacing[0], rtol=1e-6),
          (shape, translate, scale))
    cube = os.path.join(work, 'cube.binvox')
    bitvox('voxelize', os.path.join(MESHES, 'unit_sphere.stl.gz'), '-o', cube.replace('binvox', 'npy'), '--resolution', '32')
    bitvox('convert', cube.replace('binvox', 'npy'), '-o', cube)
    with open(cube, 'rb') as file:
        grid = binvox.load_binvox(file)
    check('trimesh: a cube of .binvox', np.array_equal(np.asarray(grid.matrix), np.load(cube.replace('binvox', 'npy'))), grid.matrix.shape)
    out = cube.replace('cube', 'theirs')
    with open(out, 'wb') as file:
        file.write(binvox.export_binvox(trimesh.voxel.VoxelGrid(np.array(grid.matrix))))  # runs that it read overflow in it
    found = bitvox('convert', out, '-o', cube.replace('binvox', 'npy'))
    check('trimesh writes .binvox, bitvox reads', np.array_equal(np.load(cube.replace('binvox', 'npy')), np.asarray(grid.matrix)), found['set'])


def check_vti(path, voxels, origin, spacing):
    try:
        import pyvista
    except ImportError:
        skip('PyVista: .vti', 'pyvista is missing')
        return
    image = pyvista.read(path)
    cells = np.asarray(image.cell_data['solid']).reshape(voxels.shape, order='F')
    check('PyVista: .vti has the same voxels', np.array_equal(cells != 0, voxels), cells.shape)
    check('PyVista: .vti lies at the low corner', tuple(image.origin) == tuple(origin) and tuple(image.spacing) == tuple(spacing), image)


def check_nrrd(path, voxels, origin, spacing):
    try:
        import nrrd
    except ImportError:
        skip('pynrrd: .nrrd', 'pynrrd is missing')
        return
    data, header = nrrd.read(path)
    check('pynrrd: .nrrd has the same voxels', np.array_equal(data != 0, voxels), data.shape)
    check('pynrrd: .nrrd lies at the first centre', np.array_equal(header['space origin'], origin + 0.5 * spacing) and
          np.array_equal(header['space directions'], np.diag(spacing)), header)
    out = path.replace('.nrrd', '_theirs.nrrd')
    nrrd.write(out, voxels.astype(np.int16) * 7, {'space dimension': 3, 'space origin': origin + 0.5 * spacing, 'encoding': 'raw',
                                                  'space directions': np.diag(spacing)})
    grid = bitvox('info', out)
    check('pynrrd writes, bitvox reads', grid['set'] == int(voxels.sum()) and np.allclose(grid['grid']['corner'], origin, rtol=0, atol=1e-9 * spacing.max()),
          grid['grid'])


def check_foreign(work, voxels):
    """Files that other libraries write."""
    first = bitvox('info', os.path.join(work, 'grid.npy'))['grid']['box']
    for order in 'CF':
        for kind in (bool, np.uint8, '>i2', np.float32, np.float64):
            out = os.path.join(work, 'theirs.npy')
            np.save(out, np.array(voxels.astype(kind), order=order))
            grid = bitvox('info', out)
            check(f'numpy writes {np.dtype(kind).str} in {order} order, bitvox reads', grid['set'] == int(voxels.sum()) and grid['grid']['box'] == first, grid)
    try:
        import pyvista
    except ImportError:
        skip('PyVista writes .vti', 'pyvista is missing')
        return
    image = pyvista.ImageData(dimensions=np.array(voxels.shape) + 1, origin=(1, 2, 3), spacing=(0.5, 0.25, 2))
    image.cell_data['solid'] = voxels.astype(np.uint8).ravel(order='F')
    out = os.path.join(work, 'theirs.vti')
    import vtk
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(out)
    writer.SetInputData(image)
    writer.SetCompressorTypeToNone()  # packed data are refused
    writer.Write()
    grid = bitvox('info', out)
    check('VTK writes .vti, bitvox reads', grid['set'] == int(voxels.sum()) and grid['grid']['box'] == first and grid['grid']['corner'] == [1, 2, 3],
          grid)


def main():
    with tempfile.TemporaryDirectory() as work:
        for name in sorted(os.listdir(MESHES)):
            if kind_of(name) in ('stl', 'obj', 'ply', 'off'):
                check_mesh(os.path.join(MESHES, name), work)
        check_grids(work)
    finish()


main()
