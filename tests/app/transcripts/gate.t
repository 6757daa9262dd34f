# wisp gate: what did not change passes, what became worse is a sentence and status 1, and bad input is refused.
$ cat >plain.yaml <<'END'
> wisp: 1
> steps: 20
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     pins: [0, 4]
>     damping: 1
>     cloth: {}
> END
$ cat >plain-suite.yaml <<'END'
> wisp_suite: 1
> scenes:
>   - file: cloth.yaml
>     vary: { substeps: [4, 10], "surfaces[*].cloth.bending": [bend_links, none] }
>   - { file: cloth.yaml, name: short, steps: 5, set: { "surfaces[cloth].damping": 2 } }
> END
# Each part begins with the same scene and suite, and with what it recorded of them.
$ cat >fresh <<'END'
> record() { wisp gate record suite.yaml --no-instructions; }
> check() { wisp gate check suite.yaml --no-instructions "$@" >told; status=$?; grep "$said" told; return $status; }
> cp plain.yaml cloth.yaml; cp plain-suite.yaml suite.yaml; rm -f suite-base.json
> END

# What did not change passes.
$ . ./fresh; wisp gate record suite.yaml --no-instructions -o base.json
gate suite: recorded: 5 rows in base.json...
$ wisp gate check suite.yaml --no-instructions --base base.json --junit gate.xml --strict
gate suite: pass: 5 rows, 5 the same
...
cloth: substeps=4, bending=bend_links ...
cloth: substeps=10, bending=none ...
$ wisp gate check suite.yaml --no-instructions --base base.json --format json -o results.json; grep -c '"is_same": 1' results.json
5
$ grep -o 'tests="5" failures="0"' gate.xml | head -n 1
tests="5" failures="0"

# Other bits without a worse value pass, unless their budget is 0; the damping of 'short' is its own. A base beside the suite is the default.
$ . ./fresh; record >/dev/null; sed 's/damping: 1/damping: 1.01/' plain.yaml >cloth.yaml; said=pass: check
gate suite: pass: 5 rows, 1 the same, 4 moved
$ . ./fresh; printf 'wisp_suite: 1\nbudgets: { hash: 0 }\nscenes: [{ file: cloth.yaml }]\n' >suite.yaml
> record >/dev/null; said=pass: check; sed 's/damping: 1/damping: 1.01/' plain.yaml >cloth.yaml; said=FAILED check
gate suite: pass: 1 rows, 1 the same
FAILED: cloth: hash is ...
[1]

# A worse value is status 1 with a sentence, and passes once it is accepted for a reason.
$ . ./fresh; record >/dev/null; sed 's/columns: 9/columns: 17/' plain.yaml >cloth.yaml; said='short: bytes is \|regression:' check
gate suite: regression: 5 rows...
...short: bytes is ...
[1]
$ wisp gate accept suite.yaml --no-instructions --reason finer >/dev/null; wisp gate check suite.yaml --no-instructions >/dev/null
$ python3 -c 'import json; print( json.load( open( "suite-base.json" ) )["accepted"][0]["reason"] )'
finer

# --steps measures the first steps of each row. Rows of other lengths are not compared, and a base without instructions is told.
$ . ./fresh; record >/dev/null; said='short:' check --steps 3
...short: 3 steps were made, and 5 of the base; record or accept it...
[1]
$ wisp gate record suite.yaml --no-instructions --steps 3 >/dev/null; wisp gate check suite.yaml --steps 3 | grep -o 'pass: .*\|instructions are not .*'
pass: 5 rows, 5 the same
instructions are not counted: the base was recorded without them
$ wisp gate check suite.yaml --steps 3 --paired old
! wisp gate: --steps: not with --paired...
[64]

# Budgets decide.
$ . ./fresh; record >/dev/null; sed 's/columns: 9/columns: 10/' plain.yaml >cloth.yaml; said=regression: check
> ( echo 'budgets: { bytes: 100, stretch: 100, energy: 100 }'; cat plain-suite.yaml ) >suite.yaml; said=pass: check
gate suite: regression: 5 rows...
gate suite: pass: 5 rows...

# A sheet that hangs still shows its material, as in the suite of docs/gate.md: links a tenth too soft are worse.
$ . ./fresh; hang() { cat >suite.yaml <<END
> wisp_suite: 1
> scenes: [{ file: cloth.yaml, set: { substeps: 20, "surfaces[0].damping": 5, "surfaces[0].cloth": { warp_compliance: $1, weft_compliance: $1, shear_compliance: $1, bending: none } } }]
> END
> }
> hang 0.1; record >/dev/null; hang 0.11; said='stretch is ' check
...stretch is ...
[1]

