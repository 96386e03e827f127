// Types of 'bitvox/files': meshes and grids from bytes of files, and back.
import type {
    AnyMesh,
    CallOptions,
    Grid,
    GridFormat,
    GridFormatIn,
    GridIn,
    Library,
    LoadOptions,
    Mesh,
    MeshFormat,
    MeshFormatIn,
    VoxelLabels,
    WindowIn,
    WriteOptions,
} from './index.js';

export interface Files extends Library {
    /** The mesh format that a file name's ending stands for (".gz" is looked through). */
    formatOfName(name: string): MeshFormatIn | undefined;
    /** [bvx_read_mesh]; finite: triangles with a corner that is not finite are left out and counted. */
    readMesh(
        bytes: ArrayBuffer | ArrayBufferView,
        format: MeshFormatIn,
        options: CallOptions & { finite: true },
    ): Mesh & { dropped: number };
    readMesh(
        bytes: ArrayBuffer | ArrayBufferView,
        format: MeshFormatIn,
        options?: CallOptions & { finite?: false | undefined },
    ): Mesh;
    /** [bvx_write_mesh] */
    writeMesh(mesh: AnyMesh, format: MeshFormat, options?: WriteOptions): Uint8Array<ArrayBuffer>;
    /** All levels in one file; with names the meshes are no levels but nodes of a scene, colours are four numbers a mesh. [bvx_write_mesh] */
    writeLevels(
        meshes: readonly AnyMesh[],
        format: 'glb',
        options?: WriteOptions & { names?: readonly string[] | undefined; colours?: readonly number[] | Uint8Array | undefined },
    ): Uint8Array<ArrayBuffer>;
    /** Where the format keeps no lattice (.npy, .vox) origin is 0 and spacing 1. window: only these voxels. [bvx_read_grid] */
    readGrid(
        bytes: ArrayBuffer | ArrayBufferView,
        format: GridFormatIn,
        options?: CallOptions & { window?: WindowIn | undefined },
    ): Grid;
    /** [bvx_write_grid] */
    writeGrid(grid: GridIn, format: GridFormat, options?: CallOptions): Uint8Array<ArrayBuffer>;
    /** [bvx_read_labels] */
    readLabels(bytes: ArrayBuffer | ArrayBufferView, format: 'vox', options?: CallOptions): VoxelLabels & { grid: Grid };
    /** What labelVoxels made; .nrrd has the keys of 3D Slicer's segments. [bvx_write_labels] */
    writeLabels(
        grid: GridIn,
        labels: { labels: Uint8Array; palette: Uint8Array },
        format: 'vox' | 'nrrd',
        options?: CallOptions,
    ): Uint8Array<ArrayBuffer>;
}

/** The module, once it is compiled. */
export function load(options?: LoadOptions): Promise<Files>;
