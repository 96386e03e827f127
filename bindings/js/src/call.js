// call.js - one call of the library: its context, its arguments in the module's memory, its results copied out.
//
// All that a call takes is freed at its end, whatever happened.

const CALL_OPTIONS = new Set(['progress', 'signal', 'memoryLimit']);

/** One call: its context, and all that is to be freed after it. */
class Call {
    constructor(machine, name, { progress, signal, memoryLimit = 0 }, limit) {
        this.machine = machine;
        this.c = machine.c;
        this.name = name;
        this.blocks = [];
        this.ends = [];
        if (progress !== undefined && typeof progress !== 'function')
            refuse(name, `progress is ${typeof progress}, not a function`);
        this.listener = { progress, signal };
        this.limit = numberOf(name, 'memoryLimit', 'u64', memoryLimit) || limit;
    }

    begin() {
        const { c, machine } = this;
        const options = this.struct('context_options');
        machine.setField('context_options', options, 'structSize', STRUCTS.context_options.size);
        machine.setField('context_options', options, 'memoryLimit', this.limit);
        if (this.listener.progress || this.listener.signal)
            machine.setField('context_options', options, 'progress', c.bridge_progress());
        const place = this.block(4);
        const status = c.bvx_context_create_version(c.bvx_version(), options, place);
        if (status !== 0) {
            const fault = c.bvx_context_fault(c.bvx_version(), options) || c.bvx_status_text(status);
            throw new BitvoxError(`${this.name}: no context: ${machine.text(fault)}`, {
                status: NAMES.status_[status],
                function: this.name,
            });
        }
        this.context = machine.get('u32', place);
    }

    end() {
        for (const free of this.ends.reverse()) free();
        if (this.context) {
            this.machine.peak = Number(this.c.bvx_memory_peak(this.context));
            this.c.bvx_context_destroy(this.context);
        }
        for (const block of this.blocks.reverse()) this.c.free(block);
    }

    /** Zeroed memory until the end of the call. */
    block(size) {
        const at = this.c.malloc(Math.max(size, 1)) >>> 0;
        if (at === 0)
            throw new BitvoxError(`${this.name}: ${size} bytes do not fit the module's memory`, {
                status: 'memory',
                reason: 'memory',
                function: this.name,
            });
        this.blocks.push(at);
        this.machine.bytes.fill(0, at, at + size);
        return at;
    }

