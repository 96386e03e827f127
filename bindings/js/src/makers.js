// makers.js - the package's fourth part: hulls, mass, and whether a mesh can be made, in a module of their own.

class Makers extends Library {
    hull(mesh, options = {}) {
        const { targetTriangles, targetErrors } = options;
        const all = { count: (targetTriangles ?? targetErrors ?? { length: 1 }).length, ...options };
        return chainOf(this, 'hull', 'bvx_hull', 'hull_options', 'hull_report', mesh, all);
    }

    measure(mesh, options = {}) {
        return this._call('measure', options, (call, machine) => {
            const report = call.struct('measure_report');
            call.do('bvx_measure', call.view(mesh), call.options('measure_options', options), report);
            return machine.read('measure_report', report);
        });
    }

    inspect(mesh, options = {}) {
        const { thickness: wanted = false, most = 8, ...rest } = options;
        return this._call('inspect', options, (call, machine) => {
            const report = call.struct('inspect_report'),
                view = call.view(mesh);
            const given = call.options('inspect_options', { ...rest, most }, {
                lattice: (lattice, at) => machine.setField('inspect_options', at, 'lattice', call.lattice(lattice)),
            });
            const vertices = wanted ? machine.field('mesh_view', view, 'vertexCount') : 0;
            const thickness = call.block(8 * vertices);
            // The library takes 0 as 8, and refuses what is out of range before it writes.
            const room = most >= 1 && most <= 2 ** 20 ? most : 8;
            const places = call.struct('finding', 4 * room);
            machine.setField('inspect_options', given, 'findings', places);
            if (wanted) machine.setField('inspect_options', given, 'thickness', thickness);
            call.do('bvx_inspect', view, given, report);

            const read = machine.read('inspect_report', report);
            const [walls, gaps, cavities, islands] = read.found.map((found, kind) =>
                Array.from({ length: Math.min(found, room) }, (_, i) =>
                    machine.read('finding', places + (kind * room + i) * STRUCTS.finding.size),
                ),
            );
            const made = { sound: read.needs === 'nothing', walls, gaps, cavities, islands, report: read };
            return wanted ? { ...made, thickness: call.array(Float64Array, thickness, vertices) } : made;
        });
    }
}

export const load = options => loadAs(Makers, options);
