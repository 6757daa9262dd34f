"""Wisp for Conan 2, built from the tree that holds this file: conan create packaging/conan"""
import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.0"


class WispConan(ConanFile):
    name = "wisp"
    license = "MIT"
    description = "Position-based simulation of thin things: cloth, balloons, hair"
    topics = ("simulation", "cloth", "hair", "xpbd")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "openmp": [True, False], "embree": [True, False]}
    default_options = {"shared": False, "fPIC": True, "openmp": True, "embree": True}
    languages = "C"
    implements = ["auto_shared_fpic"]

    @property
    def tree(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        self.version = re.search(r"version : '(.*)'", load(self, os.path.join(self.tree, "meson.build"))).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "meson.build", "cmake/*", "engine/*", "modules/*"):
            copy(self, pattern, src=self.tree, dst=self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        if self.settings.os != "Linux" or self.settings.compiler not in ("gcc", "clang"):
            raise ConanInvalidConfiguration(f"got {self.settings.os} and {self.settings.compiler}, expected Linux, and gcc or clang")

    def requirements(self):
        if self.options.embree:
            self.requires("embree/4.4.0")

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["WISP_SHARED"] = bool(self.options.shared)
        toolchain.cache_variables["WISP_STATIC"] = not self.options.shared
        toolchain.cache_variables["WISP_OPENMP"] = bool(self.options.openmp)
        toolchain.cache_variables["WISP_EMBREE"] = bool(self.options.embree)
        toolchain.generate()
        dependencies = CMakeDeps(self)
        dependencies.set_property("embree", "cmake_target_name", "embree")
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        # Conan writes both for its consumers.
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))

    def package_info(self):
        self.cpp_info.libs = ["wisp"]
        self.cpp_info.system_libs = ["m"]
        self.cpp_info.set_property("cmake_target_name", "wisp::wisp")
        self.cpp_info.set_property("pkg_config_name", "wisp")
        if not self.options.shared:
            self.cpp_info.set_property("cmake_target_aliases", ["wisp::wisp_static"])
            if self.options.openmp:
                self.cpp_info.exelinkflags = self.cpp_info.sharedlinkflags = ["-fopenmp"]
        if self.options.embree:
            self.cpp_info.requires = ["embree::embree"]
