// files.js - the package's second part: bytes of files to meshes and grids and back, in a module of their own.

class Files extends Library {
    formatOfName(name) {
        const ending = String(name)
            .toLowerCase()
            .replace(/\.gz$/, '')
            .match(/\.([a-z0-9]+)$/)?.[1];
        return ['stl', 'obj', 'ply', 'off', 'glb', 'gltf', '3mf'].includes(ending) ? ending : undefined;
    }

    readMesh(bytes, format, options = {}) {
        return this._call('readMesh', options, (call, machine) => {
            const mesh = call.result('mesh');
            const [at, size] = call.bytesIn(bytes);
            const kind = choiceOf('readMesh', 'format', 'format_', format);
            const report = call.struct('read_report');
            const given = call.options('read_options', { dropNonfinite: !!options.finite });
            machine.setField('read_options', given, 'report', report);
            call.do('bvx_read_mesh', at, size, kind, given, mesh);
            const made = call.meshOut(mesh);
            const assets = machine.field('mesh', mesh, 'assets');
            const colours = assets && machine.field('assets', assets, 'baseColours');
            if (colours)
                made.materialColours = call.array(Uint8Array, colours, 4 * machine.field('assets', assets, 'materialCount'));
            return options.finite ? { ...made, dropped: machine.read('read_report', report).dropped } : made;
        });
    }

    writeMesh(mesh, format, options = {}) {
        return this._call('writeMesh', options, call => {
            const file = call.result('buffer');
            call.do(
                'bvx_write_mesh',
                call.mesh(mesh),
                1n,
                call.options('write_options', options),
                choiceOf('writeMesh', 'format', 'format_', format),
                file,
            );
            return call.bufferOut(file);
        });
    }

    writeLevels(meshes, format, options = {}) {
        return this._call('writeLevels', options, (call, machine) => {
            const levels = call.struct('mesh', meshes.length);
            const file = call.result('buffer');
            const each = (what, list, length) => {
                if (list?.length !== length)
                    refuse('writeLevels', `${what} has ${list?.length} values, and there are ${meshes.length} meshes`);
                return list;
            };
            const given = call.options('write_options', options, {
                names: (names, at) => {
                    const texts = each('names', names, meshes.length).map(name => call.copy(new TextEncoder().encode(`${name}\0`)));
                    machine.setField('write_options', at, 'names', call.copy(Uint32Array.from(texts)));
                },
                colours: (colours, at) =>
                    machine.setField('write_options', at, 'colours', call.list('colours', 'u8', each('colours', colours, 4 * meshes.length))),
            });
            meshes.forEach((mesh, i) => call.mesh(mesh, levels + i * STRUCTS.mesh.size));
            call.do(
                'bvx_write_mesh',
                levels,
                BigInt(meshes.length),
                given,
                choiceOf('writeLevels', 'format', 'format_', format),
                file,
            );
            return call.bufferOut(file);
        });
    }

    // ---- Grids, and the labels of their voxels ----

    readGrid(bytes, format, options = {}) {
        return this._call('readGrid', options, call => {
            const grid = call.result('grid');
            const [at, size] = call.bytesIn(bytes);
            call.do('bvx_read_grid', at, size, choiceOf('readGrid', 'format', 'format_', format), call.window(options.window), grid);
            return call.gridOut(grid);
        });
    }

    writeGrid(grid, format, options = {}) {
        return this._call('writeGrid', options, call => {
            const file = call.result('buffer');
            call.do('bvx_write_grid', call.grid(grid), choiceOf('writeGrid', 'format', 'format_', format), file);
            return call.bufferOut(file);
        });
    }

    readLabels(bytes, format, options = {}) {
        return this._call('readLabels', options, call => {
            const grid = call.result('grid'),
                labels = call.result('buffer'),
                palette = call.block(1024);
            const [at, size] = call.bytesIn(bytes);
            const kind = choiceOf('readLabels', 'format', 'format_', format);
            call.do('bvx_read_labels', at, size, kind, labels, palette);
            call.do('bvx_read_grid', at, size, kind, 0, grid);
            return { grid: call.gridOut(grid), labels: call.bufferOut(labels), palette: call.array(Uint8Array, palette, 1024) };
        });
    }

    writeLabels(grid, made, format, options = {}) {
        return this._call('writeLabels', options, call => {
            const file = call.result('buffer'),
                at = call.grid(grid);
            for (const [name, value, count] of [
                ['labels', made?.labels, grid.size[0] * grid.size[1] * grid.size[2]],
                ['palette', made?.palette, 1024],
            ])
                if (!(value instanceof Uint8Array && value.length === count)) refuse('writeLabels', `${name} must be a Uint8Array of ${count} numbers`);
            call.do('bvx_write_labels', at, call.copy(made.labels), call.copy(made.palette), choiceOf('writeLabels', 'format', 'format_', format), file);
            return call.bufferOut(file);
        });
    }
}

export const load = options => loadAs(Files, options);
