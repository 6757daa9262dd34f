# Suites in wisp bench, and wisp accuracy; their numbers; suites whose rows have checks; a report beside the results.
$ sheet() { cat <<END
> wisp: 1
> steps: 12
> gravity: [0, -9.8, 0]
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: $1, rows: $1, spacing: $2 }
>     pin_box: { min: [-1, -1, -1], max: [-0.39, 1, 1] }
>     cloth: { warp_compliance: 1e-3, weft_compliance: 1e-3, shear_compliance: 1e-3, bending: none }
> END
> }
> sheet 9 0.1 >sheet.yaml

# An entry of a list is removed by its name or number.
$ cat >both.yaml <<'END'
> wisp: 1
> steps: 2
> surfaces:
>   - { name: a_sheet_with_a_long_name, generate: { shape: plane, columns: 3, rows: 3 }, cloth: {} }
>   - { name: a_sheet_with_a_long_name_too, generate: { shape: plane, columns: 4, rows: 4 }, cloth: {} }
> END
$ cat >less.yaml <<'END'
> wisp_suite: 1
> scenes:
>   - { file: both.yaml, name: both }
>   - { file: both.yaml, name: second, set: { "surfaces[a_sheet_with_a_long_name]": null } }
>   - { file: both.yaml, name: first, set: { "surfaces[1]": null } }
> END
$ wisp bench less.yaml --seconds 0.1 --workers 1 -f json | grep -o '"variant": "[a-z]*"\|"vertices": [0-9]*' | uniq
"variant": "both"
"vertices": 25
"variant": "second"
"vertices": 16
"variant": "first"
"vertices": 9

# A suite without a reference is a table of times.
$ printf 'wisp_suite: 1\nscenes:\n  - { file: sheet.yaml, vary: { iterations: [1, 2] } }\n' >times.yaml
$ wisp bench times.yaml --seconds 0.1 >told; cat told
...Suite `times`: times, ms per step...sheet, iterations=2...
...Suite `times`: cost per vertex, and spread of times...
...ms of a step by pass, one worker...links.xpbd...
$ grep 'equal error' told
[1]

# What a suite gets wrong is said.
$ for line in 'reference: { set: { substeps: 60 } }' 'reference: { stored: nowhere.wisp }' 'reference: { kept: x }' \
>     'reference: { set: { substeps: 60 }, extrapolate: 3 }' 'reference: { set: { substeps: 60 }, extrapolate: {} }' \
>     'reference: { set: { substeps: 60 }, extrapolat: 1 }' 'reference: { set: { substeps: 60 }, check: {}, extrapolate: 1 }' \
>     'reference: { set: { substeps: 30 }, extrapolate: 1 }' 'reference: { overlap: some }' 'reference: { set: { substeps: 60 }, check: {} }' \
>     'reference: { set: { "surfaces[3].damping": 1 }, check: {} }' 'reference: { set: { "surfaces[3]": null }, check: {} }' \
>     'seconds: -1' 'titel: x'
> do
>     printf 'wisp_suite: 1\n%s\nscenes:\n  - { file: sheet.yaml }\n' "$line" >bad.yaml; wisp bench bad.yaml >&2; test $? = 2 || echo "taken: $line"
> done
! wisp: ...expected set, the fields of the converged run, and check...
! wisp: ...nowhere.wisp...
! wisp: ...got key 'kept'...
! wisp: bad.yaml:2:...got extrapolate '3', expected the order...
! wisp: ...expected a text or a number...
! wisp: ...did you mean 'extrapolate'?...
! wisp: ...got extrapolate with check...
! wisp: ...got a reference of 30 substeps...
! wisp: ...expected overlap: none alone...
! wisp: bad.yaml:2:...expected a coarser run...
! wisp: ...names nothing of the scene...
! wisp: ...names nothing of the scene...
! wisp: ...expected seconds of simulated time...
! wisp: ...did you mean 'title'?...
$ for keys in 'along: { dt: [0.01, 0.02] }' 'along: { substeps: [1, 2], iterations: [1] }' 'along: { substeps: [many] }' \
>     'along: { substeps: [1] }, order: 99' 'steps: 3, seconds: 1'
> do
>     printf 'wisp_suite: 1\nscenes:\n  - { file: sheet.yaml, %s }\n' "$keys" >bad.yaml; wisp bench bad.yaml >&2; test $? = 2 || echo "taken: $keys"
> done
! wisp: ...needs seconds...
! wisp: ...expected one field and its values...
! wisp: ...expected a number above 0...
! wisp: ...expected an order...
! wisp: ...expected steps or seconds, not both...
$ : >empty.yaml; printf 'wisp_suite: 1\nscenes: [{ file: empty.yaml }]\n' >bad.yaml; wisp bench bad.yaml
! wisp: ...empty.yaml: got an empty file...
[2]
$ wisp bench nowhere/suite.yaml
! wisp: ...
[2]
$ wisp bench sheet.yaml
! wisp: ...wisp_suite...
[2]

