// machine.js - errors, choices and numbers, and the module's memory: structs of the library by the table LAYOUT.
//
// build.mjs puts LAYOUT, the module's bytes, this file, call.js, library.js, chain.js where it is called, and bitvox.js, files.js, labels.js or makers.js one after the other into a module.

const { structs: STRUCTS, choices: CHOICES } = LAYOUT;
const NAMES = Object.fromEntries(
    Object.entries(CHOICES).map(([prefix, values]) => [
        prefix,
        Object.fromEntries(Object.entries(values).map(([name, value]) => [value, name])),
    ]),
);

// ---- Errors ----

/** What a call of the library refused, or that it was cancelled (status "cancelled"). */
export class BitvoxError extends Error {
    constructor(
        message,
        { status = 'argument', reason = 'unspecified', function: name = '', index = -1, values = [] } = {},
    ) {
        super(message);
        this.name = 'BitvoxError';
        this.status = status;
        this.code = CHOICES.status_[status];
        this.reason = reason;
        this.function = name;
        this.index = index;
        this.values = values;
    }

    /** Each module of the package has this class; an error of one is an error of all. */
    static [Symbol.hasInstance](error) {
        return error?.name === 'BitvoxError';
    }
}

const refuse = (name, text, reason) => {
    throw new BitvoxError(`${name}: ${text}`, { function: name, reason });
};

// ---- Choices and numbers ----

function choiceOf(name, what, prefix, value) {
    const found =
        typeof value === 'string' && Object.hasOwn(CHOICES[prefix], value)
            ? CHOICES[prefix][value]
            : undefined;
    if (found === undefined)
        refuse(
            name,
            `${what} is ${JSON.stringify(value)}; there are ${Object.keys(CHOICES[prefix]).join(', ')}`,
            'choice',
        );
    return found;
}

function numberOf(name, what, type, value) {
    if (typeof value === 'boolean' || typeof value === 'bigint') value = Number(value);
    if (typeof value !== 'number')
        refuse(name, `${what} is ${value === null ? 'null' : typeof value}, not a number`);
    const whole = type !== 'f64' && type !== 'f32';
    const [low, high] =
        type === 'i32'
            ? [-2147483648, 2147483647]
            : type === 'u8'
              ? [0, 255]
              : type === 'u32'
                ? [0, 4294967295]
                : [type === 'i64' ? Number.MIN_SAFE_INTEGER : 0, Number.MAX_SAFE_INTEGER];
    if (whole && !(Number.isInteger(value) && value >= low && value <= high)) {
        throw new BitvoxError(
            `${name}: ${what} is ${value}; it must be a whole number from ${low} to ${high}`,
            { status: 'range', function: name },
        );
    }
    return value;
}

// ---- The module's memory ----

/** Calls, and what the module's memory holds for them. */
class Machine {
    constructor(module) {
        this.listener = undefined;
        this.thrown = undefined;
        this.broken = false;
        const nothing = new Proxy({}, { get: () => () => 0 });
        this.instance = new WebAssembly.Instance(module, {
            bitvox: { report: (stage, fraction) => this.report(stage, fraction) },
            env: nothing,
            wasi_snapshot_preview1: nothing,
        });
        this.c = this.instance.exports;
        this.c._initialize?.();
    }

    get bytes() {
        const { buffer } = this.c.memory;
        if (this.held !== buffer)
            [this.held, this.view, this.data] = [buffer, new Uint8Array(buffer), new DataView(buffer)];
        return this.view;
    }

    get words() {
        return this.bytes && this.data;
    }

    text(pointer) {
        pointer >>>= 0;
        const { bytes } = this;
        return new TextDecoder().decode(bytes.slice(pointer, bytes.indexOf(0, pointer)));
    }

    /** Nothing may leave the module by an exception: it is kept, the call is cancelled, and then it is thrown. */
    report(stage, fraction) {
        const { progress, signal } = this.listener ?? {};
        try {
            progress?.(fraction, this.text(stage)); // its result counts for nothing: stream.write() returns true
            return signal?.aborted ? 1 : 0;
        } catch (error) {
            this.thrown = { error };
            return 1;
        }
    }

    get(type, at) {
        const { words } = this;
        switch (type) {
            case 'i32':
                return words.getInt32(at, true);
            case 'u32':
            case 'ptr':
                return words.getUint32(at, true);
            case 'i64':
                return Number(words.getBigInt64(at, true));
            case 'u64':
                return Number(words.getBigUint64(at, true));
            case 'f32':
                return words.getFloat32(at, true);
            case 'f64':
                return words.getFloat64(at, true);
            default:
                return this.bytes[at];
        }
    }

    set(type, at, value) {
        const { words } = this;
        switch (type) {
            case 'i32':
                words.setInt32(at, value, true);
                break;
            case 'u32':
            case 'ptr':
                words.setUint32(at, value, true);
                break;
            case 'i64':
                words.setBigInt64(at, BigInt(value), true);
                break;
            case 'u64':
                words.setBigUint64(at, BigInt(value), true);
                break;
            case 'f32':
                words.setFloat32(at, value, true);
                break;
            case 'f64':
                words.setFloat64(at, value, true);
                break;
            default:
                this.bytes[at] = value;
        }
    }

    field(struct, at, name) {
        const [type, offset] = STRUCTS[struct].fields[name];
        return this.get(type, at + offset);
    }

    setField(struct, at, name, value) {
        const [type, offset] = STRUCTS[struct].fields[name];
        this.set(type, at + offset, value);
    }

    /** A struct as a plain object; pointers and sizes are the library's own and stay behind. */
    read(struct, at) {
        const made = {};
        for (const [name, [type, offset, count, meaning]] of Object.entries(STRUCTS[struct].fields)) {
            if (type === 'ptr' || name === 'structSize') continue;
            if (STRUCTS[type]) made[name] = this.read(type, at + offset);
            else if (count)
                made[name] = Array.from({ length: count }, (_, i) =>
                    this.get(type, at + offset + i * SIZES[type]),
                );
            else {
                const value = this.get(type, at + offset);
                made[name] =
                    meaning === 'yes' ? value === 1 : meaning ? (NAMES[meaning][value] ?? value) : value;
            }
        }
        return made;
    }
}

const SIZES = { i32: 4, u32: 4, i64: 8, u64: 8, f32: 4, f64: 8, u8: 1, ptr: 4 };
const ARRAYS = { u64: BigUint64Array, f64: Float64Array, i32: Int32Array, u8: Uint8Array };
