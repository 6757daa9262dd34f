# Recordings of a run: formats, values, verification. What their frames hold is in test_program_record.c.
$ cat >hair.yaml <<'END'
> wisp: 1
> steps: 3
> strands:
>   - name: hair
>     generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }
>     frozen_hair: { freeze: {}, align: { cursor: [0, -0.3, 0] }, clump: { radius: 0.006 } }
>     appearance: {}
> hair_events:
>   - { step: 1, strands: hair, cursor: [0.1, -0.2, 0] }
> END
$ cat >cloth.yaml <<'END'
> wisp: 1
> steps: 6
> substeps: 4
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 12, rows: 12, spacing: 0.05 }
>     transform: { translate: [0, 0.43, 0] }
>     cloth: {}
>     collision: { thickness: 0.01 }
> colliders:
>   - { name: ball, shape: sphere, radius: 0.2, position: [0, 0.2, 0] }
>   - { name: floor, shape: plane }
> END

# A run is recorded in every format.
$ for file in a.wisp a.pc2 a.pvd a.obj a.usda a.glb; do wisp run hair.yaml --record $file | grep -o ': 4 frames$'; done
: 4 frames
: 4 frames
: 4 frames
: 4 frames
: 4 frames
: 4 frames
$ for file in a.wisp a.pc2 a/hair_0004.vtp a_0004.obj a.usda a.glb; do test -e $file || echo "no $file"; done

# Recording does not change the hash.
$ wisp run cloth.yaml | grep '^hash' >hash
$ for file in h.wisp h.pc2 h.pvd h.obj h.usda h.glb; do wisp run cloth.yaml --record $file >told; grep '^hash' told | cmp hash -; grep -o 'h[_.a-z0-9, ]*\( to h_0007.obj\)*: 7' told; done
h.wisp: 7
h_cloth.pc2, h_ball.pc2: 7
h.pvd: 7
h_0001.obj to h_0007.obj: 7
h.usda: 7
h.glb: 7
$ grep -o 'Name="Normals"\|Name="strain"' h/cloth_0007.vtp; grep -o 'Name="Normals"' h/ball_0001.vtp; test ! -e h/ball_0002.vtp
Name="Normals"
Name="Normals"

# Values that are asked for are computed and move no vertex; those that the scene computes are recorded without asking.
$ wisp run cloth.yaml --record with.usda --record-with strain,speed >/dev/null
$ grep -o 'primvars:strain.timeSamples\|primvars:speed.timeSamples' with.usda | sort -u
primvars:speed.timeSamples
primvars:strain.timeSamples
$ wisp run cloth.yaml --record plain.pvd >/dev/null; wisp run cloth.yaml --record with.pvd --record-with speed >/dev/null
> grep -o 'Name="speed"\|Name="strain"' with/cloth_0007.vtp
Name="speed"
$ for run in plain with; do sed -n '/<Points>/,$p' $run/cloth_0007.vtp >$run.points; done; test -s plain.points && cmp plain.points with.points
$ sed 's/^    cloth: {}/    compute: [points, strain]\n    cloth: {}/' cloth.yaml >strained.yaml
> wisp run strained.yaml --record strained.pvd >/dev/null; grep -o 'Name="speed"\|Name="strain"' strained/cloth_0007.vtp
Name="strain"

# Hair is recorded with the widths and colours of its appearance.
$ wisp run hair.yaml --record dressed.pvd >/dev/null; grep -o 'Name="width"\|Name="RGB"' dressed/hair_0001.vtp | sort -u
Name="RGB"
Name="width"

# A value that cannot be recorded is refused.
$ wisp run hair.yaml --record r.pvd --record-with strain
! wisp: ...hair.yaml has no body with strain...
[2]
$ wisp run cloth.yaml --record r.glb --record-with strain
! ...--record-with: expected together with --record and a file that ends in .pvd...
[64]
$ wisp run cloth.yaml --record r.pvd --record-with strain,mass
! ...--record-with: got 'strain,mass', expected strain, speed or both...
[64]
$ wisp run cloth.yaml --record r.pvd --record-with strain --verify a.wisp 2>/dev/null
[64]
$ wisp run cloth.yaml --record r.glb --steps 1001
! wisp: r.glb: got 1002 frames, expected at most 1000...
[2]
$ ls r.pvd r.glb 2>/dev/null
[2]

# A run verifies its recording on other workers and instruction sets.
$ wisp run hair.yaml --record proof.wisp --workers 1 >/dev/null
$ wisp run hair.yaml --verify proof.wisp --workers 3 --isa baseline
...proof.wisp: 4 frames, every bit equal...
$ wisp run hair.yaml --verify proof.wisp --steps 2
...proof.wisp: 3 frames, every bit equal...proof.wisp: 1 frames after the last step...

# One that is cut, of another length or of something else proves nothing.
$ wisp run hair.yaml --record short.wisp --steps 2 >/dev/null
$ wisp run hair.yaml --verify short.wisp
! wisp: short.wisp: got 3 frames, expected 4...
[2]
$ wisp run hair.yaml --verify short.wisp --steps 2 >/dev/null
$ wisp run hair.yaml --verify proof.wisp --steps 4
! wisp: proof.wisp: got 4 frames, expected 5...
[2]
$ head -c -100 proof.wisp >cut.wisp; wisp run hair.yaml --verify cut.wisp
! wisp: cut.wisp: the recording is cut...
[2]
$ sed 's/name: hair/name: fur/; s/strands: hair/strands: fur/' hair.yaml >fur.yaml; wisp run fur.yaml --record fur.wisp >/dev/null
$ wisp run hair.yaml --verify fur.wisp
! wisp: ...body 0 differs in its name...
[2]
$ wisp run hair.yaml --verify absent.wisp
! wisp: ...absent.wisp...
[2]
$ wisp run hair.yaml --verify a_0004.obj
! wisp: ...a_0004.obj...
[2]

# Info names what is wrong with a mesh by element.
$ printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n' >turned.obj
$ wisp info turned.obj
...triangles            2...open edges...winding...
$ printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >broken.obj
$ wisp info broken.obj
! wisp: ...broken.obj...
[2]