# Times of rows need not agree with those of the reference only if their steps cannot.
$ cat >odd.yaml <<'END'
> wisp_suite: 1
> seconds: 0.2
> reference: { set: { substeps: 20 }, check: { substeps: 10 } }
> scenes:
>   - { file: sheet.yaml, along: { dt: [0.02, 0.01] } }
> END
$ wisp bench odd.yaml --seconds 0.1
! wisp: ...no step ends at...
[2]
$ cat >apart.yaml <<'END'
> wisp_suite: 1
> reference: { file: sheet.yaml, set: { substeps: 20 }, check: { substeps: 10 } }
> scenes:
>   - { file: sheet.yaml, name: short, set: { steps: 1 } }
>   - { file: sheet.yaml, name: coarse, set: { dt: 0.1 } }
> END
$ wisp bench apart.yaml
! wisp: ...no moment is common to all rows: short ends after...coarse makes steps of 0.1 s...
[2]
$ sed 's/set: { substeps: 20/set: { dt: 0.01, substeps: 20/; s/0.02, 0.01/0.02, 0.01, 0.005/' odd.yaml >even.yaml
$ wisp bench even.yaml --seconds 0.1
...ms per 0.02 s of motion...

# The accuracy of a scene, and the suite that is made of it.
$ wisp accuracy sheet.yaml --quick --seconds 0.2 --report page.html >told
> grep -o 'at equal error: the fastest setting\|observed order\|coarse sheets, substeps=1\|The reference is uncertain by' told | LC_ALL=C sort -u
The reference is uncertain by
at equal error: the fastest setting
coarse sheets, substeps=1
observed order
$ wisp accuracy sheet.yaml --suite made.yaml >/dev/null
$ wisp bench made.yaml --quick --seconds 0.2
...coarse sheets, substeps=1...
$ wisp gate record made.yaml --no-instructions >/dev/null
$ printf 'wisp: 1\nsteps: 2\nstrands:\n  - { name: hair, generate: { strands: 3, vertices: 4 } }\n' >still.yaml
$ wisp accuracy still.yaml
! wisp: ...nothing in the scene is solved over time...
[2]
$ wisp accuracy 2>/dev/null
[64]

# Rows that hold are status 0.
$ cat >cloth.yaml <<'END'
> wisp: 1
> steps: 300
> gravity: [0, -9.81, 0]
> surfaces:
>   - name: sheet
>     generate: { shape: alternating_plane, columns: 12, rows: 12, spacing: 0.05 }
>     transform: { rotate: { axis: [1, 0, 0], degrees: 90 } }
>     pins: [0, 11]
>     damping: 4
>     cloth: { bending: isometric, internal_damping: 0 }
> END
$ cat >holds.yaml <<'END'
> wisp_suite: 1
> checks: all
> scenes: [{ file: cloth.yaml }, { file: cloth.yaml, name: wrong, expect: refused, set: { "surfaces[0].area_density": -1 } }]
> END
$ wisp bench holds.yaml
...refused, as expected...2 cells: 1 hold...

