// index.d.ts - types of the package bitvox. What each call does, its cost and its exactness: bitvox.h, by the names in brackets.

/** Three coordinates, or three counts along the axes. */
export type Triple = [number, number, number];
/** Where three numbers are given. */
export type TripleIn = readonly [number, number, number] | Float64Array | Float32Array | Int32Array;

/** Formats of meshes that are read, and those that are written. */
export type MeshFormatIn = 'stl' | 'obj' | 'ply' | 'off' | 'glb' | 'gltf' | '3mf';
export type MeshFormat = 'stl' | 'obj' | 'ply' | 'off' | 'glb' | '3mf';
/** Formats of grids that are read, and those that are written. */
export type GridFormatIn = 'npy' | 'binvox' | 'vox' | 'nrrd' | 'vti' | 'bvx';
export type GridFormat = GridFormatIn | 'vdb' | 'nvdb';

export type Fill = 'auto' | 'parity' | 'nonzero' | 'vote' | 'flood' | 'regions' | 'below' | 'winding';
export type FillReason = 'asked' | 'sound' | 'nested' | 'overlap' | 'open' | 'unorientable';
export type Sign = 'auto' | 'parity' | 'nonzero' | 'vote' | 'winding' | 'normal' | 'none';
export type PositionType = 'auto' | 'f32' | 'f64';
export type Interpolation = 'vector' | 'scalar' | 'middle' | 'paper' | 'tangent';
export type FaceRule = 'separate' | 'join';
export type Side = 'x-low' | 'x-high' | 'y-low' | 'y-high' | 'z-low' | 'z-high';

/** A mesh that goes in. Without triangles each three vertices are one. A BufferGeometry of three.js is taken too. */
export interface MeshIn {
    /** x, y, z of each vertex. */
    positions: Float32Array | Float64Array | number[];
    /** Three vertex indices a triangle, counter-clockwise seen from outside. */
    triangles?: Uint32Array | Uint16Array | Int32Array | number[] | undefined;
    /** Red, green, blue, alpha of each vertex. */
    colours?: Uint8Array | Uint8ClampedArray | undefined;
    /** Texture coordinates: of each vertex, or those that uvTriangles names. */
    uvs?: Float32Array | undefined;
    uvTriangles?: Uint32Array | undefined;
    /** x, y, z of each vertex. */
    normals?: Float32Array | undefined;
    /** Second texture coordinates of each vertex. */
    uvs2?: Float32Array | undefined;
    /** Index of each triangle's material. */
    materials?: Uint32Array | undefined;
    /** Red, green, blue, alpha of each material; looked at by labelVoxels alone. */
    materialColours?: Uint8Array | undefined;
    /** Added to positions to reach the world; looked at by hash alone. */
    frame?: TripleIn | undefined;
}
export interface GeometryIn {
    attributes: { position: { array: ArrayLike<number> } };
    index?: { array: ArrayLike<number> } | null | undefined;
}
export type AnyMesh = MeshIn | GeometryIn;

/** A mesh that comes out: arrays of its own. */
export interface Mesh {
    positions: Float32Array<ArrayBuffer> | Float64Array<ArrayBuffer>;
    triangles: Uint32Array<ArrayBuffer>;
    colours?: Uint8Array<ArrayBuffer>;
    uvs?: Float32Array<ArrayBuffer>;
    uvTriangles?: Uint32Array<ArrayBuffer>;
    normals?: Float32Array<ArrayBuffer>;
    uvs2?: Float32Array<ArrayBuffer>;
    materials?: Uint32Array<ArrayBuffer>;
    /** Of a glTF or 3MF file: red, green, blue, alpha of each material. */
    materialColours?: Uint8Array<ArrayBuffer>;
    /** Add to positions to reach the world; there with localFrame alone. */
    frame?: Triple;
}

