// right.ts - uses that the types must allow; compiled by tsc --strict, never run.
import { BitvoxError, gridGet, load } from 'bitvox';
import { load as loadFiles, type Files } from 'bitvox/files';
import { load as loadLabels, type Labels } from 'bitvox/labels';
import { load as loadMakers, type Makers } from 'bitvox/makers';
import type { Bitvox, Certificate, Grid, Lattice, LevelsOptions, Mesh, MeshIn } from 'bitvox';

const bitvox: Bitvox = await load({ memoryLimit: 1e9 });
const files: Files = await loadFiles();
const labels: Labels = await loadLabels();
const { labels: bodies, complex } = labels.labelSurfaces({ samples: new Uint8Array(8), size: [2, 2, 2] }, { triangles: 9 });
const makers: Makers = await loadMakers();
const solid: Grid = files.readGrid(new ArrayBuffer(8), 'vox', { window: { low: [0, 0, 0], size: [1, 1, 1] } });
const voxels: Uint8Array = files.writeLabels(solid, labels.labelVoxels(files.readMesh(new ArrayBuffer(8), 'glb'), solid), 'vox');
const { grid: read, palette } = files.readLabels(voxels, 'vox');
files.writeLevels([{ positions: [] }], 'glb', { names: ['a'], colours: palette.subarray(4, 8) });
console.log(files.writeGrid(read, 'vdb').length);
const body: Mesh | undefined = bodies[0]?.mesh;
const sides: Uint32Array = complex.sides;
const triangle: MeshIn = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], triangles: [0, 1, 2] };
const bytes: ArrayBuffer = await (await fetch('scan.ply')).arrayBuffer();

const mesh: Mesh = files.readMesh(bytes, 'ply');
const counted: number = files.readMesh(bytes, 'stl', { finite: true }).dropped;
const found: Certificate = bitvox.check(mesh, { weld: true });
const { grid, report } = bitvox.voxelize(mesh, { resolution: 128, fill: 'winding', checkThin: 'never' });
const lattice: Lattice = grid.lattice;
const again: Grid = bitvox.voxelize({ positions: new Float64Array(9) }, { lattice, fill: report.fill }).grid;
const shell: Grid = bitvox.subtract(grid, bitvox.erode(again, { radius: 0.5 }));
const set: boolean = gridGet(shell, 0, 0, 0);
const options: LevelsOptions = {
    targetTriangles: [1000, 100],
    errorKind: 'mean',
    progress: (fraction, stage) => console.log(fraction, stage),
};
for (const { mesh: level, report: of } of bitvox.buildLevels(triangle, options).levels) {
    const file: Uint8Array = files.writeMesh(level, 'stl', { rounding: 'allow' });
    console.log(file.byteLength, of.certificate.closed, of.distance.mean);
}
const doubles: Float64Array = bitvox.distances(grid, { side: 'signed', type: 'f64' });
const floats: Float32Array = bitvox.distances(grid);
const pairs: Uint32Array = bitvox.crossings(mesh, { pairs: true }).pairs;
bitvox.boolean(mesh, { attributes: { position: { array: floats } }, index: null }, 'difference', {
    sharp: 'always',
});
bitvox.fitLattice({ low: [0, 0, 0], high: [1, 1, 1] }, { spacing: 0.1 });
const moved: ArrayBuffer = mesh.positions.buffer;
postMessage(mesh.positions, { transfer: [moved] });
try {
    bitvox.repair(mesh, { signal: AbortSignal.timeout(1000) });
} catch (error) {
    if (error instanceof BitvoxError && error.status === 'cancelled')
        console.log(error.function, error.index, error.values[0]);
}
console.log(counted, found.euler, set, doubles, pairs, bitvox.memory.peak);
const thickness: Float64Array = makers.inspect(triangle, { walls: 1, thickness: true, up: 'x' }).thickness;
const inertia: number | undefined = makers.measure(mesh, { density: 7.8 }).inertia[0];