# Rows that only one side has are told.
$ . ./fresh; record >/dev/null; printf 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: [4, 6] } }]\n' >suite.yaml; said=rows check
gate suite: inconclusive: 2 rows...
5 rows of the base are not in the suite any more...
$ wisp gate check suite.yaml --no-instructions --strict >/dev/null
[1]

# With a reference a row that is farther from it than before is worse.
$ . ./fresh; with() { cat >suite.yaml <<END
> reference: { set: { substeps: 40 }, check: { substeps: 20 } }
> wisp_suite: 1
> scenes: [{ file: cloth.yaml, set: { substeps: $1 }, steps: 10 }]
> budgets: { stretch: 100, energy: 100, bytes: 100 }
> END
> }
> with 10; record >/dev/null; python3 -c 'import json; print( 1e-5 < json.load( open( "suite-base.json" ) )["rows"][0]["values"]["error"] < 0.1 )'
> with 20; said='compared until' check; with 4; said='error is ' check
True
...; compared until 0.133 s, where two converged runs part
...error is ...
[1]

# Rows that do not fit the reference are refused at once, with the rule and the way out.
$ fit() { . ./fresh; cat >suite.yaml <<END
> wisp_suite: 1
> seconds: 0.1
> reference: { file: cloth.yaml, set: { substeps: 80, dt: 0.02 }, check: { substeps: 40 } }
> scenes: [{ file: cloth.yaml, $1 }]
> END
> WISP_CACHE=unused record; }
> fit 'along: { dt: [0.01, 0.02, 0.012] }'; fit 'set: { dt: 0.02, "surfaces[0].name": sheet }'
! wisp: ...a dt of 0.02 s or 0.01 s does...
! wisp: ...none of the reference is called 'sheet'; name it 'cloth'...
[2]
$ test ! -e unused

# Iterations of linear solves are compared: the base has half of them.
$ . ./fresh; cat >implicit.yaml <<'END'
> wisp: 1
> steps: 4
> surfaces:
>   - { name: a, generate: { shape: plane, columns: 9, rows: 9 }, pins: [0], implicit: {} }
> END
> printf 'wisp_suite: 1\nscenes: [{ file: implicit.yaml }, { file: cloth.yaml, steps: 2 }]\n' >suite.yaml; record >/dev/null
> cat >halve.py <<'END'
> import json
> base = json.load( open( "suite-base.json" ) )
> counts = [row["values"]["solver_iterations"] for row in base["rows"]]
> print( counts[0] >= 4, counts[1] )
> base["rows"][0]["values"]["solver_iterations"] = counts[0] // 2
> json.dump( base, open( "suite-base.json", "w" ) )
> END
> python3 halve.py; said='solver_iterations is ' check
True None
...solver_iterations is ...
[1]

# Bad suites are refused in a sentence, and leave no base.
$ . ./fresh; for suite in '' 'scenes: []' 'wisp_suite: 2\nscenes: [{ file: cloth.yaml }]' 'wisp_suite: 1\nscenes: []' \
>     'wisp_suite: 1\nscene: [{ file: cloth.yaml }]' 'wisp_suite: 1\nscenes: [{ file: none.yaml }]' \
>     'wisp_suite: 1\nscenes: [{ file: cloth.yaml, varies: {} }]' 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: [] } }]' \
>     'wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: 4 } }]' 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { "surfaces[7].damping": 1 } }]' \
>     'wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { substep: 1 } }]' 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { substeps: -1 } }]' \
>     'wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 21 }]' 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: soon }]' \
>     'wisp_suite: 1\nscenes: [{ file: cloth.yaml }, { file: cloth.yaml }]' 'wisp_suite: 1\nbudgets: { byte: 1 }\nscenes: [{ file: cloth.yaml }]' \
>     'wisp_suite: 1\nbudgets: { bytes: -1 }\nscenes: [{ file: cloth.yaml }]' 'wisp_suite: 1\nbudgets: { bytes: much }\nscenes: [{ file: cloth.yaml }]'
> do
>     printf "$suite\n" >suite.yaml; record; test $? = 2 -a ! -e suite-base.json || echo "taken: $suite"
> done
! wisp: suite.yaml...
! wisp: ...wisp_suite: 1...
! wisp: ...wisp_suite: 1...
! wisp: ...at least one...
! wisp: ...did you mean 'scenes'?...
! wisp: suite.yaml:2:18: none.yaml...
! wisp: ...got key 'varies', expected one of file...
! wisp: ...at least one...
! wisp: ...expected a list of values...
! wisp: ...names nothing...
! wisp: ...did you mean 'substeps'?...
! wisp: ...substeps...
! wisp: ...got 21 steps, the scene has 20...
! wisp: ...expected a number of steps...
! wisp: ...two rows are called 'cloth'...
! wisp: ...did you mean 'bytes'?...
! wisp: ...expected a fraction...
! wisp: ...expected a fraction...

