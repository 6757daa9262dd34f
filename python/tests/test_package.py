"""The package as it is installed: errors, types, examples, import in an empty folder."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

import wisp
from conftest import TREE


def test_each_status_has_an_exception_of_python_too():
    from wisp._errors import CLASSES, check
    from wisp._native import ffi, lib

    bases = {
        lib.WISP_NO_MEMORY: (wisp.NoMemory, MemoryError),
        lib.WISP_BAD_INPUT: (wisp.BadInput, ValueError),
        lib.WISP_STALE_ID: (wisp.StaleId, LookupError),
        lib.WISP_CONFLICT: (wisp.Conflict, wisp.Error),
        lib.WISP_IO_ERROR: (wisp.IoError, OSError),
    }
    assert set(CLASSES) == set(bases)
    for status, (kind, base) in bases.items():
        error = ffi.new("wisp_error*", {"status": status, "message": b"element 3: wrong"})
        with pytest.raises(base) as caught:
            check(status, error)
        assert type(caught.value) is kind and isinstance(caught.value, wisp.Error) and str(caught.value) == "element 3: wrong"


def test_the_version_is_that_of_the_engine():
    header = (TREE / "engine" / "include" / "wisp" / "base.h").read_text()
    assert wisp.__version__ == re.search(r'WISP_VERSION_STRING "(.*)"', header).group(1)


def test_the_package_works_in_an_empty_folder_without_the_tree(python):
    result = python(
        'import wisp\n'
        'points, triangles = wisp.grid(5, 5, 0.1)\n'
        'scene = wisp.Scene.from_dict({"surfaces": [{"name": "s", "points": points, "triangles": triangles, "cloth": {}}]})\n'
        'with scene.create_world() as world:\n'
        '    world.run()\n'
        '    print(world.points("s").shape)\n'
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "(25, 3)\n", "")


def test_nothing_of_the_engine_is_visible_to_other_extensions():
    library = next(pathlib.Path(wisp.__file__).parent.glob("_native*.so"))
    names = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout.split("\n")
    names = [line.split()[-1] for line in names if line]
    assert [name for name in names if not name.startswith("__")] == ["PyInit__native"]


# With the sanitizer a converged run takes minutes, and mypy runs none of the engine.
plain = pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="runs without the sanitizer")


@plain
def test_the_types_are_those_of_the_code():
    mypy = pytest.importorskip("mypy.api")
    package = str(pathlib.Path(wisp.__file__).parent)
    out, errors, status = mypy.run(["--strict", "--cache-dir=/dev/null", "--python-version=3.9", package])
    assert status == 0, out + errors


@plain
def test_the_types_are_found_by_programs_that_use_the_package(tmp_path):
    mypy = pytest.importorskip("mypy.api")
    (tmp_path / "use.py").write_text(
        "import wisp\nscene = wisp.Scene.from_file('a.yaml')\nworld = scene.create_world()\nreveal_type(world.points('a'))\nworld.step(3)\n"
    )
    out, _, status = mypy.run(["--strict", "--cache-dir=/dev/null", str(tmp_path / "use.py")])
    assert status == 1 and "float" in out and 'Too many arguments for "step"' in out and out.count("error:") == 1


@pytest.mark.parametrize("path", sorted((TREE / "python" / "examples").glob("*.py")), ids=lambda path: path.name)
def test_an_example_runs_and_its_result_holds(path, tmp_path):
    result = subprocess.run([sys.executable, path], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout and result.stderr == ""


@plain
def test_the_code_of_the_guide_runs_from_top_to_bottom(tmp_path, monkeypatch, capsys):
    """In an empty folder with the data of the tree; a block may use what the blocks before it made. `>>>` blocks show what is printed."""
    import doctest

    monkeypatch.setenv("MPLBACKEND", "Agg")
    page = "docs/python.md"
    text = (TREE / page).read_text()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(TREE / "data")
    names = {"__name__": "__main__"}
    for match in re.finditer(r"(?ms)^```python\n(.*?)^```$", text):
        line, code = text[: match.start()].count("\n") + 1, match.group(1)
        if code.startswith(">>>"):
            test = doctest.DocTestParser().get_doctest(code, names, page, page, line)
            runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE, verbose=False)
            runner.run(test, clear_globs=False)
            assert runner.failures == 0, f"{page}:{line}"
            names.update(test.globs)
        else:
            exec(compile("\n" * line + code, page, "exec"), names)
    rows = re.findall(r"(?m)^(.+?) +(\d+) substeps +[\d.]+ ms +\d+ FPS +([\d.]+) mm$", capsys.readouterr().out)
    errors = {(name, int(substeps)): float(error) for name, substeps, error in rows}
    assert len(errors) == 20 and all(errors[name, 1] > 10 * errors[name, 20] > 0 for name, _ in errors)