/** Voxel (i,j,k) is the box from origin + ijk * spacing on. [bvx_lattice] */
export interface Lattice {
    origin: Triple;
    spacing: Triple;
    dims: Triple;
    fractionBits: number;
}
/** Without fractionBits they follow from dims. */
export interface LatticeIn {
    origin: TripleIn;
    spacing: TripleIn;
    dims: TripleIn;
    fractionBits?: number | undefined;
}
export interface WindowIn {
    low: TripleIn;
    size: TripleIn;
}

/** A set of voxels of a lattice's window, one bit each: voxel (x, y, z) is bit x & 31 of
 *  words[(z * size[1] + y) * row + (x >> 5)], row = 2 * ceil(size[0] / 64); bits at or past size[0] are 0. */
export interface Grid {
    lattice: Lattice;
    low: Triple;
    size: Triple;
    words: Uint32Array<ArrayBuffer>;
}
export interface GridIn {
    lattice: LatticeIn;
    low: TripleIn;
    size: TripleIn;
    words: Uint32Array;
}

/** Options of every call. */
export interface CallOptions {
    /** Called between pieces of work, fraction from 0 to 1. What it throws ends the call and reaches the caller. */
    progress?: ((fraction: number, stage: string) => unknown) | undefined;
    /** Looked at between pieces of work: aborted, it cancels the call. A call does not let the thread's other tasks run, so what aborts
     *  must do so within progress or before the call. From outside, end the worker. */
    signal?: AbortSignal | undefined;
    /** Bytes that the call may hold; 0: load's. */
    memoryLimit?: number | undefined;
}

/** Choose one of resolution (voxels along the longest axis; 256 where nothing is given), axisResolution and spacing. */
export interface FitOptions {
    resolution?: number | undefined;
    axisResolution?: TripleIn | undefined;
    spacing?: number | TripleIn | undefined;
    /** Empty voxels added on every side. */
    padding?: number | undefined;
}
export interface LatticeOptions extends FitOptions {
    /** In place of a fitted one. */
    lattice?: LatticeIn | undefined;
}

/** What a mesh is. [bvx_certificate] */
export interface Certificate {
    closed: boolean;
    edgeManifold: boolean;
    vertexManifold: boolean;
    oriented: boolean;
    vertices: number;
    edges: number;
    triangles: number;
    unusedVertices: number;
    collapsed: number;
    degenerate: number;
    duplicates: number;
    boundaryEdges: number;
    nonmanifoldEdges: number;
    flippedEdges: number;
    nonmanifoldVertices: number;
    components: number;
    euler: number;
    volume: number;
    area: number;
    low: Triple;
    high: Triple;
}

/** [bvx_distance_report] */
export interface DistanceReport {
    samples: number;
    seed: number;
    meanAToB: number;
    maxAToB: number;
    meanBToA: number;
    maxBToA: number;
    mean: number;
    max: number;
    normalAToB: number;
    normalBToA: number;
}

/** [bvx_solid_report] */
export interface SolidReport {
    crossings: number;
    unbalancedRows: number;
    leaks: number;
    regions: number;
    mixedRegions: number;
    mixedVoxels: number;
    cutVoxels: number;
    fillVoxels: number;
    fill: Fill;
    fillReason: FillReason;
    turned: number;
    volume: number;
    meshVolume: number;
    crossingVolume: number;
    volumeResolution: number;
    thinChecked: boolean;
    thinResolution: number;
    thinVoxels: number;
    /** Lowest and highest of these voxels. */
    thinBox: number[];
    /** 1 << code for each warning of the call. */
    warnings: number;
}

export type When = 'auto' | 'never' | 'always';

/** [bvx_voxelize_options] */
export interface VoxelizeOptions extends CallOptions, LatticeOptions {
    fill?: Fill | undefined;
    window?: WindowIn | undefined;
    closeGaps?: number | undefined;
    addShell?: boolean | undefined;
    up?: 'x' | 'y' | 'z' | undefined;
    /** Used with hasBase. */
    base?: number | undefined;
    hasBase?: boolean | undefined;
    second?: AnyMesh | undefined;
    checkThin?: When | undefined;
}

