# wisp torture: scenes that hold are status 0.
$ cat >good.yaml <<'END'
> wisp: 1
> steps: 60
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 5, rows: 5, spacing: 0.05 }
>     pins: [0, 4]
>     cloth: {}
> END
$ wisp torture good.yaml >told; grep -o 'scenes  1, \|broken  0' told
scenes  1, 
broken  0

# A scene that breaks is status 1 and a sentence. The reader takes this one and the engine does not: the mesh is open.
$ printf 'wisp: 1\nsteps: 120\nsurfaces:\n  - name: cloth\n    generate: { shape: plane }\n    balloon: {}\n' >broken.yaml
$ wisp torture good.yaml broken.yaml >told 2>/dev/null; echo $?; grep -o 'broken   1\|broken.yaml: refused: ' told | LC_ALL=C sort -u
1
broken   1
broken.yaml: refused: 

# Close limits break what others let pass: a sheet that is heavy at the bottom gains less energy than all of it could by being lifted,
# but it gains some.
$ cat >close.yaml <<'END'
> wisp: 1
> steps: 300
> surfaces:
>   - name: cloth
>     generate: { shape: alternating_plane, columns: 12, rows: 12, spacing: 0.05 }
>     transform: { rotate: { degrees: [90, 0, 0] } }
>     pins: [0, 11]
>     damping: 4
>     mass_ratio: 1e3
>     cloth: { bending: isometric, internal_damping: 0 }
> END
$ wisp torture close.yaml >/dev/null
$ wisp torture --close close.yaml
...close.yaml: energy: energy is ...
[1]

# A search counts its scenes, and prints the scene of a seed.
$ wisp torture --seed 1 --scenes 3 --keep 0 --out found --format json >json 2>/dev/null; test $? -lt 2
> python3 -c 'import json; print( json.load( open( "json" ) )["rows"][0]["size"]["scenes"] )'
3
$ wisp torture --seed 3 --first 5 --print >printed.yaml
$ wisp info printed.yaml >/dev/null