# A row that breaks is status 1 and a sentence. Heavy at the bottom, the sheet gains energy: one sweep of its links cannot carry it.
$ cat >breaks.yaml <<'END'
> wisp_suite: 1
> checks: [energy]
> scenes: [{ file: cloth.yaml }, { file: cloth.yaml, name: heavy, set: { "surfaces[0].mass_ratio": 1e3 } }]
> END
$ wisp bench breaks.yaml
...FAILED: stability, heavy: breaks energy: energy is ...2 cells: 1 hold...
[1]

# What is known to break passes until it holds.
$ cat >known.yaml <<'END'
> wisp_suite: 1
> checks: [energy]
> known: { heavy: energy }
> scenes: [{ file: cloth.yaml, name: heavy, set: { "surfaces[0].mass_ratio": 1e3 } }]
> END
$ wisp bench known.yaml
...1 break as known...
$ printf 'wisp_suite: 1\nchecks: [finite, energy]\nknown: { cloth: energy }\nscenes: [{ file: cloth.yaml }]\n' >mended.yaml
$ wisp bench mended.yaml
...cloth: holds now; remove it from what is known to break...
[1]

# A sweep has each value alone and pairs, and leaves out what is not due: base, short, small and two pairs.
$ cat >sweeps.yaml <<'END'
> wisp_suite: 1
> checks: [finite]
> seconds: 0.1
> axes:
>   dt: { short: { dt: 0.01 }, long: { dt: 0.05, seconds: 0.2 } }
>   size: { small: { "surfaces[0].generate.spacing": 0.01 } }
> quick: [base]
> long: ["cloth: long"]
> scenes: [{ file: cloth.yaml, sweep: [dt, size], pairs: [dt, size] }]
> END
$ wisp bench sweeps.yaml >told; grep -o 'cloth: short, small' told | head -n 1; grep -o 'sweeps: [0-9]* cells: [0-9]* hold' told
cloth: short, small
sweeps: 5 cells: 5 hold
$ wisp bench sweeps.yaml --long
...sweeps: 6 cells: 6 hold...
$ wisp bench sweeps.yaml --quick
...sweeps: 1 cells: 1 hold...

# Rows that must agree and differ fail.
$ cat >differs.yaml <<'END'
> wisp_suite: 1
> checks: [finite]
> seconds: 0.5
> scenes: [{ file: cloth.yaml, agree: 0.01, vary: { held: { both: {}, one: { "surfaces[0].pins": [0] } } } }]
> END
$ wisp bench differs.yaml
...cloth: rows differ by ...
[1]

# A check without a limit says so, and takes that of the user. In wind nothing is at rest, so that no limit is known but that.
$ cat >windy.yaml <<'END'
> wisp_suite: 1
> seconds: 0.5
> scenes:
>   - { file: cloth.yaml, checks: [strain, rest], set: { "surfaces[0].cloth.wind": [3, 0, 0], "surfaces[0].cloth.drag_coefficient": 1 } }
>   - file: cloth.yaml
>     name: mine
>     checks: [{ strain: 1e-4 }, { speed: 50 }]
>     set: { "surfaces[0].cloth.wind": [3, 0, 0], "surfaces[0].cloth.drag_coefficient": 1 }
> END
$ wisp bench windy.yaml >told; echo $?; grep -o 'strain rest\|in 1 cells no limit is known\|FAILED: stability, mine: breaks strain: .* and 0.01 % are allowed' told
1
strain rest
FAILED: stability, mine: breaks strain: ... and 0.01 % are allowed
in 1 cells no limit is known
! wisp: a result is wrong; ...

# A measure is far from its value, a body is not there, and bits are those of another row.
$ cat >far.yaml <<'END'
> wisp_suite: 1
> scenes:
>   - { file: cloth.yaml, name: far, checks: [{ near: { of: sheet.max.y, value: 5, within: 0.5, from: "nowhere" } }] }
>   - { file: cloth.yaml, name: who, checks: [{ near: { of: nobody.tip.y, value: 5, within: 0.5 } }] }
>   - { file: cloth.yaml, name: alike, checks: [{ same: far }, { near: { of: sheet.speed, take: min, value: 0, within: 1e6 } }, { near: { of: sheet.momentum, value: [0, 0, 0], within: 1e6 } }] }
>   - { file: cloth.yaml, name: other, set: { gravity: [0, 1, 0] }, checks: [{ same: far }] }
> END
$ wisp bench far.yaml | grep -o 'FAILED: stability.*\|[0-9]* hold.*'
FAILED: stability, far: breaks near: sheet.max.y is ..., expected 5 within 0.5: nowhere
FAILED: stability, who: breaks near: nobody.tip.y has no value: ...
FAILED: stability, other: breaks same: the points at the end have hash ..., those of 'far' ...
1 hold, 3 fail
! wisp: a result is wrong; ...

