// shapes.mjs - the meshes of tests/golden/shapes.h: integers, sums, products, quotients and square roots alone.

const MASK = (1n << 64n) - 1n;

export class Random {
    constructor(seed) {
        this.state = BigInt(seed);
    }

    /** The upper 24 bits of the next state. */
    next() {
        this.state ^= (this.state << 13n) & MASK;
        this.state ^= this.state >> 7n;
        this.state ^= (this.state << 17n) & MASK;
        return Number(this.state >> 40n);
    }

    fraction() {
        return this.next() / 16777216;
    }
}

function circle(i, n) {
    const quarter = Math.floor((4 * i) / n);
    const u = (4.0 * i) / n - quarter,
        d = 1.0 + u * u,
        a = (1.0 - u * u) / d,
        b = (2.0 * u) / d;
    return [
        [a, b],
        [-b, a],
        [-a, -b],
        [b, -a],
    ][quarter];
}

const mesh = (v, t) => ({ positions: Float64Array.from(v.flat()), triangles: Uint32Array.from(t.flat()) });

export function torus(n, m, dent, seed) {
    const random = new Random(seed),
        v = [],
        t = [];
    for (let i = 0; i < n; i++) {
        const [x, y] = circle(i, n);
        for (let j = 0; j < m; j++) {
            const wobble = 1.0 + dent * (random.fraction() - 0.5);
            const [c, z] = circle(j, m);
            v.push([
                x * (2.0 + 0.75 * c * wobble),
                y * (2.0 + 0.75 * c * wobble),
                0.75 * z * wobble + 0.25 * x * y,
            ]);
        }
    }
    for (let i = 0; i < n; i++) {
        for (let j = 0; j < m; j++) {
            const i1 = ((i + 1) % n) * m,
                j1 = (j + 1) % m,
                i0 = i * m;
            t.push([i0 + j, i1 + j, i1 + j1], [i0 + j, i1 + j1, i0 + j1]);
        }
    }
    return mesh(v, t);
}

export function ball(n) {
    const v = [],
        t = [];
    for (let face = 0; face < 8; face++) {
        const sx = face & 1 ? -1 : 1,
            sy = face & 2 ? -1 : 1,
            sz = face & 4 ? -1 : 1;
        const flip = ((face & 1) + ((face >> 1) & 1) + ((face >> 2) & 1)) % 2;
        const first = v.length;
        for (let i = 0; i <= n; i++) {
            for (let j = 0; j <= n - i; j++) {
                const x = i,
                    y = j,
                    z = n - i - j,
                    r = Math.sqrt(x * x + y * y + z * z);
                v.push([sx * (x / r), sy * (y / r), sz * (z / r)]);
            }
        }
        for (let i = 0, row = 0; i < n; row += n - i + 1, i++) {
            for (let j = 0; j < n - i; j++) {
                const a = first + row + j,
                    b = a + n - i + 1,
                    c = a + 1,
                    d = b + 1;
                t.push(flip ? [a, c, b] : [a, b, c]);
                if (j + 1 < n - i) t.push(flip ? [b, c, d] : [b, d, c]);
            }
        }
    }
    return mesh(v, t);
}

export function soup(n, seed) {
    const random = new Random(seed),
        v = [],
        t = [];
    for (let i = 0; i < n; i++) {
        const size = i % 5 === 0 ? 2.0 : 0.25;
        const at = [random.fraction(), random.fraction(), random.fraction()];
        for (let c = 0; c < 3; c++) v.push(at.map(x => x + size * (random.fraction() - 0.5)));
        t.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    return mesh(v, t);
}
