// Types of 'bitvox/files': meshes from bytes of files, and back.
import type { AnyMesh, CallOptions, Library, LoadOptions, Mesh, MeshFormat, MeshFormatIn, WriteOptions } from './index.js';

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
    /** All levels in one file. [bvx_write_mesh] */
    writeLevels(meshes: readonly AnyMesh[], format: 'glb', options?: WriteOptions): Uint8Array<ArrayBuffer>;
}

/** The module, once it is compiled. */
export function load(options?: LoadOptions): Promise<Files>;
