// labels.js - the package's third part: the surfaces between all labels of a volume, in a module of their own.

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
}

export const load = options => loadAs(Labels, options);
