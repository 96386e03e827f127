// labels.js - the package's third part: labels of voxels from a mesh, and the surfaces between all labels of a volume, in a module of their own.

const SAMPLES = {
    u8: [Uint8Array, Uint8ClampedArray],
    i8: [Int8Array],
    u16: [Uint16Array],
    i16: [Int16Array],
    u32: [Uint32Array],
    i32: [Int32Array],
    u64: [BigUint64Array],
    i64: [BigInt64Array],
};

class Labels extends Library {
    #volume(call, volume) {
        const { samples, size } = volume ?? {};
        const type = Object.keys(SAMPLES).find(name => SAMPLES[name].some(Type => samples instanceof Type));
        if (!type) refuse(call.name, 'samples of the volume must be a typed array of whole numbers');
        if (size?.length !== 3) refuse(call.name, `size of the volume has ${size?.length} numbers; it needs 3`);
        const needed = size[0] * size[1] * size[2];
        if (samples.length !== needed)
            refuse(call.name, `samples of the volume are ${samples.length} numbers; its size needs ${needed}`);

        const at = call.struct('volume_view');
        const { lattice = { origin: [0, 0, 0], spacing: [1, 1, 1], dims: size }, low = [0, 0, 0] } = volume;
        call.machine.setField('volume_view', at, 'samples', call.copy(samples));
        call.put('volume_view', at, 'sampleType', type);
        call.put('volume_view', at, 'low', low);
        call.put('volume_view', at, 'size', size);
        call.lattice(lattice, at + STRUCTS.volume_view.fields.lattice[1]);
        return at;
    }

    labelSurfaces(volume, options = {}) {
        return this._call('labelSurfaces', options, (call, machine) => {
            const complex = call.result('complex'),
                body = call.result('mesh');
            call.do('bvx_label_surfaces', this.#volume(call, volume), call.options('labels_options', options), complex);
            const get = name => machine.field('complex', complex, name);
            const wide = { u64: BigUint64Array, i64: BigInt64Array };
            const Value = Object.values(wide).find(Type => volume.samples instanceof Type);

            const labels = Array.from({ length: get('labelCount') }, (_, i) => {
                const at = get('labels') + i * STRUCTS.label.size;
                const { value, ...label } = machine.read('label', at);
                call.do('bvx_label_mesh', complex, BigInt(i), body);
                return { value: Value ? call.array(Value, at, 1)[0] : value, ...label, mesh: call.meshOut(body) };
            });

            // Two labels a triangle; two triangles are one face before they become fewer.
            const mesh = call.meshOut(complex + STRUCTS.complex.fields.mesh[1]);
            const sides = call.array(Uint32Array, get('sides'), get('faceCount') * 2);
            const each = get('single') ? 1 : 2;
            mesh.sides = Uint32Array.from({ length: get('faceCount') * 2 * each }, (_, i) =>
                sides[2 * Math.floor(i / 2 / each) + (i % 2)],
            );
            return { labels, complex: mesh };
        });
    }

    labelVoxels(mesh, grid, options = {}) {
        return this._call('labelVoxels', options, (call, machine) => {
            const source = call.mesh(mesh),
                given = call.grid(grid),
                colours = mesh.materialColours;
            if (colours !== undefined) {
                if (!(colours instanceof Uint8Array && colours.length % 4 === 0))
                    refuse('labelVoxels', 'materialColours of the mesh must be a Uint8Array of four numbers a material');
                const assets = call.struct('assets');
                machine.setField('assets', assets, 'baseColours', call.copy(colours));
                machine.setField('assets', assets, 'materialCount', colours.length / 4);
                machine.setField('mesh', source, 'assets', assets);
            }
            const count = grid.size[0] * grid.size[1] * grid.size[2];
            const labels = call.block(count),
                palette = call.block(1024);
            call.do('bvx_label_voxels', source, given, labels, palette);
            return { labels: call.array(Uint8Array, labels, count), palette: call.array(Uint8Array, palette, 1024) };
        });
    }
}

export const load = options => loadAs(Labels, options);
