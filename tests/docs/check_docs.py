#!/usr/bin/env python3
"""Check the pages: run their commands, compile and run their programs, run their scenes, follow their links.

usage: check_docs.py SOURCE_TREE BUILD_FOLDER COMPILER...

Every indented or fenced line of README.md, docs/*.md and the READMEs of data, examples and python that is a command runs, in an empty folder with the data of the tree,
the programs of the build and a copy of Wisp installed from it. Files that commands name are those of the page: `scene.yaml` is its first whole scene, `suite.yaml` its first suite, a C file its
program, or the example of that name. docs/embedding.md shows pieces of a host: embedding_host.c.in puts them together. Three commands run
in part, since the build exists: `meson setup build` and `./dev` programs are not built again, `./dev test` lists the tests, of which this is one.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

source, build = (os.path.abspath(path) for path in sys.argv[1:3])
compiler = " ".join(sys.argv[3:])
sanitizer = " ".join(word for word in sys.argv[3:] if word.startswith("-fsanitize"))
PAGES = ["README.md", "examples/README.md", "data/README.md", "python/README.md"] + ["docs/" + name for name in sorted(os.listdir(f"{source}/docs")) if name.endswith(".md")]
PROGRAMS = r"(\./dev|wisp|meson|cc|c\+\+)(?= )"
STRICT = "-std=c17 -Wall -Wextra -Wpedantic -Werror"

PAGE = '<script type="application/json" id="wisp-data">null</script>'

# Replacement of a command on a page for this test, and why it is equivalent.
REWRITTEN = [
    (r"^\./dev wisp ", "wisp "),                        # builds the program, then runs it
    (r"^\./dev (run|bench) ", r"wisp \1 "),             # likewise
    (r"^\./dev (setup|test)$", rf"{source}/dev \1"),    # the script of the tree
    (r"/dev test$", "/dev test --list"),                # a test cannot run all tests
    (r"^meson setup build && meson install -C build$", "meson install --no-rebuild --quiet -C {build} --destdir $PWD/installed"),
    (r"^c\+\+ ", "g++ {sanitizer} "),
    (r"^cc ", "{compiler} "),                           # a sanitizer of the build is in its libraries
    (r"^wisp run data/scenes/character\.yaml", r"\g<0> --steps 2"), # minutes of a figure; the first steps are like the others
    (r"(character\.yaml) --frames \S+", r"\1 --frames 0:1 --size 80x60 --samples 1"),
    (r"(character\.yaml) --steps \d+", r"\1 --steps 1"),
    (r"^wisp validate( cantilever rubber)?", r"wisp validate chain --quick --seconds 0.1"), # minutes of all cases
    (r"^(wisp render (?!.*--size).*)", r"\1 --size 80x60 --samples 1"), # a picture takes seconds by its size
    (r"^wisp bench cloth --quick", "wisp bench boundary --quick --seconds 0.1"), # half a minute of references, in a clone
    (r"(?<=suite\.yaml --seconds )5", "0.2"),           # for steadier times
    (r"^wisp sweep data/suites/scaling/scaling\.yaml", "wisp sweep suite.yaml"), # half a minute of sizes
    (r"^wisp view ", f"mkdir -p page && printf '%s' '{PAGE}' >page/viewer.html && WISP_DATA=page wisp view "), # the page needs a compiler of its own
    (r"^(\./dev python|meson setup .*-Dpython=enabled|meson install -C build$|meson install --tags python).*", "true"), # builds of their own: ./dev python
    (r" \| dot .*$", ""),                               # draws a graph; not a package of Wisp's
]
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


def fenced(text, language):
    return re.findall(rf"(?ms)^```{language}\n(.*?)^```$", text)


def shell(command, folder):
    """Run a command as a user would who has installed Wisp. Return its status and what it said."""
    root = f"{folder}/installed"
    pc = [path for path, _, files in os.walk(root) if "wisp.pc" in files]
    lib = [path for path, _, files in os.walk(root) if "libwisp.so" in files]
    environment = {**os.environ, "PATH": f"{build}/app:" + os.environ["PATH"], "PKG_CONFIG_SYSROOT_DIR": root,
                   "PKG_CONFIG_PATH": ":".join(pc), "LD_LIBRARY_PATH": ":".join(lib + [os.environ.get("LD_LIBRARY_PATH", "")])}
    result = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, env=environment, timeout=200)
    return result.returncode, (result.stdout + result.stderr).strip()


def run(page, number, command, folder):
    line = command
    for pattern, replacement in REWRITTEN:
        line = re.sub(pattern, replacement.replace("{build}", build).replace("{compiler}", compiler).replace("{sanitizer}", sanitizer), line)
    status, said = shell(line, folder)
    if status != 0:
        fail(page, number, f"'{command}' ends with {status}: {said[-600:]}")


def clean(command):
    command = re.sub(r"\s+#.*$", "", command)
    return re.split(r"\s{3,}", command.strip())[0].strip()


# ---- programs and scenes ----


def write_files(page, text, commands, folder):
    """Write the files that the commands of a page name."""
    for file in set(re.findall(r"\b\w+\.c(?:pp)?\b", "\n".join(commands))):
        programs = fenced(text, "c")
        if os.path.exists(f"{source}/examples/{file}"):
            shutil.copy(f"{source}/examples/{file}", folder)
        elif file == "host.c":
            open(f"{folder}/{file}", "w", encoding="utf-8").write(host_of_embedding())
        elif programs:
            open(f"{folder}/{file}", "w", encoding="utf-8").write(programs[0])
        else:
            fail(page, 1, f"no program {file} on the page or in examples/")
    for scene in [scene for scene in fenced(text, "yaml") if scene.startswith("wisp:")][:1]:
        open(f"{folder}/scene.yaml", "w", encoding="utf-8").write(scene)
    for suite in [suite for suite in fenced(text, "yaml") if suite.startswith("wisp_suite:")][:1]:
        open(f"{folder}/suite.yaml", "w", encoding="utf-8").write(suite)


def host_of_embedding():
    pieces, heading, last = {}, "", -1
    text = open(f"{source}/docs/embedding.md", encoding="utf-8").read()
    text = re.sub(r"(?ms)^```.*?^```$", "", text) # programs of their own
    for number, line in enumerate(text.split("\n")):
        if line.startswith("#"):
            heading, count = line.lstrip("# "), 0
        elif line.startswith("    "):
            count += number != last + 1
            last = number
            pieces.setdefault(f"{heading} {count}", []).append(line)
    host = open(f"{source}/tests/docs/embedding_host.c.in", encoding="utf-8").read()
    used = re.findall(r"(?m)^\s*@(.+) (\d+)@$", host)
    missing = set(pieces) - {f"{name} {count}" for name, count in used} - {"Build and link 1"}
    if missing:
        fail("docs/embedding.md", 1, f"code that embedding_host.c.in does not use: {sorted(missing)}")
    return re.sub(r"(?m)^\s*@(.+ \d+)@$", lambda match: "\n".join(pieces[match.group(1)]), host)


def check_programs(folder):
    """Programs compile without a warning, and run."""
    for file in ("hang.c", "host.c"):
        if not os.path.exists(f"{folder}/{file}"):
            fail("README.md" if file == "hang.c" else "docs/embedding.md", 1, f"no command names {file}")
            continue
        status, said = shell(f"{compiler} {STRICT} {file} $(pkg-config --cflags --libs wisp) -lm -o program && ./program", folder)
        if status != 0:
            fail(file, 1, said[-2000:])


def check_cpp(page, text, folder):
    """Programs in C++ compile without a warning, and run, if there is a compiler for them."""
    for number, program in enumerate(fenced(text, "cpp"), 1):
        if shutil.which("g++"):
            open(f"{folder}/program.cpp", "w", encoding="utf-8").write(program)
            flags = STRICT.replace("-std=c17", "-std=c++17")
            status, said = shell(f"g++ {flags} {sanitizer} program.cpp $(pkg-config --cflags --libs wisp) -o program && ./program", folder)
            if status != 0:
                fail(page, 1, f"program {number} in C++: {said[-2000:]}")


def check_scenes(page, text, folder):
    for number, scene in enumerate(fenced(text, "yaml"), 1):
        if scene.startswith("wisp:"):
            open(f"{folder}/piece.yaml", "w", encoding="utf-8").write(scene)
            status, said = shell("wisp run piece.yaml --steps 2", folder)
            if status != 0:
                fail(page, 1, f"scene {number}: {said[-600:]}")


# ---- names and links ----


def known_words():
    help_text = subprocess.run([f"{source}/dev", "help"], capture_output=True, text=True).stdout
    cases = subprocess.run([f"{build}/app/wisp", "bench", "--list"], capture_output=True, text=True).stdout
    verbs = subprocess.run([f"{build}/app/wisp", "--help"], capture_output=True, text=True).stdout
    return {"./dev": set(re.findall(r"(?m)^  (\w+)", help_text)), "wisp": set(re.findall(r"(?m)^  (?:wisp )?(\w+)", verbs)),
            "bench": set(re.findall(r"(?m)^\s*(\w+)", cases)) | {"instructions"}}


def check_names(page, text, known):
    """Commands in a sentence name what exists."""
    for number, line in enumerate(text.split("\n"), 1):
        for program, verb, word in re.findall(r"`(\./dev|wisp) ([a-z]\w*)(?: ([a-z]\w*)(?![\w./]))?[^`]*`", line):
            if verb not in known[program]:
                fail(page, number, f"{program} has no command '{verb}'")
            elif verb == "bench" and word and word not in known["bench"]:
                fail(page, number, f"the benchmark has no case '{word}'")


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


def check_tables():
    told = subprocess.run([f"{source}/bench/tables.py", "--check"], capture_output=True, text=True)
    failures.extend(told.stderr.splitlines())


def main():
    check_tables()
    known = known_words()
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(f"{source}/data", f"{folder}/data")
        for page in PAGES:
            text = open(f"{source}/{page}", encoding="utf-8").read()
            check_links(page, text)
            check_names(page, text, known)
            commands = [(number, clean(line)) for number, line, language in blocks(text) if language in ("", "sh", "text")]
            commands = [(number, command) for number, command in commands if re.match(PROGRAMS, command)]
            write_files(page, text, [command for _, command in commands], folder)
            for number, command in commands:
                run(page, number, command, folder)
                count += 1
            check_scenes(page, text, folder)
            check_cpp(page, text, folder)
        check_programs(folder)
    print("\n".join(failures))
    print(f"{count} commands of {len(PAGES)} pages ran")
    print(f"{0 if failures else 1} passed, {len(failures)} failed")
    return 1 if failures or count == 0 else 0


sys.exit(main())