/** [bvx_surface_options] */
export interface SurfaceOptions extends CallOptions, LatticeOptions {
    mode?: 'conservative' | 'thin' | 'sampled' | undefined;
    window?: WindowIn | undefined;
}
export interface SurfaceReport {
    triangles: number;
    samples: number;
    parts: number;
}

/** [bvx_extract_options] */
export interface ExtractOptions extends CallOptions {
    faceRule?: FaceRule | undefined;
    positionType?: PositionType | undefined;
    /** Bits: 1 x low, 2 x high, 4 y low, 8 y high, 16 z low, 32 z high. */
    openSides?: number | undefined;
    localFrame?: boolean | undefined;
}
/** [bvx_faces_options] */
export interface FacesOptions extends CallOptions {
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    merged?: boolean | undefined;
    /** 1, 2: x low and high, 4, 8: y, 16, 32: z; the outermost voxels there are a neighbour's, whose faces are left to it. */
    openSides?: number | undefined;
}

/** [bvx_morph_options]; with a radius alone the neighbourhood is a ball. */
export interface MorphOptions extends CallOptions {
    neighbourhood?: 6 | 18 | 26 | undefined;
    steps?: number | undefined;
    radius?: number | undefined;
    /** What lies beyond the window: 0 empty, 1 set voxels. */
    beyond?: 0 | 1 | undefined;
}

/** [bvx_hollow_options] */
export interface HollowOptions extends CallOptions {
    thickness: number;
    drainRadius?: number | undefined;
    drainSide?: Side | undefined;
    drainPlaced?: boolean | undefined;
    drainAt?: readonly [number, number] | undefined;
    beyond?: 0 | 1 | undefined;
}
export interface HollowReport {
    hollowed: number;
    drained: number;
    drain: Triple;
}

/** [bvx_distance_options] */
export interface DistancesOptions extends CallOptions {
    side?: 'outside' | 'inside' | 'signed' | undefined;
    beyond?: 'nothing' | 'empty' | 'set' | undefined;
    type?: 'f32' | 'f64' | undefined;
}

/** [bvx_repair_options] */
export interface RepairOptions extends CallOptions {
    lattice?: LatticeIn | undefined;
    resolution?: number | undefined;
    sign?: Sign | undefined;
    interpolation?: Interpolation | undefined;
    faceRule?: FaceRule | undefined;
    /** auto: where the mesh has many sharp edges. */
    sharp?: When | undefined;
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    shell?: number | undefined;
    leastPart?: number | undefined;
    keepLargest?: number | undefined;
    leastCavity?: number | undefined;
    targetTriangles?: number | undefined;
    /** Points a side for the report's distances; 0: not measured [0]. */
    samples?: number | undefined;
    keepCrumbs?: boolean | undefined;
    ifNeeded?: boolean | undefined;
    thin?: 'keep' | 'shell' | 'drop' | undefined;
}
/** [bvx_repair_report] */
export interface RepairReport {
    before: Certificate;
    after: Certificate;
    lattice: Lattice;
    sign: Sign;
    needs: 'nothing' | 'lids' | 'manifold' | 'turns' | 'area' | 'outside-in' | 'uncrossing';
    copied: boolean;
    sharp: boolean;
    thinKept: boolean;
    thinResolution: number;
    thinVoxels: number;
    holes: number;
    turned: number;
    crossings: number;
    shelledTriangles: number;
    partsDropped: number;
    cavitiesDropped: number;
    crumbs: number;
    distance: DistanceReport;
    /** What volume the result should have, whatever was wrong with the input; 0: copied, or nothing encloses a centre. */
    crossingVolume: number;
    /** 1 << code for each warning of the call. */
    warnings: number;
}

