# The program with valid and invalid input: results, notes, help of every command.
$ cat >good.yaml <<'END'
> wisp: 1
> steps: 3
> strands:
>   - name: hair
>     generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }
>     frozen_hair:
>       freeze: {}
>       align: { cursor: [0, -0.3, 0] }
>       clump: { radius: 0.006 }
>     appearance: {}
>     compute: [points, width, colour]
> hair_events:
>   - { step: 1, strands: hair, cursor: [0.1, -0.2, 0] }
> output:
>   - { strands: hair, file: written.hair }
>   - { strands: hair, file: written.obj }
> END

# What has no effect is told in a line by the log and by run, plan and info; what has one ('right', 'picture') is not.
$ cat >vain.yaml <<'END'
> wisp: 1
> steps: 1
> strands:
>   - name: fine
>     generate: { strands: 2, vertices: 20, length: 0.0001 }
>     dynamics: { wind: [3, 0, 0] }
>     collision: false
>   - name: still
>     generate: { strands: 2 }
>     frozen_hair: {}
>   - name: thick
>     generate: { strands: 2 }
>     dynamics: {}
>     grid: { friction: 0 }
>     collision: false
> surfaces:
>   - name: left
>     generate: { shape: plane, columns: 3, rows: 3 }
>     pins: [0, 1]
>     cloth: { wind: [3, 0, 0] }
>     collision: { mask: [2] }
>     contact: { self: false, layers: [3] }
>   - name: right
>     generate: { shape: plane, columns: 3, rows: 3 }
>     pins: [0, 2]
>     cloth: {}
>     collision: false
>   - { name: open, file: split.obj, cloth: {}, collision: false }
> colliders:
>   - { name: floor, shape: plane }
>   - { name: picture, shape: plane, layers: [] }
> seams:
>   - { name: sewn, surfaces: [left, right], pairs: [[0, 0], [1, 1], [2, 2]] }
> END
# Two triangles of a square, with vertices of their own.
$ printf 'v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 4 5 6\n' >split.obj
$ wisp run vain.yaml >told 2>log; wisp plan vain.yaml --steps 0 >planned 2>/dev/null; wisp info vain.yaml >described
$ for f in told log planned described; do grep -o "vain.yaml:[0-9]*: '.*\|seams: 1 of 3 .*" $f | sort -u >$f.notes; cmp told.notes $f.notes; done; cat told.notes
seams: 1 of 3 pairs of entity 10 join two pinned vertices, ...
vain.yaml:11: 'thick': 'grid' has no effect ...
vain.yaml:17: 'left': 'collision' has no effect...
vain.yaml:17: 'left': 'contact' has no effect...
vain.yaml:17: 'left': 'wind' has no effect ...
vain.yaml:28: 'open': 2 vertices are where others are, ...
vain.yaml:30: 'floor': nothing collides with this collider...
vain.yaml:4: 'fine': 'wind' has no effect ...
vain.yaml:4: 'fine': 38 of the segments are below 10 um ...
vain.yaml:8: 'still': 'frozen_hair' has no effect without freeze, align or clump
$ grep -h "note: vain.yaml:21\|'picture'" told planned described
[1]
$ wisp info good.yaml | grep note:
[1]
$ cat >joined.yaml <<'END'
> wisp: 1
> surfaces:
>   - { name: joined, file: split.obj, repair: [weld], cloth: {} }
> END
$ wisp info joined.yaml 2>/dev/null | grep note:
[1]

# The version is that of the header.
$ number() { sed -n "s/#define WISP_VERSION_$1 //p" "$SOURCE/engine/include/wisp/base.h"; }
> echo "wisp $(number MAJOR).$(number MINOR).$(number PATCH)" >version; number STRING | sed 's/"\(.*\)"/wisp \1/' | cmp version -
> wisp --version | head -n 1 | cmp version -
$ wisp --version
wisp ...
kernels: baseline...

# Help of every command names its usage and the exit statuses, in lines that a terminal of 100 columns holds.
$ for verb in "" run plan bench accuracy info render tune torture; do
>     wisp $verb --help >help && grep '^Usage' help; awk 'length > 100' help; grep -A1 '^Exit status:' help | tail -n 1
> done
Usage: wisp [OPTION...] COMMAND...
  0   success
