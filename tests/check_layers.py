#!/usr/bin/env python3
"""Check the rules of docs/design.md about layers that the include folders of meson cannot refuse.

usage: check_layers.py [--self-test] TREE

Prints `path:line: 'word': what is wrong` for each violation. --self-test first plants some in a small tree.
"""
import re
import sys
import tempfile
from pathlib import Path

SOURCES = (".c", ".h", ".inc", ".cc", ".cpp", ".hpp")
# Headers and programs of hosts.
HOSTS = re.compile(r"engine/include/wisp/[^/]*$|modules/(\w+)/\1\.h$|create/\w+\.h|examples/")
STANDARD = {name + ".h" for name in """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp
    signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath time uchar wchar
    wctype""".split()}
# Words in names of modules that mean data or geometry. The engine may use them, but not a whole name of such words.
GENERIC = set("""strand strands hair appearance collision environment cloth triangle boundary particle implicit contact
    attachments motion constraints seams""".split())
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:(["<])([^">]*)[">]|(\w+))')

# Pattern in code and meson files; the paths that may have it; what is wrong elsewhere.
WORDS = [(re.compile(pattern), re.compile(where), message) for pattern, where, message in (
    (r"[<\"]omp\.h|#\s*pragma\s+omp|_Pragma\s*\(\s*\"\s*omp|\bomp_[a-z_]+\s*\(|\bopenmp",
     r"engine/jobs/", "only engine/jobs knows OpenMP"),
    (r"[<\"](\w*intrin|arm_neon|arm_sve)\.h|[<\"]simde/|\b_mm\d*_\w+|\b__m(64|128|256|512)|\b__mmask\d|\b__builtin_ia32_\w+",
     r"engine/math/lane|engine/kernels/", "intrinsics live in engine/math/lane*.h and engine/kernels"),
    (r"'-m(avx|sse|fma|bmi|arch=)", r"engine/kernels/", "only engine/kernels is compiled for an instruction set"),
    (r"[<\"]embree\d/", r"engine/space/|app/render/", "in the library only engine/space knows Embree"),
    (r"[<\"](pthread|sched|unistd)\.h", r"engine/jobs/|app/|bench/|examples/", "in the library only engine/jobs knows threads"),
    (r"#\s*include.*\.\./|'[^']*\.\./", r"app/|bench/|create/|examples/", "a path out of the folder hides from meson what it leads to"),
)]


def without_comments(text):
    """Blank the comments of C. Strings and line ends stay."""
    kept = lambda m: m[0] if m[0][0] in "\"'" else re.sub(r"[^\n]", " ", m[0])
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'", kept, text, flags=re.S)


class Tree:
    def __init__(self, root):
        self.root = root
        files = [f for folder in ("engine", "modules", "create", "app", "bench", "examples") for f in (root / folder).rglob("*")]
        self.files = dict.fromkeys(sorted(f.relative_to(root).as_posix() for f in files if f.is_file()))
        modules = {f.split("/")[1] for f in self.files if f.startswith("modules/") and f.count("/") > 1}
        # Headers of modules that are for nobody else.
        self.own = {f.split("/")[-1] for f in self.files if re.match(r"modules/\w+/\w+\.h$", f)} - {m + ".h" for m in modules}
        self.own -= {f.split("/")[-1] for f in self.files if not f.startswith("modules/")}
        names = {"balloon"}
        for module in modules:
            names |= set(module.split("_")) - GENERIC or ({module} if "_" in module else set())
        self.effects = [(n, re.compile(r"(?<![^\W_])" + n.replace("_", "[ _-]?") + r"s?(?![^\W_])", re.I)) for n in sorted(names)]

    def include_fault(self, path, quote, name):
        """The direction among layers of the engine and of the program is that of meson's folders."""
        if HOSTS.match(path) and name.startswith("wisp/module/"):
            return "wisp/module/ is for modules, not for hosts"
        if not path.startswith(("engine/", "modules/")):
            return "that header is the module's own" if name.split("/")[-1] in self.own else None
        if name in STANDARD or "engine/include/" + name in self.files or any(word.search(quote + name) for word, _, _ in WORDS):
            return None
        if path.startswith("engine/include/"):
            return "a public header needs public headers and the C library alone"
        if path.startswith("modules/"):
            beside = quote == '"' and path.rsplit("/", 1)[0] + "/" + name in self.files
            return None if beside else "a module needs wisp/*.h, the C library and its own folder, and never another module"
        return None if quote == '"' else "the library stands on the C library, OpenMP and Embree"

    def faults(self):
        """Yield (path, line, word, message)."""
        for path in self.files:
            is_source, is_meson = path.endswith(SOURCES), path.endswith("/meson.build")
            text = (self.root / path).read_text(encoding="utf-8") if is_source or is_meson or path.startswith("engine/") else ""
            if path.startswith("engine/"):
                for number, line in enumerate([path] + text.split("\n")):
                    yield from ((path, number, n, "the engine has never heard of an effect")
                                for n, word in self.effects if word.search(line))
            code = without_comments(text) if is_source else re.sub(r"#[^\n]*", "", text) if is_meson else ""
            for number, line in enumerate(code.split("\n"), 1):
                yield from ((path, number, word.search(line)[0], message) for word, where, message in WORDS
                            if word.search(line) and not where.match(path))
                include = INCLUDE.match(line) if is_source else None
                fault = include and ("an include whose name is computed cannot be checked" if include[3] else
                                     self.include_fault(path, include[1], include[2]))
                if fault:
                    yield path, number, include[2] or include[3], fault


GOOD = {
    "engine/include/wisp/base.h": "#include <stdint.h>\n",
    "engine/include/wisp/module/module.h": '#include "wisp/base.h"\n',
    "engine/math/lane.h": "#include <immintrin.h>\n__m256 wide;\n",
    "engine/jobs/jobs.c": '#include "lane.h"\n#include <omp.h>\n#include <sched.h>\n#pragma omp parallel\n',
    "engine/jobs/meson.build": "lib(base_include, dependencies : [openmp_dep])\n",
    "engine/space/trees.c": "#include <embree3/rtcore.h>\n",
    "engine/kernels/meson.build": "flags = ['-mavx2']\n",
    "engine/world/world.c": '// never <omp.h>, never _mm_add_ps\n/* nor\n#include "own.h"\n*/ int hair; // strands\n',
    "modules/frozen_hair/frozen_hair.h": '#include "wisp/base.h"\n',
    "modules/frozen_hair/own.h": '#include "frozen_hair.h"\n#include "wisp/module/module.h"\n',
    "modules/strand_appearance/look.c": '#include "wisp/module/module.h"\n#include <math.h>\n',
    "app/io/scene.c": '#include "frozen_hair/frozen_hair.h"\n#include <yaml.h>\n#include <unistd.h>\n',
    "examples/embed.c": "#include <wisp/base.h>\n#include <wisp/frozen_hair.h>\n",
}
BAD = [  # path, text, line of the report, a part of it
    ("engine/plan/a.c", "int frozen_count;\n", 1, "frozen"),
    ("engine/plan/b.c", "\n// WISP_COUNT_FROZEN\n", 2, "frozen"),
    ("engine/plan/README.md", "Balloons\n", 1, "balloon"),
    ("engine/plan/frozen.c", "", 0, "frozen"),
    ("engine/plan/c.c", "int strand_appearance;\n", 1, "strand_appearance"),
    ("engine/plan/d.c", "#include <omp.h>\n", 1, "OpenMP"),
    ("engine/plan/e.c", "\n#  pragma   omp simd\n", 2, "OpenMP"),
    ("app/f.c", "int n = omp_get_max_threads();\n", 1, "OpenMP"),
    ("engine/world/meson.build", "lib(dependencies : openmp_dep)\n", 1, "OpenMP"),
    ("engine/math/vec_fast.h", "__m128 a;\n", 1, "intrinsics"),
    ("modules/frozen_hair/g.c", "a = _mm256_add_ps( a, b );\n", 1, "intrinsics"),
    ("bench/h.c", "#include <immintrin.h>\n", 1, "intrinsics"),
    ("engine/space/meson.build", "lib(c_args : ['-mavx512f'])\n", 1, "instruction set"),
    ("engine/plan/i.c", "#include <embree3/rtcore.h>\n", 1, "Embree"),
    ("engine/plan/j.c", "#include <pthread.h>\n", 1, "threads"),
    ("engine/plan/k.c", '#include "../world/world.c"\n', 1, "out of the folder"),
    ("modules/frozen_hair/meson.build", "include_directories('../cloth')\n", 1, "out of the folder"),
    ("engine/plan/l.c", "#include HEADER\n", 1, "computed"),
    ("engine/plan/m.c", "#include <yaml.h>\n", 1, "C library"),
    ("engine/include/wisp/host.h", '#include "wisp/module/module.h"\n', 1, "not for hosts"),
    ("engine/include/wisp/lane.h", '#include "jobs.h"\n', 1, "public headers"),
    ("modules/frozen_hair/frozen_hair.h", '#include "wisp/module/module.h"\n', 1, "not for hosts"),
    ("examples/module.c", "#include <wisp/module/module.h>\n", 1, "not for hosts"),
    ("modules/strand_appearance/n.c", '#include "frozen_hair.h"\n', 1, "never another module"),
    ("modules/strand_appearance/o.c", "#include <wisp/frozen_hair.h>\n", 1, "never another module"),
    ("modules/strand_appearance/p.c", '#include "store.h"\n', 1, "its own folder"),
    ("app/q.c", '\n#include "own.h"\n', 2, "module's own"),
]


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        def found(files):
            for path, text in files.items():
                (Path(folder) / path).parent.mkdir(parents=True, exist_ok=True)
                (Path(folder) / path).write_text(text)
            return list(Tree(Path(folder)).faults())

        assert found(GOOD) == [], found(GOOD)
        for path, text, line, part in BAD:
            faults = found({path: text})
            assert [f[:2] for f in faults] == [(path, line)] and part in " ".join(faults[0][2:]), (path, faults)
            (Path(folder) / path).unlink()
            found(GOOD)


if __name__ == "__main__":
    if sys.argv[1:-1] == ["--self-test"]:
        self_test()
    elif len(sys.argv) != 2:
        sys.exit(__doc__)
    tree = Tree(Path(sys.argv[-1]))
    all_faults = list(tree.faults())
    for path, number, word, message in all_faults:
        print(f"{path}:{number}: '{word}': {message}")
    if not any(path.startswith("engine/") for path in tree.files):
        sys.exit(f"{tree.root}: there is no engine to look at")
    sys.exit(1 if all_faults else 0)
