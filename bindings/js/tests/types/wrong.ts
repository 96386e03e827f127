// wrong.ts - uses that the types must refuse: each line says so, and tsc fails where one is allowed.
import { BitvoxError, load } from 'bitvox';
import { load as loadFiles } from 'bitvox/files';
import { load as loadLabels } from 'bitvox/labels';
import { load as loadMakers } from 'bitvox/makers';
import type { Grid, Mesh } from 'bitvox';

const bitvox = await load();
const files = await loadFiles();
const labels = await loadLabels();
const makers = await loadMakers();
declare const mesh: Mesh;
declare const grid: Grid;

// @ts-expect-error no such option
bitvox.voxelize(mesh, { resolutoin: 64 });
// @ts-expect-error no such rule
bitvox.voxelize(mesh, { fill: 'even' });
// @ts-expect-error a number
bitvox.voxelize(mesh, { resolution: '64' });
// @ts-expect-error no mesh
bitvox.voxelize([0, 0, 0]);
// @ts-expect-error bytes
files.readMesh('scan.ply', 'ply');
// @ts-expect-error OpenVDB is written, not read
files.readGrid(new ArrayBuffer(8), 'vdb');
// @ts-expect-error labels of a palette
files.writeLabels(grid, new Uint8Array(8), 'vox');
// @ts-expect-error whole numbers
labels.labelSurfaces({ samples: new Float32Array(8), size: [2, 2, 2] });
// @ts-expect-error thickness only where it was asked for
makers.inspect(mesh).thickness.length;
// @ts-expect-error glTF text is read, not written
files.writeMesh(mesh, 'gltf');
// @ts-expect-error one level a file
files.writeLevels([mesh], 'stl');
// @ts-expect-error targets are a list
bitvox.buildLevels(mesh, { targetTriangles: 1000 });
// @ts-expect-error no such operation
bitvox.boolean(mesh, mesh, 'minus');
// @ts-expect-error a grid and a mesh
bitvox.union(grid, mesh);
// @ts-expect-error thickness is required
bitvox.hollow(grid, {});
// @ts-expect-error two coordinates
bitvox.fitLattice({ low: [0, 0], high: [1, 1] }, { resolution: 4 });
// @ts-expect-error floats where doubles are said
const doubles: Float64Array = bitvox.distances(grid);
// @ts-expect-error pairs were not asked for
bitvox.crossings(mesh).pairs;
// @ts-expect-error results of the library alone
new BitvoxError('mine');
// @ts-expect-error not counted
files.readMesh(new Uint8Array(4), 'stl').dropped;
// @ts-expect-error it is to be awaited
load().version;
// @ts-expect-error read only
bitvox.version = '2';
console.log(doubles);
