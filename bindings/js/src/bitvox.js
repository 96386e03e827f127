// bitvox.js - the package: typed arrays in, typed arrays out, the C library between them.

const LATTICE_OPTIONS = ['lattice', 'resolution', 'axisResolution', 'spacing', 'padding'];

const without = (given, names) =>
    Object.fromEntries(Object.entries(given).filter(([name]) => !names.includes(name)));

// ---- The package ----

class Bitvox extends Library {
    // ---- Questions ----

    check(mesh, options = {}) {
        return this._call('check', options, (call, machine) => {
            const certificate = call.struct('certificate');
            call.do('bvx_mesh_check', call.view(mesh), options.weld ? 1 : 0, certificate);
            return machine.read('certificate', certificate);
        });
    }

    crossings(mesh, options = {}) {
        return this._call('crossings', options, (call, machine) => {
            const count = call.block(8),
                view = call.view(mesh);
            call.do('bvx_mesh_crossings', view, count, 0, 0n);
            const found = machine.get('u64', count);
            if (!options.pairs) return { count: found };
            const pairs = call.block(found * 8);
            call.do('bvx_mesh_crossings', view, count, pairs, BigInt(found));
            return { count: found, pairs: call.array(Uint32Array, pairs, found * 2) };
        });
    }

    distance(a, b, options = {}) {
        return this._call('distance', options, (call, machine) => {
            const report = call.struct('distance_report');
            const samples = numberOf('distance', 'samples', 'u64', options.samples ?? 100000),
                seed = numberOf('distance', 'seed', 'u64', options.seed ?? 1);
            call.do(
                'bvx_mesh_distance',
                call.view(a, 'the first mesh'),
                call.view(b, 'the second mesh'),
                BigInt(samples),
                BigInt(seed),
                report,
            );
            return machine.read('distance_report', report);
        });
    }

    hash(meshOrGrid, options = {}) {
        return this._call('hash', options, (call, machine) => {
            const hash = call.block(8);
            if (meshOrGrid?.words) call.do('bvx_grid_hash', call.grid(meshOrGrid), hash);
            else {
                const mesh = call.mesh(meshOrGrid);
                if (meshOrGrid.frame) call.put('mesh', mesh, 'frame', meshOrGrid.frame);
                call.do('bvx_mesh_hash', mesh, hash);
            }
            return machine.words.getBigUint64(hash, true).toString(16).padStart(16, '0');
        });
    }

    // ---- Lattices and voxels ----

    fitLattice(mesh, options = {}) {
        return this._call('fitLattice', options, (call, machine) => {
            const lattice = call.struct('lattice');
            const view = mesh?.low && mesh.high ? call.corners(mesh) : call.view(mesh);
            call.do('bvx_lattice_fit_with', view, call.latticeOptions(options), lattice);
            return machine.read('lattice', lattice);
        });
    }

    voxelize(mesh, options = {}) {
        return this._call('voxelize', options, (call, machine) => {
            const view = call.view(mesh);
            const report = call.struct('solid_report'),
                grid = call.result('grid');
            const given = call.options('voxelize_options', without(options, LATTICE_OPTIONS), {
                second: (second, at) =>
                    machine.setField('voxelize_options', at, 'second', call.view(second, 'the second mesh')),
            });
            machine.setField('voxelize_options', given, 'report', report);
            call.do('bvx_voxelize_solid', view, call.latticeFor(view, options), given, grid);
            return { grid: call.gridOut(grid), report: machine.read('solid_report', report) };
        });
    }

    voxelizeSurface(mesh, options = {}) {
        return this._call('voxelizeSurface', options, (call, machine) => {
            const view = call.view(mesh);
            const report = call.struct('surface_report'),
                grid = call.result('grid');
            const given = call.options('surface_options', without(options, LATTICE_OPTIONS));
            machine.setField('surface_options', given, 'report', report);
            call.do('bvx_voxelize_surface', view, call.latticeFor(view, options), given, grid);
            return { grid: call.gridOut(grid), report: machine.read('surface_report', report) };
        });
    }

