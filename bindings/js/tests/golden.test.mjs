// golden.test.mjs - the package gives the bits of the library's golden rows (fixtures/golden), which all native builds give.
// BITVOX_JS: the package's folder; BITVOX_ENTRY: its file [bitvox.js]. Run from the repository root.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { Random, ball, soup, torus } from './shapes.mjs';

const { gridGet, gridSet, load, makeGrid } = await import(
    pathToFileURL(resolve(process.env.BITVOX_JS, process.env.BITVOX_ENTRY ?? 'bitvox.js'))
);
const bitvox = await load();
const { load: loadLabels } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'labels.js')));
const { load: loadMakers } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'makers.js')));
const { load: loadFiles } = await import(pathToFileURL(resolve(process.env.BITVOX_JS, 'files.js')));

/** A stored row: [key, value] in order; keys may come twice. */
function stored(table, name) {
    const line = readFileSync(`fixtures/golden/${table}.txt`, 'utf8')
        .split('\n')
        .find(row => row.startsWith(`${name} `));
    assert.ok(line, `${table}.txt has ${name}`);
    return line
        .slice(name.length + 1)
        .split(' ')
        .map(pair => pair.split('='));
}

/** All pairs that were computed stand in the row in this order. */
function compare(table, name, found) {
    const row = stored(table, name);
    let at = 0;
    for (const [key, value] of found) {
        at = row.findIndex(([k], i) => i >= at && k === key);
        assert.ok(at >= 0, `${name} has ${key}`);
        assert.equal(String(value), row[at][1], `${name} ${key}`);
        at++;
    }
}

const hash = thing => bitvox.hash(thing);

// ---- Solids, surfaces and levels of coarser lattices ----

const solids = [
    ['torus_130', torus(96, 40, 0.25, 7), 130, 'parity'],
    ['torus_64_nonzero', torus(96, 40, 0.25, 7), 64, 'nonzero'],
    ['torus_130_window', torus(96, 40, 0.25, 7), 130, 'parity', { low: [17, 5, 3], size: [65, 70, 11] }],
    ['ball_63', ball(20), 63, 'parity'],
    ['soup_65_nonzero', soup(300, 11), 65, 'nonzero'],
    ['soup_65_auto', soup(300, 11), 65, 'auto'],
];
for (const [name, mesh, resolution, fill, window] of solids) {
    test(`solid.txt ${name}`, () => {
        const { grid, report } = bitvox.voxelize(mesh, { resolution, fill, window });
        const surface = bitvox.extractSurface(grid);
        const found = [
            ['nx', grid.lattice.dims[0]],
            ['ny', grid.lattice.dims[1]],
            ['nz', grid.lattice.dims[2]],
            ['set', bitvox.count(grid)],
            ['bits', hash(grid)],
            ['crossings', report.crossings],
            ['unbalanced', report.unbalancedRows],
            ['triangles', surface.triangles.length / 3],
            ['surface', hash(surface)],
            ['joined_f64', hash(bitvox.extractSurface(grid, { faceRule: 'join', positionType: 'f64' }))],
            [
                'open_local',
                hash(
                    bitvox.extractSurface(grid, {
                        faceRule: 'join',
                        positionType: 'f64',
                        openSides: 63,
                        localFrame: true,
                    }),
                ),
            ],
        ];
        if (!window) {
            for (const method of ['edge-ratio', 'coverage']) {
                const { levels } = bitvox.buildLods(grid, { method, resolutions: [24, 13, 6] });
                levels.forEach((level, i) =>
                    found.push([
                        (method === 'coverage' ? 'coverage' : 'ratio') + [24, 13, 6][i],
                        hash(level.mesh),
                    ]),
                );
            }
            found.push([
                'collapsed',
                hash(bitvox.buildLods(grid, { targetTriangles: [1500], collapse: 2.5 }).levels[0].mesh),
            ]);
        }
        compare('solid', name, found);
    });
}

