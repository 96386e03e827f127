// main.js - a page by Vite: the job in a worker, its levels on the page. npm create vite, npm install bitvox, then these files.
import { startJob } from './worker.mjs';

const n = 200;
const positions = [],
    triangles = [];
for (let i = 0; i < n; i++) {
    for (let j = 0; j < n; j++) {
        const [a, b] = [(2 * Math.PI * i) / n, (2 * Math.PI * j) / n];
        positions.push((2 + Math.cos(b)) * Math.cos(a), (2 + Math.cos(b)) * Math.sin(a), Math.sin(b));
        const [i1, j1] = [(i + 1) % n, (j + 1) % n];
        triangles.push(i * n + j, i1 * n + j, i1 * n + j1, i * n + j, i1 * n + j1, i * n + j1);
    }
}

const levels = await startJob(
    { positions: new Float64Array(positions), triangles: new Uint32Array(triangles) },
    { count: 3 },
).levels;
document.querySelector('output').textContent = levels.map(({ report }) => report.triangles).join(', ');
