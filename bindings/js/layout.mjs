// layout.mjs - reads the headers: the layout of each struct in WebAssembly's 32-bit memory, and the names of choices.
//
// A field is [name, type, offset, count]; type is i32, u32, i64, u64, f32, f64, u8, ptr or the name of a struct. Choices of a field
// follow from its comment: "BVX_FILL_..."; "1: ..." is a yes or no.

const SIZES = { i32: 4, u32: 4, i64: 8, u64: 8, f32: 4, f64: 8, u8: 1, ptr: 4 };
const TYPES = {
    int32_t: 'i32',
    uint32_t: 'u32',
    int64_t: 'i64',
    uint64_t: 'u64',
    float: 'f32',
    double: 'f64',
    uint8_t: 'u8',
    size_t: 'u32',
    bvx_status: 'i32',
};

const camel = name => name.replace(/_([a-z0-9])/g, (_, letter) => letter.toUpperCase());
const choiceName = (constant, prefix) => constant.slice(prefix.length).toLowerCase().replace(/_/g, '-');

/** Choices by prefix: { BVX_FILL_: { parity: 0, ... } }. Lists win over enumerations. */
function readChoices(header) {
    const choices = {};

    for (const [, name, body] of header.matchAll(/#define (BVX_[A-Z]+)_LIST\(X\)((?:.*\\\n)*.*\n)/g)) {
        const prefix = name + '_';
        choices[prefix] = {};
        for (const [, constant, value, text] of body.matchAll(/X\((BVX_[A-Z0-9_]+), (\d+),[\s\\]*"([^"]*)"\)/g)) {
            const named =
                prefix === 'BVX_STATUS_'
                    ? constant.replace(/^BVX_(ERR_)?/, '').toLowerCase()
                    : prefix === 'BVX_REASON_'
                      ? choiceName(constant, prefix)
                      : text;
            choices[prefix][named] = Number(value);
        }
    }

    for (const [, body] of header.matchAll(/^enum \{((?:[^#}]|\n)*)\}/gm)) {
        const constants = [...body.replace(/\/\*[^]*?\*\//g, '').matchAll(/(BVX_[A-Z0-9_]+) = (\d+)/g)];
        if (constants.length < 2) continue;
        let shared = constants[0][1];
        for (const [, constant] of constants)
            while (!constant.startsWith(shared)) shared = shared.slice(0, -1);
        const prefix = shared.slice(0, shared.lastIndexOf('_') + 1);
        if (prefix === 'BVX_' || choices[prefix]) continue;
        choices[prefix] = Object.fromEntries(
            constants.map(([, constant, value]) => [choiceName(constant, prefix), Number(value)]),
        );
    }

    choices.BVX_POSITION_ = { auto: 0, f32: 1, f64: 2 };
    return choices;
}

/** What a field's comment says about its values: the prefix of its choices, "yes" or nothing. */
function meaningOf(name, comment, choices) {
    if (name === 'position_type') return 'BVX_POSITION_';
    if (name === 'error_kind') return 'BVX_ERROR_';
    if (name === 'local_frame') return 'yes';
    if (name === 'drain_side') return 'BVX_SIDE_';
    if (name === 'open_sides' || name === 'lost' || /^\s*BVX_(FEW|KEPT)_/.test(comment)) return undefined; // bits
    // "BVX_OK: ..." says when the field is set, not what it holds.
    const condition = comment.match(/^\s*BVX_[A-Z0-9_]*[A-Z0-9](?: without [^:]*)?: (1\b)?/);
    if (condition) return condition[1] ? 'yes' : undefined;
    const constant =
        comment.match(/^\s*(?:[^.([]*?: )?(BVX_[A-Z0-9_]+)/)?.[1] ??
        comment.match(/BVX_[A-Z]+_\.\.\./)?.[0].slice(0, -3);
    const prefix =
        constant &&
        Object.keys(choices)
            .filter(p => constant.startsWith(p))
            .sort((a, b) => b.length - a.length)[0];
    if (prefix) return prefix;
    return /^\s*1: /.test(comment) ? 'yes' : undefined;
}

/** All structs of the header: { name: { size, align, fields: [[name, type, offset, count, meaning]] } }. */
export function readHeader(header) {
    const choices = readChoices(header);
    const structs = {};

    for (const [, name, body] of header.matchAll(/^(?:typedef )?struct (bvx_[a-z_]+) \{\n([^]*?)^\}(?: \1)?;/gm)) {
        const fields = [];
        let offset = 0,
            align = 1;

        for (const [, declaration, comment] of body.matchAll(
            /^ {4}([a-z][^;]*);(?:\s*\/\*\*<([^]*?)\*\/)?/gm,
        )) {
            const [, type, names] = declaration.match(/^((?:const )?(?:struct )?\w+)\s+(.*)$/s);
            for (const part of names.split(',').map(text => text.trim())) {
                const [, star, field, counts] = part.match(/^((?:\*|const )*)(\w+)((?:\[\d+\])*)$/);
                const plain = type.replace(/^const |^struct /g, '');
                const kind = star ? 'ptr' : (TYPES[plain] ?? plain);
                const known = SIZES[kind]
                    ? { size: SIZES[kind], align: SIZES[kind] }
                    : (structs[kind] ?? { size: 4, align: 4, pointer: true }); // a callback is a pointer
                const count = [...counts.matchAll(/\d+/g)].reduce(
                    (product, [digits]) => product * Number(digits),
                    1,
                );

                offset = Math.ceil(offset / known.align) * known.align;
                fields.push([
                    field,
                    known.pointer ? 'ptr' : kind,
                    offset,
                    counts ? count : 0,
                    meaningOf(field, comment ?? '', choices),
                ]);
                offset += known.size * count;
                align = Math.max(align, known.align);
            }
        }
        structs[name] = { size: Math.ceil(offset / align) * align, align, fields };
    }
    return { structs, choices };
}

/** Assertions with which the C compiler confirms all of it. */
export function layoutHeader({ structs }) {
    const lines = [
        '/* layout.h - made by build.mjs: the layouts that the package uses are those of the compiler. */',
    ];
    for (const [name, { size, fields }] of Object.entries(structs)) {
        lines.push(`_Static_assert(sizeof(${name}) == ${size}, "${name}");`);
        for (const [field, , offset] of fields)
            lines.push(`_Static_assert(offsetof(${name}, ${field}) == ${offset}, "${name}.${field}");`);
    }
    return lines.join('\n') + '\n';
}

/** What the package carries: structs of these names and those within them, fields by their JavaScript names. */
export function layoutTable({ structs, choices }, wanted) {
    const kept = {},
        used = {};
    const keep = name => {
        if (kept[name] || !structs[name]) return;
        const fields = {};
        // Fields of the structs that options share are options themselves; a box has its corners' names.
        const flat = structs[name].fields.flatMap(field =>
            field[1] === 'bvx_box' || (/_options$/.test(name) && /^bvx_(fit|placing|parts|targets|collapse|sampling)$/.test(field[1]))
                ? structs[field[1]].fields.map(([inner, type, offset, ...rest]) => [inner, type, field[2] + offset, ...rest])
                : [field],
        );
        for (const [field, type, offset, count, meaning] of flat) {
            if (field.startsWith('reserved')) continue;
            keep(type);
            const row = [type.replace(/^bvx_/, ''), offset, count];
            if (meaning && type === 'i32') row.push(meaning.replace(/^BVX_/, '').toLowerCase());
            if (meaning && meaning !== 'yes' && !choices[meaning])
                throw new Error(`${name}.${field}: no choices ${meaning}`);
            if (meaning && meaning !== 'yes') used[meaning] = true;
            fields[camel(field)] = row;
        }
        kept[name] = { size: structs[name].size, fields };
    };
    for (const name of wanted) keep(name);

    const strip = (object, from) =>
        Object.fromEntries(
            Object.entries(object).map(([key, value]) => [key.replace(/^(bvx_|BVX_)/, ''), value]),
        );
    for (const prefix of [
        'BVX_STATUS_',
        'BVX_REASON_',
        'BVX_FORMAT_',
        'BVX_BOOLEAN_',
        'BVX_DISTANCE_',
        'BVX_REDUCE_',
        'BVX_POSITION_',
        'BVX_FILL_',
        'BVX_SURFACE_',
    ])
        used[prefix] = true;
    const lower = Object.fromEntries(
        Object.keys(choices)
            .filter(prefix => used[prefix])
            .map(prefix => [prefix.replace(/^BVX_/, '').toLowerCase(), choices[prefix]]),
    );
    return { structs: strip(kept), choices: lower };
}