# Wrong words name their place.
$ for line in 'checks: [enrgy]' 'checks: some' 'checks: [{ strain: -1 }]' 'checks: [{ bits: 1 }]' 'checks: all\nknown: { other: rest }' \
>     'checks: [finite]\nknown: { cloth: rest }' 'checks: all\naxes: { dt: [1] }' 'checks: all\nquick: [none]' 'check: all' \
>     'checks: [near]' 'checks: [{ near: { of: sheet.tip } }]' 'checks: [{ near: { of: sheet.tip.y, value: 1, within: 0 } }]' \
>     'checks: [{ near: { of: sheet.tip.y, value: 1, within: 1, take: all } }]' 'checks: [{ same: other }]'
> do
>     printf "wisp_suite: 1\n$line\nscenes: [{ file: cloth.yaml }]\n" >wrong.yaml; wisp bench wrong.yaml >&2; test $? = 2 || echo "taken: $line"
> done
! wisp: wrong.yaml:2:10: got check 'enrgy'; did you mean 'energy'?...
! wisp: wrong.yaml:2:9: expected checks: all...
! wisp: wrong.yaml:2:20: expected a limit above 0...
! wisp: wrong.yaml:2:10: expected a check and its limit...
! wisp: wrong.yaml:3:10: no row is called 'other'...
! wisp: ...which is none of its checks...
! wisp: ...expected axes, such as...
! wisp: ...no row is called 'none'...
! wisp: ...did you mean 'checks'?...
! wisp: wrong.yaml:2:10: expected what, such as...
! wisp: ...got 'sheet.tip', expected a body and a measure, such as rod.tip.y or ball.pressure: of v12, v4-v7, tip, ...
! wisp: ...expected a value, `within` above 0...
! wisp: ...got 'all', expected one of end, mean...
! wisp: wrong.yaml: cloth: no other row is called 'other'...
$ for keys in 'expect: luck' 'sweep: [dt]' 'agree: 2'; do
>     printf "wisp_suite: 1\nchecks: all\nscenes: [{ file: cloth.yaml, $keys }]\n" >wrong.yaml; wisp bench wrong.yaml >&2; test $? = 2 || echo "taken: $keys"
> done
! wisp: wrong.yaml:3:38: expected expect: refused...
! wisp: wrong.yaml:3:38: axes has no 'dt'...
! wisp: ...expected a part of the size...

# A report is written beside the usual output: every title there is one of the page. A table that is too wide for a terminal has
# further parts there.
$ wisp bench boundary --quick --seconds 0.01 --workers 1 --report page.html >told
$ head -n 1 page.html; tail -n 1 page.html; grep -o '<h1>boundary</h1>\|quick, about 0.01 s per case, up to 1 worker<' page.html
<!DOCTYPE html>
...</html>
<h1>boundary</h1>
quick, about 0.01 s per case, up to 1 worker<
$ tables=$(( $( grep -c '^---' told ) - $( grep -c '^(continued)$' told ) )); test $tables -gt 0 && grep -q " id=\"table-$tables\"" page.html

# One that cannot be written is refused before anything is measured, and looking whether it can be leaves it as it was.
$ mkdir folder; echo 'a page of last week' >kept.html; quick() { wisp bench boundary --quick --seconds 0.01 "$@"; }
> quick --report nowhere/page.html; quick --report folder; quick --output nowhere/out.json --format json
> quick --report kept.html --output nowhere/out.txt; quick --output new.txt --report nowhere/page.html
! wisp: nowhere/page.html: cannot be written: No such...
! wisp: folder: cannot be written: Is a directory...
! wisp: ...nowhere/out.json...
! wisp: ...nowhere/out.txt...
! wisp: ...nowhere/page.html...
[2]
$ cat kept.html; ls -d nowhere new.txt 2>/dev/null
a page of last week
[2]

