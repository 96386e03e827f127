// api.test.mjs - what the package promises beside the bits: errors, progress, cancelling, memory, arguments of every kind.
// BITVOX_JS: the package's folder. Run from the repository root.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { ball, soup, torus } from './shapes.mjs';

const { BitvoxError, gridGet, load } = await import(
    pathToFileURL(resolve(process.env.BITVOX_JS, 'bitvox.js'))
);
const bitvox = await load();
const { load: loadFiles } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'files.js')));
const files = await loadFiles();
const { load: loadLabels } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'labels.js')));
const labels = await loadLabels();
const { load: loadMakers } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'makers.js')));
const makers = await loadMakers();
const tetrahedron = {
    positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]),
    triangles: new Uint32Array([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]),
};

/** What a call throws. */
function thrown(call) {
    try {
        call();
    } catch (error) {
        return error;
    }
    assert.fail('nothing was thrown');
}

// ---- Arguments ----

test('the count of the README', () => {
    const { grid, report } = bitvox.voxelize(tetrahedron, { resolution: 64 });
    assert.equal(bitvox.count(grid), 43680);
    assert.equal(report.fill, 'parity');
    assert.equal(gridGet(grid, 0, 0, 0), true);
    assert.equal(gridGet(grid, 63, 63, 63), false);
    assert.equal(
        bitvox.version,
        readFileSync('include/bitvox.h', 'utf8')
            .match(/VERSION_(MAJOR|MINOR|PATCH) \d+/g)
            .map(x => x.split(' ')[1])
            .join('.'),
    );
});

test('bodies of labels share their faces', () => {
    const size = [12, 9, 8];
    const label = n => (n % 12 < 6 ? 3n : n % 108 < 48 ? 5n : 0n);
    for (const Type of [BigInt64Array, BigUint64Array, Uint16Array]) {
        const samples = Type.from({ length: 12 * 9 * 8 }, (_, n) => (Type === Uint16Array ? Number(label(n)) : label(n)));
        const { labels: bodies, complex } = labels.labelSurfaces({ samples, size });
        assert.deepEqual(bodies.map(body => body.value), Type === Uint16Array ? [3, 5] : [3n, 5n]);
        assert.deepEqual(bodies.map(body => body.voxels), [6 * 9 * 8, 6 * 4 * 8]);
        const corners = mesh => new Set(Array.from({ length: mesh.positions.length / 3 }, (_, v) => mesh.positions.slice(3 * v, 3 * v + 3).join()));
        const all = corners(complex);
        for (const { mesh, voxels } of bodies) {
            const found = bitvox.check(mesh);
            assert.ok(found.closed && found.edgeManifold && found.vertexManifold && found.oriented);
            assert.ok(Math.abs(found.volume / voxels - 1) < 0.001);
            assert.ok([...corners(mesh)].every(corner => all.has(corner)));
        }
        const inner = complex.sides.filter((_, i) => i % 2 === 1 && complex.sides[i] === 1).length;
        assert.equal(bodies[0].mesh.triangles.length + bodies[1].mesh.triangles.length, complex.triangles.length + 3 * inner);
        assert.equal(labels.labelSurfaces({ samples, size }, { background: 3 }).labels.length, 2);
    }
    const made = labels.labelSurfaces({ samples: new Uint8Array(8), size: [2, 2, 2] });
    assert.deepEqual([made.labels.length, made.complex.triangles.length], [0, 0]);
});