    copy(array) {
        const at = this.c.malloc(Math.max(array.byteLength, 1)) >>> 0;
        if (at === 0)
            throw new BitvoxError(
                `${this.name}: ${array.byteLength} bytes of arguments do not fit the module's memory`,
                { status: 'memory', reason: 'memory', function: this.name },
            );
        this.blocks.push(at);
        this.machine.bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), at);
        return at;
    }

    struct(name, count = 1) {
        return this.block(STRUCTS[name].size * count);
    }

    /** A struct that the library fills, freed by its function. */
    result(name, count = 1, free = `bvx_${name}_free`) {
        const at = this.struct(name, count);
        this.ends.push(() => {
            for (let i = 0; i < count; i++) this.c[free](this.context, at + i * STRUCTS[name].size);
        });
        return at;
    }

    /** Calls a function of the library, and throws what it refuses. */
    do(name, ...args) {
        const { machine } = this;
        const before = machine.listener;
        let status;

        machine.listener = this.listener;
        machine.thrown = undefined;
        try {
            status = this.c[name](this.context, ...args);
        } catch (error) {
            machine.broken = true; // a trap: memory may be in any state
            throw error;
        } finally {
            machine.listener = before;
        }

        const { thrown } = machine;
        machine.thrown = undefined;
        if (thrown) throw thrown.error;
        if (status !== 0) throw this.error(status);
    }

    error(status) {
        const { machine } = this;
        const at = this.c.bvx_last_error(this.context) >>> 0;
        const found = machine.read('error', at);
        return new BitvoxError(machine.text(machine.field('error', at, 'message')), {
            status: NAMES.status_[status],
            reason: found.reason,
            function: machine.text(machine.field('error', at, 'function')),
            index: found.index,
            values: found.value.slice(0, found.valueCount),
        });
    }

    /** An options struct: the library's defaults, then what was given. special: fields that are no plain numbers. */
    options(struct, given, special = {}) {
        const { machine } = this;
        const { fields, size } = STRUCTS[struct];
        const at = this.struct(struct);
        const known = Object.keys(fields).filter(
            name =>
                name !== 'structSize' &&
                name !== 'report' &&
                name !== 'reports' &&
                (fields[name][0] !== 'ptr' || special[name]),
        );

        machine.setField(struct, at, 'structSize', size);
        for (const [name, value] of Object.entries(given)) {
            if (value === undefined || CALL_OPTIONS.has(name)) continue;
            if (!known.includes(name) && !special[name])
                refuse(
                    this.name,
                    `there is no option ${name}; there are ${[...new Set([...known, ...Object.keys(special)]), ...CALL_OPTIONS].join(', ')}`,
                    'options',
                );
            if (special[name]) special[name](value, at);
            else this.put(struct, at, name, value);
        }
        return at;
    }

    put(struct, at, name, value) {
        const { machine } = this;
        const [type, offset, count, meaning] = STRUCTS[struct].fields[name];
        if (STRUCTS[type]) {
            for (const [part, inner] of Object.entries(value)) {
                if (!STRUCTS[type].fields[part]) refuse(this.name, `there is no ${name}.${part}`);
                this.put(type, at + offset, part, inner);
            }
        } else if (count) {
            if (value?.length !== count)
                refuse(this.name, `${name} has ${value?.length} numbers; it needs ${count}`);
            for (let i = 0; i < count; i++)
                machine.set(
                    type,
                    at + offset + i * SIZES[type],
                    numberOf(this.name, `${name}[${i}]`, type, value[i]),
                );
        } else if (meaning && meaning !== 'yes')
            machine.set(type, at + offset, choiceOf(this.name, name, meaning, value));
        else machine.set(type, at + offset, numberOf(this.name, name, type, value));
    }

    /** Numbers of the caller's as an array of the library's. */
    list(what, type, values) {
        const numbers = Array.from(values, (value, i) => numberOf(this.name, `${what}[${i}]`, type, value));
        return this.copy(ARRAYS[type].from(type === 'u64' ? numbers.map(BigInt) : numbers));
    }

    // ---- Meshes ----

    /** A mesh of the caller's in the module's memory: arrays and their types. */
    meshArrays(mesh, what) {
        const { name } = this;
        if (mesh?.attributes?.position)
            mesh = { positions: mesh.attributes.position.array, triangles: mesh.index?.array }; // three.js
        let { positions, triangles } = mesh ?? {};
        if (positions === undefined) refuse(name, `${what} has no positions`, 'null');
        if (Array.isArray(positions)) positions = Float64Array.from(positions);
        if (!(positions instanceof Float32Array || positions instanceof Float64Array))
            refuse(
                name,
                `positions of ${what} must be a Float32Array, a Float64Array or an array of numbers`,
            );
        if (positions.length % 3 !== 0)
            refuse(name, `positions of ${what} are ${positions.length} numbers, not three a vertex`);
        if (Array.isArray(triangles))
            triangles.forEach((value, i) => numberOf(name, `triangles[${i}]`, 'u32', value));
        if (Array.isArray(triangles) || triangles instanceof Int32Array)
            triangles = Uint32Array.from(triangles);
        if (triangles && !(triangles instanceof Uint32Array || triangles instanceof Uint16Array))
            refuse(name, `triangles of ${what} must be a Uint32Array, a Uint16Array or an array of numbers`);
        if ((triangles ?? positions).length % (triangles ? 3 : 9) !== 0)
            refuse(
                name,
                triangles
                    ? `triangles of ${what} are ${triangles.length} numbers, not three a triangle`
                    : `${what} has no triangles, and its ${positions.length / 3} vertices are not three a triangle`,
            );
        return {
            positions,
            triangles,
            doubles: positions instanceof Float64Array,
            ...this.attributes(mesh, what, positions.length / 3, (triangles ?? positions).length / 3),
        };
    }

    /** What a mesh has by vertex and by triangle, as the library takes it. */
    attributes({ colours, normals, uvs, uvTriangles, uvs2, materials }, what, vertices, triangles) {
        const given = { colours, normals, uvs, uvTriangles, uvs2, materials };
        for (const [name, value] of Object.entries(given)) {
            if (value === undefined || value === null) {
                delete given[name];
                continue;
            }
            const [type, count, text] = {
                colours: [Uint8Array, vertices * 4, 'four numbers a vertex'],
                normals: [Float32Array, vertices * 3, 'three numbers a vertex'],
                uvs: [Float32Array, uvTriangles ? value.length : vertices * 2, 'two numbers a vertex'],
                uvTriangles: [Uint32Array, triangles * 3, 'three numbers a triangle'],
                uvs2: [Float32Array, vertices * 2, 'two numbers a vertex'],
                materials: [Uint32Array, triangles, 'one number a triangle'],
            }[name];
            const fits =
                value instanceof type ||
                (name === 'colours' && ArrayBuffer.isView(value) && value.BYTES_PER_ELEMENT === 1);
            if (!fits || value.length !== count)
                refuse(this.name, `${name} of ${what} must be a ${type.name} of ${text}`);
        }
        if (given.uvTriangles && !given.uvs)
            refuse(this.name, `uvTriangles of ${what} are indices into uvs, which are missing`);
        return given;
    }

    view(mesh, what = 'the mesh') {
        const { machine } = this;
        const { positions, triangles, doubles, uvTriangles, ...attributes } = this.meshArrays(mesh, what);
        const at = this.struct('mesh_view');
        const set = (name, value) => machine.setField('mesh_view', at, name, value);

        set('positions', this.copy(positions));
        if (triangles) set('indices', this.copy(triangles));
        set('vertexCount', positions.length / 3);
        set('triangleCount', (triangles ? triangles.length : positions.length / 3) / 3);
        set('positionType', doubles ? 2 : 1);
        set('indexType', triangles instanceof Uint16Array ? 1 : 2);
        for (const [name, values] of Object.entries(attributes)) set(name, this.copy(values));
        if (uvTriangles) set('uvIndices', this.copy(uvTriangles));
        if (attributes.uvs) set('uvCount', Math.floor(attributes.uvs.length / 2));
        return at;
    }

    /** The corners of a box, as a cloud of two points. */
    corners({ low, high }) {
        const at = this.struct('mesh_view');
        const set = (name, value) => this.machine.setField('mesh_view', at, name, value);

        set('positions', this.list('low and high', 'f64', [...low, ...high]));
        set('vertexCount', 2);
        set('positionType', 2);
        return at;
    }

    /** The struct that writers take. */
    mesh(mesh, at = this.struct('mesh')) {
        const { machine } = this;
        let { positions, triangles, doubles, ...attributes } = this.meshArrays(mesh, 'the mesh');
        if (!triangles) triangles = Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
        if (triangles instanceof Uint16Array) triangles = Uint32Array.from(triangles);
        const set = (name, value) => machine.setField('mesh', at, name, value);

        set('positions', this.copy(positions));
        set('triangles', this.copy(triangles));
        for (const name of ['vertexCount', 'vertexCapacity']) set(name, positions.length / 3);
        for (const name of ['triangleCount', 'triangleCapacity']) set(name, triangles.length / 3);
        set('positionType', doubles ? 2 : 1);
        for (const [name, values] of Object.entries(attributes)) set(name, this.copy(values));
        if (attributes.uvs) set('uvCount', Math.floor(attributes.uvs.length / 2));
        return at;
    }

    array(Type, at, count) {
        return count === 0
            ? new Type(0)
            : new Type(this.machine.bytes.slice(at, at + count * Type.BYTES_PER_ELEMENT).buffer);
    }

    meshOut(at) {
        const { machine } = this;
        const get = name => machine.field('mesh', at, name);
        const doubles = get('positionType') === 2;
        const made = {
            positions: this.array(
                doubles ? Float64Array : Float32Array,
                get('positions'),
                get('vertexCount') * 3,
            ),
            triangles: this.array(Uint32Array, get('triangles'), get('triangleCount') * 3),
        };
        const uvs = get('uvTriangles') ? get('uvCount') : get('vertexCount');
        for (const [name, Type, count] of [
            ['colours', Uint8Array, get('vertexCount') * 4],
            ['normals', Float32Array, get('vertexCount') * 3],
            ['uvs', Float32Array, uvs * 2],
            ['uvTriangles', Uint32Array, get('triangleCount') * 3],
            ['uvs2', Float32Array, get('vertexCount') * 2],
            ['materials', Uint32Array, get('triangleCount')],
        ])
            if (get(name)) made[name] = this.array(Type, get(name), count);
        const frame = machine.read('mesh', at).frame;
        if (frame.some(x => x !== 0)) made.frame = frame;
        return made;
    }

    // ---- Grids ----

    lattice(lattice, at = this.struct('lattice')) {
        const { name } = this;
        if (!lattice?.origin || !lattice.spacing || !lattice.dims)
            refuse(name, 'a lattice has origin, spacing and dims');
        if (lattice.fractionBits === undefined) {
            const parts = [
                this.list('origin', 'f64', lattice.origin),
                this.list('spacing', 'f64', lattice.spacing),
                this.list('dims', 'i32', lattice.dims),
            ];
            this.do('bvx_lattice_make', ...parts, at);
        } else
            for (const field of Object.keys(STRUCTS.lattice.fields))
                this.put('lattice', at, field, lattice[field]);
        return at;
    }

    window(window) {
        if (window === undefined) return 0;
        const at = this.struct('window');
        for (const field of ['low', 'size']) this.put('window', at, field, window[field]);
        return at;
    }

    /** From a lattice that is given, or fitted to the mesh. */
    latticeFor(view, { lattice, resolution, axisResolution, spacing, padding }) {
        const at = this.struct('lattice');
        if (lattice) return this.lattice(lattice, at);
        if (resolution === undefined && axisResolution === undefined && spacing === undefined)
            resolution = 256;
        this.do(
            'bvx_lattice_fit_with',
            view,
            this.latticeOptions({ resolution, axisResolution, spacing, padding }),
            at,
        );
        return at;
    }

    latticeOptions(given) {
        if (typeof given.spacing === 'number')
            given = { ...given, spacing: [given.spacing, given.spacing, given.spacing] };
        return this.options('lattice_options', given);
    }

    grid(grid, what = 'the grid') {
        const { machine, name } = this;
        if (!(grid?.words instanceof Uint32Array) || !grid.lattice || !grid.low || !grid.size)
            refuse(name, `${what} has no lattice, low, size and words`, 'null');
        const at = this.struct('grid');
        this.lattice(grid.lattice, at + STRUCTS.grid.fields.lattice[1]);
        this.put('grid', at, 'low', grid.low);
        this.put('grid', at, 'size', grid.size);
        const row = (grid.size[0] + 63) >> 6;
        const needed = row * grid.size[1] * grid.size[2];
        if (grid.words.length !== 2 * needed)
            refuse(name, `words of ${what} are ${grid.words.length} numbers; its size needs ${2 * needed}`);
        machine.setField('grid', at, 'wordsPerRow', row);
        machine.setField('grid', at, 'words', this.copy(grid.words));
        machine.setField('grid', at, 'wordCapacity', needed);
        return at;
    }

    gridOut(at) {
        const { machine } = this;
        const { lattice, low, size, wordsPerRow } = machine.read('grid', at);
        return {
            lattice,
            low,
            size,
            words: this.array(
                Uint32Array,
                machine.field('grid', at, 'words'),
                2 * wordsPerRow * size[1] * size[2],
            ),
        };
    }

    bytesIn(bytes) {
        if (bytes instanceof ArrayBuffer) bytes = new Uint8Array(bytes);
        if (!ArrayBuffer.isView(bytes))
            refuse(this.name, 'the bytes of a file must be an ArrayBuffer or a typed array', 'null');
        return [this.copy(bytes), BigInt(bytes.byteLength)];
    }

    bufferOut(at) {
        const { machine } = this;
        return this.array(
            Uint8Array,
            machine.field('buffer', at, 'bytes'),
            machine.field('buffer', at, 'size'),
        );
    }
}