# A disk that fills up is a failed run, whose results are printed already.
$ if [ -w /dev/full ]; then wisp bench boundary --quick --seconds 0.01 --workers 1 --report /dev/full; else wisp bench boundary --quick --seconds 0.01; echo "wisp: /dev/full: the report could not be written" >&2; exit 2; fi
...
---...
! wisp: /dev/full: the report could not be written...
[2]

# Numbers of suites. More substeps are nearer to the converged run, and the same motion on another mesh is comparable with it.
$ sed 's/columns: 9, rows: 9, spacing: 0.1/columns: 17, rows: 17, spacing: 0.05/' sheet.yaml >fine.yaml; cat >suites.py <<'END'
> import json, os, subprocess
> def wisp( command, status=0 ):
>     run = subprocess.run( [os.environ["WISP"], *command.split()], capture_output=True, text=True )
>     assert run.returncode == status, ( command, run )
>     return run.stdout
> def measure( name, reference, scenes, more="" ):
>     open( name, "w" ).write( f"wisp_suite: 1\n{more}reference: {reference}\nscenes:\n" + "".join( f"  - {{ {scene} }}\n" for scene in scenes ) )
>     return rows_of( name )
> def rows_of( name ):
>     return { row["variant"]: row["error"] for row in json.loads( wisp( f"bench {name} --seconds 0.1 --workers 1 -f json" ) )["rows"] }
> rms, below, half = "RMS_distance_to_the_reference_mm", "RMS_distance_to_the_reference_mm_below", "error_at_0_5_s_mm"
> def doubt_of( name ):
>     return wisp( f"bench {name} --seconds 0.1" ).split( "uncertain by " )[1].split( " mm" )[0]
> falling = ( "{ file: sheet.yaml, set: { substeps: 60, iterations: 4 }, check: { substeps: 30 } }",
>             ["file: sheet.yaml, along: { substeps: [1, 2, 4, 8] }, order: 1", "file: fine.yaml, name: fine, along: { substeps: [1, 8] }"] )
> END
$ python3 <<'END'
> from suites import *
> rows = measure( "falling.yaml", *falling )
> errors = [rows[f"sheet, substeps={n}"][rms] for n in ( 8, 4, 2, 1 )]
> assert errors == sorted( set( errors ) ) and 0 < rows["fine, substeps=8"][rms] < rows["fine, substeps=1"][rms]
> END

# The skin of a figure that lowers its arms is stretched there by a lot, and the cloth that falls through it is not.
$ cat >figure.yaml <<END
> wisp: 1
> steps: 3
> surfaces:
>   - { name: body, file: "$SOURCE/data/figure.glb", animation: { clips: [{ clip: walk, time: 0.05 }] } }
>   - { name: cloth, generate: { shape: plane, columns: 9, rows: 9, spacing: 0.1 }, transform: { translate: [0, 1.2, 0] }, cloth: {}, contact: {} }
> END
$ printf 'wisp_suite: 1\nscenes: [{ file: figure.yaml, name: skin }]\n' >skin.yaml; python3 <<'END'
> from suites import *
> skin = rows_of( "skin.yaml" )["skin"]
> assert skin["stretch_max_percent"] < 1e-3 and skin["intersections"] == skin["intersections_with_driven_surfaces"] > 0
> END

