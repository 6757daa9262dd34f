#!/usr/bin/env python3
"""The weight of the tree: lines and files of C per room, rows and CPU seconds of builds, public functions, scene keys, lines of documents.

budget.json has a limit for each number. The test suite holds them. A number may only fall; a commit that raises a limit says why.
"""
import argparse
import collections
import json
import os
import re
import resource
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TREE = os.path.dirname(os.path.dirname(HERE))
ROOMS = ["engine", "modules", "create", "app", "app/io", "bench", "web", "examples",
         "tests/engine", "tests/modules", "tests/oracle", "tests/app", "tests/bench", "tests"]
# Targets of `./dev run`, and those of `./dev test`.
FIRST, TESTS = ["app/wisp"], ["all"]


def files_of(tree):
    try:
        out = subprocess.run(["git", "-C", tree, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout.split("\0")[:-1]
        return [f for f in out if os.path.isfile(os.path.join(tree, f))]
    except (OSError, subprocess.CalledProcessError):  # an unpacked archive
        found = [os.path.relpath(os.path.join(folder, f), tree) for folder, _, names in os.walk(tree) for f in names]
        return [f for f in found if not f.startswith("build")]


def read(tree, file):
    with open(os.path.join(tree, file), encoding="utf-8") as stream:
        return stream.read()


def room_of(file):
    return max((room for room in ROOMS if file.startswith(room + "/")), key=len, default="(elsewhere)")


def is_public(file):
    found = re.match(r"engine/include/wisp/(?:module/)?\w+\.h$|create/wisp/\w+\.h$|create/\w+\.h$|modules/(\w+)/(\w+)\.h$", file)
    return bool(found) and found[1] == found[2]


def weigh(tree):
    """All numbers that the text of the tree alone tells."""
    lines, files = collections.Counter(), collections.Counter()
    functions, documents = set(), 0
    for file in files_of(tree):
        if file.endswith((".c", ".h", ".cc", ".cpp", ".hpp")):
            text = read(tree, file)
            lines[room_of(file)] += text.count("\n")
            files[room_of(file)] += 1
            if is_public(file) and file.endswith(".h"):
                functions |= set(re.findall(r"^(?:[A-Za-z_][\w *]*?[ *])(wisp_\w+)\(", text, re.M))
        elif file.endswith(".md"):
            documents += read(tree, file).count("\n")
    keys = read(tree, "docs/scenes.md").split("<!-- keys: begin -->")[1].split("<!-- keys: end -->")[0]
    out = {"lines of C": sum(lines.values()), "files of C": sum(files.values())}
    for room in ROOMS:
        out[f"lines of C, {room}"] = lines[room]
    out.update({"public functions": len(functions), "scene keys": len(re.findall(r"^- `", keys, re.M)), "choice words": len(re.findall(r"^  - `", keys, re.M)), "lines of documents": documents})
    return out


def rows_of(folder, targets):
    """Commands that build these targets from nothing."""
    done = subprocess.run(["ninja", "-C", folder, "-t", "commands", *targets], check=True, capture_output=True, text=True)
    # A first build has the kernels of its machine: of the three sets of this processor family, two.
    skipped = ("ninja: ",) if targets != FIRST else ("ninja: ", "-o engine/kernels/libwisp_kernels_avx2")
    return sum(not any(word in line for word in skipped) for line in done.stdout.splitlines())


def weigh_rows(folder):
    return {"build rows, first": rows_of(folder, FIRST), "build rows, tests": rows_of(folder, TESTS)}


def weigh_builds(tree, folder):
    """CPU seconds of a build from nothing, without a compiler cache."""
    out, environment = {}, {**os.environ, "CCACHE_DISABLE": "1"}
    for name, targets, options in (("first", FIRST, ["-Dtests=false", "-Dexamples=false", "-Dkernels=native"]), ("tests", TESTS, [])):
        shutil.rmtree(folder, ignore_errors=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(["meson", "setup", folder, tree, *options], check=True, env=environment, stdout=subprocess.DEVNULL)
        subprocess.run(["ninja", "-C", folder, *targets], check=True, env=environment, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        out[f"CPU s of the build, {name}"] = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    shutil.rmtree(folder, ignore_errors=True)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("action", nargs="?", default="show", choices=["show", "check", "lower"],
                        help="show the numbers beside their limits; check fails if one is above; lower writes lower ones into budget.json")
    parser.add_argument("--tree", default=TREE)
    parser.add_argument("--rows", metavar="FOLDER", help="count the rows of this build folder too")
    parser.add_argument("--build", metavar="FOLDER", help="build from nothing in this folder and count CPU seconds, minutes")
    arguments = parser.parse_args()
    store = os.path.join(HERE, "budget.json")
    with open(store, encoding="utf-8") as stream:
        budget = json.load(stream)
    found = weigh(arguments.tree)
    if arguments.rows:
        found.update(weigh_rows(arguments.rows))
    if arguments.build:
        found.update(weigh_builds(arguments.tree, arguments.build))
    above = [name for name in found if found[name] > budget.get(name, 0)]
    if arguments.action == "show":
        for name in {**budget, **found}:
            print(f"{name:28} {found.get(name, '-'):>8} of {budget.get(name, 0):>8}{'  ABOVE' if name in above else ''}")
    if arguments.action == "lower":
        budget.update({name: number for name, number in found.items() if number < budget.get(name, number + 1)})
        with open(store, "w", encoding="utf-8") as stream:
            stream.write(json.dumps(budget, indent=1) + "\n")
    for name in above if arguments.action == "check" else []:
        print(f"weigh: {name}: {found[name]}, and budget.json allows {budget.get(name, 0)}: remove as much elsewhere, or argue a higher limit in the commit")
    return 1 if above and arguments.action == "check" else 0


if __name__ == "__main__":
    sys.exit(main())
