# wisp tune: the reported result holds in another run, and the written scene has the configuration.
$ cat >cloth.yaml <<'END'
> # A small cloth.
> wisp: 1
> dt: 0.0166667
> steps: 20
> substeps: 3 # as it was
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     pins: [0, 8]
>     # soft
>     cloth: { bending: none, coarse_substeps: 0 }
> END

# An error is met, and the scene that is written has the choice.
$ wisp tune cloth.yaml --error 0.02 --workers 1 --output tuned.yaml >told; cat told
target     met: error at most 0.02 m; compared until 0.333 s, the end
chosen ...
...Pareto...
$ sed -nE 's/^.* ms per step, error ([^ ]+) m.*/\1/p' told | head -n 1 | awk '{ print ( $1 <= 0.02 ) }'
1
# (a value that is that of a scene without the key is not written)
$ chosen() { grep '^chosen ' told | grep -oE "[ .]$1: [^,]+" | sed 's/.*: //'; }
> written() { grep -oE "\b$1: [^,} ]+" tuned.yaml | sed 's/.*: //'; }
> for pair in substeps/ iterations/1 tethers/false coarse_substeps/0; do
>     key=${pair%/*} value=$( written ${pair%/*} ); test "$( chosen $key )" = "${value:-${pair#*/}}" || echo "$key: $value"
> done
$ sed 's/^#/comment:/' tuned.yaml
comment: A small cloth.
wisp: 1
...substeps: ... # as it was
...
    # soft
    cloth: {...
$ wisp run tuned.yaml >/dev/null 2>&1

# Its errors are those of `wisp accuracy`: one reference, one horizon, one norm.
$ wisp accuracy cloth.yaml --seconds 0.01 --workers 1 -f csv >rows.csv; python3 <<'END'
> import csv, re
> rows = {row["variant"]: row for row in csv.DictReader( open( "rows.csv" ) )}
> NAMES = {( "1", "false" ): "as written", ( "4", "false" ): "4 iterations", ( "1", "true" ): "tethers"}
> found = 0
> for substeps, *kind, error, largest in re.findall( r"(?m)^ *(\d+) +(\d+) +(true|false) +0 +\S+ +(\S+) +(\S+)", open( "told" ).read() ):
>     row = rows.get( f"{NAMES.get( tuple( kind ) )}, substeps={substeps}" )
>     if row:
>         found += 1
>         for mm, m in ( row["error.RMS_distance_to_the_reference_mm"], error ), ( row["error.largest_distance_mm"], largest ):
>             assert abs( float( mm ) - 1e3 * float( m ) ) < 1e-3 * float( mm ), ( substeps, mm, m )
> assert found > 1, found
> END

# Coarse substeps of a scene are tuned, and the choice is written where they stand.
$ cat >coarse.yaml <<'END'
> wisp: 1
> steps: 8
> substeps: 1
> iterations: 1
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 33, rows: 33, spacing: 0.02 }
>     pins: [0, 32]
>     cloth:
>       bending: none
>       coarse_substeps: 3 # of mine
> END
$ wisp tune coarse.yaml --error 10 --workers 1 -o tuned.yaml >told
$ grep -o 'coarse_substeps: [0-9]* # of mine' tuned.yaml | grep -o '[a-z_]*: [0-9]*' >written; grep '^chosen ' told | grep -o 'coarse_substeps: [0-9]*' | cmp written -

# So are passes of strands.
$ cat >strands.yaml <<'END'
> wisp: 1
> steps: 8
> strands:
>   - name: hair
>     generate: { dimension: 2, strands: 16, vertices: 9, spacing: 0.03 }
>     dynamics: { stretch_passes: 3, rest: straight }
> END
$ wisp tune strands.yaml --error 0.01 --workers 1 -o tuned.yaml >told
$ passes() { grep -o 'stretch_passes: [0-9]*'; }; passes <tuned.yaml >written; grep '^chosen ' told | passes | cmp written -

# A budget is met, or it is told that it is not; nothing is written then.
$ wisp tune cloth.yaml --budget 1000 --workers 1 --length 0.1
target     met: at most 1000 ms per step...
...81 vertices and 6 times up to 0.1 s...
$ wisp tune cloth.yaml --budget 1e-9 --workers 1 --length 0.1 -o unmet.yaml
target     not met: at most 1e-09 ms per step; compared until 0.1 s, the end
nearest    substeps: 1, iterations: 1...
not written: unmet.yaml...
[1]
$ test ! -e unmet.yaml

