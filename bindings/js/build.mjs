// build.mjs FOLDER - the npm package bitvox in FOLDER/package: modules of JavaScript, WebAssembly inside, each at most 250 kB gzipped.
// bitvox.js; scalar.js, the same without 128-bit instructions; files.js, the formats, labels.js and makers.js without these instructions as well.
// Called by `make js`, from the repository root. EMCC: the compiler [emcc].
import { execFile, execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { basename, resolve } from 'node:path';
import { promisify } from 'node:util';
import { gzipSync } from 'node:zlib';
import { layoutHeader, layoutTable, readHeader } from './layout.mjs';

const folder = resolve(process.argv[2]);
const root = process.cwd();
const here = 'bindings/js';
const run = promisify(execFile);
mkdirSync(`${folder}/package`, { recursive: true });

// ---- What the package calls and fills ----

// Of mesh.h the colours of materials, which the public header keeps to itself.
const headers = ['include/bitvox.h', 'include/bitvox_io.h', 'src/mesh/mesh.h'];
const header = readHeader(headers.map(name => readFileSync(name, 'utf8')).join('\n'));
writeFileSync(`${folder}/layout.h`, layoutHeader(header));

const CHAINED = new Set(['bitvox', 'makers']); // levels are made there

/** A module of the package: its text in JavaScript, structs and calls that this names, and whether it has 128-bit instructions. */
function moduleOf(name, last, simd) {
    const source = ['machine', 'call', 'library', ...(CHAINED.has(last) ? ['chain'] : []), last].map(part => readFileSync(`${here}/src/${part}.js`, 'utf8')).join('\n');
    const structs = Object.keys(header.structs).filter(struct => source.includes(`'${struct.slice(4)}'`));
    const calls = new Set(source.match(/\bbvx_[a-z_]+\b/g).filter(call => !call.endsWith('_')));
    for (const struct of structs)
        if (['bvx_mesh', 'bvx_grid', 'bvx_buffer', 'bvx_image', 'bvx_complex'].includes(struct)) calls.add(`${struct}_free`);
    return { name, simd, source, structs, calls };
}
const modules = [
    moduleOf('bitvox', 'bitvox', true),
    moduleOf('scalar', 'bitvox', false),
    ...['files', 'labels', 'makers'].map(name => moduleOf(name, name, false)),
];

// ---- The modules ----

// Where time goes, measured on levels, repairs, booleans and solids of scans: these files are compiled for
// speed, all others for size.
const HOT = new Set(
    `nearest_cell nearest_eight nearest_build nearest_pairs closest closest_build
    point_triangle check radix collapse edge_costs sheet field_cuts crossings triangle_rows`.split(/\s+/),
);

// Without vectors these are smaller at -O2: arrays of four become plain numbers there.
const SMALLER = new Set(['sheet_series', 'nearest_order', 'sign_normal', 'mesh_rays']);

// Of the sum over a sheet the compiler chooses what it puts in line, which halves it.
const wayOf = (name, simd) => (name === 'sheet' ? 2 : HOT.has(name) || (!simd && SMALLER.has(name)) ? 1 : 0);

// Contraction would change results. With 128-bit instructions repairs take four fifths of the time. The stack lies
// below all data, so a module whose stack overflows stops and does not write on.
const emcc = process.env.EMCC ?? 'emcc';
const SIMD = ['-msimd128'];
const SCALAR = ['-DBVXI_VECTOR_INLINE=static inline']; // a module of 12 kB less
const flagsOf = simd => [
    '-std=c11',
    '-ffp-contract=off',
    '-fno-math-errno',
    '-fno-trapping-math',
    ...simd,
    '-mbulk-memory',
    `-I${root}/include`,
    `-I${root}/src`,
    `-I${folder}`,
];
const linkingOf = (simd, calls) => [
    '-Oz',
    // Control flow is made anew where there are no vectors, which saves two kilobytes; then until nothing gets smaller, one less.
    `-sBINARYEN_EXTRA_PASSES=${simd.length ? '' : '--flatten,--rereloop,-Oz,-Oz,'}--converge`,
    ...simd,
    '-mbulk-memory',
    '-sSTANDALONE_WASM',
    '--no-entry',
    '-sALLOW_MEMORY_GROWTH=1',
    '-sMAXIMUM_MEMORY=4GB',
    '-sINITIAL_MEMORY=4MB',
    '-sTOTAL_STACK=1MB',
    '-sMALLOC=emmalloc',
    '-Wl,--stack-first',
    '-sABORTING_MALLOC=0',
    '-sERROR_ON_UNDEFINED_SYMBOLS=0',
    `-sEXPORTED_FUNCTIONS=${[...calls, 'bridge_progress', 'malloc', 'free'].map(name => '_' + name).join(',')}`,
];

const files = readdirSync('src')
    .filter(room => !room.startsWith('cli') && statSync(`src/${room}`).isDirectory())
    .flatMap(room =>
        readdirSync(`src/${room}`)
            .filter(name => name.endsWith('.c'))
            .map(name => `${root}/src/${room}/${name}`),
    );
files.push(`${root}/${here}/src/bridge.c`);

/** All objects, with 128-bit instructions or without. One compiler call for many files, on every processor. */
async function compileAll(simd) {
    const objects = `${folder}/objects-${simd ? 'simd' : 'scalar'}`;
    rmSync(objects, { recursive: true, force: true });
    mkdirSync(objects);

    const batches = [];
    for (const [way, flags] of [['-Oz'], ['-O2'], ['-O2', ...SCALAR]].entries()) {
        const chosen = files.filter(file => wayOf(basename(file, '.c'), simd) === way);
        for (let i = 0; i < chosen.length; i += 40)
            batches.push([...flags, ...flagsOf(simd ? SIMD : SCALAR), '-c', ...chosen.slice(i, i + 40)]);
    }
    const compile = async () => {
        for (let batch = batches.shift(); batch; batch = batches.shift())
            await run(emcc, batch, { cwd: objects, maxBuffer: 1 << 26 });
    };
    await Promise.all(Array.from({ length: availableParallelism() }, compile));
    return files.map(file => `${objects}/${file.replace(/^.*\//, '').replace(/c$/, 'o')}`);
}
for (const simd of [true, false]) {
    const objects = await compileAll(simd);
    for (const { name, calls } of modules.filter(made => made.simd === simd))
        await run(emcc, [...linkingOf(simd ? SIMD : [], calls), ...objects, '-o', `${folder}/${name}.wasm`]);
}

// zopfli packs 4 % tighter in the same format; without it the package works as well and is 10 kB larger.
const squeeze = file => {
    try {
        return execFileSync('zopfli', ['--i5', '-c', file], { maxBuffer: 1 << 26 });
    } catch {
        console.log('zopfli is missing (make deps-js): the package is 10 kB larger without it');
        return gzipSync(readFileSync(file), { level: 9 });
    }
};

// ---- The package ----

const version = ['MAJOR', 'MINOR', 'PATCH']
    .map(part => readFileSync('include/bitvox.h', 'utf8').match(`#define BVX_VERSION_${part} (\\d+)`)[1])
    .join('.');
// Comments and indentation stay in the repository: the file is small before it is anything else.
for (const { name, simd, source, structs } of modules) {
    const bare = source.replace(/^ *(\/\/.*|\/\*\*.*\*\/)\n/gm, '').replace(/^ +|\n(?=\n)/gm, '');
    const packed = squeeze(`${folder}/${name}.wasm`).toString('base64');
    const text =
        `// bitvox ${version}, MIT licence; made by make js\nconst LAYOUT = ${JSON.stringify(layoutTable(header, structs))};\n` +
        `const SCALAR = ${!simd};\nconst MODULE = '${packed}';\n${bare}`;
    writeFileSync(`${folder}/package/${name}.js`, text);
    console.log(
        `${process.argv[2]}/package/${name}.js: ${text.length} bytes, ${gzipSync(text, { level: 9 }).length} gzipped`,
    );
}
for (const file of ['index.d.ts', 'files.d.ts', 'labels.d.ts', 'makers.d.ts', 'README.md']) copyFileSync(`${here}/${file}`, `${folder}/package/${file}`);
copyFileSync('LICENSE', `${folder}/package/LICENSE`);
const description = { ...JSON.parse(readFileSync(`${here}/package.json`, 'utf8')), version };
delete description.private;
writeFileSync(`${folder}/package/package.json`, JSON.stringify(description, null, 2) + '\n');
