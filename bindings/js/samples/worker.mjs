// worker.mjs - the job of worker.js from the page's side; to cancel, end the worker and begin another one.
export function startJob(mesh, options, { onProgress } = {}) {
    const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    const levels = new Promise((done, failed) => {
        worker.onmessage = ({ data }) => {
            if (data.levels) done(data.levels);
            else if (data.error) failed(Object.assign(new Error(data.error.message), data.error));
            else onProgress?.(data.fraction, data.stage);
        };
        worker.onerror = failed;
        worker.postMessage({ ...mesh, options });
    });
    return { levels: levels.finally(() => worker.terminate()), cancel: () => worker.terminate() };
}
