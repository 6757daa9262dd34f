# What the program says of boundary points, contact and intersections.
$ cat >ball.yaml <<'END'
> wisp: 1
> steps: 4
> substeps: 4
> surfaces:
>   - name: ball
>     generate: { shape: icosphere, level: 2, radius: 0.2 }
>     balloon: { gas_ratio: 1.2, buoyancy: false }
>     boundary: { spacing: 0.015 }
> END
$ cat >two.yaml <<'END'
> wisp: 1
> steps: 3
> substeps: 4
> contact: { compute: [stats, intersections] }
> surfaces:
>   - name: left
>     generate: { shape: icosphere, level: 2, radius: 0.2 }
>     balloon: { gas_ratio: 1.1, buoyancy: false }
>     boundary: { spacing: 0.02 }
>     contact: {}
>   - name: right
>     instance_of: left
>     transform: { translate: [0.45, 0, 0] }
>     balloon: { gas_ratio: 1.1, buoyancy: false }
>     boundary: {}
>     contact: {}
> END
$ printf 'wisp: 1\nsteps: 2\nsurfaces:\n  - { name: cloth, generate: { shape: plane, columns: 4, rows: 4 }, cloth: {} }\n' >plain.yaml

# A run tells how many points there are and how much was resampled, of 480 edges and 320 triangles.
$ wisp run ball.yaml >told
$ sed -nE 's/^ball: (.*) boundary points: (.*) on edges, (.*) in triangles; resampled (.*) % of 800 elements.*/\1 \2 \3 \4/p' told |
>     awk '{ print ( $1 > 500 ), ( $1 == $2 + $3 ), ( $4 >= 0 && $4 <= 100 ) }'
1 1 1
$ grep -o 'boundary points, whole run: \|contact' told
boundary points, whole run: 

# A run tells of contact and intersections where the scene requests them, or an option does, and of nothing where nothing does.
$ wisp run two.yaml -v >told; grep -o 'contact: 2 entities, \|, 0 intersections, \|intersections  none in 3 steps\|Intersections' told
intersections  none in 3 steps
contact: 2 entities, 
, 0 intersections, 
$ wisp run plain.yaml | grep 'contact\|oundary\|ntersections'
[1]
$ wisp run plain.yaml --intersections
...intersections  none in 2 steps...

# Counting them moves no vertex: a cloth hangs through a level one, both without contact.
$ cat >through.yaml <<'END'
> wisp: 1
> steps: 3
> surfaces:
>   - name: level
>     generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }
>     pins: [0, 5, 30, 35]
>     cloth: {}
>   - name: upright
>     generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }
>     transform: { rotate: { axis: [1, 0, 0], degrees: 80 }, translate: [0.033, 0, 0] }
>     pins: [0, 5]
>     cloth: {}
> END
$ wisp run through.yaml --record alone.obj | grep ntersections
[1]
$ wisp run through.yaml --record seen.obj --intersections -v >told
$ cmp alone_0004.obj seen_0004.obj
$ sed -nE 's/.*intersections  in 3 of 3 steps; at most ([0-9]+), in step ([0-9]+); ([0-9]+) at the end.*/3 \1 \2 \3/p' told >run
> sed -nE 's/^level  upright +([0-9]+) +([0-9]+) +([0-9]+) +([0-9]+).*/\1 \2 \3 \4/p' told | cmp run -
> awk '{ print ( $2 > 0 && $4 > 0 && $2 >= $4 && $3 >= 1 && $3 <= 3 ) }' run
1
$ wisp run through.yaml --intersections --format json >json; most=$( cut -d' ' -f2 run )
> grep -c "\"max_intersections\": $most\\b" json; grep -o '"steps_with_intersections": 3' json
1
"steps_with_intersections": 3

# Programs get a row a step.
$ wisp run two.yaml --format json --output two.json
$ for word in boundary_points boundary_edge_points boundary_changed_fraction boundary_changed_fraction_of_run contacts 'contact_intersections": 0'; do
>     grep -q "\"$word" two.json || echo "lacks $word"
> done; grep -o '"step [0-9]*"' two.json
"step 1"
"step 2"
"step 3"
$ wisp run plain.yaml --format json | grep '"step 1"'
[1]
$ wisp info two.json
...results, 4 rows...two.yaml/step 2...

# A scene is described with its layers and contacts.
$ wisp info two.yaml | grep 'contact and self\|boundary points'
    contact and self contact: thickness a quarter of the mean edge, friction ...
    boundary points: even, spacing 0.02 m
...
    boundary points: even, spacing half of the mean edge

# Several surfaces are a file each; what has no points or no folder is refused.
$ wisp run two.yaml --boundary both.ply
...6 files...
$ test -e both_left_0002.ply -a -e both_right_0004.ply
$ wisp run plain.yaml --boundary a.ply
! wisp: ...plain.yaml has no surface with the key 'boundary'...
[2]
$ wisp run ball.yaml --boundary no_folder/a.ply
! wisp: ...no_folder/a_0002.ply...
[2]
$ wisp render plain.yaml -o plain.png --size 120x90 --samples 1 >/dev/null
$ wisp render plain.yaml --boundary none -o plain.png --size 120x90 --samples 1 >/dev/null
$ wisp render plain.yaml --boundary class -o a.png
! wisp: plain.yaml: has no boundary points...
[2]
$ wisp render plain.yaml --normals -o a.png
! wisp: plain.yaml: has no boundary points...
[2]
