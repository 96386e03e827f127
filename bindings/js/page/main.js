// main.js - the page: it hands meshes and jobs to the worker, and shows what comes back.
import { View } from './view.js';

const $ = id => document.getElementById(id);
const view = new View($('canvas'));

// Of the slider: 0 leaves it to the job.
const RESOLUTIONS = [0, 32, 64, 96, 128, 192, 256, 384, 512];
const LARGEST_FILE = 1.5e9;

const state = {
    worker: undefined,
    last: 0,
    waiting: undefined,
    source: undefined, // { bytes, name } of the mesh, for a worker that begins anew
    opened: false,
    before: undefined,
    results: [],
    job: '',
};

// ---- The worker ----

function startWorker() {
    state.worker = new Worker('job.js', { type: 'module' });
    state.opened = false;
    state.worker.onmessage = ({ data }) => {
        if (data.id !== state.waiting?.id) return;
        const { done, failed } = state.waiting;
        if (data.fraction !== undefined) return showProgress(data.fraction, data.stage);
        state.waiting = undefined;
        if (data.error) return failed(data.error);
        const megabytes = bytes => `${Math.ceil(bytes / 2 ** 20)} MiB`;
        $('memory').textContent =
            `${(data.time / 1000).toFixed(2)} s; memory: ${megabytes(data.memory.module)} held, ${megabytes(data.memory.peak)} needed at most`;
        done(data.answer);
    };
    state.worker.onerror = event => {
        const { failed } = state.waiting ?? {};
        state.waiting = undefined;
        failed?.({ status: 'broken', message: event.message ?? 'the worker could not begin' });
    };
}

function ask(job, options) {
    return new Promise((done, failed) => {
        state.waiting = { id: ++state.last, done, failed };
        state.worker.postMessage({ id: state.last, job, ...options });
    });
}

function cancel() {
    const { failed } = state.waiting ?? {};
    state.waiting = undefined;
    state.worker.terminate();
    startWorker();
    failed?.({ status: 'cancelled', message: '' });
}

// ---- Words ----

const REMEDIES = {
    cancelled: () => 'Cancelled.',
    format: text => `This file is broken, or is not what its name says. ${text}`,
    name: text => `This kind of file is not read here. ${text}.`,
    empty: text => `There is nothing to work on. ${text}`,
    range: text => `A number in this mesh cannot be used. ${text}`,
    memory: text =>
        `This is too large for the browser's memory: lower the resolution, or take fewer triangles. ${text}`,
    budget: text =>
        `This is too large for the browser's memory: lower the resolution, or take fewer triangles. ${text}`,
    unsupported: text => `This browser or format cannot do it. ${text}`,
};

function say(text, error = false) {
    $('status').textContent = text;
    $('status').classList.toggle('error', error);
}

function sayError({ status, message }) {
    const words = REMEDIES[status] ?? (text => `That did not work. ${text}`);
    say(words(message ? `(${message})` : ''), status !== 'cancelled');
}

function showProgress(fraction, stage) {
    $('progress').value = fraction;
    say(`${Math.round(100 * fraction)} %: ${stage}`);
}

function busy(on) {
    for (const id of ['run', 'file', 'sample', 'download']) $(id).disabled = on;
    $('cancel').disabled = !on;
    if (!on) {
        $('run').disabled = !state.source;
        $('download').disabled = state.results.length === 0;
        $('progress').value = 0;
    }
    document.body.setAttribute('aria-busy', String(on));
}

/** A job from its first word to its last; what is shown stays when it fails. */
async function during(words, body) {
    busy(true);
    say(words);
    try {
        await body();
    } catch (error) {
        if (!error.status) console.error(error);
        sayError(error.status ? error : { status: 'broken', message: error.message });
    }
    busy(false);
}

// ---- Certificates ----

const number = value => (value === undefined ? '' : value.toLocaleString('en', { maximumFractionDigits: 4 }));
const ROWS = [
    ['Triangles', c => number(c.triangles)],
    ['Vertices', c => number(c.vertices)],
    ['Voxels', c => number(c.voxels)],
    ['Closed', c => c.closed],
    ['Manifold', c => (c.closed === undefined ? undefined : c.edgeManifold && c.vertexManifold)],
    ['Oriented', c => c.oriented],
    ['Crossings', c => (c.closed === undefined ? '' : (c.crossings ?? 'not counted'))],
    ['Parts', c => number(c.components)],
    ['Volume', c => number(c.volume)],
    ['Hash', c => c.hash],
];

function certificates(after) {
    $('certificates').tBodies[0].replaceChildren(
        ...ROWS.filter(([, of]) =>
            [state.before, after].some(c => c && of(c) !== '' && of(c) !== undefined),
        ).map(([name, of]) => {
            const row = document.createElement('tr');
            const head = document.createElement('th');
            head.scope = 'row';
            head.textContent = name;
            row.append(head);
            [state.before, after].forEach((certificate, i) => {
                const cell = document.createElement('td');
                const value = certificate ? of(certificate) : '';
                cell.textContent = value === true ? 'yes' : value === false ? 'no' : String(value ?? '');
                cell.classList.toggle('bad', value === false || (name === 'Crossings' && value > 0));
                cell.dataset.cell = `${i === 0 ? 'before' : 'after'}-${name.toLowerCase()}`;
                row.append(cell);
            });
            return row;
        }),
    );
}