# Bad bases are refused and stay.
$ . ./fresh; wisp gate check suite.yaml
! wisp: ...suite-base.json...
[2]
$ . ./fresh; record >/dev/null; head -c 400 suite-base.json >cut.json; cp cut.json good.json
$ wisp gate check suite.yaml --base cut.json
! wisp: ...cut.json...
[2]
$ wisp gate accept suite.yaml --no-instructions --reason x --base cut.json
! wisp: ...cut.json...
[2]
$ cmp cut.json good.json
$ against() { echo "$1" >other.json; wisp gate check suite.yaml --base other.json; }
> against '{ "wisp_gate": 99 }'; against '{ "wisp_gate":4, "suite": "suite" }'; against '[]'
! wisp: ...version 99...
! wisp: ...the file was edited...
! wisp: ...expected a base file...
[2]
$ cp suite.yaml another.yaml; wisp gate check another.yaml --base suite-base.json
! wisp: ...of suite 'suite', not of 'another'...
[2]

# Times are compared with those of another program, here of one that says it needs half as long: half is far beyond the noise of any
# machine. Speed itself is not tested.
$ short() { . ./fresh; printf 'wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 2 }]\n' >suite.yaml; }
> short; cat >faster <<END
> #!/bin/sh
> '$WISP' "\$@" | while read name version ns steps; do echo \$name \$version \$((ns / 2)) \$steps; done
> END
> chmod +x faster; wisp gate check suite.yaml --paired ./faster >told; echo $? >>told
> grep -c '^1$\|not measurable' told; grep -o 'Time against the other program' told
1
Time against the other program
$ wisp gate check suite.yaml --paired /bin/true
! wisp: /bin/true: expected a Wisp...
[2]
$ wisp gate check suite.yaml --paired none
! wisp: none: expected a Wisp...
[2]
$ wisp gate self-test suite.yaml --trials 1 --no-instructions
...What the gate finds of itself...is slowed down...

# Programs that hang or make other steps are refused.
$ printf '#!/bin/sh\nsleep 600\n' >hangs; printf '#!/bin/sh\nwhile :; do echo yes; done\n' >chatters
> printf '#!/bin/sh\nwhile read n; do echo wisp_gate_ns 2 1000000 1; done\n' >skips; chmod +x hangs chatters skips
$ wisp gate check suite.yaml --paired ./hangs --patience 0.2
! wisp: ./hangs: gave no time of row 0...
[2]
$ wisp gate check suite.yaml --paired ./chatters
! wisp: ./chatters: expected a Wisp...
[2]
$ wisp gate check suite.yaml --paired ./skips
! wisp: ./skips: made 1 steps of row 0...
[2]

# A row that the suite lacks is refused.
$ . ./fresh; wisp gate step suite.yaml --row 5
! wisp: suite.yaml: got row 5, the suite has 5
[2]

# Where valgrind is installed: the same counts in every run; one percent of instructions and five of cycles more are too much. A base that has cycles is compared
# with cycles, without being asked.
$ cat >sheet.yaml <<'END'
> wisp: 1
> steps: 12
> gravity: [0, -9.8, 0]
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.1 }
>     pin_box: { min: [-1, -1, -1], max: [-0.39, 1, 1] }
>     cloth: { warp_compliance: 1e-3, weft_compliance: 1e-3, shear_compliance: 1e-3, bending: none }
> END
$ printf 'wisp_suite: 1\nscenes: [{ file: sheet.yaml, steps: 2 }]\n' >counted.yaml; cat >counted.py <<'END'
> import json, os, shutil, subprocess
> def gate( *arguments ):
>     return subprocess.run( [os.environ["WISP"], "gate", *arguments], capture_output=True, text=True )
> if shutil.which( "valgrind" ) is None:
>     assert "valgrind" in gate( "record", "counted.yaml" ).stderr
>     raise SystemExit
> for name, most, options in ( "instructions", 100, [] ), ( "cycles", 20, ["--cycles"] ):
>     assert gate( "record", "counted.yaml", *options ).returncode == 0 and gate( "check", "counted.yaml" ).returncode == 0
>     base = json.load( open( "counted-base.json" ) )
>     values = base["rows"][0]["values"]
>     assert values[name] > 10000 and values[name] >= values["instructions"]
>     values[name] -= values[name] // most
>     json.dump( base, open( "counted-base.json", "w" ) )
>     run = gate( "check", "counted.yaml" )
>     assert run.returncode == 1 and f"{name} is " in run.stdout
> run = gate( "self-test", "counted.yaml", "--trials", "1" )
> assert run.returncode == 0 and "0 %       +0.00 %" in run.stdout and "5 %       +0.00 %" not in run.stdout
> END
> python3 counted.py