test('voxel_surface.txt', () => {
    for (const [name, mesh, resolution] of [
        ['torus_130', torus(96, 40, 0.25, 7), 130],
        ['torus_17', torus(96, 40, 0.25, 7), 17],
        ['soup_65', soup(300, 11), 65],
    ]) {
        const found = [];
        for (const mode of ['conservative', 'thin', 'sampled']) {
            const { grid } = bitvox.voxelizeSurface(mesh, { resolution, mode });
            if (mode === 'thin')
                found.push(
                    ['faces', hash(bitvox.extractFaces(grid))],
                    ['merged', hash(bitvox.extractFaces(grid, { merged: true }))],
                );
            found.push(['bits', hash(grid)]);
        }
        compare('voxel_surface', name, found);
    }
});

// ---- Set algebra and booleans ----

test('algebra.txt', () => {
    const a = torus(48, 20, 0.25, 7),
        b = ball(12);
    for (let i = 0; i < b.positions.length; i += 3) b.positions[i] += 2;
    const lattice = bitvox.fitLattice(a, { resolution: 66 });
    const first = bitvox.voxelize(a, { lattice }).grid,
        second = bitvox.voxelize(b, { lattice }).grid;
    compare('algebra', 'torus_and_ball', [
        ['union', hash(bitvox.union(first, second))],
        ['intersection', hash(bitvox.intersection(first, second))],
        ['difference', hash(bitvox.subtract(first, second))],
        ['xor', hash(bitvox.xor(first, second))],
        ['complement', hash(bitvox.complement(first))],
        ...['any', 'all', 'majority'].map(rule => [
            rule,
            hash(bitvox.downsample(first, [3, 2, 5], { rule })),
        ]),
    ]);
    compare(
        'algebra',
        'meshes',
        ['union', 'intersection', 'difference', 'xor'].map((operation, i) => [
            operation,
            hash(bitvox.boolean(a, b, operation, { resolution: 40, sharp: i % 2 === 1 ? 'always' : 'never' }).mesh),
        ]),
    );
});

// ---- Morphology ----

function pittedTorus(stretched) {
    const mesh = torus(48, 20, 0.25, 7),
        random = new Random(3);
    const { grid } = bitvox.voxelize(
        mesh,
        stretched ? { axisResolution: [70, 43, 21], padding: 2 } : { resolution: 66, padding: 2 },
    );
    for (let z = 0; z < grid.size[2]; z++)
        for (let y = 0; y < grid.size[1]; y++)
            for (let x = 0; x < grid.size[0]; x++)
                if (random.next() % 40 === 0) gridSet(grid, x, y, z, !gridGet(grid, x, y, z));
    return grid;
}

function fewSpecks(stretched) {
    const random = new Random(17),
        size = [301, 27, 21];
    const grid = makeGrid(
        {
            origin: [-3, 0.7, 11],
            spacing: [
                [0.3, 0.3, 0.3],
                [0.3, 0.47, 0.21],
            ][stretched],
            dims: [340, 30, 25],
        },
        { low: [3, 0, 2], size },
    );
    for (let i = 0; i < 4; i++) {
        const [x, y, z] = size.map(side => random.next() % side);
        gridSet(grid, x, y, z);
    }
    return grid;
}

function morphed(grid, second, neighbourhood, steps, radius) {
    return ['dilate', 'erode', 'open', 'close'].map((call, i) => {
        const options = {
            neighbourhood: neighbourhood || undefined,
            steps,
            radius: radius * Math.min(...grid.lattice.spacing),
            beyond: second === grid ? (i + steps) & 1 : Number(i === 1 || i === 2),
        };
        return [
            call + (neighbourhood || Math.floor(radius)),
            hash(bitvox[call](i === 1 || i === 2 ? second : grid, options)),
        ];
    });
}

for (const stretched of [0, 1]) {
    test(`morphology.txt ${stretched ? 'stretched' : 'cubic'}`, () => {
        const grid = pittedTorus(stretched),
            name = stretched ? 'stretched' : 'cubic';
        const [, second] = grid.lattice.spacing,
            [first] = grid.lattice.spacing;
        const hollowed = [
            ['hollow', 0, 'z-low'],
            ['drained_z', 2 * first, 'z-low'],
            ['drained_x', 2 * first, 'x-high'],
        ].map(([key, drainRadius, drainSide]) => [
            key,
            hash(bitvox.hollow(grid, { thickness: 1.1 * second, drainRadius, drainSide }).grid),
        ]);
        compare('morphology', `torus_${name}`, [
            ...morphed(grid, grid, 6, 1, 0),
            ...morphed(grid, grid, 18, 3, 0),
            ...morphed(grid, grid, 26, 2, 0),
            ...morphed(grid, grid, 0, 1, 2.3),
            ...hollowed,
        ]);
        const specks = fewSpecks(stretched),
            rest = bitvox.complement(specks);
        compare('morphology', `specks_${name}`, [
            ...morphed(specks, rest, 6, 30, 0),
            ...morphed(specks, rest, 0, 1, 15),
            ...morphed(specks, rest, 0, 1, 37),
        ]);
    });
}