/** [bvx_boolean_options] */
export interface BooleanOptions extends CallOptions {
    lattice?: LatticeIn | undefined;
    resolution?: number | undefined;
    fill?: 'auto' | 'parity' | 'nonzero' | 'vote' | 'winding' | undefined;
    interpolation?: Interpolation | undefined;
    faceRule?: FaceRule | undefined;
    sharp?: When | undefined;
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    thin?: 'keep' | 'drop' | undefined;
    keepCrumbs?: boolean | undefined;
    leastPart?: number | undefined;
    keepLargest?: number | undefined;
}
/** [bvx_boolean_report] */
export interface BooleanReport {
    lattice: Lattice;
    voxelsA: number;
    voxelsB: number;
    voxels: number;
    surface: FieldSurfaceReport;
    sharp: boolean;
    /** Bits: 1 the first mesh, 2 the second, 4 the result has few voxels. */
    few: number;
    advisedResolution: number;
    /** Bits: 1 the first mesh's, 2 the second's thin walls were kept. */
    thinKept: number;
    crumbs: number;
    partsDropped: number;
    solidA: SolidReport;
    solidB: SolidReport;
    /** 1 << code for each warning of the call. */
    warnings: number;
}
/** [bvx_field_surface_report] */
export type FieldSurfaceReport = Record<string, number>;

/** What levels are for: targets, one a level; with none each level has half of the triangles of the one before. */
export interface ChainOptions extends CallOptions {
    /** Levels, where no targets say how many [4]. */
    count?: number | undefined;
    targetTriangles?: readonly number[] | Uint32Array | undefined;
    targetErrors?: readonly number[] | Float64Array | undefined;
    errorKind?: 'mean' | 'max' | undefined;
    positionType?: PositionType | undefined;
    even?: number | undefined;
    samples?: number | undefined;
    strict?: boolean | undefined;
    /** Vertices on borders stay where they are, so that tiles join. */
    lockBorder?: boolean | undefined;
    /** Of texture coordinates, normals and colours beside the shape, 0 to 1000; 0: they follow it and cost nothing [1]. */
    attributeWeight?: number | undefined;
    /** One value a vertex; those other than 0 stay where they are. */
    locked?: readonly number[] | Uint8Array | undefined;
    /** Placed: new ones, where they lie nearest to the mesh; kept: the mesh's own, all of them, which triangles index [placed]. */
    vertices?: 'placed' | 'kept' | undefined;
    /** Simplify: small handles are cut and small holes filled, the smallest first [keep]. */
    topology?: 'keep' | 'simplify' | undefined;
}
/** [bvx_simplify_options] */
export type SimplifyOptions = ChainOptions;
/** [bvx_levels_options] */
export interface LevelsOptions extends ChainOptions {
    /** The surface that repair measures: closed, manifold, oriented, without crossings. */
    solid?: boolean | undefined;
    lattice?: LatticeIn | undefined;
    resolution?: number | undefined;
    sign?: Sign | undefined;
    sharp?: When | undefined;
    shell?: number | undefined;
    leastPart?: number | undefined;
    keepLargest?: number | undefined;
    /** Number.MAX_SAFE_INTEGER fills all: what was `outer`. */
    leastCavity?: number | undefined;
}
/** [bvx_level_report] */
export interface LevelReport {
    vertices: number;
    triangles: number;
    target: number;
    targetError: number;
    met: boolean;
    measured: boolean;
    /** Its distances are NaN where they were not measured. */
    distance: DistanceReport;
    certificate: Certificate;
    crossings: number;
    leastAngle: number;
    refused: number;
    handlesCut: number;
    holesFilled: number;
    longestClosed: number;
}
/** [bvx_levels_report] */
export interface LevelsReport {
    solid: boolean;
    before: Certificate;
    triangles: number;
    collapsed: number;
    doubles: number;
    turned: number;
    split: number;
    parted: number;
    cut: number;
    cutEdge: number[];
    crumbs: number;
    repair: RepairReport;
    resolution: number;
    plannedResolution: number;
    /** 1 << code for each warning of the call. */
    warnings: number;
}

/** [bvx_lod_options]; exactly one of resolutions (samples along the longest axis) and targetTriangles, one number a level. */
export interface LodOptions extends CallOptions {
    resolutions?: readonly number[] | undefined;
    targetTriangles?: readonly number[] | undefined;
    method?: 'edge-ratio' | 'coverage' | undefined;
    edgeSamples?: number | undefined;
    threshold?: number | undefined;
    faceRule?: FaceRule | undefined;
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    firstLevel?: number | undefined;
    collapse?: number | undefined;
}
/** [bvx_lod_report] */
export interface LodReport {
    resolution: Triple;
    ratio: Triple;
    vertices: number;
    triangles: number;
    searched: number;
}