Usage: wisp run [OPTION...] SCENE
  0   success
Usage: wisp plan [OPTION...] SCENE
  0   success
Usage: wisp bench [OPTION...] [CASE|SUITE...]
  0   success
Usage: wisp accuracy [OPTION...] SCENE
  0   success
Usage: wisp info [OPTION...] FILE
  0   success
Usage: wisp render [OPTION...] SCENE|RECORDING|MESH|GROOM
  0   success
Usage: wisp tune [OPTION...] SCENE
  0   success
Usage: wisp torture [OPTION...] SCENE...
  0   success
$ wisp bench --help | grep -c -- --report=FILE
1

# A misspelt word is answered with the nearest, a misspelt key with its line too.
$ wisp run good.yaml --isa avx22
! ...did you mean 'avx2'?...
[64]
$ wisp run good.yaml --isa quantum
! ...expected one of baseline, avx2, avx512...
[64]
$ cat >bad.yaml <<'END'
> wisp: 1
> strands:
>   - name: hair
>     generate: { shape: wavy, dimension: 2, strnads: 40 }
> END
$ wisp run bad.yaml
! wisp: bad.yaml:4:44: ...unknown key 'strnads', did you mean 'strands'?
[2]
$ wisp plan bad.yaml
! wisp: bad.yaml:4:44: ...unknown key 'strnads', did you mean 'strands'?
[2]
$ wisp info bad.yaml
! wisp: bad.yaml:4:44: ...unknown key 'strnads', did you mean 'strands'?
[2]

# A groom that a scene cannot read is named with the line of the scene.
$ printf 'wisp: 1\nstrands:\n  - name: hair\n    file: absent.hair\n    compute: [points]\n' >bad.yaml
$ wisp run bad.yaml
! wisp: bad.yaml:3:...absent.hair...
[2]
$ wisp info bad.yaml
...
! wisp: bad.yaml:3:...
[2]

# A run writes the files of its scene, with the widths and colours of its appearance: 80 micrometres at the root, 20 at the tip.
$ wisp run good.yaml
scene        good.yaml
steps        3 of 16.67 ms: ...
ms per step  ...
speed        ...
size         40 strands, 800 vertices, ... bytes per vertex
written      written.hair
written      written.obj
hash         ...
$ test -r written.obj
$ wisp info written.hair
...
  vertices             800
...
  thickness            min 2e-05, mean ..., max 8e-05 m
  colour               a vertex
...

# A list of numbers must have one for each strand of the file.
$ cat >bad.yaml <<'END'
> wisp: 1
> strands:
>   - name: hair
>     file: written.hair
>     frozen_hair:
>       align: { intensity: [0.5, 0.6, 0.7] }
>     compute: [points]
> END
$ wisp run bad.yaml
! wisp: bad.yaml:3:...intensity: got 3 numbers, expected one for each of 40 strands...
[2]

# What cannot be written is told before the first step, with which a recording begins.
$ wisp run good.yaml --output absent/summary.csv
! wisp: ...absent/summary.csv...
[2]
$ if [ -w /dev/full ]; then wisp run good.yaml --output /dev/full; else echo "wisp: no /dev/full" >&2; exit 2; fi
! wisp: .../dev/full...
[2]
$ cat >lost.yaml <<'END'
> wisp: 1
> strands:
>   - name: hair
>     generate: { shape: straight, dimension: 2, strands: 3, vertices: 4 }
>     compute: [points]
> output:
>   - { strands: hair, file: absent/hair.obj }
> END
$ wisp run lost.yaml --record early.wisp
! wisp: lost.yaml:7:5: absent/hair.obj: cannot be written...
[2]
$ wisp run good.yaml --record early.wisp --output absent/summary.csv
! wisp: absent/summary.csv: cannot be written...
[2]
$ ls early.wisp 2>/dev/null
[2]