// ---- Repair ----

test('repair.txt', () => {
    const open = torus(96, 40, 0.25, 7),
        disc = ball(24),
        loose = soup(300, 11);
    open.triangles = open.triangles.slice(0, -2100);
    for (let i = 2; i < disc.positions.length; i += 3) disc.positions[i] *= 0.01;
    for (const [name, mesh, resolution, sign, thin] of [
        ['torus_48_open', open, 48, 'auto', 'keep'],
        ['torus_48_open_vote', open, 48, 'vote', 'keep'],
        ['torus_48_open_shell', open, 48, 'auto', 'shell'],
        ['thin_disc_48', disc, 48, 'auto', 'keep'],
        ['thin_disc_48_shell', disc, 48, 'auto', 'shell'],
        ['soup_32', loose, 32, 'auto', 'keep'],
        ['soup_32_vote', loose, 32, 'vote', 'keep'],
    ]) {
        compare(
            'repair',
            name,
            [
                ['plain', 'never'],
                ['sharp', 'always'],
            ].map(([key, sharp]) => {
                const { mesh: made, report } = bitvox.repair(mesh, { resolution, sign, sharp, thin });
                assert.ok(
                    report.after.closed &&
                        report.after.edgeManifold &&
                        report.after.vertexManifold &&
                        report.after.oriented,
                );
                return [key, hash(made)];
            }),
        );
    }
});

// ---- Levels ----

const levelRows = levels =>
    levels.flatMap(({ mesh, report }, i) => [
        ['triangles', mesh.triangles.length / 3],
        [['fine', 'coarse'][i], hash(mesh)],
        ['met', Number(report.met)],
    ]);
const simplified = (mesh, options) =>
    levelRows(bitvox.simplify(mesh, { targetTriangles: [900, 120], even: 0.000001, ...options }).levels);
const built = (mesh, options) => {
    const { levels, report } = bitvox.buildLevels(mesh, {
        targetTriangles: options.targetErrors ? undefined : [1500, 100],
        ...options,
    });
    return [
        ['source', 1 + Number(report.solid)],
        ['surface', report.triangles],
        ['crumbs', report.crumbs],
        ...levelRows(levels),
    ];
};

test('levels.txt simplified', () => {
    const mesh = torus(96, 40, 0.25, 7);
    compare('levels', 'torus_f32', simplified(mesh, { positionType: 'f32' }));
    compare('levels', 'torus_f64', simplified(mesh, { positionType: 'f64' }));
    compare('levels', 'torus_even', simplified(mesh, { positionType: 'f64', even: 0.5 }));
    const sheet = { ...mesh, triangles: mesh.triangles.slice(0, -6000) };
    compare('levels', 'sheet_f32', simplified(sheet, { positionType: 'f32' }));
    compare('levels', 'ball_loose', simplified(ball(20), { positionType: 'f64' }));
});

test('levels.txt built', () => {
    const mesh = torus(96, 40, 0.25, 7);
    compare('levels', 'torus_sound', built(mesh, {}));
    compare('levels', 'torus_measured', built(mesh, { positionType: 'f32', resolution: 60, sharp: 'never' }));
    compare(
        'levels',
        'torus_measured_f64_sharp',
        built(mesh, { positionType: 'f64', resolution: 60, sharp: 'always' }),
    );
    compare('levels', 'torus_by_error', built(mesh, { targetErrors: [0.02, 0.08] }));
    compare('levels', 'soup', built(soup(60, 11), { resolution: 40 }));
});