/** [bvx_write_options] */
export interface WriteOptions extends CallOptions {
    normals?: boolean | undefined;
    rounding?: 'refuse' | 'allow' | undefined;
    turn?: 'none' | 'z-to-y' | 'y-to-z' | undefined;
    quantize?: boolean | undefined;
}

/** A label of each voxel of a grid's window, x fastest, 0 where none is set, and the colour of each label. */
export interface VoxelLabels {
    labels: Uint8Array<ArrayBuffer>;
    /** Red, green, blue, alpha of each of 256 labels. */
    palette: Uint8Array<ArrayBuffer>;
}

export type Status =
    | 'argument'
    | 'version'
    | 'memory'
    | 'budget'
    | 'range'
    | 'empty'
    | 'format'
    | 'unsupported'
    | 'capacity'
    | 'lattice'
    | 'cancelled';
export type Reason =
    | 'none'
    | 'unspecified'
    | 'null'
    | 'reserved'
    | 'options'
    | 'choice'
    | 'memory'
    | 'budget'
    | 'capacity'
    | 'lattice'
    | 'cancelled'
    | 'not-finite'
    | 'index'
    | 'floats-coarse'
    | 'doubles-coarse'
    | 'several-bodies'
    | 'loops-meet'
    | 'loop-flat'
    | 'compressed';

/** What a call refused and why; status "cancelled" where the signal said so. [bvx_error] */
export class BitvoxError extends Error {
    readonly name: 'BitvoxError';
    readonly status: Status;
    /** The status as bitvox.h numbers it. */
    readonly code: number;
    readonly reason: Reason;
    /** The function that refused. */
    readonly function: string;
    /** Of the vertex, triangle, level ... that the message names first; -1: none. */
    readonly index: number;
    /** The numbers of the message. */
    readonly values: number[];
    private constructor();
}

/** A part of the library in a WebAssembly module of its own. All calls work at once and on the thread that calls them. */
export interface Library {
    /** Of the library, as "0.1.0". */
    readonly version: string;
    /** Bytes: of the module's memory, which grows and never shrinks, and the most that the last call held. */
    readonly memory: { module: number; peak: number };
    /** Give the module's memory back, by beginning anew. */
    reset(): void;
}

/** All but files, which 'bitvox/files' has. */
export interface Bitvox extends Library {
    /** [bvx_mesh_check]; weld takes vertices at equal positions for one. */
    check(mesh: AnyMesh, options?: CallOptions & { weld?: boolean | undefined }): Certificate;
    /** Pairs of triangles that cross. [bvx_mesh_crossings] */
    crossings(
        mesh: AnyMesh,
        options: CallOptions & { pairs: true },
    ): { count: number; pairs: Uint32Array<ArrayBuffer> };
    crossings(mesh: AnyMesh, options?: CallOptions & { pairs?: false | undefined }): { count: number };
    /** Distances between two meshes. [bvx_mesh_distance] */
    distance(
        a: AnyMesh,
        b: AnyMesh,
        options?: CallOptions & { samples?: number | undefined; seed?: number | undefined },
    ): DistanceReport;
    /** Sixteen hexadecimal digits, the same on every machine. [bvx_mesh_hash], [bvx_grid_hash] */
    hash(meshOrGrid: AnyMesh | GridIn, options?: CallOptions): string;

    /** Around a mesh or a box. [bvx_lattice_fit_with] */
    fitLattice(mesh: AnyMesh | { low: TripleIn; high: TripleIn }, options: CallOptions & FitOptions): Lattice;
    /** The voxels whose centres lie inside a mesh. [bvx_voxelize_solid] */
    voxelize(mesh: AnyMesh, options?: VoxelizeOptions): { grid: Grid; report: SolidReport };
    /** The voxels that a mesh's surface touches. [bvx_voxelize_surface] */
    voxelizeSurface(mesh: AnyMesh, options?: SurfaceOptions): { grid: Grid; report: SurfaceReport };
    /** Marching cubes: closed and manifold. [bvx_extract_surface] */
    extractSurface(grid: GridIn, options?: ExtractOptions): Mesh;
    /** The faces of voxels. [bvx_extract_faces] */
    extractFaces(grid: GridIn, options?: FacesOptions): Mesh;

