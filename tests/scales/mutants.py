#!/usr/bin/env python3
"""Mutants of the engine, the modules and the readers, and the tests that kill each.

All mutants are compiled into one build: each is an expression of its own that WISP_MUTANT=<id> chooses at run time, so that a mutant
costs the run of its tests and no build. `make` chooses a seeded list, runs it and stores it; `check` holds a later tree to the
stored list: a mutant that was killed must still be killed.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOMS = {"engine": 0.35, "modules": 0.45, "app/io": 0.2}  # share of the mutants
SLOWEST = 20.0  # s; slower tests are not asked for a mutant
PATIENCE = 40.0  # s of tests for a mutant, those of its room first
# Tests of files, packages and pages; none of them asks the engine.
NOT_ASKED = re.compile(r"layers|docs|install|hosts|exported|completions|packag|meson and CMake|binary interface|example|C\+\+|fuzz|torture|stability")
IDLE = {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "0"}  # several tests share the cores
GOLDEN = re.compile(r"determinism|^gate")

HEADER = """\
#pragma once
extern int wisp_mutant;
extern unsigned char wisp_mutants_reached[%d];
#define MUTANT( n ) ( wisp_mutants_reached[n] = 1, wisp_mutant == ( n ) )
"""
TAIL = """
// ---- mutants ----
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
__attribute__( ( visibility( "default" ) ) ) int wisp_mutant = -1;
__attribute__( ( visibility( "default" ) ) ) unsigned char wisp_mutants_reached[%d];
__attribute__( ( constructor ) ) static void choose_mutant( void )
{
    const char* name = getenv( "WISP_MUTANT" );
    wisp_mutant = name ? atoi( name ) : -1;
}
__attribute__( ( destructor ) ) static void write_reached( void )
{
    const char* folder = getenv( "WISP_MUTANTS_REACHED" );
    char path[512];
    FILE* file = folder && snprintf( path, sizeof path, "%%s/%%d", folder, (int)getpid() ) > 0 ? fopen( path, "a" ) : NULL;
    for ( int n = 0; file && n < %d; ++n )
    {
        if ( wisp_mutants_reached[n] )
        {
            fprintf( file, "%%d\\n", n );
        }
    }
    if ( file )
    {
        fclose( file );
    }
}
"""

# ---- where an expression can change ----

CONTEXTS = [
    ("condition", re.compile(r"^( +(?:else )?(?:if|while) \( )(.+)( \))$")),
    ("loop", re.compile(r"^( +for \( [^;]*; )([^;]+)(; [^;]*\))$")),
    ("return", re.compile(r"^( +return )([^;]+)(;)$")),
    ("assignment", re.compile(r"^( +(?:const )?[\w ]*[\w*\]\[.>+-]*?(?: [+*/|&-]?= ))([^;]+)(;(?: *//.*)?)$")),
    ("call", re.compile(r"^( +)(\w+\( [^;]+ \))(;)$")),
]
SWAPS = [
    ("comparison", r" < ", " <= "), ("comparison", r" <= ", " < "), ("comparison", r" > ", " >= "), ("comparison", r" >= ", " > "),
    ("comparison", r" == ", " != "), ("comparison", r" != ", " == "), ("logic", r" && ", " || "), ("logic", r" \|\| ", " && "),
    ("sign", r" \+ ", " - "), ("sign", r" - ", " + "), ("factor", r" \* ", " / "),
    ("sign", r"_add\( ", "_sub( "), ("sign", r"_sub\( ", "_add( "), ("bound", r"_min\( ", "_max( "), ("bound", r"_max\( ", "_min( "),
    ("bound", r"\bfminf\( ", "fmaxf( "), ("bound", r"\bfmaxf\( ", "fminf( "),
    ("comparison", r"_lt\( ", "_le( "), ("comparison", r"_le\( ", "_lt( "), ("logic", r"m_and\( ", "m_or( "), ("logic", r"m_or\( ", "m_and( "),
]


def depth_at(text, place):
    return sum(c in "([{" for c in text[:place]) - sum(c in ")]}" for c in text[:place])


def changes(kind, expression):
    """All changed forms of an expression: (kind of change, text)."""
    if '"' in expression or "{" in expression or "?" in expression and kind == "call":
        return
    if any(depth_at(expression, m.start()) == 0 for m in re.finditer(",", expression)):
        return
    if kind == "call":
        yield "drop a call", None
        return
    for name, old, new in SWAPS:
        for found in re.finditer(old, expression):
            yield name, expression[:found.start()] + new + expression[found.end():]
    for found in re.finditer(r"(?<![\w.\[])(\d+)(?![\w.])", expression):
        yield "off by one", expression[:found.start()] + str(int(found[1]) + 1) + expression[found.end():]
    for found in re.finditer(r"\b(\d+\.\d+)f\b", expression):
        value = float(found[1])
        yield "factor", f"{expression[:found.start()]}{2 * value if value else 0.001!r}f{expression[found.end():]}"
    if not re.search(r"[<>=?]|&&|\|\|", expression):
        places = [m for m in re.finditer(r" ([+*-]) ", expression) if depth_at(expression, m.start()) == 0]
        for index, place in enumerate(places):
            end = places[index + 1].start() if index + 1 < len(places) else len(expression)
            if index + 1 < len(places) and place[1] != "*" and places[index + 1][1] == "*":
                continue  # the next factor belongs to the dropped term
            yield "drop a factor" if place[1] == "*" else "drop a term", expression[:place.start()] + expression[end:]


def candidates(text):
    """All mutants of a file: (line number from 0, kind, line, changed expression or None)."""
    in_macro = False
    for number, line in enumerate(text.split("\n")):
        was_macro, in_macro = in_macro, line.endswith("\\")
        if was_macro or in_macro or line.lstrip().startswith(("#", "//", "static ", "*")) or "ASSERT" in line or "assert" in line:
            continue
        for kind, pattern in CONTEXTS:
            found = pattern.match(line)
            if found:
                for change, new in changes(kind, found[2]):
                    yield number, change, line, new
                break


def rewritten(line, rows):
    """The line with all its mutants as choices. Rows: (id, changed expression or None)."""
    for kind, pattern in CONTEXTS:
        found = pattern.match(line)
        if found:
            out = f"( {found[2]} )"
            for number, new in rows:
                if new is None:
                    return f"{found[1]}if ( !MUTANT( {number} ) ) {{ {found[2]}; }}"
                out = f"( MUTANT( {number} ) ? ( {new} ) : {out} )"
            return found[1] + out + found[3]
    raise ValueError(line)


# ---- the tree with mutants ----

def tracked(tree):
    return subprocess.run(["git", "-C", tree, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout.split("\0")[:-1]


def sources(tree):
    return [f for f in tracked(tree) if f.endswith(".c") and any(f.startswith(room + "/") for room in ROOMS)]


def room_of(file):
    return next(room for room in ROOMS if file.startswith(room + "/"))


def function_of(lines, number):
    for line in reversed(lines[:number]):
        found = re.match(r"^\w[^;=]*?(\w+)\)?\( ", line)
        if found and not line.startswith(("typedef", "#")):
            inner = re.match(r"^.*\bKERNEL\( (\w+) \)", line)
            return inner[1] if inner else found[1]
    return "?"


def choose(tree, count, seed):
    rng = random.Random(seed)
    by_room = collections.defaultdict(list)
    for file in sources(tree):
        by_room[room_of(file)].append(file)
    out = []
    for room, share in ROOMS.items():
        files = sorted(by_room[room])
        # A file as often as it is long, so that each line is as likely as another.
        weights = [os.path.getsize(os.path.join(tree, f)) for f in files]
        wanted, taken = round(count * share), set()
        while wanted > 0:
            file = rng.choices(files, weights)[0]
            with open(os.path.join(tree, file), encoding="utf-8") as stream:
                text = stream.read()
            found = [row for row in candidates(text) if (file, row[0]) not in taken]
            if not found:
                continue
            kinds = sorted({row[1] for row in found})
            kind = rng.choice(kinds)
            number, change, line, new = rng.choice([row for row in found if row[1] == kind])
            taken.add((file, number))
            out.append({"file": file, "function": function_of(text.split("\n"), number), "line": number + 1, "change": change, "from": line, "to": new})
            wanted -= 1
    return out


def place(tree, mutant):
    """The line of a mutant in this tree, or None: the nearest line with its text, in its file or in one to which it moved."""
    path = os.path.join(tree, mutant["file"])
    paths = [path] if os.path.exists(path) else []
    paths += [os.path.join(tree, f) for f in sources(tree) if os.path.join(tree, f) != path]
    for path in paths:
        with open(path, encoding="utf-8") as stream:
            lines = stream.read().split("\n")
        hits = [n for n, line in enumerate(lines) if line == mutant["from"]]
        # In another file a short line says little: the function must be the same too.
        if path != os.path.join(tree, mutant["file"]):
            hits = [n for n in hits if function_of(lines, n) == mutant["function"]]
        if hits:
            return os.path.relpath(path, tree), min(hits, key=lambda n: abs(n + 1 - mutant["line"]))
    return None


def build(tree, work, mutants, jobs):
    """Copy the tree, put the mutants in, build; drop those that do not compile. Returns the numbers that did."""
    copy, folder = os.path.join(work, "tree"), os.path.join(work, "tree", "build")  # tests look for data beside the build
    shutil.rmtree(work, ignore_errors=True)
    for file in tracked(tree):
        if os.path.exists(os.path.join(tree, file)):
            os.makedirs(os.path.dirname(os.path.join(copy, file)), exist_ok=True)
            shutil.copy2(os.path.join(tree, file), os.path.join(copy, file))
    places = {n: place(tree, mutant) for n, mutant in enumerate(mutants)}
    alive = {n for n in places if places[n]}

    def write(file):
        with open(os.path.join(tree, file), encoding="utf-8") as stream:
            lines = stream.read().split("\n")
        rows = collections.defaultdict(list)
        for n in sorted(alive):
            if places[n][0] == file:
                rows[places[n][1]].append((n, mutants[n]["to"]))
        for number, found in rows.items():
            lines[number] = rewritten(lines[number], found)
        if file == "engine/base/status.c":
            lines.append(TAIL % (len(mutants), len(mutants)))
        with open(os.path.join(copy, file), "w", encoding="utf-8") as stream:
            stream.write("\n".join(lines))

    for file in sorted({places[n][0] for n in alive} | {"engine/base/status.c"}):
        write(file)
    header = os.path.join(work, "mutants.h")
    with open(header, "w", encoding="utf-8") as stream:
        stream.write(HEADER % len(mutants))
    subprocess.run(["meson", "setup", folder, copy, "-Doptimization=1", "-Dexamples=false", "-Dman=disabled", f"-Dc_args=-include {header}"],
                   check=True, stdout=subprocess.DEVNULL)
    while True:
        done = subprocess.run(["ninja", "-C", folder, "-k", "0", "-j", str(jobs)], capture_output=True, text=True, check=False)
        # A name that does not exist is only a warning to the compiler.
        wrong = {(os.path.relpath(os.path.join(folder, m[1]), copy), int(m[2]) - 1)
                 for m in re.finditer(r"^(\S+?):(\d+):\d+: (?:error|warning: implicit declaration)", done.stdout, re.M)}
        dropped = {n for n in alive if places[n] in wrong}
        if done.returncode == 0 and not dropped:
            return alive
        if not dropped:
            sys.exit(done.stdout[-4000:] + "\nmutants: the tree does not build")
        print(f"mutants: {len(dropped)} do not compile", flush=True)
        alive -= dropped
        for file in {places[n][0] for n in dropped}:
            write(file)


# ---- runs ----

class Tests:
    def __init__(self, folder, jobs):
        known = json.loads(subprocess.run(["meson", "introspect", "--tests", folder], check=True, capture_output=True, text=True).stdout)
        self.rows = {t["name"]: t for t in known if not NOT_ASKED.search(t["name"])}
        self.seconds, self.reached, self.jobs = {}, {}, jobs

    def run(self, name, limit, **env):
        """True if the test passes."""
        test = self.rows[name]
        with tempfile.TemporaryDirectory() as scratch:
            start = time.monotonic()
            process = subprocess.Popen(test["cmd"], cwd=test["workdir"] or scratch, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, env={**os.environ, **IDLE, **test["env"], **env}, start_new_session=True)
            try:
                status = process.wait(limit)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                process.wait()
                status = "time"
            return status in (0, 77), time.monotonic() - start

    def survey(self):
        """Run each test once: those that pass are asked, with what they reach."""
        def one(name):
            with tempfile.TemporaryDirectory() as folder:
                passed, seconds = self.run(name, 3 * SLOWEST, WISP_MUTANTS_REACHED=folder)
                reached = {int(n) for f in os.listdir(folder) for n in open(os.path.join(folder, f), encoding="utf-8").read().split()}
            return name, passed, seconds, reached
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for name, passed, seconds, reached in pool.map(one, sorted(self.rows)):
                if passed and seconds <= SLOWEST:
                    self.seconds[name], self.reached[name] = seconds, reached
                else:
                    print(f"mutants: not asked: {name}, {'slow' if passed else 'fails without a mutant'}, {seconds:.0f} s", flush=True)

    def asked(self, number, mutant):
        """Names of the tests for a mutant, quick ones first: those of its room and the golden hashes; then all others."""
        reach = sorted((n for n in self.reached if number in self.reached[n]), key=lambda n: self.seconds[n])
        parts = mutant["file"].split("/")
        own = {"engine": ("engine", "math"), "modules": ("modules " + parts[1],), "app": ("io",)}[parts[0]]
        wide = {"engine": ("engine",), "modules": ("modules",), "app": ("io",)}[parts[0]]
        first = [n for n in reach if n.startswith(own)]
        second = [n for n in reach if n not in first and (n.startswith(wide) or GOLDEN.search(n))]
        return first + second, [n for n in reach if n not in first and n not in second]

    def kills(self, name, number):
        return not self.run(name, max(10.0, 6 * self.seconds[name]), WISP_MUTANT=str(number))[0]

    def killers(self, number, mutant, known=()):
        """The tests that kill a mutant. With known killers, the first that still does."""
        room, others = self.asked(number, mutant)
        out, spent = [], 0.0
        for name in known:
            if name in self.seconds and self.kills(name, number):
                return [name]
        for name in room:
            if spent + self.seconds[name] > PATIENCE:
                continue
            spent += self.seconds[name]
            if self.kills(name, number):
                out.append(name)
                if known:
                    return out
        for name in others if not out else []:
            if spent + self.seconds[name] <= 2 * PATIENCE and self.kills(name, number):
                return [name]
            spent += self.seconds[name]
        return out


def ask(tests, mutants, alive, known=False):
    def one(n):
        return n, tests.killers(n, mutants[n], mutants[n].get("killed_by", []) if known else [])
    out = {}
    with concurrent.futures.ThreadPoolExecutor(tests.jobs) as pool:
        for n, killers in pool.map(one, sorted(alive)):
            out[n] = killers
            print(f"mutants: {n} {mutants[n]['file']}:{mutants[n]['line']} {mutants[n]['change']}: "
                  f"{'killed by ' + ', '.join(killers[:3]) if killers else 'SURVIVES'}", flush=True)
    return out


def is_reached(tests, n):
    return any(n in reached for reached in tests.reached.values())


def make(arguments):
    # Some do not compile: choose a few more.
    mutants = choose(arguments.tree, round(arguments.count * 1.25), arguments.seed)
    alive = build(arguments.tree, arguments.work, mutants, arguments.jobs)
    tests = Tests(os.path.join(arguments.work, "tree", "build"), arguments.jobs)
    tests.survey()
    killers = ask(tests, mutants, alive)
    rows = [{**mutants[n], "killed_by": killers[n], **({} if killers[n] or is_reached(tests, n) else {"reached": False})} for n in sorted(alive)]
    with open(arguments.store, "w", encoding="utf-8") as stream:
        stream.write('{ "seed": %d, "mutants": [\n' % arguments.seed + ",\n".join(json.dumps(row) for row in rows) + "\n] }\n")
    report(rows)


def report(rows):
    survivors = [row for row in rows if not row["killed_by"]]
    print(f"mutants: {len(rows)}, killed {len(rows) - len(survivors)}, survive {len(survivors)}")
    for row in survivors:
        print(f"  {row['file']}:{row['line']} {row['function']}: {row['change']}: {row['from'].strip()} -> {row['to'] or '(nothing)'}"
              + ("" if row.get("reached", True) else " (no test reaches it)"))


def check(arguments):
    with open(arguments.store, encoding="utf-8") as stream:
        mutants = json.load(stream)["mutants"]
    alive = build(arguments.tree, arguments.work, mutants, arguments.jobs)
    tests = Tests(os.path.join(arguments.work, "tree", "build"), arguments.jobs)
    tests.survey()
    was_killed = {n for n in alive if mutants[n]["killed_by"]}
    killers = ask(tests, mutants, was_killed, known=True)
    lost = [n for n in was_killed if not killers[n]]
    gone = [n for n in range(len(mutants)) if n not in alive]
    print(f"mutants: {len(mutants)} stored, {len(gone)} of lines that are gone, {len(was_killed)} were killed and are there, {len(lost)} survive now")
    for n in lost:
        row = mutants[n]
        print(f"  {row['file']}:{row['line']} {row['function']}: {row['change']}: {row['from'].strip()} -> {row['to'] or '(nothing)'}; was killed by {', '.join(row['killed_by'])}")
    return 1 if lost else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("action", choices=["make", "check", "list"])
    parser.add_argument("--tree", default=os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    parser.add_argument("--work", help="folder of the copy and its build, made anew; default TREE/build-mutants")
    parser.add_argument("--store", help="default: mutants.json beside this file")
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    arguments.work = arguments.work or os.path.join(arguments.tree, "build-mutants")
    arguments.store = arguments.store or os.path.join(os.path.dirname(os.path.abspath(__file__)), "mutants.json")
    if arguments.action == "list":
        with open(arguments.store, encoding="utf-8") as stream:
            report(json.load(stream)["mutants"])
        return 0
    return make(arguments) if arguments.action == "make" else check(arguments)


if __name__ == "__main__":
    sys.exit(main())
