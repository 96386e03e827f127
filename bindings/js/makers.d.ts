// Types of 'bitvox/makers': hulls, mass of a mesh, and whether it can be made.
import type {
    AnyMesh,
    CallOptions,
    Certificate,
    FaceRule,
    Fill,
    FillReason,
    Interpolation,
    Lattice,
    LatticeIn,
    LevelReport,
    Library,
    LoadOptions,
    Mesh,
    PositionType,
    RepairReport,
    Triple,
    When,
} from './index.js';

/** [bvx_hull_options]; with no targets the hull with all its triangles, then halves. */
export interface HullOptions extends CallOptions {
    /** Levels, where no targets say how many [1]. */
    count?: number | undefined;
    targetTriangles?: readonly number[] | Uint32Array | undefined;
    targetErrors?: readonly number[] | Float64Array | undefined;
    errorKind?: 'mean' | 'max' | undefined;
    even?: number | undefined;
    samples?: number | undefined;
    strict?: boolean | undefined;
    lattice?: LatticeIn | undefined;
    resolution?: number | undefined;
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    faceRule?: FaceRule | undefined;
    interpolation?: Interpolation | undefined;
    sharp?: When | undefined;
    leastPart?: number | undefined;
    keepLargest?: number | undefined;
    shell?: number | undefined;
    /** Openings of up to this many voxels are closed [0: those that no empty voxel leads through]. */
    closeGaps?: number | undefined;
    /** Levels go around every triangle, touch none and are nowhere further from them [0: no]. */
    enclose?: number | undefined;
}
/** [bvx_hull_report] */
export interface HullReport {
    lattice: Lattice;
    triangles: number;
    outerTriangles: number;
    shelledTriangles: number;
    lids: number;
    partsDropped: number;
    /** 1 << code for each warning of the call. */
    warnings: number;
}

/** [bvx_measure_options] */
export interface MeasureOptions extends CallOptions {
    /** Mass of a unit of volume [1]. */
    density?: number | undefined;
    /** Voxels along each axis where the mesh is not one sound shell [128]. */
    resolution?: number | undefined;
}
/** [bvx_measure_report] */
export interface MeasureReport {
    volume: number;
    area: number;
    mass: number;
    center: Triple;
    /** About center: xx, yy, zz, xy, xz, yz. */
    inertia: number[];
    /** Bounds: the body's own values are at most so far off. */
    volumeError: number;
    centerError: number;
    inertiaError: number;
    resolution: number;
    fill: Fill;
    fillReason: FillReason;
    turned: number;
}

/** [bvx_inspect_options] */
export interface InspectOptions extends CallOptions {
    lattice?: LatticeIn | undefined;
    /** Voxels along the longest axis [256]. */
    resolution?: number | undefined;
    /** Thinner walls and narrower gaps are findings; 0: none [0]. */
    walls?: number | undefined;
    gaps?: number | undefined;
    density?: number | undefined;
    up?: 'x' | 'y' | 'z' | undefined;
    /** Findings of a kind that are listed [8]. */
    most?: number | undefined;
    /** Give it for each vertex. */
    thickness?: boolean | undefined;
}
/** [bvx_finding] */
export interface Finding {
    /** Least thickness or width, volume of a cavity, area of an island. */
    size: number;
    position: Triple;
    low: Triple;
    high: Triple;
    voxels: number;
}
/** [bvx_inspect_report] */
export interface InspectReport {
    certificate: Certificate;
    lattice: Lattice;
    needs: RepairReport['needs'];
    fill: Fill;
    crossings: number;
    volume: number;
    volumeError: number;
    mass: number;
    leastThickness: number;
    thinEnds: number[];
    /** That 1, 5, 50 and 95 % of the surface do not reach. */
    thickness: number[];
    thinArea: number;
    leastGap: number;
    gapEnds: number[];
    cavityVolume: number;
    /** Findings of each kind, listed or not: walls, gaps, cavities, islands. */
    found: number[];
}
/** The worst of each kind first. */
export interface Inspection {
    /** Nothing is to be repaired before it can be made; walls, gaps and the others are not part of it. */
    sound: boolean;
    walls: Finding[];
    gaps: Finding[];
    cavities: Finding[];
    islands: Finding[];
    report: InspectReport;
    /** Of each vertex, the least beside it; Infinity where none is found. */
    thickness?: Float64Array<ArrayBuffer>;
}

export interface Makers extends Library {
    /** What of a mesh can be reached from outside, closed: inner walls and parts go. [bvx_hull] */
    hull(
        mesh: AnyMesh,
        options?: HullOptions,
    ): { levels: { mesh: Mesh; report: LevelReport }[]; report: HullReport };
    /** Volume, area, mass, center and inertia of the body that a mesh encloses, with bounds of their errors. [bvx_measure] */
    measure(mesh: AnyMesh, options?: MeasureOptions): MeasureReport;
    /** Whether a mesh can be made: sound or not, thin walls, narrow gaps, cavities, islands. [bvx_inspect] */
    inspect(mesh: AnyMesh, options: InspectOptions & { thickness: true }): Inspection & { thickness: Float64Array<ArrayBuffer> };
    inspect(mesh: AnyMesh, options?: InspectOptions): Inspection;
}

/** The module, once it is compiled. */
export function load(options?: LoadOptions): Promise<Makers>;
