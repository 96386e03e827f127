// browser.mjs SITE - runs the samples of a folder in headless Chromium: module.html, and vite/index.html where it was built.
// CHROMIUM: the browser [chromium]. Modules are looked for beside NODE_TOOLS/package.json. Prints TAP.
import { createServer } from 'node:http';
import { createReadStream, existsSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';

const TYPES = {
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.mjs': 'text/javascript',
    '.css': 'text/css',
    '.ply': 'application/octet-stream',
};

/** A file server for one folder on a free port. */
export function serve(folder) {
    return new Promise(done => {
        const server = createServer((request, response) => {
            const path = join(
                folder,
                decodeURIComponent(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html'),
            );
            if (!existsSync(path) || !statSync(path).isFile()) return response.writeHead(404).end();
            response.writeHead(200, { 'Content-Type': TYPES[extname(path)] ?? 'application/octet-stream' });
            createReadStream(path).pipe(response);
        }).listen(0, '127.0.0.1', () => done({ server, url: `http://127.0.0.1:${server.address().port}` }));
    });
}

/** A browser with an empty profile of its own, removed at the end. */
export async function browse(body) {
    const puppeteer = createRequire(join(process.env.NODE_TOOLS, 'package.json'))('puppeteer-core');
    const profile = mkdtempSync(join(tmpdir(), 'bitvox-browser-'));
    const browser = await (puppeteer.default ?? puppeteer).launch({
        executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
        headless: true,
        userDataDir: profile,
        protocolTimeout: 300000,
        args: [
            '--no-sandbox',
            '--disable-quic',
            '--no-first-run',
            '--disable-background-networking',
            '--disable-component-update',
            '--disable-sync',
            '--enable-unsafe-swiftshader',
        ],
    });
    try {
        return await body(browser);
    } finally {
        await browser.close();
        rmSync(profile, { recursive: true, force: true });
    }
}

const results = [];
export function report(name, good, why = '') {
    results.push(good);
    console.log(`${good ? 'ok' : 'not ok'} ${results.length} - ${name}${good ? '' : `\n# ${why}`}`);
}
export function finish() {
    console.log(`1..${results.length}`);
    process.exitCode = results.every(Boolean) ? 0 : 1;
}

if (process.argv[1].endsWith('browser.mjs')) {
    const site = process.argv[2];
    const { server, url } = await serve(site);
    await browse(async browser => {
        for (const [path, want] of [
            ['module.html', '43680 voxels'],
            ['vite/index.html', '40000, 20000, 10000'],
        ]) {
            if (!existsSync(join(site, path))) continue;
            const page = await browser.newPage();
            const errors = [];
            page.on('pageerror', error => errors.push(error.message));
            await page.goto(`${url}/${path}`);
            const found = await page
                .waitForFunction(() => document.querySelector('output')?.textContent, { timeout: 120000 })
                .then(
                    handle => handle.jsonValue(),
                    error => `${error.message} ${errors.join(' ')}`,
                );
            report(path, found === want, `${found}, not ${want}`);
            await page.close();
        }
    });
    server.close();
    finish();
}
