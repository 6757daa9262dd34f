#!/usr/bin/env python3
"""Compare the builds of libwisp by meson and by CMake: the same files with the same flags, in every kind of build.

usage: check_builds.py SOURCE_TREE

Both are only configured, in an empty folder, with the compiler of CC. Flags that change neither results nor the interface, such
as those of warnings, are left out. Kernels must have -O3 in every build that is not for debugging, after all other levels: with
the flags of a distribution a step would take 43 % longer.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

source = os.path.abspath(sys.argv[1])
# What dpkg-buildflags prints in Debian 12.
DISTRIBUTION = "-g -O2 -fstack-protector-strong -Wformat -Werror=format-security -Wdate-time -D_FORTIFY_SOURCE=2"
# name, flags of the environment, options of meson, options of CMake, expected level of kernels
BUILDS = [
    ("release", "", ["-Dbuildtype=release"], ["-DCMAKE_BUILD_TYPE=Release"], "-O3"),
    ("distribution", DISTRIBUTION, ["-Dbuildtype=plain"], ["-DCMAKE_BUILD_TYPE=None"], "-O3"),
    ("debugoptimized", "", ["-Dbuildtype=debugoptimized"], ["-DCMAKE_BUILD_TYPE=RelWithDebInfo"], "-O3"),
    ("debug", "", ["-Dbuildtype=debug"], ["-DCMAKE_BUILD_TYPE=Debug"], "-O0"),
    ("debug by flags", "-g -O2 -Og", ["-Dbuildtype=plain"], ["-DCMAKE_BUILD_TYPE=None"], "-Og"),
    ("without parts", "", ["-Dopenmp=disabled", "-Dembree=disabled", "-Dmodules=cloth,collision"],
     ["-DWISP_OPENMP=OFF", "-DWISP_EMBREE=OFF", "-DWISP_MODULES=cloth;collision"], "-O3"),
]
RELEVANT = re.compile(r"-(std=|m|fno-math|fno-trapping|ffp|ffast|fvisibility|fPIC|fopenmp|fstack|DWISP|D_GNU|D_FORTIFY)")


def configure(command, flags, folder):
    environment = {**os.environ, "CFLAGS": flags}
    environment.pop("LDFLAGS", None)
    result = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        sys.exit(f"FAILED: {' '.join(command)}\n{result.stdout}")


def commands(folder):
    """The relevant flags of each file of the library, by file and instruction set. The last level of optimisation counts."""
    found = {}
    for entry in json.load(open(f"{folder}/compile_commands.json", encoding="utf-8")):
        path = os.path.join(entry["directory"], entry["file"])
        # Meson compiles a room as one file, which includes those of the room.
        files = re.findall(r"#include ?<(.*)>", open(path, encoding="utf-8").read()) if path.endswith("-unity0.c") else [path]
        flags = entry["command"].split()
        isa = [flag.split("=")[1] for flag in flags if flag.startswith("-DWISP_KERNEL_ISA=")]
        level = ([flag for flag in flags if re.match("-O.$", flag)] or ["-O0"])[-1]
        for file in files:
            found[os.path.relpath(file, source), isa[0] if isa else ""] = [level] + sorted({flag for flag in flags if RELEVANT.match(flag)})
    return found


def main():
    failures = []
    for name, flags, meson_options, cmake_options, level in BUILDS:
        with tempfile.TemporaryDirectory() as folder:
            configure(["meson", "setup", f"{folder}/meson", source, "-Dapp=false", "-Dtests=false", "-Dexamples=false"] + meson_options, flags, folder)
            configure(["cmake", "-S", source, "-B", f"{folder}/cmake", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"] + cmake_options, flags, folder)
            meson, cmake = commands(f"{folder}/meson"), commands(f"{folder}/cmake")
        found = []
        for key in sorted(set(meson) | set(cmake)):
            if key not in cmake or key not in meson:
                found.append(f"{name}: {' '.join(key)} is only built by {'meson' if key in meson else 'CMake'}")
            elif meson[key] != cmake[key]:
                found.append(f"{name}: {' '.join(key)}: meson has {meson[key]}, CMake has {cmake[key]}")
        failures += found[:4] + ([f"{name}: and {len(found) - 4} objects more"] if len(found) > 4 else [])
        levels = {flags[0] for build in (meson, cmake) for (_, isa), flags in build.items() if isa}
        if levels != {level}:
            failures.append(f"{name}: kernels have {sorted(levels)}, expected {level}")
        print(f"{name}: {len(meson)} objects, kernels {' '.join(sorted(levels))}")
    print("\n".join(failures))
    print(f"{len(BUILDS) if not failures else 0} passed, {len(failures)} failed")
    return 1 if failures else 0


sys.exit(main())
