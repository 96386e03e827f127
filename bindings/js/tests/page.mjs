// page.mjs SITE PROGRAM MESH FOLDER - the page in headless Chromium: a file is dropped, jobs are done, read and downloaded, and compared
// with the program's files; cancelling, broken files, keys, labels, dark. Pictures go to FOLDER. Prints TAP.
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readFileSync, rmSync } from 'node:fs';
import { basename, join } from 'node:path';
import { browse, finish, report, serve } from './browser.mjs';

const [site, program, mesh, folder] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
copyFileSync(mesh, join(site, basename(mesh)));
const { server, url } = await serve(site);

await browse(async browser => {
    const page = await browser.newPage();
    const errors = [],
        requests = [];
    page.on('pageerror', error => errors.push(error.message));
    page.on('console', message => message.type() === 'error' && errors.push(message.text()));
    page.on('request', request => requests.push(request.url()));
    await page.setViewport({ width: 1280, height: 860 });
    await page.goto(url + '/index.html');

    const status = () => page.$eval('#status', part => part.textContent);
    const cell = name => page.$eval(`[data-cell="${name}"]`, part => part.textContent);
    const until = (pattern, timeout = 200000) =>
        page.waitForFunction(
            text =>
                new RegExp(text).test(document.getElementById('status').textContent) &&
                document.body.ariaBusy === 'false',
            { timeout, polling: 50 },
            pattern,
        );
    const set = (id, value) =>
        page.$eval(
            `#${id}`,
            (part, to) => {
                part.value = to;
                part.dispatchEvent(new Event('input', { bubbles: true }));
            },
            String(value),
        );
    const drop = (name, path, text) =>
        page.evaluate(
            async (file, from, content) => {
                const transfer = new DataTransfer();
                transfer.items.add(new File([from ? await (await fetch(from)).blob() : content], file));
                document
                    .getElementById('drop')
                    .dispatchEvent(
                        new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }),
                    );
            },
            name,
            path,
            text,
        );
    const step = async (name, body) => {
        try {
            report(name, (await body()) !== false, await status());
        } catch (error) {
            report(name, false, `${error.message}; status: ${await status()}; ${errors.join(' ')}`);
        }
    };

    await step('a dropped file is read and certified', async () => {
        await drop(basename(mesh), basename(mesh));
        await until('triangles\\.$');
        return (await cell('before-triangles')) === '38,400' && (await cell('before-closed')) === 'yes';
    });

    await step("levels are the program's, byte for byte", async () => {
        await set('triangles', 60);
        await set('count', 3);
        const finest = Number((await page.$eval('#triangles-value', part => part.value)).replace(/,/g, ''));
        await page.click('#run');
        await until('^Done');
        const client = await page.createCDPSession();
        await client.send('Browser.setDownloadBehavior', {
            behavior: 'allow',
            downloadPath: folder,
            eventsEnabled: true,
        });
        const targets = [finest, Math.round(finest / 2), Math.round(finest / 4)];
        execFileSync(
            program,
            ['lod', mesh, '-o', join(folder, 'program_%d.ply'), '--triangles', targets.join(',')],
            { stdio: 'ignore' },
        );
        for (let level = 0; level < 3; level++) {
            await page.select('#level', String(level));
            const [closed, manifold, crossings] = await Promise.all(
                ['closed', 'manifold', 'crossings'].map(name => cell(`after-${name}`)),
            );
            if (closed !== 'yes' || manifold !== 'yes' || crossings !== '0') return false;
            await page.click('#download');
            await until('bytes\\.$');
            const file = join(folder, `${basename(mesh, '.ply')}_levels_${level}.ply`);
            for (let i = 0; i < 100 && !existsSync(file); i++)
                await new Promise(done => setTimeout(done, 50));
            await new Promise(done => setTimeout(done, 200));
            if (!readFileSync(file).equals(readFileSync(join(folder, `program_${level}.ply`)))) return false;
        }
    });

    await step("the hash is that of the program's mesh", async () => {
        await page.select('#level', '0');
        const shown = await cell('after-hash');
        const [{ load }, { load: loadFiles }] = await Promise.all(['bitvox.js', 'files.js'].map(name => import(join(process.env.BITVOX_JS, name))));
        const [bitvox, files] = [await load(), await loadFiles()];
        return shown === bitvox.hash(files.readMesh(readFileSync(join(folder, 'program_0.ply')), 'ply'));
    });

    await step('a mesh with holes is repaired', async () => {
        await page.click('#sample');
        await until('triangles\\.$');
        const before = await cell('before-closed');
        await page.click('input[value=repair]');
        await page.click('#run');
        await until('^Done');
        await page.screenshot({ path: join(folder, 'repair.png') });
        return (
            before === 'no' &&
            (await cell('after-closed')) === 'yes' &&
            (await cell('after-crossings')) === '0'
        );
    });

    await step('a solid of voxels, cut open', async () => {
        await page.click('input[value=solid]');
        await page.click('#run');
        await until('^Done');
        await set('cut', 45);
        await page.screenshot({ path: join(folder, 'solid.png') });
        await set('cut', 0);
        return Number((await cell('after-voxels')).replace(/,/g, '')) > 1000;
    });

    await step('a job is cancelled, and the next one works', async () => {
        await page.click('input[value=repair]');
        await set('resolution', 8);
        await page.click('#run');
        await page.waitForFunction(() => document.getElementById('progress').value > 0.05, {
            timeout: 60000,
        });
        await page.click('#cancel');
        await until('^Cancelled\\.$', 5000);
        await set('resolution', 2);
        await page.click('#run');
        await until('^Done');
    });

    await step('clear words for broken files', async () => {
        await drop('broken.off', undefined, 'OFF\n4 4 0\n0 0 0\n1 0 0\n');
        await until('^This file is broken');
        await drop('notes.txt', undefined, 'hello');
        await until('does not end with');
        return page.$eval('#status', part => part.classList.contains('error'));
    });

    await step('keys turn the view', async () => {
        await page.click('#sample');
        await until('triangles\\.$');
        const canvas = await page.$('#canvas');
        const before = await canvas.screenshot();
        await page.focus('#canvas');
        for (let i = 0; i < 4; i++) await page.keyboard.press('ArrowLeft');
        await new Promise(done => setTimeout(done, 300));
        return !Buffer.from(before).equals(Buffer.from(await canvas.screenshot()));
    });

    await step('all controls have names, and the status is announced', async () => {
        const nameless = await page.$$eval('input, select, button, progress, canvas', parts =>
            parts
                .filter(part => !(part.labels?.length || part.ariaLabel || part.textContent.trim()))
                .map(part => part.outerHTML),
        );
        const live = await page.$eval('#status', part => part.ariaLive);
        if (nameless.length || live !== 'polite') throw new Error(`${nameless} ${live}`);
    });

    await step('dark where the system is dark', async () => {
        const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
        await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }]);
        const light = await ground();
        await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }]);
        const dark = await ground();
        await page.screenshot({ path: join(folder, 'dark.png') });
        return light !== dark;
    });

    report(
        'nothing is fetched from elsewhere, no errors',
        requests.every(from => from.startsWith(url) || /^(data|blob):/.test(from)) && errors.length === 0,
        `${requests.filter(from => !from.startsWith(url))} ${errors}`,
    );
});
server.close();
finish();
