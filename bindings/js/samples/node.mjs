// node.mjs INPUT OUTPUT - four levels of a mesh as one GLB: node node.mjs scan.ply scan.glb
import { readFileSync, writeFileSync } from 'node:fs';
import { load } from 'bitvox';
import { load as loadFiles } from 'bitvox/files';

const [input, output] = process.argv.slice(2);
const [bitvox, files] = [await load(), await loadFiles()];
const mesh = files.readMesh(readFileSync(input), files.formatOfName(input));
const { levels } = bitvox.buildLevels(mesh, {
    progress: fraction => process.stderr.write(`\r${Math.round(100 * fraction)} %`),
});

console.error();
for (const { mesh: level, report } of levels) {
    console.log(
        `${report.triangles} triangles, closed ${report.certificate.closed}, crossings ${report.crossings}, ${bitvox.hash(level)}`,
    );
}
writeFileSync(
    output,
    files.writeLevels(
        levels.map(level => level.mesh),
        'glb',
    ),
);
