// library.js - the library in a module of its own: how it is loaded, and how a method calls it.
//
// Each method makes a context, copies its arguments into the module's memory, calls one function of bitvox.h, copies the
// result out and frees all that it took.

/** The library in a module of its own, which methods call. */
class Library {
    #module;
    #machine;
    #limit;

    constructor(module, memoryLimit) {
        this.#module = module;
        this.#limit = memoryLimit;
        this.#machine = new Machine(module);
        const version = this.#machine.c.bvx_version();
        this.version = `${Math.floor(version / 10000)}.${Math.floor(version / 100) % 100}.${version % 100}`;
    }

    /** Bytes: held by the module (it grows, and never shrinks), and the most that the last call held. */
    get memory() {
        return { module: this.#machine.c.memory.buffer.byteLength, peak: this.#machine.peak ?? 0 };
    }

    /** Give the module's memory back, by a module that is made anew. */
    reset() {
        this.#machine = new Machine(this.#module);
    }

    _call(name, options, body) {
        if (options === null || typeof options !== 'object')
            refuse(name, `options are ${options === null ? 'null' : typeof options}, not an object`);
        if (this.#machine.broken) this.reset();
        const machine = this.#machine;
        const call = new Call(machine, name, options, this.#limit);
        if (options.signal?.aborted)
            throw new BitvoxError(`${name}: cancelled before it began`, {
                status: 'cancelled',
                reason: 'cancelled',
                function: name,
            });
        try {
            call.begin();
            return body(call, machine);
        } finally {
            if (!machine.broken) call.end();
        }
    }
}

// ---- Loading ----

let compiled;

/** The module: its bytes are packed, and text in this file. */
async function compile() {
    const bytes = Uint8Array.from(atob(MODULE), letter => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

/** The smallest module with an instruction of 128 bits. */
const SIMD_PROBE = Uint8Array.of(
    0,
    97,
    115,
    109,
    1,
    0,
    0,
    0,
    1,
    5,
    1,
    96,
    0,
    1,
    123,
    3,
    2,
    1,
    0,
    10,
    10,
    1,
    8,
    0,
    65,
    0,
    253,
    15,
    253,
    98,
    11,
);

async function loadAs(Kind, { memoryLimit = 0 } = {}) {
    const limit = numberOf('load', 'memoryLimit', 'u64', memoryLimit);
    if (!SCALAR && !WebAssembly.validate(SIMD_PROBE)) {
        throw new BitvoxError(
            "load: WebAssembly has no 128-bit instructions here; import 'bitvox/scalar', which uses none",
            { status: 'unsupported', function: 'load' },
        );
    }
    compiled ??= compile();
    return new Kind(await compiled, limit);
}