# What frozen hair costs grows as the number of its vertices (Kim 2026, eq. 20): instructions, which repeat exactly; time is fitted by `wisp bench paper`, whose roots
# 0.5 mm apart and a vertex each centimetre give a dozen neighbours each at every size. The paper's row demands 0.98, which time needs; counts have no noise, and a
# power of 1.5 has 0.992 here.
$ cat >hair.yaml <<'END'
> wisp: 1
> steps: 1
> strands:
>   - name: hair
>     generate: { shape: wavy, dimension: 2, strands: 100, vertices: 20, length: 0.2, spacing: 0.0005 }
>     frozen_hair:
>       freeze: {}
>       align: { cursor: [1, -3, 0], reach: 10 }
>       clump: { radius: 0.0042 }
>     compute: [points]
> END
$ printf 'wisp_suite: 1\nscenes:\n  - file: hair.yaml\n    vary: { "strands[hair].generate.strands": [100, 200, 300, 500] }\n' >linear.yaml; cat >linear.py <<'END'
> import json, os, shutil, subprocess
> if shutil.which( "valgrind" ) is None:
>     raise SystemExit
> assert subprocess.run( [os.environ["WISP"], "gate", "record", "linear.yaml", "-o", "linear.json"], capture_output=True ).returncode == 0
> rows, vertices = json.load( open( "linear.json" ) )["rows"], [2000, 4000, 6000, 10000]
> counts = { name: [row["passes"][name] for row in rows] for name in ( "frozen_hair.freeze", "frozen_hair.align", "frozen_hair.clump" ) }
> for name, y in { "a step": [row["values"]["instructions"] for row in rows], **counts }.items():
>     x_mean, y_mean = sum( vertices ) / 4, sum( y ) / 4
>     xx, yy = sum( ( x - x_mean ) ** 2 for x in vertices ), sum( ( v - y_mean ) ** 2 for v in y )
>     xy = sum( ( x - x_mean ) * ( v - y_mean ) for x, v in zip( vertices, y, strict=True ) )
>     assert xy * xy / ( xx * yy ) > 0.999 and xy / xx > 10, ( name, xy / xx, xy * xy / ( xx * yy ) )
> END
> python3 linear.py

# So does a crowd of cloths with bodies of their own: who can meet whom is found once a step, and adding one looks at no other.
$ cat >crowd.yaml <<'END'
> wisp: 1
> steps: 3
> surfaces: [ { name: cloth, generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }, copies: { count: 20, columns: 10, spacing: [1, 0, 1] }, cloth: {} } ]
> colliders:
>   - { name: left, shape: capsule, radius: 0.08, half_length: 0.1, position: [-0.1, -0.1, 0], copies: { count: 20, columns: 10, spacing: [1, 0, 1] } }
>   - { name: right, shape: sphere, radius: 0.1, position: [0.15, -0.12, 0.1], copies: { count: 20, columns: 10, spacing: [1, 0, 1] } }
> END
> printf 'wisp_suite: 1\nscenes:\n  - file: crowd.yaml\n    vary:\n      cloths:\n' >many.yaml
> for n in 40 80 160; do printf '        %d: { "surfaces[0].copies.count": %d, "colliders[left].copies.count": %d, "colliders[right].copies.count": %d }\n' $n $n $n $n; done >>many.yaml
> cat >many.py <<'END'
> import json, os, re, shutil, subprocess
> if shutil.which( "valgrind" ) is None:
>     raise SystemExit
> assert subprocess.run( [os.environ["WISP"], "gate", "record", "many.yaml", "-o", "many.json"], capture_output=True ).returncode == 0
> steps = [row["values"]["instructions"] for row in json.load( open( "many.json" ) )["rows"]]
> counted = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"] + ["--toggle-collect=" + f for f in ( "wisp_set_collision", "wisp_add_collider" )]
> adding = [subprocess.run( [*counted, os.environ["WISP"], "gate", "step", "many.yaml", f"--row={i}"], env={ "PATH": os.environ["PATH"] }, capture_output=True, text=True ).stderr for i in range( 3 )]
> for bound, ( one, two, four ) in ( 2.2, steps ), ( 2.5, [int( re.search( r"Collected : (\d+)", told )[1] ) for told in adding] ): # tables grow by a quarter
>     assert ( four - two ) / ( two - one ) < bound, ( one, two, four )
> END
> python3 many.py
