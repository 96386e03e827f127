// build_page.mjs PACKAGE FOLDER - the page as files that any file server can give, or a memory stick: index.html, style.css, main.js
// with three.js, job.js with the package. Called by `make js-page`; NODE_TOOLS/node_modules has esbuild and three.
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const [bitvox, folder] = process.argv.slice(2).map(path => resolve(path));
const { build } = createRequire(resolve(process.env.NODE_TOOLS, 'package.json'))('esbuild');

mkdirSync(folder, { recursive: true });
await build({
    entryPoints: ['bindings/js/page/main.js', 'bindings/js/page/job.js'],
    outdir: folder,
    bundle: true,
    minify: true,
    format: 'esm',
    target: 'es2022',
    alias: { 'bitvox/files': `${bitvox}/files.js`, bitvox: `${bitvox}/bitvox.js` },
    nodePaths: [resolve(process.env.NODE_TOOLS, 'node_modules')],
    legalComments: 'eof',
    logLevel: 'warning',
});
for (const name of ['index.html', 'style.css']) copyFileSync(`bindings/js/page/${name}`, `${folder}/${name}`);

// three.js is under the MIT licence, whose text goes where its code goes.
const licence = readFileSync(resolve(process.env.NODE_TOOLS, 'node_modules/three/LICENSE'), 'utf8');
writeFileSync(
    `${folder}/LICENSE.txt`,
    `bitvox\n\n${readFileSync('LICENSE', 'utf8')}\nthree.js\n\n${licence}`,
);