/** The box between two corners; inwards: its sides turned round. */
function box(low, high, inwards = false) {
    const positions = Array.from({ length: 24 }, (_, i) => ((i / 3) >> (i % 3) & 1 ? high : low)[i % 3]);
    const sides = [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
    return { positions, triangles: inwards ? sides.reverse() : sides };
}

test('mass of whole meshes, and of torn ones within its bounds', () => {
    const close = (found, want, error) => [found].flat().forEach((x, i) => assert.ok(Math.abs(x - [want].flat()[i]) <= error, `${found}, not ${want}`));
    const whole = makers.measure(tetrahedron, { density: 6 });
    assert.deepEqual([whole.fill, whole.resolution], ['parity', 0]);
    close([whole.volume, whole.mass, ...whole.center], [1 / 6, 1, 0.25, 0.25, 0.25], 1e-14);
    close(whole.inertia, [0.075, 0.075, 0.075, 0.0125, 0.0125, 0.0125], 1e-14);
    const torn = makers.measure({ ...tetrahedron, triangles: tetrahedron.triangles.slice(3) }, { resolution: 32 });
    assert.equal(torn.resolution, 32);
    close(torn.volume, 1 / 6, torn.volumeError);
    assert.equal(thrown(() => makers.measure(tetrahedron, { density: -1 })).status, 'argument');
});

test('hulls: what is outside, and levels that go around', () => {
    const outer = box([0, 0, 0], [8, 8, 8]),
        inner = box([3, 3, 3], [5, 5, 5]);
    const both = { positions: [...outer.positions, ...inner.positions], triangles: [...outer.triangles, ...inner.triangles.map(v => v + 8)] };
    const [whole, fewer] = makers.hull(both, { resolution: 16, targetTriangles: [200, 60] }).levels.map(level => bitvox.check(level.mesh));
    assert.deepEqual([whole.components, whole.closed, whole.triangles <= 200, fewer.triangles <= 60], [1, true, true, true]);
    assert.ok(Math.abs(whole.volume / 512 - 1) < 0.05);
    const { levels } = makers.hull(both, { enclose: 0.5, targetTriangles: [100] });
    const { low, high, volume } = bitvox.check(levels[0].mesh);
    assert.ok(low.every(x => x < 0 && x >= -0.5) && high.every(x => x > 8 && x <= 8.5) && volume > 512);
});

test('whether a mesh can be made, and where it cannot', () => {
    const outer = box([0, 0, 0], [8, 8, 8]),
        inner = box([1, 2, 2], [6, 6, 6], true);
    const hollow = {
        positions: [...outer.positions, ...inner.positions],
        triangles: [...outer.triangles, ...inner.triangles.map(v => v + 8)],
    };
    const found = makers.inspect(hollow, { walls: 1.5, resolution: 32, thickness: true });
    assert.deepEqual([found.sound, found.report.needs, found.report.up], [true, 'nothing', undefined]);
    assert.deepEqual([found.cavities.length, found.islands.length, found.gaps.length], [1, 0, 0]);
    assert.ok(Math.abs(found.cavities[0].size / 80 - 1) < 0.1 && Math.abs(found.report.leastThickness - 1) < 1e-9);
    assert.ok(found.walls[0].size === found.report.leastThickness && found.walls[0].high[0] <= 1);
    assert.deepEqual([found.thickness.length, Math.min(...found.thickness)], [16, found.report.leastThickness]);
    const few = makers.inspect(hollow, { most: 1, lattice: found.report.lattice });
    assert.deepEqual([few.thickness, few.walls, few.cavities], [undefined, [], found.cavities]);
    assert.ok(!makers.inspect({ ...hollow, triangles: hollow.triangles.slice(3) }, { resolution: 16 }).sound);
    assert.equal(thrown(() => makers.inspect(hollow, { most: -1 })).status, 'argument');
});

test('all kinds of arrays are one mesh', () => {
    const want = bitvox.hash(bitvox.voxelize(tetrahedron, { resolution: 20 }).grid);
    const { positions, triangles } = tetrahedron;
    const loose = Array.from(triangles, v => Array.from(positions.subarray(3 * v, 3 * v + 3))).flat();
    for (const mesh of [
        { positions: Array.from(positions), triangles: Array.from(triangles) },
        { positions: Float64Array.from(positions), triangles: Uint16Array.from(triangles) },
        { positions, triangles: Int32Array.from(triangles) },
        { positions: new Float32Array(loose) },
        { attributes: { position: { array: positions } }, index: { array: triangles } },
        { attributes: { position: { array: new Float32Array(loose) } }, index: null },
    ])
        assert.equal(bitvox.hash(bitvox.voxelize(mesh, { resolution: 20 }).grid), want);
    const view = new Float32Array(new Float32Array([9, ...positions, 9]).buffer, 4, 12); // a part of a buffer
    assert.equal(bitvox.hash(bitvox.voxelize({ positions: view, triangles }, { resolution: 20 }).grid), want);
});

test('results are arrays of their own, and inputs stay', () => {
    const before = tetrahedron.positions.slice();
    const made = bitvox.repair(tetrahedron, { resolution: 16 }).mesh;
    const kept = made.positions.slice();
    bitvox.reset();
    bitvox.repair(soup(50, 3), { resolution: 16 });
    assert.deepEqual(made.positions, kept);
    assert.deepEqual(tetrahedron.positions, before);
    assert.equal(made.positions.byteOffset, 0);
    assert.equal(made.positions.buffer.byteLength, made.positions.byteLength);
});

test('formats come back', () => {
    const mesh = torus(24, 12, 0, 1),
        want = bitvox.check(mesh);
    for (const format of ['stl', 'obj', 'ply', 'off', 'glb', '3mf']) {
        const again = bitvox.check(files.readMesh(files.writeMesh(mesh, format), format));
        assert.equal(again.triangles, want.triangles);
        assert.equal(again.closed, true);
    }
    const glb = files.writeLevels(
        bitvox.simplify(mesh).levels.map(level => level.mesh),
        'glb',
    );
    assert.equal(new TextDecoder().decode(glb.subarray(0, 4)), 'glTF');
    assert.equal(files.formatOfName('Scan.PLY.gz'), 'ply');
    assert.equal(files.formatOfName('scan.txt'), undefined);
    assert.ok(files.writeMesh(mesh, 'ply', { normals: true }).length > files.writeMesh(mesh, 'ply').length);
    const coloured = { ...mesh, colours: new Uint8Array((mesh.positions.length / 3) * 4).fill(7) };
    assert.deepEqual(files.readMesh(files.writeMesh(coloured, 'ply'), 'ply').colours, coloured.colours);
    const text = new TextEncoder().encode('OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 3\n');
    assert.equal(files.readMesh(text, 'off', { finite: true }).dropped, 1);
    assert.equal(thrown(() => files.readMesh(text, 'off')).status, 'range');
});

/** The boxes of one .glb, each a node with its name and colour. */
const COLOURS = [255, 0, 0, 255, 0, 90, 255, 255, 12, 200, 40, 255];
const coloured = () =>
    files.writeLevels([0, 5, 10].map(x => box([x, 0, 0], [x + 4, 3, 2])), 'glb', { names: ['red', 'blüe', 'green'], colours: COLOURS });

test('a coloured .glb becomes a .vox, and that a .glb', () => {
    const mesh = files.readMesh(coloured(), 'glb');
    assert.deepEqual([...mesh.materialColours], COLOURS);
    const { grid } = bitvox.voxelize(mesh, { resolution: 28 });
    const made = labels.labelVoxels(mesh, grid);
    assert.deepEqual([...grid.size, made.labels.length, made.palette.length], [28, 6, 4, 28 * 6 * 4, 1024]);
    assert.ok(made.labels.every((label, n) => label === (n % 28 % 10 < 8 ? 1 + Math.floor((n % 28) / 10) : 0)));
    assert.deepEqual([...made.palette.subarray(4, 16)], COLOURS);

    const file = files.writeLabels(grid, made, 'vox');
    const back = files.readLabels(file, 'vox');
    assert.deepEqual([back.labels, back.grid.words, back.grid.size], [made.labels, grid.words, grid.size]);
    assert.deepEqual([...back.palette.subarray(4, 16)], COLOURS);
    assert.deepEqual(files.readGrid(file, 'vox'), back.grid);
    assert.match(new TextDecoder().decode(files.writeLabels(grid, made, 'nrrd')), /Segment1_LabelValue:=2\n/);

    // The file keeps no lattice: the grid's own is put in its place.
    const { labels: bodies } = labels.labelSurfaces({ samples: back.labels, size: back.grid.size, lattice: grid.lattice }, { staircase: true });
    const names = bodies.map(body => String(body.value));
    const colours = bodies.flatMap(body => [...back.palette.subarray(4 * body.value, 4 * body.value + 4)]);
    const again = files.readMesh(files.writeLevels(bodies.map(body => body.mesh), 'glb', { names, colours }), 'glb');
    assert.deepEqual([...again.materialColours], COLOURS);
    const { low, high, volume } = bitvox.check(again);
    assert.deepEqual([low, high, volume], [[0, 0, 0], [14, 3, 2], 72]);
    assert.deepEqual(labels.labelVoxels(again, grid), made);

    // Colours of vertices are labels of their own, and count beside those of materials.
    const painted = { ...box([0, 0, 0], [4, 3, 2]), colours: new Uint8Array(32).fill(100) };
    const all = labels.labelVoxels(painted, grid);
    assert.deepEqual([[...new Set(all.labels)], [...all.palette.subarray(4, 8)]], [[1, 0], [100, 100, 100, 255]]);
});

test('grids come back from their files', () => {
    const { grid } = bitvox.voxelize(torus(24, 12, 0, 1), { resolution: 70 });
    const corner = g => g.lattice.origin.map((x, i) => x + g.low[i] * g.lattice.spacing[i]);
    for (const format of ['npy', 'binvox', 'vox', 'nrrd', 'vti', 'bvx']) {
        const bytes = files.writeGrid(grid, format);
        const back = files.readGrid(bytes, format);
        assert.deepEqual([back.size, back.words], [grid.size, grid.words], format);
        if (format === 'npy' || format === 'vox') assert.deepEqual([corner(back), back.lattice.spacing], [[0, 0, 0], [1, 1, 1]]);
        else assert.ok(corner(back).every((x, i) => Math.abs(x - corner(grid)[i]) < 1e-5), format);
        const window = { low: [3, 4, 5], size: [33, 20, 6] };
        assert.deepEqual(files.readGrid(bytes.buffer, format, { window }).words, bitvox.crop(grid, window).words, format);

        // Cut off anywhere a file is refused, and what was damaged is refused or a grid.
        for (let n = 0; n < bytes.length; n += 1 + Math.floor(bytes.length / 40))
            assert.equal(thrown(() => files.readGrid(bytes.subarray(0, n), format)).status, 'format', `${format} ${n}`);
        for (let n = 0; n < bytes.length; n += 1 + Math.floor(bytes.length / 200)) {
            const damaged = bytes.slice();
            damaged[n] ^= 0x55;
            for (const read of ['readGrid', format === 'vox' ? 'readLabels' : 'readGrid'])
                try {
                    files[read](damaged, format, { memoryLimit: 1 << 24 });
                } catch (error) {
                    assert.ok(error instanceof BitvoxError && /^bvx_read_(grid|labels)$/.test(error.function), `${format} ${n}: ${error}`);
                }
        }
    }
    for (const format of ['vdb', 'nvdb']) assert.ok(files.writeGrid(grid, format).length > 1000);
});

test('distances, crossings, planes', () => {
    const a = ball(8),
        b = { positions: a.positions.map(x => x * 2), triangles: a.triangles };
    const { max, mean } = bitvox.distance(a, b, { samples: 1000 });
    assert.ok(max < 1.1 && mean > 0.8);
    assert.equal(bitvox.crossings(a).count, 0);
    const found = bitvox.crossings(soup(40, 5), { pairs: true });
    assert.equal(found.pairs.length, 2 * found.count);
    assert.ok(found.count > 0);
    const { grid } = bitvox.voxelize(a, { resolution: 16 });
    const signed = bitvox.distances(grid, { side: 'signed', type: 'f64' });
    assert.equal(signed.filter(x => x < 0).length, bitvox.count(grid));
    assert.ok(bitvox.distances(grid) instanceof Float32Array);
    assert.equal(
        bitvox.count(bitvox.crop(grid, { low: [0, 0, 0], size: [16, 16, 8] })) * 2,
        bitvox.count(grid),
    );
    assert.deepEqual(
        bitvox.fitLattice({ low: [0, 0, 0], high: [2, 1, 1] }, { spacing: 0.5 }).dims,
        [4, 2, 2],
    );
});

// ---- Attributes ----

/** A wavy square of n x n cells with all attributes. */
function sheet(n) {
    const at = Array.from({ length: (n + 1) ** 2 }, (_, i) => [(i % (n + 1)) / n, Math.floor(i / (n + 1)) / n]);
    const triangles = [];
    for (let y = 0; y < n; y++)
        for (let x = 0; x < n; x++) {
            const a = y * (n + 1) + x;
            triangles.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
        }
    return {
        positions: Float64Array.from(at.flatMap(([x, y]) => [x, y, 0.05 * Math.sin(6 * x)])),
        triangles: Uint32Array.from(triangles),
        normals: Float32Array.from(at.flatMap(() => [0, 0, 1])),
        uvs: Float32Array.from(at.flat()),
        uvs2: Float32Array.from(at.flatMap(([x, y]) => [y, x])),
        colours: Uint8Array.from(at.flatMap(([x]) => [255 * x, 0, 0, 255])),
        materials: Uint32Array.from({ length: 2 * n * n }, (_, t) => (t < n * n ? 0 : 1)),
    };
}

test('levels have the attributes of the mesh', () => {
    const mesh = sheet(20);
    for (const call of ['buildLevels', 'simplify']) {
        const [{ mesh: level }] = bitvox[call](mesh, { targetTriangles: [200] }).levels;
        const vertices = level.positions.length / 3;
        assert.deepEqual(
            ['normals', 'uvs', 'uvs2', 'colours', 'materials'].map(name => level[name].length),
            [3 * vertices, 2 * vertices, 2 * vertices, 4 * vertices, level.triangles.length / 3],
        );
        for (let v = 0; v < vertices; v++)
            assert.ok(Math.abs(level.uvs[2 * v] - level.positions[3 * v]) < 0.02);
        assert.deepEqual([...new Set(level.materials)].sort(), [0, 1]);
    }
    const [{ mesh: kept }] = bitvox.simplify(mesh, { targetTriangles: [200], vertices: 'kept' }).levels;
    assert.deepEqual([kept.positions, kept.normals, kept.uvs2], [mesh.positions, mesh.normals, mesh.uvs2]);

    const uvTriangles = mesh.triangles;
    const [{ mesh: own }] = bitvox.simplify({ ...mesh, uvTriangles }, { targetTriangles: [200] }).levels;
    assert.equal(own.uvTriangles.length, own.triangles.length);
    assert.equal(
        thrown(() => bitvox.simplify({ ...mesh, uvTriangles: uvTriangles.map(() => 1e6) })).status,
        'range',
    );
    for (const name of ['normals', 'uvs', 'uvs2', 'materials'])
        assert.match(
            thrown(() => bitvox.simplify({ ...mesh, [name]: mesh[name].slice(1) })).message,
            new RegExp(`^simplify: ${name} of the mesh must be a .* of (one|two|three) numbers? a`),
        );
});

// ---- Errors ----

test('errors say status, reason, function and element', () => {
    const wrong = thrown(() => bitvox.check({ positions: tetrahedron.positions, triangles: [0, 1, 7] }));
    assert.ok(wrong instanceof BitvoxError && wrong instanceof Error);
    assert.deepEqual(
        [wrong.name, wrong.status, wrong.code, wrong.reason, wrong.function, wrong.index],
        ['BitvoxError', 'range', 5, 'index', 'bvx_mesh_check', 0],
    );
    assert.match(wrong.message, /^bvx_mesh_check: .*7/);

    const nan = thrown(() =>
        bitvox.voxelize(
            { positions: [0, 0, NaN, 1, 0, 0, 0, 1, 0], triangles: [0, 1, 2] },
            { resolution: 4 },
        ),
    );
    assert.deepEqual([nan.status, nan.reason], ['range', 'not-finite']);
    assert.equal(
        thrown(() => files.readMesh(new TextEncoder().encode('ply\nnonsense'), 'ply')).status,
        'format',
    );
    assert.equal(thrown(() => files.readMesh(new Uint8Array(0), 'stl')).status, 'empty');
    assert.ok(thrown(() => files.readMesh(new Uint8Array(0), 'stl')) instanceof BitvoxError);
    assert.equal(thrown(() => bitvox.voxelize({ positions: [], triangles: [] })).status, 'empty');
    const [a, b] = [4, 5].map(resolution => bitvox.voxelize(tetrahedron, { resolution }).grid);
    assert.deepEqual(
        [thrown(() => bitvox.union(a, b)).status, thrown(() => bitvox.union(a, b)).reason],
        ['lattice', 'lattice'],
    );
    assert.equal(
        thrown(() => bitvox.buildLevels(tetrahedron, { solid: true, lockBorder: true })).status,
        'argument',
    );
});

test('wrong arguments are refused before the library sees them', () => {
    const refused = (call, text, status = 'argument') => {
        const error = thrown(call);
        assert.ok(error instanceof BitvoxError, `${error.stack}`);
        assert.match(error.message, text);
        assert.equal(error.status, status);
    };
    refused(
        () => bitvox.voxelize(tetrahedron, { resolutoin: 5 }),
        /^voxelize: there is no option resolutoin; there are fill, hasBase, window/,
    );
    refused(
        () => bitvox.voxelize(tetrahedron, { fill: 'even' }),
        /fill is "even"; there are auto, parity, nonzero/,
    );
    refused(() => bitvox.voxelize(tetrahedron, { fill: 'toString' }), /fill is "toString"/);
    refused(
        () => bitvox.voxelize(tetrahedron, { resolution: 1.5 }),
        /resolution is 1.5; it must be a whole number/,
        'range',
    );
    refused(() => bitvox.voxelize(tetrahedron, { resolution: '64' }), /resolution is string, not a number/);
    refused(() => bitvox.voxelize(tetrahedron, null), /options are null/);
    refused(() => bitvox.voxelize(undefined), /the mesh has no positions/);
    refused(
        () => bitvox.voxelize({ positions: new Float32Array(4), triangles: [] }),
        /4 numbers, not three a vertex/,
    );
    refused(
        () => bitvox.voxelize({ positions: new Float32Array(9), triangles: [0, 1] }),
        /2 numbers, not three a triangle/,
    );
    refused(
        () => bitvox.voxelize({ positions: new Float32Array(9), triangles: [0, 1, -1] }),
        /triangles\[2\] is -1/,
        'range',
    );
    refused(() => bitvox.voxelize({ positions: new Int8Array(9) }), /must be a Float32Array/);
    refused(
        () => bitvox.voxelize(tetrahedron, { lattice: { origin: [0, 0, 0] } }),
        /a lattice has origin, spacing and dims/,
    );
    refused(
        () =>
            bitvox.voxelize(tetrahedron, {
                lattice: { origin: [0, 0, 0], spacing: [1, 1, 1], dims: [2, 2, 1e9] },
            }),
        /1000000000 voxels along z/,
        'range',
    );
    refused(
        () =>
            bitvox.count({
                ...bitvox.voxelize(tetrahedron, { resolution: 4 }).grid,
                words: new Uint32Array(3),
            }),
        /words of the grid are 3 numbers/,
    );
    refused(() => files.readMesh('text', 'stl'), /must be an ArrayBuffer/);
    refused(() => files.readMesh(new Uint8Array(1), 'xls'), /format is "xls"/);
    const { grid } = bitvox.voxelize(tetrahedron, { resolution: 4 });
    const mesh = files.readMesh(coloured(), 'glb');
    const made = labels.labelVoxels(mesh, grid);
    refused(() => files.readGrid('text', 'vox'), /must be an ArrayBuffer/);
    refused(() => files.readGrid(new Uint8Array(1), 'xls'), /format is "xls"/);
    refused(() => files.readGrid(new Uint8Array(1), 'vdb'), /npy/);
    refused(() => files.writeGrid(grid, 'stl'), /npy/, 'unsupported');
    refused(() => files.writeGrid({}, 'vox'), /the grid has no lattice/);
    refused(() => files.readLabels(new Uint8Array(1), 'nrrd'), /vox/, 'unsupported');
    refused(() => files.writeLabels(grid, made, 'npy'), /vox/, 'unsupported');
    refused(() => files.writeLabels(grid, undefined, 'vox'), /labels must be a Uint8Array of 64 numbers/);
    refused(() => files.writeLabels(grid, { ...made, palette: [1, 2, 3, 4] }, 'vox'), /palette must be a Uint8Array of 1024 numbers/);
    refused(() => files.writeLabels(grid, { ...made, labels: new Uint8Array(64) }, 'vox'), /voxel 0,0,0 has label 0/);
    refused(() => files.writeLevels([mesh], 'glb', { names: [] }), /names has 0 values, and there are 1 meshes/);
    refused(() => files.writeLevels([mesh], 'glb', { names: ['a'], colours: [1] }), /colours has 1 values/);
    refused(() => labels.labelVoxels(tetrahedron, grid), /neither colours of its vertices nor materials/);
    refused(() => labels.labelVoxels(mesh, {}), /the grid has no lattice/);
    refused(() => labels.labelVoxels({ ...mesh, materialColours: new Uint8Array(3) }, grid), /four numbers a material/);
    refused(() => labels.labelSurfaces({ samples: new Float32Array(1), size: [1, 1, 1] }), /typed array of whole numbers/);
    refused(() => labels.labelSurfaces({ samples: new Uint8Array(3), size: [1, 1, 1] }), /samples of the volume are 3 numbers/);
    refused(() => labels.labelSurfaces({ samples: new Uint8Array(1), size: [1, 1] }), /size of the volume has 2 numbers/);
    refused(() => labels.labelSurfaces({ samples: new Uint8Array(1), size: [1, 1, 1] }, { smooth: 1 }), /there is no option smooth/);
    refused(() => bitvox.buildLevels(tetrahedron, { count: 2, targetTriangles: [1] }), /count is 2/);
    refused(() => bitvox.simplify(tetrahedron, { locked: [1] }), /locked has 1 values, the mesh 4 vertices/);
    refused(() => bitvox.repair(tetrahedron, { progress: 1 }), /progress is number/);
    refused(() => bitvox.boolean(tetrahedron, tetrahedron, 'minus'), /operation is "minus"; there are union/);
});

// ---- Progress and cancelling ----

test('progress rises to 1 and names stages', () => {
    const fractions = [],
        stages = new Set();
    bitvox.buildLevels(torus(96, 40, 0.25, 7), {
        resolution: 64,
        progress: (fraction, stage) => (fractions.push(fraction), stages.add(stage), undefined),
    });
    assert.ok(fractions.length > 20 && stages.size > 3);
    assert.ok(fractions.every((x, i) => i === 0 || x >= fractions[i - 1]));
    assert.equal(fractions.at(-1), 1);
});

test('a signal cancels, an exception passes, results of progress count for nothing', () => {
    const mesh = torus(96, 40, 0.25, 7),
        controller = new AbortController();
    const late = new AbortController();
    const cancelled = thrown(() =>
        bitvox.repair(mesh, {
            signal: late.signal,
            progress: fraction => {
                if (fraction > 0.3) late.abort();
            },
        }),
    );
    assert.ok(bitvox.repair(mesh, { resolution: 32, progress: () => true }).report.after.closed);
    assert.deepEqual([cancelled.status, cancelled.reason, cancelled.code], ['cancelled', 'cancelled', 11]);
    assert.equal(
        thrown(() =>
            bitvox.repair(mesh, {
                progress: () => {
                    throw new TypeError('mine');
                },
            }),
        ).message,
        'mine',
    );
    assert.equal(
        thrown(() => bitvox.repair(mesh, { signal: controller.signal, progress: () => controller.abort() }))
            .status,
        'cancelled',
    );
    assert.equal(thrown(() => bitvox.repair(mesh, { signal: controller.signal })).status, 'cancelled');
    assert.equal(bitvox.repair(mesh, { resolution: 32 }).report.after.closed, true);
});

test('a call within a progress report', () => {
    let inner = 0;
    const { report } = bitvox.repair(tetrahedron, {
        resolution: 32,
        progress: () => {
            inner += bitvox.count(bitvox.voxelize(tetrahedron, { resolution: 8 }).grid);
        },
    });
    assert.ok(inner > 0 && report.after.closed);
});

// ---- Memory ----

test('nothing is left after calls, whatever became of them', () => {
    const mesh = torus(96, 40, 0.25, 7);
    const round = () => {
        bitvox.buildLevels(mesh, { resolution: 48 });
        thrown(() =>
            bitvox.repair(mesh, {
                progress: fraction => {
                    if (fraction > 0.5) throw new Error('enough');
                },
            }),
        );
        thrown(() =>
            files.readMesh(
                new TextEncoder().encode('ply\nformat ascii 1.0\nelement vertex 1000000\n'),
                'ply',
            ),
        );
        thrown(() => bitvox.voxelize(mesh, { fill: 'even' }));
    };
    for (let i = 0; i < 3; i++) round();
    const held = () => [bitvox.memory.module, files.memory.module];
    const before = held();
    for (let i = 0; i < 25; i++) round();
    assert.deepEqual(held(), before);
});

test('a memory limit is kept and named', async () => {
    const small = await load({ memoryLimit: 1 << 20 });
    assert.deepEqual([thrown(() => small.voxelize(tetrahedron, { resolution: 512 })).status], ['budget']);
    assert.equal(small.count(small.voxelize(tetrahedron, { resolution: 64 }).grid), 43680);
    assert.equal(
        thrown(() => bitvox.voxelize(tetrahedron, { resolution: 512, memoryLimit: 100000 })).reason,
        'budget',
    );
    assert.ok(bitvox.voxelize(tetrahedron, { resolution: 64 }) && bitvox.memory.peak > 0);
    const before = small.memory.module;
    small.voxelize(tetrahedron, { resolution: 512, memoryLimit: 1 << 30 });
    small.reset();
    assert.ok(small.memory.module <= before);
});

test('more than the module can hold is an error, and the next call works', () => {
    const huge = thrown(() => bitvox.voxelize(tetrahedron, { resolution: 8000 }));
    assert.ok(['memory', 'budget'].includes(huge.status), huge.message);
    assert.equal(bitvox.count(bitvox.voxelize(tetrahedron, { resolution: 64 }).grid), 43680);
    bitvox.reset();
});

// ---- The types ----

test('index.d.ts names all that is there, and no more', () => {
    let types = readFileSync('bindings/js/index.d.ts', 'utf8');
    const fieldsOf = name =>
        [
            ...types
                .match(new RegExp(`export (?:interface|type) ${name}\\b[^{]*\\{([^]*?)\\n\\}`))[1]
                .replace(/\/\*[^]*?\*\//g, '')
                .matchAll(/^ {4}(?:readonly )?(\w+)\??[:(]/gm),
        ]
            .map(match => match[1])
            .sort();
    const same = (object, name) => assert.deepEqual(Object.keys(object).sort(), fieldsOf(name), name);
    const mesh = torus(24, 12, 0, 1);
    const { grid, report } = bitvox.voxelize(mesh, { resolution: 8 });
    same(report, 'SolidReport');
    same(grid, 'Grid');
    same(grid.lattice, 'Lattice');
    same(bitvox.voxelizeSurface(mesh, { resolution: 8 }).report, 'SurfaceReport');
    same(bitvox.check(mesh), 'Certificate');
    same(bitvox.distance(mesh, mesh, { samples: 10 }), 'DistanceReport');
    same(bitvox.repair(mesh, { resolution: 8 }).report, 'RepairReport');
    same(bitvox.boolean(mesh, mesh, 'union', { resolution: 8 }).report, 'BooleanReport');
    const levels = bitvox.buildLevels(mesh);
    same(levels.report, 'LevelsReport');
    assert.deepEqual([levels.report.solid, levels.report.resolution, levels.report.cut], [false, 0, 0]);
    same(levels.levels[0].report, 'LevelReport');
    assert.ok(Number.isNaN(levels.levels[0].report.distance.mean) && !levels.levels[0].report.measured);
    assert.ok(bitvox.buildLevels(mesh, { count: 1, solid: true }).report.solid);
    const sheet = { ...tetrahedron, triangles: tetrahedron.triangles.slice(3) };
    assert.equal(bitvox.buildLevels(sheet, { targetTriangles: [3] }).levels[0].report.certificate.boundaryEdges, 3);
    same(bitvox.buildLods(grid, { resolutions: [4] }).levels[0].report, 'LodReport');
    same(bitvox.hollow(grid, { thickness: 1 }).report, 'HollowReport');
    const own = object =>
        Object.getOwnPropertyNames(Object.getPrototypeOf(object)).filter(name => !/^(constructor|_call)$/.test(name));
    assert.deepEqual(own(bitvox).sort(), [...new Set(fieldsOf('Bitvox'))].sort());
    assert.deepEqual([...own(Object.getPrototypeOf(bitvox)), 'version'].sort(), fieldsOf('Library'));
    types = readFileSync('bindings/js/files.d.ts', 'utf8');
    assert.deepEqual(own(files).sort(), [...new Set(fieldsOf('Files'))].sort());
    types = readFileSync('bindings/js/labels.d.ts', 'utf8');
    const blocks = labels.labelSurfaces({ samples: Uint8Array.of(1, 2), size: [2, 1, 1] });
    same(blocks, 'LabelSurfaces');
    same(blocks.labels[1], 'LabelBody');
    assert.deepEqual(own(labels).sort(), [...new Set(fieldsOf('Labels'))].sort());
    types = readFileSync('bindings/js/makers.d.ts', 'utf8');
    same(makers.measure(tetrahedron), 'MeasureReport');
    same(makers.hull(mesh, { resolution: 16 }).report, 'HullReport');
    const found = makers.inspect(tetrahedron, { resolution: 16, thickness: true });
    same(found, 'Inspection');
    same(found.report, 'InspectReport');
    same(found.islands[0] ?? { size: 0, position: 0, low: 0, high: 0, voxels: 0 }, 'Finding');
    assert.deepEqual(own(makers).sort(), [...new Set(fieldsOf('Makers'))].sort());
});
