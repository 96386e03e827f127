// worker.js - one job in a worker: { positions, triangles, options } in; progress, then levels or an error out. The arrays are moved.
import { load } from 'bitvox';

const ready = load();

addEventListener('message', async ({ data: { options, ...mesh } }) => {
    const bitvox = await ready;
    try {
        const { levels } = bitvox.buildLevels(mesh, {
            ...options,
            progress: (fraction, stage) => postMessage({ fraction, stage }),
        });
        postMessage(
            { levels },
            levels.flatMap(({ mesh: level }) => [level.positions.buffer, level.triangles.buffer]),
        );
    } catch ({ message, status }) {
        postMessage({ error: { message, status } });
    }
});
