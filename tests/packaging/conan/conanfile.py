"""Conan 2: `conan create tests/packaging/conan` builds the sources that it lies in, and a program against the package."""

import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load

required_conan_version = ">=2.0"


class Bitvox(ConanFile):
    name = "bitvox"
    description = "Shapes to bit-packed voxels and voxels to closed meshes, exactly"
    license = "MIT"
    topics = ("voxels", "mesh", "geometry", "level-of-detail")
    package_type = "library"
    languages = "C"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "threads": [True, False]}
    default_options = {"shared": False, "fPIC": True, "threads": True}
    implements = ["auto_shared_fpic"]

    def _sources(self):
        return os.path.normpath(os.path.join(self.recipe_folder, "..", "..", ".."))

    def set_version(self):
        header = load(self, os.path.join(self._sources(), "include", "bitvox.h"))
        self.version = ".".join(re.search(rf"#define BVX_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "include/*", "src/*"):
            copy(self, pattern, self._sources(), self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["BITVOX_THREADS"] = bool(self.options.threads)
        toolchain.cache_variables["BITVOX_PROGRAM"] = False
        toolchain.cache_variables["BITVOX_INSTALL"] = True
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        """CMake finds the package by the file that it brings."""
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "bitvox")]
        self.cpp_info.set_property("pkg_config_name", "bitvox")
        self.cpp_info.libs = ["bitvox"]
        if self.settings.os == "Windows" and self.options.shared:
            self.cpp_info.defines = ["BVX_USE_SHARED"]
        if self.settings.os in ("Linux", "FreeBSD"):
            self.cpp_info.system_libs = ["m", *(["gomp"] if self.settings.compiler == "gcc" else []), "pthread"] if self.options.threads else ["m"]
