"""What pyproject.toml cannot say: the version of the header, what is made from it, and which flags come last."""

import os
import re
import shutil
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from setuptools import setup
from setuptools.command.build_ext import build_ext

sys.path.insert(0, str(Path(__file__).resolve().parent))
import build_native  # noqa: E402
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

        def link_shared(*arguments, **options):
            made = link(*arguments, **options)
            self.build_command(arguments[0], os.path.dirname(arguments[1]), compile_beside, ext)
            return made

        link = self.compiler.link_shared_object
        self.compiler.compile, self.compiler.link_shared_object = compile_beside, link_shared
        try:
            super().build_extension(ext)
        finally:
            self.compiler.compile, self.compiler.link_shared_object = compile_all, link

    def copy_extensions_to_source(self):
        """Of an editable install: the program too."""
        super().copy_extensions_to_source()
        here = Path(__file__).resolve().parent / "src" / "bitvox" / "_bin"
        for path in Path(self.build_lib).glob("bitvox/_bin/*"):
            here.mkdir(exist_ok=True)
            shutil.copy2(path, here)

    def build_command(self, objects, folder, compile_beside, ext):
        """The program `bitvox`, of its own sources and the library's objects, into the package."""
        if os.name != "posix" or os.environ.get("BITVOX_COMMAND", "1") == "0":
            return
        root = Path(__file__).resolve().parent
        zlib = build_native.compiles(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc", ["-lz"],
                                     "#include <zlib.h>\nint main(void) { return zlibVersion() == 0; }\n")
        own = compile_beside([os.path.relpath(path, root) for path in csource.program()], output_dir=self.build_temp,
                             include_dirs=list(ext.include_dirs), extra_postargs=list(ext.extra_compile_args) + ["-O1"],
                             macros=[("BVX_HAVE_ZLIB", "1")] if zlib else [])
        library = [one for one in objects if os.path.basename(one).startswith("unit_")]
        target = os.path.join(folder, "_bin")
        self.mkpath(target)
        # without the options of the distribution for modules of Python, which an executable does not take
        self.compiler.link_executable(own + library, "bitvox", output_dir=target, libraries=["m", *(["z"] if zlib else [])],
                                      extra_postargs=list(ext.extra_link_args))


setup(
    cmdclass={"build_ext": BuildBeside},
    version=version,
    cffi_modules=["build_native.py:ffibuilder"],
    options={"bdist_wheel": {"py_limited_api": "cp310"}, "build_ext": {"force": True}},  # flags may have changed
)
