#!/usr/bin/env python3
"""Line coverage per file of engine, modules and app, from a build with gcc's counters whose tests have run.

A line counts once, however often its file is compiled (kernels: once per instruction set).
"""
import collections
import csv
import gzip
import json
import os
import subprocess
import sys
import tempfile

ROOMS = ("engine/", "modules/", "create/", "app/")


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: coverage.py TREE BUILD-FOLDER OUT.csv")
    tree, folder, out = map(os.path.abspath, sys.argv[1:])
    counters = [os.path.join(place, f) for place, _, names in os.walk(folder) for f in names if f.endswith(".gcda")]
    if not counters:
        sys.exit(f"coverage: {folder} has no counters: no test has run there")
    executable, covered = collections.defaultdict(set), collections.defaultdict(set)
    with tempfile.TemporaryDirectory() as scratch:
        for index, counter in enumerate(counters):
            subprocess.run(["gcov", "--json-format", counter], cwd=scratch, check=False, capture_output=True)
            for name in os.listdir(scratch):
                with gzip.open(os.path.join(scratch, name)) as stream:
                    report = json.load(stream)
                os.remove(os.path.join(scratch, name))
                for file in report["files"]:
                    path = os.path.relpath(os.path.join(report["current_working_directory"], file["file"]), tree)
                    if path.startswith(ROOMS):
                        for line in file["lines"]:
                            executable[path].add(line["line_number"])
                            if line["count"]:
                                covered[path].add(line["line_number"])
    rows = [(path, len(executable[path]), len(covered[path])) for path in sorted(executable)]
    with open(out, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "lines", "covered"])
        writer.writerows(rows)
    for room in ROOMS:
        total = [sum(row[k] for row in rows if row[0].startswith(room)) for k in (1, 2)]
        print(f"coverage: {room:10} {total[1]:6} of {total[0]:6} lines, {100 * total[1] / max(1, total[0]):.1f} %")


if __name__ == "__main__":
    main()
