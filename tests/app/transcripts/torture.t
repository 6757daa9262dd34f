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

# One twin alone, in JSON.
$ wisp torture --twin shift --format json good.yaml | python3 -c 'import json, sys; print( json.load( sys.stdin )["rows"][0]["size"]["scenes"] )'
1