# An error out of reach ends with 1 and the best.
$ wisp tune cloth.yaml --error 1e-12 --workers 1 --length 0.1
target     not met: error at most 1e-12 m; compared until 0.1 s, the end
nearest    ...
[1]

# A report in JSON has a row for every setting.
$ wisp tune cloth.yaml --error 0.02 --workers 1 --length 0.1 --format json | python3 -m json.tool | grep -o '^{\|"chosen"\|"rms_m"\|"substeps"' | sort -u
"chosen"
"rms_m"
"substeps"
{

# A limit leaves one run and says that there may be better.
$ wisp tune cloth.yaml --error 0.02 --workers 1 --limit 1e-9
...1 run of 1 configuration in ...better ones may exist...

# A repair is told once and not with every run.
$ printf 'v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\nf 2 3 4\n' >doubled.obj
$ cat >doubled.yaml <<'END'
> wisp: 1
> steps: 4
> surfaces:
>   - name: a
>     file: doubled.obj
>     repair: [duplicates]
>     pins: [0]
>     cloth: { bending: none }
> END
$ wisp tune doubled.yaml --error 1e-9 --workers 1 >/dev/null
! wisp: ...surface 'a'...
[1]
$ wisp tune doubled.yaml --error 1e-9 --workers 1 2>&1 >/dev/null | wc -l
1

# Scenes that cannot be tuned are refused.
$ printf 'wisp: 1\nstrands:\n  - name: hair\n    generate: { dimension: 2, strands: 4, vertices: 9 }\n    frozen_hair: { freeze: {} }\n' >still.yaml
$ wisp tune still.yaml --error 1
! wisp: ...nothing in the scene moves...
[2]
$ printf 'wisp: 1\nsubsteps: none\n' >bad.yaml
$ wisp tune bad.yaml --error 1
! wisp: bad.yaml:2:11...
[2]

# So is a place where the scene would not find its files.
$ printf 'wisp: 1\nsurfaces:\n  - { name: a, file: a.obj, cloth: {} }\n' >mesh.yaml
$ wisp tune mesh.yaml --error 1 -o elsewhere/tuned.yaml
! wisp: ...elsewhere/tuned.yaml must be in the same folder...
[2]
$ wisp tune cloth.yaml --error 10 --length 0.02 --workers 1 -o elsewhere/tuned.yaml
! wisp: ...elsewhere...
[2]

# A place where nothing can be written is refused before any run. The first run of this scene fails, because nothing is at the
# position of its pins: another message means that it did not run.
$ cat >unmade.yaml <<'END'
> wisp: 1
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     pin_box: { min: [7, 7, 7], max: [8, 8, 8] }
>     cloth: {}
> END
$ wisp tune unmade.yaml --error 1
! wisp: ...no vertex starts in pin_box...
[2]
$ wisp tune unmade.yaml --error 1 -o no_such/tuned.yaml
! wisp: no_such/tuned.yaml: cannot be written...
[2]
$ test ! -e no_such && mkdir folder
$ wisp tune unmade.yaml --error 1 -o folder
! wisp: folder: cannot be written...
[2]
$ wisp tune unmade.yaml --error 1 -o cloth.yaml/tuned.yaml
! wisp: cloth.yaml/tuned.yaml: cannot be written...
[2]
$ echo kept >kept.yaml; chmod 0400 kept.yaml; if [ -w kept.yaml ]; then echo 'wisp: kept.yaml: cannot be written, unless by root' >&2; exit 2; fi
> wisp tune unmade.yaml --error 1 -o kept.yaml
! wisp: kept.yaml: cannot be written...
[2]

# Trying whether a file can be written leaves it as it was.
$ echo before >before.yaml
$ wisp tune unmade.yaml --error 1 -o before.yaml
! wisp: ...no vertex starts in pin_box...
[2]
$ wisp tune unmade.yaml --error 1 -o new.yaml
! wisp: ...no vertex starts in pin_box...
[2]
$ cat before.yaml; test ! -e new.yaml
before
