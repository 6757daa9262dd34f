# Suites in wisp bench, and wisp accuracy; suites whose rows have checks; a report beside the results. Their numbers are in
# test_program_suite.c.
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
