#!/usr/bin/env python3
"""Search for scenes that break the engine: Hypothesis draws them, `wisp torture` judges them, and those that break become small files.

usage: search.py WISP [--minutes M | --scenes N] [--seed S] [--jobs N] [--limit SECONDS] [--close] [--as-drawn] [--out FOLDER]

Exit status: 1 if a scene breaks. A seed has the same scenes on every machine with the same version of Hypothesis.
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import re
import subprocess
import sys
import time

import hypothesis
import yaml

from scenes import read_keys, scenes

TWINS = ["bits", "scale", "snapshot", "shift"]  # each scene is run again in one way, in turn: all of them would take five times as long


class Broken(AssertionError):
    """A scene breaks a judge. Each kind is a class of its own, so that Hypothesis keeps them apart."""


class Search:
    """A search with one seed."""

    def __init__(self, options, seed):
        self.options, self.seed = options, seed
        self.scenes, self.refused, self.kinds, self.found = 0, 0, {}, {}
        self.end = time.monotonic() + 60 * options.minutes if options.minutes else float("inf")
        self.path = pathlib.Path(options.out) / f"scene_{seed}.yaml"
        self.blocks = read_keys(subprocess.run([options.wisp, "info", "--keys"], capture_output=True, text=True, check=True).stdout)

    def judge(self, scene):
        """Return kind and message of what a scene breaks; None if it holds."""
        self.path.write_text(yaml.safe_dump(scene, sort_keys=False, default_flow_style=None, width=150), encoding="utf-8")
        twin = TWINS[len(json.dumps(scene)) % len(TWINS)]  # by the scene, so that a smaller one is judged in the same way whenever it comes
        command = [self.options.wisp, "torture", "--limit", str(self.options.limit), "--twin", twin, "--format", "json"]
        told = subprocess.run([*command, *["--close"][: self.options.close], self.path], capture_output=True, text=True)
        if told.returncode not in (0, 1):
            return "refused", told.stderr.strip()
        notes = " ".join(json.loads(told.stdout)["notes"])
        broken = re.search(r"\.yaml: (\w+): (.*)", notes)
        return (broken[1], broken[2]) if told.returncode else None

    def check(self, scene):
        if time.monotonic() > self.end + 120 or (time.monotonic() > self.end and not self.found):
            return
        verdict = self.judge(scene)
        self.scenes += 1
        if verdict and verdict[0] == "refused":
            self.refused += 1
        elif verdict:
            kind, message = verdict
            self.found[kind] = (message, scene)  # the last one is the smallest
            raise self.kinds.setdefault(kind, type(kind, (Broken,), {}))(message)

    def run(self):
        """Return counts and what was found: for each kind, its message and smallest scene."""
        count = self.options.scenes or 10**9
        phases = [hypothesis.Phase.generate, hypothesis.Phase.shrink][: 1 if self.options.as_drawn else 2]
        settings = hypothesis.settings(max_examples=count, deadline=None, database=None, phases=phases, suppress_health_check=list(hypothesis.HealthCheck))
        test = settings(hypothesis.seed(self.seed)(hypothesis.given(scenes(self.blocks))(self.check)))
        try:
            test()
        except (Broken, hypothesis.errors.HypothesisException, BaseExceptionGroup if sys.version_info >= (3, 11) else Broken):
            pass
        self.path.unlink(missing_ok=True)
        return self.scenes, self.refused, self.found


def run_job(options, seed):
    return seed, Search(options, seed).run()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wisp")
    parser.add_argument("--minutes", type=float)
    parser.add_argument("--scenes", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=20, help="seconds that a scene may take")
    parser.add_argument("--close", action="store_true", help="the limits of suites with checks, too")
    parser.add_argument("--as-drawn", action="store_true", help="make nothing smaller")
    parser.add_argument("--out", default="torture", help="folder of scenes that break")
    options = parser.parse_args()
    options.minutes = options.minutes or (None if options.scenes else 1)
    os.makedirs(options.out, exist_ok=True)
    with multiprocessing.Pool(options.jobs) as pool:
        jobs = [(options, options.seed * 1000 + job) for job in range(options.jobs)]
        results = pool.starmap(run_job, jobs)
    count = 0
    for seed, (_, _, found) in results:
        for kind, (message, scene) in found.items():
            path = pathlib.Path(options.out) / f"{kind}_{seed}.yaml"
            text = yaml.safe_dump(scene, sort_keys=False, default_flow_style=None, width=150)
            path.write_text(f"# {kind}: {message} (seed {seed}).\n{text}", encoding="utf-8")
            print(f"{path}: {kind}: {message}")
            count += 1
    print(f"scenes  {sum(r[0] for _, r in results)}, of these refused {sum(r[1] for _, r in results)}\nbroken  {count}")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