test('volumes.txt, surfaces of labels', async () => {
    const side = 24,
        labels = await loadLabels();
    const samples = Uint8Array.from({ length: side ** 3 }, (_, n) => {
        const x = n % side,
            y = Math.floor(n / side) % side,
            z = Math.floor(n / side / side);
        return (Math.floor((x + 2 * y) / 13) + Math.floor((3 * z + y) / 17) * 3) % 7;
    });
    const volume = { samples, size: [side, side, side], lattice: { origin: [-7, 0.5, 100], spacing: [1, 0.75, 1.5], dims: [side, side, side] } };
    const found = [
        ['count', { positionType: 'f32', triangles: 2000 }],
        ['error', { positionType: 'f64', error: 0.05 }],
    ].flatMap(([key, options]) => {
        const { complex } = labels.labelSurfaces(volume, options);
        return [
            [key, complex.sides.length / 2],
            ['whole', hash(complex)],
        ];
    });
    compare('volumes', 'label_surfaces_fewer', found);
});

/** bvx_hash of bytes. */
function hashOf(bytes, seed) {
    const step = (h, word) => {
        h = BigInt.asUintN(64, (h ^ word) * 0x100000001b3n);
        return h ^ (h >> 32n);
    };
    const padded = new Uint8Array(8 * Math.ceil(bytes.length / 8));
    padded.set(bytes);
    return step(new BigUint64Array(padded.buffer).reduce(step, seed ^ 0xcbf29ce484222325n), BigInt(bytes.length));
}
const digits = hash => hash.toString(16).padStart(16, '0');

/** Doubles one after the other. */
const mixed = values => digits(values.reduce((hash, value) => hashOf(new Uint8Array(Float64Array.of(value).buffer), hash), 0n));

test('questions.txt, mass and inspection', async () => {
    const makers = await loadMakers(),
        mesh = torus(48, 20, 0.25, 7),
        count = mesh.triangles.length / 3;
    const open = { ...mesh, triangles: mesh.triangles.slice(0, 3 * (count - Math.floor(count / 5))) };
    const mass = [mesh, open].flatMap(body => {
        const r = makers.measure(body, { density: 3, resolution: 24 });
        return [r.volume, r.area, r.mass, ...r.center, ...r.inertia, r.volumeError, r.centerError, r.inertiaError];
    });
    const { walls, gaps, cavities, islands, report: r } = makers.inspect(mesh, { walls: 1, gaps: 2.5, resolution: 32 });
    const none = Array.from({ length: 8 }, () => ({ size: 0, position: [0, 0, 0], low: [0, 0, 0], high: [0, 0, 0] }));
    const found = [walls, gaps, cavities, islands].flatMap(kind => [...kind, ...none].slice(0, 8));
    compare('questions', 'torus_40', [
        ['mass', mixed(mass)],
        ['inspection', mixed([
            r.volume, r.volumeError, r.mass, r.leastThickness, ...r.thinEnds, ...r.thickness,
            r.thinArea, r.leastGap, ...r.gapEnds, r.cavityVolume,
            ...found.flatMap(({ size, position, low, high }) => [size, ...position, ...low, ...high]),
        ])],
    ]);
});

test('questions.txt, labels of voxels', async () => {
    const [files, labels] = [await loadFiles(), await loadLabels()];
    const { grid } = bitvox.voxelize(torus(48, 20, 0.25, 7), { resolution: 40, fill: 'parity' });
    const surface = bitvox.extractSurface(grid);
    const colours = Uint8Array.from({ length: (surface.positions.length / 3) * 4 }, (_, i) => ((i * 37) % 251) & 255);
    const made = labels.labelVoxels({ ...surface, colours }, grid);
    const read = files.readLabels(files.writeLabels(grid, made, 'vox'), 'vox');
    const hashed = ({ labels, palette }) => digits(hashOf(labels, hashOf(palette, 0n)));
    compare('questions', 'torus_40', [
        ['labels', hashed(made)],
        ['labels_read', hashed(read)],
        ['segments', digits(hashOf(files.writeLabels(grid, read, 'nrrd'), 0n))],
    ]);
});

test('levels.txt knot, read from its file', async () => {
    const knot = (await loadFiles()).readMesh(readFileSync('fixtures/knot.ply'), 'ply');
    compare('levels', 'knot_read', [['triangles', knot.triangles.length / 3]]);
    compare('levels', 'knot_f32', simplified(knot, { positionType: 'f32' }));
    compare('levels', 'knot_f64', simplified(knot, { positionType: 'f64' }));
});
