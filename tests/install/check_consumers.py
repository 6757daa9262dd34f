#!/usr/bin/env python3
"""Build and run hosts as other projects would: each must print the hash of the host of the build.

usage: check_consumers.py installed|sources SOURCE_TREE BUILD_FOLDER HOST COMPILER...

installed: the library that meson installs, through pkg-config, CMake and meson.
sources: what CMake builds and installs, and Wisp as a part of projects of CMake and meson. Each of these builds the whole library,
which takes minutes; without optimisation where nothing is cached.

The project files are the pieces of docs/embedding.md, under "Build and link".
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

mode, source, build, host = sys.argv[1], *(os.path.abspath(path) for path in sys.argv[2:5])
compiler = sys.argv[5:]
JOBS = os.environ.get("JOBS") or "2"
LAUNCHER = ["-DCMAKE_C_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
results = {}


def run(command, folder, **environment):
    """The output of a command that must work."""
    result = subprocess.run(command, cwd=folder, env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        sys.exit(f"FAILED: {' '.join(command)}\n{result.stdout[-6000:]}")
    return result.stdout


def refused(name, command, folder, sentence):
    """A command that must fail, and say why."""
    result = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = re.sub(r"\s+", " ", result.stdout)
    results[name] = result.returncode != 0 and sentence in said
    if not results[name]:
        print(f"FAILED: {name}: ends with {result.returncode}, expected '{sentence}' in: {said[-1500:]}")


def expect(name, program, **environment):
    printed = run([program], ".", **environment).strip()
    results[name] = printed == expected
    print(f"{name}: {printed}" if results[name] else f"FAILED: {name}: got '{printed}', expected '{expected}'")


def pieces():
    """The project files of the page: CMake for an installed library and for sources, meson."""
    text = open(f"{source}/docs/embedding.md", encoding="utf-8").read()
    section = re.search(r"(?ms)^## Build and link$(.*?)^## ", text).group(1)
    cmake, meson = (re.findall(rf"(?ms)^```{language}\n(.*?)^```$", section) for language in ("cmake", "meson"))
    if len(cmake) != 2 or len(meson) != 1:
        sys.exit(f"docs/embedding.md: got {len(cmake)} pieces of CMake and {len(meson)} of meson, expected 2 and 1")
    return cmake + meson


def project(folder, name, file, text, language="C"):
    """A folder with host.c and a project file."""
    path = f"{folder}/{name}"
    os.makedirs(path)
    shutil.copy(f"{source}/tests/install/host.c", path)
    head = f"cmake_minimum_required(VERSION 3.20)\nproject(consumer {language})\n" if file == "CMakeLists.txt" else f"project('consumer', '{language.lower()}')\n"
    open(f"{path}/{file}", "w", encoding="utf-8").write(head + text)
    return path


def cmake_build(path, *options):
    run(["cmake", "-S", path, "-B", f"{path}/build"] + LAUNCHER + list(options), path)
    run(["cmake", "--build", f"{path}/build", "-j", JOBS], path)


def cmake_with_installed(folder, label, prefix):
    """find_package of both targets, a project of C++ alone, and requests that cannot be met."""
    option = f"-DCMAKE_PREFIX_PATH={prefix}"
    for target in ("wisp", "wisp_static"):
        path = project(folder, f"{label} {target}", "CMakeLists.txt", pieces()[0].replace("wisp::wisp)", f"wisp::{target})"))
        cmake_build(path, option)
        expect(f"{label}, wisp::{target}", f"{path}/build/host")
        needs = run(["ldd", f"{path}/build/host"], path)
        if ("libwisp" in needs) == (target == "wisp_static"):
            sys.exit(f"FAILED: {label}, wisp::{target}: {needs}")
    path = project(folder, f"{label} C++", "CMakeLists.txt",
                   "find_package(wisp REQUIRED COMPONENTS static)\nadd_executable(host host.cpp)\ntarget_link_libraries(host PRIVATE wisp::wisp_static)\n", "CXX")
    open(f"{path}/host.cpp", "w", encoding="utf-8").write(
        "#include <wisp/wisp.h>\n#include <cstring>\nint main() { return std::strcmp( wisp_status_name( WISP_OK ), \"ok\" ); }\n")
    cmake_build(path, option)
    run([f"{path}/build/host"], path)
    for request, sentence in (("0.14 REQUIRED", f"version: {version}"), ("99 REQUIRED", f"version: {version}"),
                              ("REQUIRED COMPONENTS cuda", "there is no component cuda, only shared and static")):
        path = project(folder, f"{label} {request}", "CMakeLists.txt", f"find_package(wisp {request})\n")
        refused(f"{label}, refusal of {request}", ["cmake", "-S", path, "-B", f"{path}/build", option], path, sentence)


def installed(folder):
    run(["meson", "install", "-C", build, "--no-rebuild", "--quiet", "--destdir", f"{folder}/root"], folder)
    pc = next(f"{path}/wisp.pc" for path, _, files in os.walk(f"{folder}/root") if "wisp.pc" in files)
    prefix = f"{folder}/root" + re.search(r"(?m)^prefix=(.*)", open(pc, encoding="utf-8").read()).group(1)
    libraries = os.path.dirname(os.path.dirname(pc))
    environment = {"PKG_CONFIG_PATH": os.path.dirname(pc), "LD_LIBRARY_PATH": libraries}
    path = project(folder, "pkg-config", "Makefile", "")
    words = f"pkg-config --define-variable=prefix='{prefix}'"
    for name, flags in (("shared", f"$({words} --cflags --libs wisp)"), ("static", f"$({words} --static --cflags --libs wisp | sed 's/-lwisp/-l:libwisp.a/')")):
        run(["bash", "-c", f"{' '.join(compiler)} host.c {flags} -o {name}"], path, **environment)
        expect(f"pkg-config, {name}", f"{path}/{name}", **environment)
    cmake_with_installed(folder, "CMake", prefix)
    path = project(folder, "meson", "meson.build", pieces()[2])
    run(["meson", "setup", f"{path}/build", path], path, PKG_CONFIG_SYSROOT_DIR=f"{folder}/root", **environment)
    run(["meson", "compile", "-C", f"{path}/build"], path, **environment)
    expect("meson, installed", f"{path}/build/host", **environment)


def sources(folder):
    # A library that CMake builds, in the folders of its own choice.
    path = f"{folder}/cmake"
    run(["cmake", "-S", source, "-B", path, f"-DCMAKE_INSTALL_PREFIX={folder}/root"] + LAUNCHER, folder)
    run(["cmake", "--build", path, "-j", JOBS], folder)
    run(["cmake", "--install", path], folder)
    names = []
    for library in (f"{path}/libwisp.so", f"{path}/libwisp.a", f"{build}/packaging/libwisp.so"):
        run([f"{source}/tests/install/test_exports.sh", library], folder)
        names.append(run(["bash", "-c", f"nm -D --defined-only '{library}' | awk '{{ print $3 }}' | sort"], folder) if library.endswith(".so") else None)
    if names[0] != names[2]:
        sys.exit("FAILED: the shared libraries of CMake and of meson export different names")
    pc = next(found for found, _, files in os.walk(f"{folder}/root") if "wisp.pc" in files)
    host_folder = project(folder, "pkg-config of CMake", "Makefile", "")
    run(["bash", "-c", f"{' '.join(compiler)} host.c $(pkg-config --static --cflags --libs wisp | sed 's/-lwisp/-l:libwisp.a/') -o host"], host_folder, PKG_CONFIG_PATH=pc)
    expect("CMake's library, pkg-config", f"{host_folder}/host")
    cmake_with_installed(folder, "CMake's library", f"{folder}/root")

    # As a part of other projects. With ccache they share the objects of above; without, no optimisation is faster.
    options = [f"-DFETCHCONTENT_SOURCE_DIR_WISP={source}"]
    options += ["-DCMAKE_BUILD_TYPE=Release"] if LAUNCHER else ["-DCMAKE_BUILD_TYPE=None", "-DCMAKE_C_FLAGS=-O0"]
    fetch = pieces()[1]
    added = fetch[fetch.index("add_executable"):].replace("wisp::wisp_static", "wisp::wisp")
    for name, text in (("FetchContent", fetch), ("add_subdirectory", f'add_subdirectory("{source}" wisp)\n{added}')):
        path = project(folder, name, "CMakeLists.txt", text)
        cmake_build(path, *options)
        expect(name, f"{path}/build/host")
    path = project(folder, "subproject", "meson.build", pieces()[2])
    os.makedirs(f"{path}/subprojects/packagefiles")
    shutil.copy(f"{source}/packaging/wisp.wrap", f"{path}/subprojects/wisp.wrap")
    archive = re.search(r"(?m)^source_filename = (.*)$", open(f"{path}/subprojects/wisp.wrap", encoding="utf-8").read()).group(1)
    top = os.path.basename(archive).removesuffix(".tar.gz")
    run(["tar", "-C", source, "--exclude=./build*", "--exclude=./.git", "--exclude=./web", "--exclude=./data", "--transform", f"s,^\\.,{top},", "-czf", f"{path}/subprojects/packagefiles/{archive}", "."], folder)
    run(["meson", "setup", f"{path}/build", path, "--buildtype=debug", "-Dwisp:default_library=static", "--force-fallback-for=wisp"], path)
    run(["meson", "compile", "-C", f"{path}/build", "-j", JOBS], path)
    expect("meson subproject", f"{path}/build/host")
    built = [file for _, _, files in os.walk(f"{path}/build/subprojects") for file in files if file in ("wisp", "embed") or file.startswith("test_")]
    if built:
        sys.exit(f"FAILED: the subproject also built {built}")


expected = run([host], ".").strip()
version = re.search(r"version : '(.*)'", open(f"{source}/meson.build", encoding="utf-8").read()).group(1)
with tempfile.TemporaryDirectory(prefix="wisp-consumers-") as temporary:
    {"installed": installed, "sources": sources}[mode](temporary)
print(f"{sum(results.values())} passed, {len(results) - sum(results.values())} failed")
sys.exit(not all(results.values()))
