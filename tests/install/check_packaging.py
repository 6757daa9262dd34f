#!/usr/bin/env python3
"""Check that packaging/ and the page for hosts name the version of meson.build.

usage: check_packaging.py SOURCE_TREE
"""
import configparser
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
