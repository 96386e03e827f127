"""Builds bitvox._native: the C library and its binding in one extension (cffi, API mode, stable ABI of Python)."""

import os
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

from cffi import FFI

sys.path.insert(0, str(Path(__file__).resolve().parent))
import csource  # noqa: E402

# Results are freed without a context at hand.
GLUE_CDEF = """
extern "Python" int32_t bvxpy_progress(void *, const char *, double);
extern "Python" int32_t bvxpy_inflate(void *, const void *, uint64_t, void *, uint64_t);
extern "Python" int32_t bvxpy_open(void *, const char *, bvx_file_bytes *);
extern "Python" void bvxpy_close(void *, bvx_file_bytes *);
"""
# What the library makes and takes back; an older library has fewer.
THINGS = ("grid", "mesh", "attached", "buffer", "image", "closest", "rays", "octree", "field", "sections", "volume", "complex")

GLUE = """
#include "bitvox_io.h"

#define BVXPY_FREE(name, type) \\
    static void bvxpy_free_##name(type *thing) \\
    { \\
        bvx_context_options options = {.struct_size = sizeof options}; \\
        bvx_context *context; \\
        options.threads = 1; /* nothing runs; to count the processors would take ten times as long */ \\
        if (bvx_context_create(&options, &context) != BVX_OK) return; \\
        bvx_##name##_free(context, thing); \\
        bvx_context_destroy(context); \\
    }
"""


def compiles(compiler: str, flags: list[str], program: str = "int main(void) { return 0; }\n") -> bool:
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "probe.c"
        source.write_text(program)
        libraries = [flag for flag in flags if flag.startswith("-l")]  # linkers look for what comes before them
        command = [*compiler.split(), "-Werror", *flags, str(source), "-o", str(Path(folder) / "probe"), *libraries]
        try:
            return subprocess.run(command, capture_output=True, check=False).returncode == 0
        except OSError:
            return False


def flags() -> tuple[list[str], list[str]]:
    """Flags for compiling and linking. setuptools puts them behind those of the environment and of the distribution,
    so the arithmetic is ours whatever these say; a context looks at it once more when it is made."""
    if os.name == "nt":
        return ["/O2", "/fp:precise"], []
    compiler = os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"
    wanted = [
        ["-fno-fast-math"], ["-fno-unsafe-math-optimizations"], ["-fno-finite-math-only"], ["-fsigned-zeros"],
        ["-ffp-contract=off"], ["-mno-fma"], ["-fexcess-precision=fast"], ["-msse2", "-mfpmath=sse"],
        ["-fno-math-errno", "-fno-trapping-math"], ["-fvisibility=hidden"],
    ]
    given = os.environ.get("CFLAGS", "")
    compile_flags = ["-std=c99", *([] if "-O" in given else ["-O3"]), *([] if "-g" in given else ["-g0"])]
    for group in wanted:
        if compiles(compiler, group):
            compile_flags += group
    link_flags = ["-fno-fast-math"] if "-fno-fast-math" in compile_flags else [] # no start-up code that flushes subnormals
    threads = "#include <pthread.h>\nint main(void) { return pthread_join(pthread_self(), 0) == 0; }\n"
    if os.environ.get("BITVOX_THREADS", "1") != "0" and compiles(compiler, ["-pthread"], threads):
        compile_flags.append("-pthread")
        link_flags.append("-pthread")
    return compile_flags, link_flags


def builder() -> FFI:
    header = csource.prepare()
    callable_here = set(csource.declared(header)) - set(csource.missing(header))
    things = [name for name in THINGS if f"bvx_{name}_free" in callable_here]
    compile_flags, link_flags = flags()
    ffi = FFI()
    ffi.cdef(csource.cdef(header))
    ffi.cdef(GLUE_CDEF + "".join(f"void bvxpy_free_{name}(bvx_{name} *thing);\n" for name in things))
    here = Path(__file__).resolve().parent
    ffi.set_source(
        "bitvox._native",
        GLUE + "".join(f"BVXPY_FREE({name}, bvx_{name})\n" for name in things),
        sources=[os.path.relpath(unit, here) for unit in csource.units()],
        depends=[os.path.relpath(header, here)],
        include_dirs=[os.path.relpath(folder, here) for folder in (header.parent, header.parent / "src")],
        extra_compile_args=compile_flags,
        extra_link_args=link_flags,
        py_limited_api=True,
    )
    return ffi


ffibuilder = builder()
