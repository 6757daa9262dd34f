#!/usr/bin/env python3
"""Check the pages: run their commands, compile their programs, follow their links.

usage: check_docs.py SOURCE_TREE BUILD_FOLDER

Every indented or fenced line of README.md, docs/*.md and examples/README.md that is a command of `wisp` or `./dev` runs with the programs that are
built, in an empty folder with the data of the tree; `scene.yaml` is the first whole scene of the page. Commands that install, measure for minutes or build the whole tree are not run: NOT_RUN lists
them, and a command that is neither run nor listed fails. Fenced C programs are compiled and run by the test `install and embed`.
"""
import os
import re
import subprocess
import sys
import tempfile

source, build = (os.path.abspath(path) for path in sys.argv[1:3])
PAGES = ["README.md", "examples/README.md", "data/README.md"] + ["docs/" + name for name in sorted(os.listdir(f"{source}/docs")) if name.endswith(".md")]

# Beginnings of commands that are checked by name only, and why.
NOT_RUN = {
    "./dev setup": "installs packages",
    "./dev test": "is this test suite",
    "./dev bench": "measures for minutes; its case must exist",
    "./dev stability": "measures for minutes",
    "./dev reference": "computes for half an hour",
    "./dev docs": "writes into the tree",
    "./dev api": "needs doxygen",
    "./dev lint": "compiles everything twice",
    "./dev sanitize": "compiles everything",
    "./dev tsan": "compiles everything",
    "./dev fuzz": "runs for minutes",
    "./dev build": "compiles everything",
    "./dev help": "is read below",
    "wisp bench": "measures for minutes; its case must exist",
    "wisp tune": "needs an idle machine for minutes",
    "meson setup": "runs in the test 'install and embed'",
    "cc ": "runs in the test 'install and embed'",
    "perf ": "needs a kernel that allows it",
}
failures = []


def fail(page, line, what):
    failures.append(f"{page}:{line}: {what}")


def blocks(text):
    """Yield (line number, line, language) of fenced and indented lines; the language of indented ones is ''."""
    language = None
    for number, line in enumerate(text.split("\n"), 1):
        fence = re.match(r"```(\w*)", line)
        if fence:
            language = (fence.group(1) or "text") if language is None else None
        elif language is not None:
            yield number, line, language
        elif line.startswith("    ") and not line.lstrip().startswith(("-", "*", "|")):
            yield number, line[4:], ""


def clean(command):
    command = re.sub(r"\s+#.*$", "", command)
    return re.split(r"\s{3,}", command.strip())[0].strip()


def known_words():
    help_text = subprocess.run([f"{source}/dev", "help"], capture_output=True, text=True).stdout
    verbs = set(re.findall(r"(?m)^  (\w+)", help_text))
    cases = subprocess.run([f"{build}/app/wisp-bench", "--list"], capture_output=True, text=True).stdout
    return verbs, set(re.findall(r"(?m)^\s*(\w+)", cases)) | {"instructions"}


def check_name(page, number, command, verbs, cases):
    words = command.split()
    if words[0] == "./dev" and len(words) > 1 and words[1] not in verbs:
        fail(page, number, f"'{command}': ./dev has no command '{words[1]}'")
    for program in (["./dev", "bench"], ["wisp", "bench"]):
        if words[:2] == program:
            for word in words[2:3]:
                if re.fullmatch(r"\w+", word) and word not in cases and word not in ("CASE", "SUITE"):
                    fail(page, number, f"'{command}': no case '{word}' of the benchmark")


def run(page, number, command, folder):
    line = re.sub(r"^\./dev wisp ", "wisp ", command)
    line = re.sub(r"^\./dev run ", "wisp run ", line)
    line = re.sub(r"^\./dev (plan|info|render) ", r"wisp \1 ", line)
    line = line.split(" | ")[0]
    result = subprocess.run(["bash", "-c", line], cwd=folder, capture_output=True, text=True,
                            env={**os.environ, "PATH": f"{build}/app:" + os.environ["PATH"]}, timeout=120)
    if result.returncode != 0:
        fail(page, number, f"'{command}' ends with {result.returncode}: {result.stderr.strip()[:300]}")


def anchors(text):
    """Names that headings can be linked by."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in re.findall(r"(?m)^#+ (.*)$", text)}


def check_links(page, text):
    for number, line in enumerate(text.split("\n"), 1):
        for target in re.findall(r"\]\(([^)\s]+)\)", line):
            if re.match(r"\w+:", target):
                continue
            path, _, anchor = target.partition("#")
            file = os.path.normpath(os.path.join(source, os.path.dirname(page), path)) if path else f"{source}/{page}"
            if not os.path.exists(file):
                fail(page, number, f"link to '{target}': no such file")
            elif anchor and file.endswith(".md") and anchor not in anchors(open(file, encoding="utf-8").read()):
                fail(page, number, f"link to '{target}': no such heading")
        for path in re.findall(r"`((?:engine|modules|app|bench|tests|data|docs|examples)/[\w./-]+\.\w+)`", line):
            if "NAME" not in path and not os.path.exists(f"{source}/{path}"):
                fail(page, number, f"'{path}': no such file")


def main():
    verbs, cases = known_words()
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(f"{source}/data", f"{folder}/data")
        for page in PAGES:
            text = open(f"{source}/{page}", encoding="utf-8").read()
            check_links(page, text)
            first_scene = re.search(r"```yaml\n(wisp: .*?)```", text, re.S)
            if first_scene:
                open(f"{folder}/scene.yaml", "w", encoding="utf-8").write(first_scene.group(1))
            for number, line, language in blocks(text):
                command = clean(line) if language in ("", "sh", "text") else ""
                if not re.match(r"(\./dev|wisp|meson|cc|perf)\b", command):
                    continue
                check_name(page, number, command, verbs, cases)
                if any(command.startswith(word) for word in NOT_RUN) or re.search(r"\b[A-Z]{4,}\b", command):
                    continue
                run(page, number, command, folder)
                count += 1
    print("\n".join(failures))
    print(f"{count} commands of {len(PAGES)} pages ran")
    print(f"{0 if failures else 1} passed, {len(failures)} failed")
    return 1 if failures or count == 0 else 0


sys.exit(main())