function showLevel(index) {
    const result = state.results[index];
    view.show(1, result?.mesh);
    certificates(result?.certificate);
}

// ---- Meshes and jobs ----

async function open(file) {
    if (file && file.size > LARGEST_FILE)
        return sayError({
            status: 'memory',
            message: `${file.name} has ${number(file.size)} bytes; ${number(LARGEST_FILE)} are possible`,
        });
    if (file && !/\.(stl|obj|ply|off|glb)(\.gz)?$/i.test(file.name))
        return sayError({
            status: 'name',
            message: `${file.name} does not end with .stl, .obj, .ply, .off or .glb`,
        });

    await during(`Reading ${file?.name ?? 'the sample'} ...`, async () => {
        const source = file ? { name: file.name, bytes: await file.arrayBuffer() } : {};
        const { mesh, certificate } = await ask('open', source);
        Object.assign(state, { source, opened: true, before: certificate, results: [] });
        view.frame(certificate);
        view.cut($('cut').value / 100, Number($('axis').value));
        view.show(0, mesh);
        listLevels();
        showLevel(-1);
        sliders();
        say(`${file?.name ?? 'A knot with holes'}: ${number(certificate.triangles)} triangles.`);
    });
}

async function run(job) {
    await during('Starting ...', async () => {
        if (!state.opened) {
            await ask('open', state.source);
            state.opened = true;
        }
        const { note, results } = await ask(job, {
            resolution: RESOLUTIONS[$('resolution').value],
            triangles: targetTriangles(),
            count: Number($('count').value),
        });
        state.results = results;
        state.job = job;
        listLevels();
        showLevel(0);
        say(
            `Done. ${note}${results.some(result => result.met === false) ? ' Some levels have more triangles than wanted.' : ''}`,
        );
    });
}

function listLevels() {
    $('level').replaceChildren(
        ...state.results.map(
            ({ mesh }, i) => new Option(`${i}: ${number(mesh.triangles.length / 3)} triangles`, String(i)),
        ),
    );
    $('level').disabled = state.results.length < 2;
}

async function download() {
    await during('Writing ...', async () => {
        const format = $('format').value;
        const level = Number($('level').value || 0);
        const { bytes } = await ask('save', { format, level });
        const link = document.createElement('a');
        const stem = (state.source.name ?? 'knot').replace(/\.(stl|obj|ply|off|glb)(\.gz)?$/i, '');
        link.href = URL.createObjectURL(new Blob([bytes]));
        link.download = `${stem}_${state.job}${format === 'glb' || state.results.length < 2 ? '' : `_${level}`}.${format}`;
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 60000);
        say(`${link.download}: ${number(bytes.length)} bytes.`);
    });
}

// ---- Controls ----

/** The slider is logarithmic, from 100 triangles to those of the mesh. */
function targetTriangles() {
    const all = Math.max(state.before?.triangles ?? 10000, 200);
    return Math.round(100 * (all / 100) ** ($('triangles').value / 100));
}

function sliders() {
    const job = new FormData($('controls')).get('job');
    const resolution = RESOLUTIONS[$('resolution').value];
    $('resolution-value').value = resolution || { levels: 'as needed', repair: '256', solid: '128' }[job];
    $('triangles-value').value = number(targetTriangles());
    $('count-value').value = $('count').value;
    $('cut-value').value = $('cut').value === '0' ? 'none' : `${$('cut').value} %`;
    for (const id of ['triangles', 'count']) $(id).disabled = job !== 'levels';
    for (const [slider, output] of ['resolution', 'triangles', 'count', 'cut'].map(id => [
        $(id),
        $(`${id}-value`),
    ]))
        slider.setAttribute('aria-valuetext', output.value);
}

$('controls').addEventListener('input', event => {
    sliders();
    if (['cut', 'axis'].includes(event.target.id)) view.cut($('cut').value / 100, Number($('axis').value));
    if (event.target.id === 'wire') view.edges($('wire').checked);
    if (event.target.id === 'level') showLevel(Number($('level').value));
});
$('controls').addEventListener('submit', event => {
    event.preventDefault();
    run(new FormData($('controls')).get('job'));
});
$('file').addEventListener('change', () => $('file').files[0] && open($('file').files[0]));
$('sample').addEventListener('click', () => open());
$('cancel').addEventListener('click', cancel);
$('download').addEventListener('click', download);
for (const kind of ['dragover', 'dragleave', 'drop']) {
    addEventListener(kind, event => {
        event.preventDefault();
        $('drop').classList.toggle('over', kind === 'dragover');
        if (kind === 'drop' && event.dataTransfer.files[0] && !state.waiting)
            open(event.dataTransfer.files[0]);
    });
}

startWorker();
sliders();
certificates();
