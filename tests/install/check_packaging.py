#!/usr/bin/env python3
"""Check the files of packaging/ as far as that is possible without their package managers: they can be read, name the version of
meson.build, and set only options that CMakeLists.txt has.

usage: check_packaging.py SOURCE_TREE
"""
import ast
import configparser
import json
import re
import sys

source = sys.argv[1]
failures = []


def read(path):
    return open(f"{source}/{path}", encoding="utf-8").read()


def expect(what, got, expected):
    if got != expected:
        failures.append(f"{what}: got {got}, expected {expected}")


version = re.search(r"version : '(.*)'", read("meson.build")).group(1)
options = set(re.findall(r"(?m)^option\((WISP_\w+)", read("CMakeLists.txt")))

port = json.loads(read("packaging/vcpkg/wisp/vcpkg.json"))
expect("vcpkg.json: name and version", (port["name"], port["version"]), ("wisp", version))
recipe = ast.parse(read("packaging/conan/conanfile.py"))
expect("conanfile.py: classes", [node.name for node in recipe.body if isinstance(node, ast.ClassDef)], ["WispConan"])
for path in ("packaging/vcpkg/wisp/portfile.cmake", "packaging/conan/conanfile.py"):
    expect(f"{path}: options", set(re.findall(r"WISP_[A-Z]+", read(path))), options - {"WISP_INSTALL"})
features = {name.lower() for name in re.findall(r"WISP_(\w+)", " ".join(options))} - {"shared", "static", "install"}
expect("vcpkg.json: features", set(port["features"]), features)

wrap = configparser.ConfigParser()
wrap.read_string(read("packaging/wisp.wrap"))
expect("wisp.wrap: directory", wrap["wrap-file"]["directory"], f"wisp-{version}")
expect("wisp.wrap: file", wrap["wrap-file"]["source_filename"], f"wisp-{version}.tar.gz")
expect("wisp.wrap: provides", wrap["provide"]["dependency_names"], "wisp")

major, minor, _ = version.split(".")
series = f"{major}.{minor}"
page = read("docs/embedding.md")
for piece in (f"find_package(wisp {series} ", f"version : ['>= {series}', '< {major}.{int(minor) + 1}']", f"libwisp.so.{series}`"):
    if piece not in page:
        failures.append(f"docs/embedding.md: found no '{piece}', which names this version")

print("\n".join(failures))
print(f"{0 if failures else 1} passed, {len(failures)} failed")
sys.exit(bool(failures))
