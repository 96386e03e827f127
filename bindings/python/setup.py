"""What pyproject.toml cannot say: the version of the header, what is made from it, and which flags come last."""

import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from setuptools import setup
from setuptools.command.build_ext import build_ext

sys.path.insert(0, str(Path(__file__).resolve().parent))
import csource  # noqa: E402

source = csource.prepare()
header = source.read_text(encoding="utf-8")
(Path(__file__).resolve().parent / "src" / "bitvox" / "reports.py").write_text(csource.reports(source), encoding="utf-8")
version = ".".join(re.search(rf"#define BVX_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))


class BuildBeside(build_ext):
    """Compiles the units of the extension beside one another, as many at once as there are processors."""

    def build_extension(self, ext):
        compile_all = self.compiler.compile

        def compile_one(source, options):
            return compile_all([source], **options)

        def compile_beside(sources, output_dir=None, **options):
            for folder in {os.path.join(output_dir or "", os.path.dirname(source)) for source in sources}:
                os.makedirs(folder or ".", exist_ok=True)  # not by two at once
            options["output_dir"] = output_dir
            jobs = int(os.environ.get("BITVOX_BUILD_JOBS", "0")) or (os.cpu_count() or 1)
            with ThreadPoolExecutor(min(jobs, len(sources))) as workers:
                return [made for objects in workers.map(lambda one: compile_one(one, dict(options)), sources) for made in objects]

        self.compiler.compile = compile_beside
        try:
            super().build_extension(ext)
        finally:
            self.compiler.compile = compile_all


setup(
    cmdclass={"build_ext": BuildBeside},
    version=version,
    cffi_modules=["build_native.py:ffibuilder"],
    options={"bdist_wheel": {"py_limited_api": "cp310"}, "build_ext": {"force": True}},  # flags may have changed
)
