"""The recipes of packaging/ci, read and run as GitHub and GitLab do: a gate that passes, one that fails, and its patch."""
import os, re, subprocess, sys, tempfile

try:
    import yaml
except ImportError:
    sys.exit(77)

source, wisp = map(os.path.abspath, sys.argv[1:3])
SCENE = "wisp: 1\nsteps: 5\nsurfaces: [{ name: a, generate: { shape: plane, columns: %d, rows: 5 }, cloth: {} }]\n"
ANNOTATION = "::error file=gate/suite.yaml,title=wisp gate::scene: bytes is "


def recipe(name):
    with open(f"{source}/packaging/ci/{name}", encoding="utf-8") as file:
        return yaml.safe_load(file)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def read(path):
    return open(path, encoding="utf-8").read()


def github():
    action = recipe("action.yml")
    given = {"wisp": wisp, "suite": "gate/suite.yaml", "options": "--no-instructions"}
    inputs = {key: given.get(key, value.get("default")) for key, value in action["inputs"].items()}
    step = action["runs"]["steps"][0]
    value = lambda text: re.sub(r"\$\{\{ inputs\.(\w+) \}\}", lambda found: inputs[found[1]], text)
    assert action["runs"]["steps"][1]["if"] == "always()"
    return step["run"], {key: value(text) for key, text in step["env"].items()} | {"GITHUB_SHA": "1234"}


def gitlab():
    job = recipe("gitlab.yml")[".wisp-gate"]
    assert job["artifacts"]["reports"]["junit"] == "gate.xml" and "gate.patch" in job["artifacts"]["paths"]
    given = {"WISP": wisp, "OPTIONS": "--no-instructions", "CI_COMMIT_SHA": "1234"}
    return "\n".join(job["script"]), job["variables"] | given


def check(script, variables, has_github):
    os.mkdir("gate")
    write("gate/suite.yaml", "wisp_suite: 1\nscenes: [{ file: scene.yaml }]\n")
    write("gate/scene.yaml", SCENE % 5)
    write("summary", "of an earlier command\n")
    environment = {**os.environ, **variables, "GITHUB_STEP_SUMMARY": os.path.abspath("summary")}
    run = lambda: subprocess.run(["bash", "-e", "-c", script], env=environment, capture_output=True, text=True)
    subprocess.run([wisp, "gate", "record", "gate/suite.yaml", "--no-instructions"], check=True, stdout=subprocess.DEVNULL)
    good = run()
    assert good.returncode == 0 and "::" not in good.stdout and not os.path.exists("gate.patch"), good
    write("gate/scene.yaml", SCENE % 33)
    bad = run()
    assert bad.returncode == 1 and (ANNOTATION in bad.stdout) == has_github, bad
    summary = read("summary")
    assert "::" not in summary and summary.startswith("of an earlier"), summary
    assert summary.count("| row |") == 2 * has_github and ("| scene | worse |" in summary) == has_github, summary
    assert 'failures="1"' in read("gate.xml") and "bytes is " in read("gate.html")
    before = read("gate/suite-base.json")
    subprocess.run(["git", "apply", "gate.patch"], check=True)
    assert read("gate/suite-base.json") != before and "at 1234" in read("gate/suite-base.json")
    again = run()
    assert again.returncode == 0, again


for read_recipe in github, gitlab:
    script, variables = read_recipe()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check(script, variables, read_recipe is github)
        os.chdir("/")
