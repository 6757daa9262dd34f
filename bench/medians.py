#!/usr/bin/env python3
"""Write the medians of a file of results as CSV.

usage: medians.py RESULTS.json >MEDIANS.csv

The first lines begin with # and say version, commit, date, machine and command, then what `error` is in each case. A row has the times of all numbers of workers; rows without a time are left out.
"""
import csv
import json
import sys

# Sizes that tell rows apart; where there is an error, the name of the variant does.
SIZES = ["strands", "vertices", "exponent"]
# Measures by the beginning of their names, and their columns.
MEASURES = {
    "stretch_max": "stretch_max", "stretch_mean": "stretch_mean", "energy_against": "energy", "max_intersections": "intersections",
    "largest_distance": "largest", "doubt": "doubt", "until": "until", "error_at_0_5_s": "at_0.5", "error_at_1_s": "at_1", "detail": "wrinkles",
    "points": "points", "edge_points": "edge_points", "iterations_mean": "iterations_mean", "contacts_at_the_end": "contacts", "neighbours": "neighbours",
    "ns_per_vertex_and_iteration": "ns_a_vertex_and_iteration", "late_height": "late_height", "late_energy": "late_energy", "late_stretch": "late_stretch", "late_detail": "late_wrinkles",
}
STAGES = ["guide_hair.ghosts"]


def short(value):
    """Return three digits, and all that are before the point."""
    return "" if value is None else f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def first_error(row):
    """Return name and value of what a row is judged by, if it is judged."""
    if "rms_share_of_length" in (row["error"] or {}):
        return "rms_share_of_length", row["error"]["rms_share_of_length"]
    for name, value in (row["error"] or {}).items():
        return (None, None) if name == "against" or any(name.startswith(beginning) for beginning in MEASURES) else (name, value)
    return None, None


def cells(row):
    """Return the columns of a row, without its times."""
    size, error = row["size"], first_error(row)[1]
    found = {name: size[name] for name in SIZES if name in size and not (name == "vertices" and error is not None)}
    if "strands" in size and "substeps" in size:
        found["substeps"] = size["substeps"]
    if "bytes" in size and "vertices" in found:
        found["bytes_a_vertex"] = size["bytes"] / size["vertices"]
    found["error"] = error
    for name, value in (row["error"] or {}).items():
        for beginning, column in MEASURES.items():
            if name.startswith(beginning):
                # names without a unit are fractions
                found.setdefault(column, 100 * value if name == beginning and name.startswith("stretch") else value)
    return {name: short(value) for name, value in found.items()}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        results = json.load(file)
    build, machine = results["build"], results["machine"]
    print(f"# wisp {build['version']}, commit {build['commit']}, {results['date']}, {machine['cpu']}, {machine['cores']} cores, {machine['isa']}, "
          f"{build['compiler']}, {build['flags']}; {results['options'].split(' --format')[0]}")
    lines, errors = [], {}
    for row in results["rows"]:
        if row["ms_median"] is None and "exponent" not in row["size"]:
            continue
        workers = row["workers"]
        case = row["case"].removeprefix("accuracy.").removeprefix("suite.")
        line = {"case": case, "variant": row["variant"], **cells(row)}
        name = first_error(row)[0]
        if name:
            errors.setdefault(case, name)
        if not lines or (lines[-1]["case"], lines[-1]["variant"]) != (case, line["variant"]) or f"ms_{workers}" in lines[-1]:
            lines.append(line)
        lines[-1][f"ms_{workers}"] = short(row["ms_median"])
        for stage in STAGES:
            if stage in row["stages"]:
                lines[-1][f"{stage}_{workers}"] = short(row["stages"][stage])
    for case, name in errors.items():
        print(f"# {case}: error is {name}")
    columns = dict.fromkeys(name for line in lines for name in line if any(other.get(name) for other in lines))
    writer = csv.DictWriter(sys.stdout, columns, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)


main()
