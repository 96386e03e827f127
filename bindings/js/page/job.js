// job.js - the worker: it reads the mesh, does the jobs and writes files. One message in, progress and one answer out.
import { load } from 'bitvox';
import { load as loadFiles } from 'bitvox/files';

const ready = load();
const filesReady = loadFiles();
let source; // the mesh as it was read, and what it is
let results = []; // meshes of the last job
let peak = 0; // bytes, of the calls of one job

// Pairs of crossing triangles are counted up to so many triangles: the time for more is better spent on the job.
const COUNTED = 1000000;

/** A knot whose tube has three holes, and crosses itself nowhere. */
function sampleMesh() {
    const [n, m] = [640, 30];
    const positions = new Float32Array(3 * n * m);
    const triangles = [];
    const at = t => [
        (2 + Math.cos(3 * t)) * Math.cos(2 * t),
        (2 + Math.cos(3 * t)) * Math.sin(2 * t),
        1.2 * Math.sin(3 * t),
    ];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const unit = a => a.map(x => x / Math.hypot(...a));

    for (let i = 0; i < n; i++) {
        const t = (2 * Math.PI * i) / n;
        const centre = at(t);
        const along = unit(at(t + 1e-4).map((x, k) => x - at(t - 1e-4)[k]));
        const side = unit(cross(along, centre));
        const up = cross(along, side);
        for (let j = 0; j < m; j++) {
            const angle = (2 * Math.PI * j) / m;
            for (let k = 0; k < 3; k++)
                positions[3 * (i * m + j) + k] =
                    centre[k] + 0.42 * (Math.cos(angle) * side[k] + Math.sin(angle) * up[k]);
        }
    }
    for (let i = 0; i < n; i++) {
        for (let j = 0; j < m; j++) {
            const [a, b, c, d] = [
                i * m + j,
                ((i + 1) % n) * m + j,
                ((i + 1) % n) * m + ((j + 1) % m),
                i * m + ((j + 1) % m),
            ];
            const hole = [60, 290, 500].some(k => Math.hypot(i - k, 1.5 * (j - 12)) < 9);
            if (!hole) triangles.push(a, c, b, a, d, c);
        }
    }
    return { positions, triangles: new Uint32Array(triangles) };
}

/** The package, and after each call what it held at most. */
const watched = bitvox =>
    new Proxy(bitvox, {
        get: (target, name) =>
            typeof target[name] !== 'function'
                ? target[name]
                : (...args) => {
                      const made = target[name](...args);
                      peak = Math.max(peak, target.memory.peak);
                      return made;
                  },
    });

/** The certificate as the page shows it. */
function certify(bitvox, mesh, weld) {
    const found = bitvox.check(mesh, { weld });
    const crossings = found.triangles <= COUNTED ? bitvox.crossings(mesh).count : undefined;
    return { ...found, crossings, hash: bitvox.hash(mesh) };
}

async function unpacked(bytes, name) {
    if (!/\.gz$/i.test(name)) return bytes;
    return new Response(
        new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')),
    ).arrayBuffer();
}

/** A copy for the page; what the worker keeps stays here. */
const shown = mesh => ({ positions: Float32Array.from(mesh.positions), triangles: mesh.triangles.slice() });

const jobs = {
    async open(bitvox, { bytes, name }, progress) {
        results = [];
        source = undefined;
        const files = await filesReady;
        const mesh = name
            ? files.readMesh(await unpacked(bytes, name), files.formatOfName(name), { progress })
            : sampleMesh();
        source = { mesh, certificate: certify(bitvox, mesh, true) };
        return { mesh: shown(mesh), certificate: source.certificate };
    },

    levels(bitvox, { resolution, triangles, count }, progress) {
        const targetTriangles = Array.from({ length: count }, (_, i) =>
            Math.max(4, Math.round(triangles / 2 ** i)),
        );
        const { levels, report } = bitvox.buildLevels(source.mesh, {
            targetTriangles,
            resolution: resolution || undefined,
            progress,
        });
        results = levels.map(level => level.mesh);
        return {
            note: report.solid
                ? `Rebuilt from ${report.resolution} voxels along the longest axis.`
                : 'Simplified as it is.',
            results: levels.map(({ mesh, report: found }) => ({
                mesh: shown(mesh),
                certificate: { ...found.certificate, crossings: found.crossings, hash: bitvox.hash(mesh) },
                met: found.met,
            })),
        };
    },

    repair(bitvox, { resolution }, progress) {
        const { mesh, report } = bitvox.repair(source.mesh, { resolution: resolution || 256, progress });
        results = [mesh];
        return {
            note: `${report.holes} holes closed; ${report.partsDropped} small parts dropped.`,
            results: [{ mesh: shown(mesh), certificate: certify(bitvox, mesh, false) }],
        };
    },

    solid(bitvox, { resolution }, progress) {
        const { grid, report } = bitvox.voxelize(source.mesh, {
            resolution: resolution || 128,
            padding: 1,
            progress,
        });
        const mesh = bitvox.extractFaces(grid, { merged: true });
        results = [mesh];
        const [x, y, z] = grid.size;
        return {
            note: `${x} x ${y} x ${z} voxels, filled by the rule ${report.fill} (${report.fillReason}).`,
            results: [
                {
                    mesh: shown(mesh),
                    certificate: {
                        voxels: bitvox.count(grid),
                        volume: report.volume,
                        hash: bitvox.hash(grid),
                    },
                },
            ],
        };
    },

    async save(bitvox, { format, level }) {
        const files = await filesReady;
        const bytes =
            format === 'glb' ? files.writeLevels(results, 'glb') : files.writeMesh(results[level], format);
        return { bytes, format };
    },
};

addEventListener('message', async ({ data: { id, job, ...options } }) => {
    let last = 0;
    const progress = (fraction, stage) => {
        const now = performance.now();
        if (now - last < 40) return;
        last = now;
        postMessage({ id, fraction, stage });
    };

    try {
        const bitvox = await ready;
        const start = performance.now();
        peak = 0;
        const answer = await jobs[job](watched(bitvox), options, progress);
        const time = performance.now() - start;
        const buffers = [answer, ...(answer.results ?? [])]
            .flatMap(({ mesh }) => (mesh ? [mesh.positions.buffer, mesh.triangles.buffer] : []))
            .concat(answer.bytes ? [answer.bytes.buffer] : []);
        postMessage({ id, answer, time, memory: { module: bitvox.memory.module, peak } }, buffers);
    } catch (error) {
        postMessage({
            id,
            error: {
                message: error.message,
                status: error.status ?? (error instanceof RangeError ? 'memory' : 'broken'),
            },
        });
    }
});
