// Types of 'bitvox/labels': labels of voxels from a mesh, and the surfaces between all labels of a volume.
import type {
    CallOptions,
    GridIn,
    LatticeIn,
    Library,
    LoadOptions,
    Mesh,
    MeshIn,
    PositionType,
    Triple,
    TripleIn,
    VoxelLabels,
} from './index.js';

/** Labels as voxels, x fastest. Without a lattice voxel (i,j,k) is the box from (i,j,k) on, one wide. [bvx_volume_view] */
export interface LabelVolume {
    samples:
        | Uint8Array
        | Uint8ClampedArray
        | Int8Array
        | Uint16Array
        | Int16Array
        | Uint32Array
        | Int32Array
        | BigUint64Array
        | BigInt64Array;
    size: TripleIn;
    /** Where the voxels are; dims are the whole's where this is a window of it, from low on. */
    lattice?: LatticeIn | undefined;
    low?: TripleIn | undefined;
}
/** [bvx_labels_options] */
export interface LabelsOptions extends CallOptions {
    /** The label that is no body [0]. */
    background?: number | undefined;
    /** Vertices stay at the corners of voxels. */
    staircase?: boolean | undefined;
    positionType?: PositionType | undefined;
    localFrame?: boolean | undefined;
    /** The window is a piece that others join, with one voxel more where the lattice goes on. */
    open?: boolean | undefined;
    /** At most so many triangles of all labels together; faces stay shared. */
    triangles?: number | undefined;
    /** Instead: mean distance to all faces. */
    error?: number | undefined;
}
/** The body of a label: closed, manifold, outwards. [bvx_label, bvx_label_mesh] */
export interface LabelBody {
    /** A bigint where samples are. */
    value: number | bigint;
    voxels: number;
    low: Triple;
    size: Triple;
    mesh: Mesh;
}
export interface LabelSurfaces {
    /** All but the background, ascending. */
    labels: LabelBody[];
    /** All faces, each once; sides: the labels behind and before each triangle, as indices of labels, whose count is the background. */
    complex: Mesh & { sides: Uint32Array<ArrayBuffer> };
}

export interface Labels extends Library {
    /** Bodies of all labels, with shared faces. [bvx_label_surfaces] */
    labelSurfaces(volume: LabelVolume, options?: LabelsOptions): LabelSurfaces;
    /** Labels of set voxels by the material or colour of the mesh's nearest point; textures are not looked up. [bvx_label_voxels] */
    labelVoxels(mesh: MeshIn, grid: GridIn, options?: CallOptions): VoxelLabels;
}

/** The module, once it is compiled. */
export function load(options?: LoadOptions): Promise<Labels>;