# A run that is the reference has no error, and the doubt of the reference is the distance of the run that is its check. A reference that is extrapolated leaves a run
# of its substeps the error of first order; the doubt is half of the step of the extrapolation, a quarter of the distance of 40 to 80 substeps, and so of both errors.
$ python3 <<'END'
> from suites import *
> rows = measure( "same.yaml", "{ set: { substeps: 20 }, check: { substeps: 10 } }", ["file: sheet.yaml, along: { substeps: [10, 20] }"] )
> assert rows["sheet, substeps=20"][rms] == 0 and doubt_of( "same.yaml" ) == "%.3g" % rows["sheet, substeps=10"][rms]
> rows = measure( "limit.yaml", "{ set: { substeps: 80 }, extrapolate: 1 }", ["file: sheet.yaml, along: { substeps: [20, 40, 80] }"] )
> coarse, fine = ( rows[f"sheet, substeps={n}"][rms] for n in ( 40, 80 ) )
> assert 0.4 * coarse < fine < 0.6 * coarse and 0.2 * 2 * fine < float( doubt_of( "limit.yaml" ) ) < 0.3 * 2 * fine
> # errors at moments and of the energy against the reference: euler loses energy, less with more substeps
> rows = measure( "moments.yaml", "{ set: { substeps: 80 }, extrapolate: 1 }", ["file: sheet.yaml, along: { substeps: [5, 20] }"], "seconds: 0.6\n" )
> few, many = ( rows[f"sheet, substeps={n}"] for n in ( 5, 20 ) )
> energy = "energy_against_the_reference_percent_of_released"
> assert few[half] > 2 * many[half] > 0 and few[energy] < 2 * many[energy] < 0 and "error_at_1_s_mm" not in few
> END

# A row that is nearer to the reference than the reference is to the truth says so, and is on no front. 0.2 s are shorter than any moment.
$ python3 <<'END'
> from suites import *
> rows = measure( "below.yaml", falling[0].replace( "file: sheet.yaml, ", "" ), ["file: sheet.yaml, set: { iterations: 4 }, along: { substeps: [4, 58] }"] )
> far, near = ( rows[f"sheet, substeps={n}"] for n in ( 4, 58 ) )
> assert below not in far and near[below] == 1 and near[rms] > 0 and half not in far
> END
$ wisp bench below.yaml --seconds 0.1
... below ...1 of 2 are on it...

# References that are kept are found again, those that are broken are made again, and another scene has one of its own.
$ rm -rf cache; python3 <<'END'
> from suites import *
> error = measure( "falling.yaml", *falling )["sheet, substeps=4"][rms]
> kept = ["cache/" + name for name in os.listdir( "cache" )]
> for path in kept:
>     open( path, "r+" ).truncate( 100 )
> assert rows_of( "falling.yaml" )["sheet, substeps=4"][rms] == error and len( kept ) == len( os.listdir( "cache" ) ) == 2
> END
$ sed -i.kept 's/spacing: 0.1 /spacing: 0.11 /' sheet.yaml; wisp bench falling.yaml --seconds 0.1 >/dev/null; mv sheet.yaml.kept sheet.yaml; ls cache | wc -l
4

# Rows that differ in what is simulated have references of their own; those that differ in how it is solved share one.
$ printf 'wisp: 1\nsteps: 6\nstrands: [{ name: hair, generate: { strands: 4, vertices: 6, length: 0.2 }, dynamics: {} }]\n' >few_hairs.yaml
$ rm -rf cache; python3 <<'END'
> from suites import *
> rows = measure( "counts.yaml", "{ set: { substeps: 8 }, check: { substeps: 4 } }",
>                 ['file: few_hairs.yaml, vary: { "strands[0].generate.strands": [4, 9], "strands[0].generate.vertices": [6, 8], '
>                  '"strands[0].dynamics.integrator": [euler, bdf2], substeps: [4, 8] }',
>                  'file: sheet.yaml, vary: { "surfaces[0].generate.rows": [5, 9], substeps: [4, 8] }',
>                  'file: sheet.yaml, name: damped, vary: { "surfaces[0].damping": [0.5, 2], substeps: [8] }'] )
> assert len( os.listdir( "cache" ) ) == 2 * ( 4 + 2 + 2 )
> for name in ( "few_hairs, strands=4, vertices=6, integrator=euler, substeps=8", "few_hairs, strands=9, vertices=8, integrator=euler, substeps=8",
>               "sheet, rows=5, substeps=8", "sheet, rows=9, substeps=8", "damped, damping=0.5, substeps=8", "damped, damping=2, substeps=8" ):
>     assert rows[name][rms] == 0 and rows[name]["until_s"] > 0
> assert rows["few_hairs, strands=9, vertices=6, integrator=bdf2, substeps=8"][rms] > 0
> assert rows["sheet, rows=5, substeps=4"][rms] == rows["sheet, rows=5, substeps=4"]["doubt_mm"]
> END
$ wisp bench counts.yaml --seconds 0.1 --workers 1 -f latex >told; grep -o '22 settings of 8 scenes, each compared with its own reference' told | head -n 1; grep -A1 '^.toprule' told | head -n 2
> grep -o '^few.*vertices=8, integrator=bdf2, substeps=4 & 1 & 9 & 72 & 4 & ' told
22 settings of 8 scenes, each compared with its own reference
\toprule
setting & workers & strands & vertices & substeps & ms & ms, p90 & FPS & error, mm...
few\_hairs, strands=9, vertices=8, integrator=bdf2, substeps=4 & 1 & 9 & 72 & 4 & 

