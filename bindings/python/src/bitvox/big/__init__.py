"""More than one machine, or more than fits into one: chunks of one lattice on Dask, in Zarr, or on any other engine.

    volume = bitvox.big.voxelize("dragon.ply", resolution=2048, chunks=512)     # nothing is computed yet
    mesh = bitvox.big.surface(volume)                                           # the bytes of a single run
    bitvox.big.to_zarr(volume, "dragon.zarr")                                   # OME-Zarr, one shard a task
    shell = volume - volume.erode(radius=0.5)                                   # also dilate, open, close, hollow, |, &, ^, ~
    near = volume.distance(2.0, "signed")                                       # a Dask array, exact up to 2.0
    samples = bitvox.big.samples_from_zarr("scan.zarr", channel=1)              # numbers of any type
    skin = samples.surface(300)                                                 # a level between samples, the bytes of a single run
    coarse = volume.downsample(4, "majority")
    body = volume.keep(largest=1).fill_cavities()
    pieces = bitvox.big.run(body, "dragon", levels=4)                           # the surface and coarser levels of it, in pieces on disk
    bodies = bitvox.big.run(bitvox.big.Labels(samples), "bodies", levels=4)     # of each label

Chunks are windows of one lattice, and a window holds the bits of the whole there; so nothing depends on how the work was cut,
on who did it or on how often it was tried. What looks at neighbors gets a halo of their voxels, as wide as it looks. `plan` gives the same work as a list of picklable tasks, for Ray or a batch queue.
Needs ``bitvox[big]`` (dask, zarr, and DracoPy for `Pieces.to_neuroglancer`); `plan` needs none of them.
"""

from .chunks import Chunks
from .disk import Record
from .labels import Labels
from .parts import label
from .pieces import Pieces, run
from .plan import Plan, Task, plan
from .samples import Samples, samples_from_zarr
from .store import from_zarr, to_zarr
from .volume import Volume, from_dask, surface, voxelize

__all__ = ["Chunks", "Labels", "Pieces", "Plan", "Record", "Samples", "Task", "Volume", "from_dask", "from_zarr", "label", "plan", "run", "samples_from_zarr", "surface", "to_zarr", "voxelize"]
