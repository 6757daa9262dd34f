#!/usr/bin/env python3
"""Write the tables of README and docs from the medians of a machine, as bench/tables.yaml describes them.

usage: tables.py [--check | MACHINE]        default: the machine that bench/tables.yaml names; MACHINE becomes that

A table stands between `<!-- table NAME -->` and `<!-- end -->`. --check writes nothing: exit status 1 and the names of tables that differ.
"""
import csv
import fnmatch
import math
import pathlib
import re
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Row(dict):
    """A row of medians. A cell that it does not have is shown as a dash."""

    def __missing__(self, name):
        base, _, of = name.partition(" of ")
        if of:  # such as `stretch_max of percent`: other units
            value = self[base]
            return value if value == "-" else digits(float(value) * {"percent": 100}[of])
        if name.startswith("ns_a_point_"):
            value = self["ms_" + name[-1]]
            return value if value == "-" else digits(1e6 * float(value) / float(self["points"]))
        if name == "setting":
            return self["variant"].split(", ", 1)[1]
        return "-"


def digits(value):
    """Return three digits, and all that are before the point."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def read_medians(path):
    """Return the first line of a file of medians, and its rows."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [Row((name, cell) for name, cell in row.items() if cell) for row in csv.DictReader(line for line in lines if not line.startswith("#"))]
    for row in rows:
        for ms, over in ("ms_1", "over_1"), ("ms_2", "over_2"):  # of a step over that of the first row
            if ms in row and ms in rows[0]:
                row[over] = f"{float(row[ms]) / float(rows[0][ms]):.2f}"
    return lines[0].lstrip("# "), rows


def matches(row, part):
    """Return whether a row has a value: NAME=VALUE, NAME<=VALUE, or a pattern of its variant."""
    named = re.fullmatch(r"([a-z_0-9]+)(<=|=)([\d.e+-]+)", part)
    if not named:
        return fnmatch.fnmatchcase(row["variant"], part.replace("[", "[[]"))
    name, relation, value = named.groups()
    return name in row and (float(row[name]) == float(value) if relation == "=" else float(row[name]) <= float(value))


def merged(rows):
    """Return one row of those that differ by the number of workers alone, or else the one with the least error."""
    if all(row["variant"] == rows[0]["variant"] for row in rows) and not any("ms_1" in row and "ms_2" in row for row in rows):
        return Row({name: cell for row in reversed(rows) for name, cell in row.items()})
    return min(rows, key=lambda row: float(row.get("error", math.inf)))


class Medians:
    """All medians of a machine."""

    def __init__(self, folder):
        self.files = {path.stem: read_medians(path) for path in sorted(folder.glob("*.csv"))}

    def find(self, source):
        """Return the row that `FILE | CASE | PART | ..` names: of those that match all parts, the one with the least error. `= TEXT` is a row of it."""
        if source.startswith("= "):
            return Row(text=source[2:])
        file, case, *parts = [part.strip() for part in source.split("|")]
        if file == "run":  # the machine and version of a file
            version, commit, date, cpu, cores, isa, compiler, *_ = self.files[case][0].split(", ")
            return Row(version=version.removeprefix("wisp "), commit=commit.removeprefix("commit "), date=date[:10], cpu=cpu, cores=cores, isa=isa, compiler=compiler)
        rows = [row for row in self.files[file][1] if row["case"] == case and all(matches(row, part) for part in parts)]
        worst = max((row.get("error", "") for row in rows), key=lambda error: float(error or -1), default="")
        return Row(merged(rows), worst=worst) if rows else None

    def series(self, file):
        """Return a row of sources for each case of a file and each solver in it, which variants begin with."""
        named = dict.fromkeys((row["case"], row["variant"].split(", ")[0]) for row in self.files[file][1])
        return [[f"`{case}`, {solver}", f"{file} | {case} | {solver}, *"] for case, solver in named]


def cell(text, rows):
    """Return a cell: `{0[NAME]}` is a value of the first row, and a dash where there is none."""
    known = [row or Row() for row in rows] + [Row()] * 5
    shown = re.sub(r"- / -", "-", text.format(*known))
    return shown if re.search(r"\d", shown) else "-"


def lines_of(table, medians):
    """Return the lines of a table."""
    if "text" in table:
        named = {name: medians.find(source) for name, source in table["of"].items()}
        if None in named.values():
            sys.exit(f"no row is '{next(source for source in table['of'].values() if medians.find(source) is None)}'")
        return table["text"].format(**named).splitlines()
    heads, cells = list(table["columns"]), list(table["columns"].values())
    lines = ["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|"]
    for row in table.get("rows") or medians.series(table["series"]):
        sources = [medians.find(source) for source in row[1:]]
        lines.append("| " + " | ".join([row[0], *(cell(text, sources) for text in cells[1:])]) + " |")
    return lines


def main():
    arguments, recipe = sys.argv[1:], ROOT / "bench/tables.yaml"
    text = recipe.read_text(encoding="utf-8")
    if arguments and arguments != ["--check"]:
        text = re.sub(r"(?m)^machine: .*$", f"machine: {arguments[0]}", text)
        recipe.write_text(text, encoding="utf-8")
    documents = yaml.safe_load(text)
    folder, differ = ROOT / "bench/results" / documents.pop("machine"), []
    if not folder.is_dir():
        sys.exit(f"tables.py: no medians in {folder}")
    medians = Medians(folder)
    for document, tables in documents.items():
        path = ROOT / document
        text = path.read_text(encoding="utf-8")
        for name, table in tables.items():
            begin, end = f"<!-- table {name} -->\n", "<!-- end -->"
            if begin not in text:
                sys.exit(f"{document}: no place for table '{name}'")
            before, rest = text.split(begin, 1)
            old, after = rest.split(end, 1)
            new = "\n".join(lines_of(table, medians)) + "\n"
            differ += [f"{document}: table '{name}' is not that of {folder.name}"] if new != old else []
            text = before + begin + new + end + after
        if arguments != ["--check"]:
            path.write_text(text, encoding="utf-8")
    if arguments == ["--check"] and differ:
        sys.exit("\n".join(differ))


main()