# Tuning has the reference of accuracy.
$ wisp accuracy sheet.yaml --suite made.yaml >/dev/null; python3 <<'END'
> from suites import *
> links = rows_of( "made.yaml" )["as written, substeps=1"][rms]
> run = subprocess.run( [os.environ["WISP"], *"tune sheet.yaml --error 10 --workers 1 -f json".split()], capture_output=True, text=True )
> found = [row["error"]["rms_m"] for row in json.loads( run.stdout )["rows"]
>          if [row["size"][key] for key in ( "substeps", "iterations", "cloth.tethers", "cloth.coarse_substeps" )] == [1, 1, 0, 0]]
> assert len( found ) == 1 and abs( 1e3 * found[0] - links ) < 1e-6 * links
> END

# Two runs of `wisp bench accuracy` differ in times alone, on which the number of rounds depends, and workers change nothing but times and their memory.
$ cat >repeats.py <<'END'
> from suites import *
> def rows( seconds, workers ):
>     rows = json.loads( wisp( f"bench {os.environ['SOURCE']}/data/suites/accuracy/strands_rest.yaml --format json --seconds {seconds} --workers {workers}" ) )["rows"]
>     for row in rows:
>         for key in "ms_median", "ms_p10", "ms_p90", "fps", "stages", "steps", "samples_ms", "cpu_fraction":
>             del row[key]
>         row["error"].pop( "memory_KiB", None )
>         row["size"].pop( "bytes", None )
>     return rows
> first, longer, alone = rows( 0.01, 2 ), rows( 3, 2 ), rows( 0.01, 1 )
> assert first == longer and len( first ) == 2 * len( alone ) >= 24
> # the rows of a setting are consecutive, by workers
> assert first[0::2] == alone and [row["workers"] for row in first[1::2]] == [2] * len( alone )
> assert [{ **row, "workers": 1 } for row in first[1::2]] == alone
> END
> python3 repeats.py

# The suites of effects and of the dressed figure are read whole; the first row, which the others are compared with, is links alone.
$ wisp sweep "$SOURCE/data/suites/effect_costs.yaml" -o none --list | grep -o '^ *1 .*'; for suite in effect_costs character features; do wisp sweep "$SOURCE/data/suites/$suite.yaml" -o none --list | wc -l; done
    1 ...  links
21
13
6

# The costs of a suite are told over its first row, as `wisp bench effects` has them.
$ printf 'wisp: 1\nsteps: 6\nsurfaces: [{ name: cloth, generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }, pins: [0], cloth: {} }]\n' >costs.yaml
> printf 'wisp_suite: 1\nscenes: [{ file: costs.yaml, name: one }, { file: costs.yaml, name: many, set: { substeps: 40 } }]\n' >over.yaml
> wisp bench over.yaml --seconds 0.5 --workers 1 | awk 'NF == 7 && $1 == "one" { one = $4; print $6 } NF == 7 && $1 == "many" { q = $4 / one / $6; print ( q > 0.98 && q < 1.02 ) }'
1.00
1
