"""Shapes that the tests share. They run on the installed package, from anywhere; real data is used where it is present."""

import importlib.util
import inspect
import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest

import bitvox

if importlib.util.find_spec("hypothesis") and not os.environ.get("BITVOX_LARGE"):  # else inputs are new ones each time
    from hypothesis import HealthCheck, settings

    settings.register_profile("same", derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow])
    settings.load_profile("same")

# Dask's workers are copies of one process that has imported it, where systems have that, and nobody looks at their profiles: each start of one
# took seconds of processor time.
if hasattr(os, "fork"):
    os.environ.setdefault("DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD", "forkserver")
os.environ.setdefault("DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED", "False")

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent.parent
SHARED = Path(os.environ.get("BITVOX_SHARED", REPOSITORY.parent / "shared"))

TETRAHEDRON = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
BOX_FACES = np.array([[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6],
                      [3, 0, 4], [3, 4, 7]])


def public_names(module):
    """Names of a module's interface."""
    return getattr(module, "__all__", None) or [name for name in dir(module) if not name.startswith("_")]


def more_options(function):
    """The class that lists what a function takes by name beside its signature's keywords."""
    found = re.search(r"Unpack\[(\w+Options)\]", str(inspect.signature(function)))
    return getattr(bitvox, found[1]) if found else None


def box_mesh(low=(0.0, 0.0, 0.0), high=(1.0, 1.0, 1.0)):
    """Vertices and faces of a box, outwards."""
    (a, b, c), (d, e, f) = low, high
    return np.array([[a, b, c], [d, b, c], [d, e, c], [a, e, c], [a, b, f], [d, b, f], [d, e, f], [a, e, f]], float), BOX_FACES


def ball_grid(n=24, radius=None):
    """A ball of voxels, as an array [x, y, z]."""
    at = np.arange(n) + 0.5 - n / 2
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    return x * x + y * y + z * z < (radius or n * 0.4) ** 2



def killed_once(function, marker, *values, **options):
    """What function returns, but the first process that comes here is killed, as systems do it."""
    try:
        os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return function(*values, **options)
    return os.kill(os.getpid(), signal.SIGKILL)


def killed_at(function, name, place, *values):
    """What function returns, but a process that comes here for a folder of this name is killed, however often."""
    if os.path.basename(place) == name:
        os.kill(os.getpid(), signal.SIGKILL)
    return function(place, *values)


@pytest.fixture(scope="session")
def knot():
    path = REPOSITORY / "fixtures" / "knot.ply"
    if not path.is_file():
        pytest.skip("fixtures/knot.ply is not here")
    return bitvox.read(path)


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory):
    """A client of two worker processes of one thread; one that is killed comes again."""
    distributed = pytest.importorskip("distributed")
    folder = str(tmp_path_factory.mktemp("dask"))
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=folder) as cluster:
        with distributed.Client(cluster, set_as_default=False) as client:
            yield client


@pytest.fixture(scope="session")
def ball():
    """A closed mesh of a ball."""
    return bitvox.surface(bitvox.Grid.from_numpy(ball_grid(), spacing=0.25))


@pytest.fixture(scope="session")
def run_notebook(tmp_path_factory):
    """A function that runs a notebook of the pages once, and the folder that then holds it."""
    for module in ("nbclient", "nbformat", "ipykernel"):
        pytest.importorskip(module)
    import nbformat

    spec = importlib.util.spec_from_file_location("bitvox_docs_build", HERE.parent / "docs" / "build.py")
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    folder = tmp_path_factory.mktemp("notebooks")

    def run(path):
        if not (folder / path.name).is_file():
            nbformat.write(build.run_notebook(path, tmp_path_factory.mktemp(path.stem)), folder / path.name)
        return nbformat.read(folder / path.name, as_version=4)

    return run, folder


@pytest.fixture(scope="session")
def shared():
    """A file of the shared data, or a skipped test."""

    def find(name):
        path = SHARED / name
        if not path.is_file():
            pytest.skip(f"{path} is not here")
        return path

    return find


@pytest.fixture()
def tetrahedron():
    return TETRAHEDRON
