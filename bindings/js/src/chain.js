// chain.js - levels of one call: their targets in, meshes and reports out; for the modules that have such a call.

function chainOf(library, name, called, struct, whole, mesh, options) {
    const { count, targetTriangles, targetErrors, locked, ...rest } = options;
    return library._call(name, options, (call, machine) => {
        for (const [what, list] of Object.entries({ targetTriangles, targetErrors })) {
            if (list !== undefined && !(Array.isArray(list) || ArrayBuffer.isView(list)))
                refuse(name, `${what} must be an array, one number a level`);
            if (list && (targetTriangles ?? list).length !== list.length)
                refuse(name, 'targetTriangles and targetErrors must be of one length');
        }
        const levels = numberOf(
            name,
            'count',
            'u32',
            count ?? (targetTriangles ?? targetErrors ?? { length: 4 }).length,
        );
        if ((targetTriangles ?? targetErrors ?? { length: levels }).length !== levels)
            refuse(name, `count is ${levels}, and there are not as many targets`);
        const reports = call.struct('level_report', levels),
            made = call.result('mesh', levels);
        const chain = whole ? call.struct(whole) : 0;
        const set = (field, value) => machine.setField(struct, given, field, value);
        const given = call.options(
            struct,
            rest,
            whole
                ? {
                      lattice: (lattice, at) =>
                          machine.setField(struct, at, 'lattice', call.lattice(lattice)),
                  }
                : {},
        );

        if (targetTriangles) set('triangles', call.list('targetTriangles', 'u64', targetTriangles));
        if (targetErrors) set('errors', call.list('targetErrors', 'f64', targetErrors));
        if (locked) {
            const vertices = (mesh.positions ?? mesh.attributes?.position.array)?.length / 3;
            if (locked.length !== vertices)
                refuse(name, `locked has ${locked.length} values, the mesh ${vertices} vertices`);
            set('locked', call.list('locked', 'u8', locked));
        }
        set('reports', reports);
        if (chain) set('report', chain);
        call.do(called, call.view(mesh), given, BigInt(levels), made);

        const out = {
            levels: Array.from({ length: levels }, (_, i) => ({
                mesh: call.meshOut(made + i * STRUCTS.mesh.size),
                report: machine.read('level_report', reports + i * STRUCTS.level_report.size),
            })),
        };
        if (chain) out.report = machine.read(whole, chain);
        return out;
    });
}
