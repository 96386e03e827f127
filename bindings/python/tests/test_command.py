"""The program that comes with the package."""

import os
import subprocess
import sys

import pytest

import bitvox
from bitvox import _command

pytestmark = pytest.mark.skipif(not os.path.isfile(_command.PROGRAM), reason="the package was built without the program")


@pytest.mark.parametrize("how", [[_command.PROGRAM], [sys.executable, "-m", "bitvox"], [os.path.join(os.path.dirname(sys.executable), "bitvox")]])
def test_program_runs(how, ball, tmp_path):
    if not os.path.exists(how[0]):
        pytest.skip("the package's scripts are not beside this interpreter")
    ball.save(tmp_path / "a.ply")
    said = subprocess.run([*how, "--version"], capture_output=True, text=True, check=False)
    assert said.stdout.split() == ["bitvox", bitvox.__version__]
    made = subprocess.run([*how, "voxelize", "a.ply", "-o", "b.bvx", "--resolution", "32", "--quiet"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    assert bitvox.read(tmp_path / "b.bvx") == bitvox.voxelize(tmp_path / "a.ply", resolution=32)
    wrong = subprocess.run([*how, "voxelise"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2 and "voxelize" in wrong.stderr


def test_a_package_without_the_program_says_so(monkeypatch):
    monkeypatch.setattr(_command, "PROGRAM", "/no/such/program")
    with pytest.raises(SystemExit, match="without one"):
        _command.main()
