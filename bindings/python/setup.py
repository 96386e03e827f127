"""What pyproject.toml cannot say: the version of the header, what is made from it, and which flags come last."""

import re
import sys
from pathlib import Path

from setuptools import setup

sys.path.insert(0, str(Path(__file__).resolve().parent))
import csource  # noqa: E402

source = csource.prepare()
header = source.read_text(encoding="utf-8")
(Path(__file__).resolve().parent / "src" / "bitvox" / "reports.py").write_text(csource.reports(source), encoding="utf-8")
version = ".".join(re.search(rf"#define BVX_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))

setup(
    version=version,
    cffi_modules=["build_native.py:ffibuilder"],
    options={"bdist_wheel": {"py_limited_api": "cp310"}, "build_ext": {"force": True}},  # flags may have changed
)