    /** Set voxels. [bvx_grid_count] */
    count(grid: GridIn, options?: CallOptions): number;
    union(a: GridIn, b: GridIn, options?: CallOptions): Grid;
    intersection(a: GridIn, b: GridIn, options?: CallOptions): Grid;
    subtract(a: GridIn, b: GridIn, options?: CallOptions): Grid;
    xor(a: GridIn, b: GridIn, options?: CallOptions): Grid;
    complement(grid: GridIn, options?: CallOptions): Grid;
    crop(grid: GridIn, window: WindowIn, options?: CallOptions): Grid;
    /** Blocks of voxels become voxels. [bvx_grid_downsample] */
    downsample(
        grid: GridIn,
        factor: number | TripleIn,
        options?: CallOptions & { rule?: 'any' | 'all' | 'majority' | undefined },
    ): Grid;
    /** [bvx_grid_morph] */
    dilate(grid: GridIn, options?: MorphOptions): Grid;
    erode(grid: GridIn, options?: MorphOptions): Grid;
    open(grid: GridIn, options?: MorphOptions): Grid;
    close(grid: GridIn, options?: MorphOptions): Grid;
    /** A shell of a body, with a hole to drain it. [bvx_grid_hollow] */
    hollow(grid: GridIn, options: HollowOptions): { grid: Grid; report: HollowReport };
    /** Euclidean distances between centres, x fastest, then y, then z. [bvx_grid_distance] */
    distances(grid: GridIn, options: DistancesOptions & { type: 'f64' }): Float64Array<ArrayBuffer>;
    distances(
        grid: GridIn,
        options?: DistancesOptions & { type?: 'f32' | undefined },
    ): Float32Array<ArrayBuffer>;

    /** A closed, manifold, oriented mesh without crossing triangles, from any mesh. [bvx_repair] */
    repair(mesh: AnyMesh, options?: RepairOptions): { mesh: Mesh; report: RepairReport };
    /** What two bodies have together, alone or in common. [bvx_boolean] */
    boolean(
        a: AnyMesh,
        b: AnyMesh,
        operation: 'union' | 'intersection' | 'difference' | 'xor',
        options?: BooleanOptions,
    ): { mesh: Mesh; report: BooleanReport };
    /** Levels of detail from any mesh. [bvx_build_levels] */
    buildLevels(
        mesh: AnyMesh,
        options?: LevelsOptions,
    ): { levels: { mesh: Mesh; report: LevelReport }[]; report: LevelsReport };
    /** Fewer triangles for a mesh as it is. [bvx_mesh_simplify] */
    simplify(mesh: AnyMesh, options?: SimplifyOptions): { levels: { mesh: Mesh; report: LevelReport }[] };
    /** Levels from a solid by coarser lattices. [bvx_build_lods] */
    buildLods(solid: GridIn, options: LodOptions): { levels: { mesh: Mesh; report: LodReport }[] };
}

export interface LoadOptions {
    /** Bytes that a call may hold; 0: what the module's 4 GiB allow. */
    memoryLimit?: number | undefined;
}

/** Begin: a module of its own with each call, compiled once. */
export function load(options?: LoadOptions): Promise<Bitvox>;

/** Is voxel (x, y, z) of the grid's window set? */
export function gridGet(grid: GridIn, x: number, y: number, z: number): boolean;
/** Set or clear voxel (x, y, z) of the grid's window. */
export function gridSet(grid: GridIn, x: number, y: number, z: number, value?: boolean): void;
/** An empty grid of a lattice, or of a window of it. */
export function makeGrid(lattice: Lattice, window?: { low: Triple; size: Triple }): Grid;
