// files.js - the package's second part: bytes of files to meshes and back, in a module of their own.

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
        return this._call('writeLevels', options, call => {
            const levels = call.struct('mesh', meshes.length);
            const file = call.result('buffer');
            meshes.forEach((mesh, i) => call.mesh(mesh, levels + i * STRUCTS.mesh.size));
            call.do(
                'bvx_write_mesh',
                levels,
                BigInt(meshes.length),
                call.options('write_options', options),
                choiceOf('writeLevels', 'format', 'format_', format),
                file,
            );
            return call.bufferOut(file);
        });
    }
}

export const load = options => loadAs(Files, options);