# A run gives the same hash with any number of workers and every instruction set.
$ for o in "--workers 1" "--workers 2" "--workers 5" "--isa baseline"; do
>     wisp run good.yaml --format json $o | grep -oE '"hash": "[0-9a-f]{16}"|"steps": [0-9]+|"vertices": [0-9]+'
> done | sort | uniq -c
      4 "hash": "..."
      4 "steps": 3
      4 "vertices": 800

# With -v: passes and counters behind the hash, in lines that fit; a counter that is zero is left out.
$ wisp run good.yaml --steps 2 -v | sed '/^machine: /,$d' >told; awk 'length > 100' told; cat told
scene ...
steps        2 of 16.67 ms: ...
... x real time with ... bytes per vertex
...
hash         ...
Time per step by pass...
frozen_hair.clump...
neighbours...
$ grep 'halted\|gravity scaled' told
[1]
$ wisp run good.yaml --steps 2 --format json | grep -o '"frozen_hair.freeze"\|"frozen_hair.clump"\|"strand_appearance.width"'
"frozen_hair.freeze"
"frozen_hair.clump"
"strand_appearance.width"

# Every format, on standard output or in a file.
$ for f in text markdown csv json; do wisp run good.yaml --format $f | head -n 1 | cut -c -12; done
scene       ...
|  |  |
case,variant
{
$ wisp run good.yaml --format csv --output summary.csv
$ test -r summary.csv

# Info prints the keys of a block.
$ wisp info --keys surfaces.cloth
...
### `surfaces[].cloth`
...
- `internal_damping` (number or [map](#maps), 1/s...
$ wisp info --keys surfaces.cloth | grep balloon
[1]
$ wisp info --keys
...
### The scene
...

# Stretched cloth is told with the way out, statistics where they are requested.
$ cat >soft.yaml <<'END'
> wisp: 1
> steps: 60
> substeps: 1
> surfaces:
>   - name: flag
>     generate: { shape: plane, columns: 33, rows: 33, spacing: 0.03 }
>     pins: [0, 32]
>     cloth: { coarse_substeps: 0 }
> END
$ wisp run soft.yaml -v >told; grep -o 'links.xpbd\|flag is stretched by \|tethers: true of its cloth keeps lengths\|Motion at the end' told | sort -u
flag is stretched by 
links.xpbd
tethers: true of its cloth keeps lengths
$ { grep -v substeps: soft.yaml; echo '    compute: [ points, motion_stats ]'; echo '    cloth: { coarse_substeps: 0 }'; } >moving.yaml
$ wisp run moving.yaml -v >told; grep -o 'is stretched\|Motion at the end\|kinetic J' told | sort -u
Motion at the end
kinetic J

# Penetration is printed with -v, and a vertex below a surface is told.
$ cat >above.yaml <<'END'
> wisp: 1
> steps: 20
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     transform: { translate: [0, 0.02, 0] }
>     cloth: {}
>     collision: { thickness: 0.01, max_push_out_speed: 0.1 }
>     compute: [points, collision_stats]
> colliders:
>   - { name: ground, shape: plane }
> END
$ sed 's/0.02, 0/-0.05, 0/' above.yaml >below.yaml
$ wisp run above.yaml -v | grep -o 'deepest mm\|below the surface'
deepest mm
$ wisp run below.yaml | grep 'deepest mm\|below the surface'
...sheet: vertex ... mm below the surface of a collider in step 1
$ wisp run below.yaml --format json | grep -o '"collision_penetration": 0.0'
"collision_penetration": 0.0

# Edges that pass through those of a box are told: mean edges of 56.9 mm / 2^1.5, less a quarter of that, the default thickness.
$ for keys in "" "features: all" "thickness: 0.03"; do
>     cat >crate.yaml <<END
> wisp: 1
> steps: 1
> surfaces:
>   - { name: sheet, generate: { shape: plane, columns: 5, rows: 5, spacing: 0.05 }, cloth: {}, collision: { $keys } }
> colliders: [{ name: crate, shape: box, half_extent: [1, 1, 1] }]
> END
>     wisp run crate.yaml 2>/dev/null | grep -c "pass up to 5.9 mm through those of the box 'crate'"
> done
1
0
0
[1]

# The reaction of a collider is the weight of what lies on it: 0.15 kg/m^2, 0.16 m^2 and 9.8 m/s^2 are 0.2352 N.
$ cat >weight.yaml <<'END'
> wisp: 1
> steps: 60
> gravity: [0, -9.8, 0]
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     transform: { translate: [0, 0.01, 0] }
>     cloth: {}
>     collision: { thickness: 0.01 }
> colliders:
>   - { name: ground, shape: plane, compute: [reaction] }
>   - { name: aside, shape: sphere, radius: 1, position: [0, 9, 0] }
> END
$ wisp run weight.yaml -v >told; grep -o 'aside\|Penetration\|Reaction of colliders' told
> awk 'function is( a, b, within ) { return a - b < within && b - a < within }
> $1 == "ground" { print is( $2, 0, 1e-4 ), is( $3, -0.2352, 1e-3 ), is( $4, 0, 1e-4 ), ( $5 >= 0.235 && $5 < 0.5 ) }' told
Reaction of colliders
1 1 1 1

# A scene without requests has a plan without passes.
$ printf 'wisp: 1\nstrands:\n  - name: hair\n    generate: { dimension: 2, strands: 3, vertices: 4 }\n    compute: []\n' >empty.yaml
$ wisp plan empty.yaml
...: 0 passes...
$ wisp run empty.yaml --steps 2 -v >told; grep -o '^computed .*\|Time per step by pass' told
computed     nothing, since the scene requests nothing...
$ wisp plan good.yaml | grep -o ': 0 passes\|frozen_hair.freeze' | sort -u
frozen_hair.freeze

# Info tells kinds of files apart, and refuses what it does not know or cannot trust.
$ wisp info good.yaml
...
  hair (line 4): 40 strands, 800 vertices...
$ wisp run good.yaml --format json --output result.json
$ wisp info result.json
...good.yaml/run strands=40 vertices=800...
$ echo 'a letter' >other.txt
$ wisp info other.txt
! wisp: ...unknown kind of file, expected a groom...
[2]
$ cat >quads.yaml <<'END'
> wisp: 1
> surfaces:
>   - { name: a, generate: { shape: plane, columns: 3, rows: 3 }, implicit: { stiffness_model: link, links: quad } }
> END
$ sed 's/links: quad.*/}, detail: { level: coarse } }/; s/implicit: .*link, /cloth: { coarse_substeps: 1 /' quads.yaml >coarse.yaml; wisp info --host coarse.yaml 2>/dev/null | grep 'level = '
    detail_surface0.level = WISP_DETAIL_COARSE;
$ wisp info --host quads.yaml
! wisp: quads.yaml:3: got 'implicit.links', which --host does not print...
[2]
$ printf HAIR >cut.hair
$ wisp info cut.hair
! wisp: cut.hair...
[2]
$ echo '{"wisp_results":1,"machine":{},"build":{},"rows":[{}]}' >result.json
$ wisp info result.json
! wisp: ...rows[0].case...
[2]
$ wisp bench --list
paper ...

# Workers that share a processor have it for less than their time, which is told beside the speed.
$ python3 -c 'import os, subprocess
> os.sched_setaffinity( 0, { min( os.sched_getaffinity( 0 ) ) } )
> subprocess.run( [os.environ["WISP"], "run", os.environ["SOURCE"] + "/data/scenes/hanging_cloth.yaml", "--workers", "2"] )' | grep '^speed'
speed ...with 2 workers, which had processors for ... % of the time

# `collision: true` is the block by its defaults.
$ for way in true {} '"true"'; do
>     printf 'wisp: 1\nsteps: 9\nsurfaces: [ { name: a, generate: { shape: plane, columns: 5, rows: 5 }, cloth: {}, collision: %s } ]\ncolliders: [ { name: g, shape: sphere, radius: 0.2, position: [0, -0.21, 0] } ]\n' "$way" >way.yaml
>     wisp run way.yaml >way; grep hash way >>ways
> done; sort -u ways | wc -l; wc -l <ways
1
2
! wisp: way.yaml:3:...surfaces[0].collision: got the text 'true', expected a mapping ({} takes the defaults)