    extractSurface(grid, options = {}) {
        return this.#extract('extractSurface', 'bvx_extract_surface', 'extract_options', grid, options);
    }

    extractFaces(grid, options = {}) {
        return this.#extract('extractFaces', 'bvx_extract_faces', 'faces_options', grid, options);
    }

    #extract(name, called, struct, grid, options) {
        return this._call(name, options, call => {
            const mesh = call.result('mesh');
            call.do(called, call.grid(grid), call.options(struct, options), mesh);
            return call.meshOut(mesh);
        });
    }

    // ---- Sets of voxels ----

    count(grid, options = {}) {
        return this._call('count', options, (call, machine) => {
            const count = call.block(8);
            call.do('bvx_grid_count', call.grid(grid), count);
            return machine.get('u64', count);
        });
    }

    #combine(name, operation, a, b, options) {
        return this._call(name, options, call => {
            const made = call.result('grid');
            call.do('bvx_grid_combine', call.grid(a, 'the first grid'), call.grid(b, 'the second grid'), operation, made);
            return call.gridOut(made);
        });
    }

    union(a, b, options = {}) {
        return this.#combine('union', 0, a, b, options);
    }
    intersection(a, b, options = {}) {
        return this.#combine('intersection', 1, a, b, options);
    }
    subtract(a, b, options = {}) {
        return this.#combine('subtract', 2, a, b, options);
    }
    xor(a, b, options = {}) {
        return this.#combine('xor', 3, a, b, options);
    }

    #make(name, options, called, grid, args = () => []) {
        return this._call(name, options, call => {
            const made = call.result('grid');
            call.do(called, call.grid(grid), ...args(call), made);
            return call.gridOut(made);
        });
    }

    complement(grid, options = {}) {
        return this.#make('complement', options, 'bvx_grid_complement', grid);
    }
    crop(grid, window, options = {}) {
        return this.#make('crop', options, 'bvx_grid_crop', grid, call => [call.window(window)]);
    }

    downsample(grid, factor, options = {}) {
        if (typeof factor === 'number') factor = [factor, factor, factor];
        return this.#make('downsample', options, 'bvx_grid_downsample', grid, call => [
            call.list('factor', 'i32', factor),
            choiceOf('downsample', 'rule', 'reduce_', options.rule ?? 'any'),
        ]);
    }

    #morph(name, operation, grid, options) {
        return this.#make(name, options, 'bvx_grid_morph', grid, call => [
            operation,
            call.options(
                'morph_options',
                options.radius !== undefined && options.neighbourhood === undefined
                    ? { ...options, neighbourhood: 1 }
                    : options,
            ),
        ]);
    }

    dilate(grid, options = {}) {
        return this.#morph('dilate', 0, grid, options);
    }
    erode(grid, options = {}) {
        return this.#morph('erode', 1, grid, options);
    }
    open(grid, options = {}) {
        return this.#morph('open', 2, grid, options);
    }
    close(grid, options = {}) {
        return this.#morph('close', 3, grid, options);
    }

    hollow(grid, options = {}) {
        return this._call('hollow', options, (call, machine) => {
            const report = call.struct('hollow_report'),
                made = call.result('grid');
            const given = call.options('hollow_options', options);
            machine.setField('hollow_options', given, 'report', report);
            call.do('bvx_grid_hollow', call.grid(grid), given, made);
            return { grid: call.gridOut(made), report: machine.read('hollow_report', report) };
        });
    }

    distances(grid, options = {}) {
        return this._call('distances', options, call => {
            const { type = 'f32', ...rest } = options;
            const voxels = grid?.size ? grid.size[0] * grid.size[1] * grid.size[2] : 0;
            const at = call.grid(grid);
            if (type !== 'f32' && type !== 'f64')
                refuse('distances', `type is ${JSON.stringify(type)}; there are f32, f64`, 'choice');
            const values = call.block(voxels * SIZES[type]);
            call.do(
                'bvx_grid_distance',
                at,
                call.options('distance_options', rest),
                type === 'f64' ? 2 : 1,
                values,
                BigInt(voxels),
            );
            return call.array(type === 'f64' ? Float64Array : Float32Array, values, voxels);
        });
    }

    // ---- Meshes ----

    repair(mesh, options = {}) {
        return this._call('repair', options, (call, machine) => {
            const report = call.struct('repair_report'),
                made = call.result('mesh');
            const given = call.options('repair_options', options, {
                lattice: (lattice, at) =>
                    machine.setField('repair_options', at, 'lattice', call.lattice(lattice)),
            });
            machine.setField('repair_options', given, 'report', report);
            call.do('bvx_repair', call.view(mesh), given, made);
            return { mesh: call.meshOut(made), report: machine.read('repair_report', report) };
        });
    }

    boolean(a, b, operation, options = {}) {
        return this._call('boolean', options, (call, machine) => {
            const report = call.struct('boolean_report'),
                made = call.result('mesh');
            const given = call.options('boolean_options', options, {
                lattice: (lattice, at) =>
                    machine.setField('boolean_options', at, 'lattice', call.lattice(lattice)),
            });
            machine.setField('boolean_options', given, 'report', report);
            call.do(
                'bvx_boolean',
                call.view(a, 'the first mesh'),
                call.view(b, 'the second mesh'),
                choiceOf('boolean', 'operation', 'boolean_', operation),
                given,
                made,
            );
            return { mesh: call.meshOut(made), report: machine.read('boolean_report', report) };
        });
    }

    buildLevels(mesh, options = {}) {
        return chainOf(this, 'buildLevels', 'bvx_build_levels', 'levels_options', 'levels_report', mesh, options);
    }
    simplify(mesh, options = {}) {
        return chainOf(this, 'simplify', 'bvx_mesh_simplify', 'simplify_options', null, mesh, options);
    }

    buildLods(solid, options = {}) {
        const { resolutions, targetTriangles, ...rest } = options;
        return this._call('buildLods', options, (call, machine) => {
            const targets = resolutions ?? targetTriangles;
            if (!targets?.length || (resolutions && targetTriangles))
                refuse('buildLods', 'needs resolutions or targetTriangles, one number a level');
            const levels = targets.length;
            const reports = call.struct('lod_report', levels),
                made = call.result('mesh', levels);
            const given = call.options('lod_options', rest);
            if (resolutions)
                machine.setField(
                    'lod_options',
                    given,
                    'resolutions',
                    call.list('resolutions', 'i32', resolutions),
                );
            else
                machine.setField(
                    'lod_options',
                    given,
                    'targetTriangles',
                    call.list('targetTriangles', 'u64', targetTriangles),
                );
            machine.setField('lod_options', given, 'reports', reports);
            call.do('bvx_build_lods', call.grid(solid), given, BigInt(levels), made);
            return {
                levels: Array.from({ length: levels }, (_, i) => ({
                    mesh: call.meshOut(made + i * STRUCTS.mesh.size),
                    report: machine.read('lod_report', reports + i * STRUCTS.lod_report.size),
                })),
            };
        });
    }
}

export const load = options => loadAs(Bitvox, options);

/** Is voxel (x, y, z) of the grid's window set? */
export function gridGet(grid, x, y, z) {
    const row = ((grid.size[0] + 63) >> 6) * 2;
    return ((grid.words[(z * grid.size[1] + y) * row + (x >> 5)] >>> (x & 31)) & 1) === 1;
}

/** Set or clear voxel (x, y, z) of the grid's window. */
export function gridSet(grid, x, y, z, value = true) {
    const row = ((grid.size[0] + 63) >> 6) * 2;
    const at = (z * grid.size[1] + y) * row + (x >> 5);
    grid.words[at] = value ? grid.words[at] | (1 << (x & 31)) : grid.words[at] & ~(1 << (x & 31));
}

/** An empty grid of a lattice, or of a window of it. */
export function makeGrid(lattice, window = { low: [0, 0, 0], size: lattice.dims }) {
    const [nx, ny, nz] = window.size;
    return {
        lattice,
        low: [...window.low],
        size: [...window.size],
        words: new Uint32Array(2 * ((nx + 63) >> 6) * ny * nz),
    };
}
