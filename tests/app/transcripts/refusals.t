# Commands that are refused where there is no file at all: what they say on the error stream, and their exit status.

# Commands that are not there
$ wisp rnu good.yaml
! wisp: got command 'rnu'; did you mean 'run'?
[64]
$ wisp bnech
! wisp: got command 'bnech'; did you mean 'bench'?
[64]
$ wisp redner
! wisp: got command 'redner'; did you mean 'render'?
[64]
$ wisp simulate
! wisp: got command 'simulate', expected run, render, view, info, plan, tune, bench, accuracy, validate, sweep, merge, torture, gate, compare, help or completion
[64]
$ wisp help rnu
! wisp: got command 'rnu'; did you mean 'run'?
[64]
$ wisp completion csh
! wisp completion: shell: got 'csh', expected one of bash
[64]

# What is missing, and what is too much
$ wisp
! wisp: expected a command: run, render, view, info, plan, tune, bench, accuracy, validate, sweep, merge, torture, gate, compare, help or completion
[64]
$ wisp run
! wisp run: expected a scene
[64]
$ wisp plan
! wisp plan: expected a scene
[64]
$ wisp info
! wisp info: expected a file
[64]
$ wisp tune
! wisp tune: expected a scene
[64]
$ wisp gate
! wisp gate: expected an action and a suite, such as check suite.yaml
[64]
$ wisp gate check
! wisp gate: expected an action and a suite, such as check suite.yaml
[64]
$ wisp merge
! wisp merge: expected a folder
[64]
$ wisp render
! wisp render: expected a scene, recording, mesh or groom
[64]
$ wisp run good.yaml good.yaml
! wisp run: got a second scene 'good.yaml', expected one
[64]
$ wisp info good.yaml good.yaml
! wisp info: got a second file 'good.yaml', expected one
[64]
$ wisp tune cloth.yaml --error 1 still.yaml
! wisp tune: got a second scene 'still.yaml', expected one
[64]
$ wisp render fly.wisp stay.wisp -o a.png
! wisp render: got a second file 'stay.wisp', expected one
[64]
$ wisp gate check a.yaml b.yaml
! wisp gate: got a second suite 'b.yaml', expected one
[64]
$ wisp gate chek suite.yaml
! wisp gate: action: got 'chek'; did you mean 'check'?
[64]
$ wisp render fly.wisp
! wisp render: expected -o FILE.png
[64]
$ wisp view square.yaml
! wisp view: expected an output file: -o FILE.html
[64]
$ wisp sweep suite.yaml
! wisp sweep: expected a folder for the part, such as -o results
[64]
$ wisp sweep -o wrong
! wisp sweep: expected a suite
[64]
$ wisp gate accept suite.yaml
! wisp gate: accept: expected --reason with up to 199 bytes
[64]

# Options that are not there, lack their value or have one too much
$ wisp render flag.yaml --fra 1 -o a.png
! wisp render: got option '--fra', which can be --frame, --frames
[64]
$ wisp run --steps 2 --odd.yaml
! wisp run: got option '--odd.yaml', which does not exist; 'wisp run --help' lists all
[64]
$ wisp run flag.yaml --stpes 2
! wisp run: got option '--stpes'; did you mean '--steps'?
[64]
$ wisp run flag.yaml --steps
! wisp run: --steps: got no value, expected N
[64]
$ wisp run flag.yaml -s
! wisp run: --steps: got no value, expected N
[64]
$ wisp bench --quick=yes
! wisp bench: --quick: got a value, expected none
[64]
$ wisp run flag.yaml -qx
! wisp run: got option '-q', which does not exist; 'wisp run --help' lists all
[64]
$ wisp --verbose
! wisp: got option '--verbose', which does not exist; 'wisp --help' lists all
[64]

# Numbers out of their range
$ wisp run good.yaml --steps 0
! wisp run: --steps: got '0', expected a whole number from 1 to 100000000
[64]
$ wisp run good.yaml --steps -1
! wisp run: --steps: got '-1', expected a whole number from 1 to 100000000
[64]
$ wisp run good.yaml --steps 1.5
! wisp run: --steps: got '1.5', expected a whole number from 1 to 100000000
[64]
$ wisp run good.yaml --steps 99999999999999999999
! wisp run: --steps: got '99999999999999999999', expected a whole number from 1 to 100000000
[64]
$ wisp run good.yaml --workers 65
! wisp run: --workers: got '65', expected a whole number from 1 to 64
[64]
$ wisp bench --workers two
! wisp bench: --workers: got 'two', expected a whole number from 1 to 64
[64]
$ wisp bench --seconds 0
! wisp bench: --seconds: got '0', expected a number above 0 and at most 1e+06
[64]
$ wisp bench --seconds nan
! wisp bench: --seconds: got 'nan', expected a number above 0 and at most 1e+06
[64]
$ wisp plan hair.yaml --steps -1
! wisp plan: --steps: got '-1', expected a whole number from 0 to 1000000
[64]
$ wisp plan hair.yaml --steps many
! wisp plan: --steps: got 'many', expected a whole number from 0 to 1000000
[64]
$ wisp view square.yaml -o none.html --steps -1
! wisp view: --steps: got '-1', expected a whole number from 0 to 1000000
[64]
$ wisp gate check suite.yaml --paired ./skips --patience -1
! wisp gate: --patience: got '-1', expected a number above 0 and at most 1e+06
[64]
$ wisp torture --limit 0 a.yaml
! wisp torture: --limit: got '0', expected a number above 0 and at most 1e+06
[64]
$ wisp tune cloth.yaml --error 0.5mm
! wisp tune: --error: got '0.5mm', expected a number above 0 and at most 1e+06
[64]
$ wisp tune cloth.yaml --error -1
! wisp tune: --error: got '-1', expected a number above 0 and at most 1e+06
[64]
$ wisp tune cloth.yaml --budget nan
! wisp tune: --budget: got 'nan', expected a number above 0 and at most 1e+06
[64]
$ wisp tune cloth.yaml --error 1 --workers 0
! wisp tune: --workers: got '0', expected a whole number from 1 to 64
[64]
$ wisp render fly.wisp -o a.png --size 640
! wisp render: --size: got '640', expected a size such as 640x480, each side from 1 to 16384
[64]
$ wisp render fly.wisp -o a.png --size 0x9
! wisp render: --size: got '0x9', expected a size such as 640x480, each side from 1 to 16384
[64]
$ wisp render fly.wisp -o a.png --size 20000x9
! wisp render: --size: got '20000x9', expected a size such as 640x480, each side from 1 to 16384
[64]
$ wisp render fly.wisp -o a.png --samples 0
! wisp render: --samples: got '0', expected a whole number from 1 to 4096
[64]
$ wisp render fly.wisp -o a.png --frame -1
! wisp render: --frame: got '-1', expected a whole number from 0 to 100000000
[64]
$ wisp render fly.wisp -o a.png --time soon
! wisp render: --time: got 'soon', expected 1 number
[64]
$ wisp render fly.wisp -o a.png --frames 3
! wisp render: --frames: got '3', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers
[64]
$ wisp render fly.wisp -o a.png --frames 3:1
! wisp render: --frames: got '3:1', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers
[64]
$ wisp render fly.wisp -o a.png --frames 0:3:0
! wisp render: --frames: got '0:3:0', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers
[64]
$ wisp render fly.wisp -o a.png --frames 0:3:1:1
! wisp render: --frames: got '0:3:1:1', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers
[64]
$ wisp render fly.wisp -o a.png --frames 0:99999999999999999999
! wisp render: --frames: got '0:99999999999999999999', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers
[64]
$ wisp render fly.wisp -o a.png --sheet=0
! wisp render: --sheet: got '0', expected a whole number from 1 to 1000
[64]
$ wisp render fly.wisp -o a.png --colour speed --range 1,1
! wisp render: --range: got '1,1', expected two rising numbers
[64]
$ wisp render fly.wisp -o a.png --camera 0,0,0
! wisp render: --camera: got '0,0,0', expected 6 numbers separated by commas
[64]
$ wisp render fly.wisp -o a.png --from 0,90
! wisp render: --from: got an elevation of 90, expected -89 to 89 degrees
[64]
$ wisp render fly.wisp -o a.png --from nan,0
! wisp render: --from: got 'nan,0', expected 2 numbers separated by commas
[64]
$ wisp render fly.wisp -o a.png --fov 0
! wisp render: --fov: got '0', expected 1 to 150 degrees
[64]
$ wisp render fly.wisp -o a.png --cut 0,0,0,1
! wisp render: --cut: got '0,0,0,1', expected a direction that is not zero, and a distance
[64]
$ wisp render fly.wisp -o a.png --cut 1,0,0
! wisp render: --cut: got '1,0,0', expected 4 numbers separated by commas
[64]
$ wisp run hair.yaml --every 0
! wisp run: --every: got '0', expected a whole number from 1 to 100000000
[64]

# Words that are none of those expected
$ wisp run good.yaml --format jsn
! wisp run: --format: got 'jsn'; did you mean 'json'?
[64]
$ wisp bench papre
! wisp bench: CASE: got 'papre'; did you mean 'paper'?
[64]
$ wisp bench --format xml
! wisp bench: --format: got 'xml', expected one of text, markdown, csv, json, latex
[64]
$ wisp plan hair.yaml --format svg
! wisp plan: --format: got 'svg', expected one of text, dot, json
[64]
$ wisp tune cloth.yaml --error 1 --format tabel
! wisp tune: --format: got 'tabel', expected one of text, markdown, csv, json, latex
[64]
$ wisp render ball.yaml --boundary clas -o a.png
! wisp render: --boundary: got 'clas'; did you mean 'class'?
[64]
$ wisp render fly.wisp -o a.png --colour stain
! wisp render: --colour: got 'stain'; did you mean 'strain'?
[64]
$ wisp render fly.wisp -o a.png --ground floor
! wisp render: --ground: got 'floor', expected one of auto, none
[64]
$ wisp render fly.wisp -o a.png --background whit
! wisp render: --background: got 'whit'; did you mean 'white'?
[64]
$ wisp render fly.wisp -o a.png --background '#12345'
! wisp render: --background: got '#12345', expected a colour such as #20242c, or two separated by a comma
[64]
$ wisp run hair.yaml --track hair --track-file a.csv
! wisp run: --track: got 'hair', expected a body and its vertices, such as flag:0,31
[64]
$ wisp run hair.yaml --track hair:1, --track-file a.csv
! wisp run: --track: got 'hair:1,', expected a body and its vertices, such as flag:0,31
[64]
$ wisp run hair.yaml --track hair:-1 --track-file a.csv
! wisp run: --track: got 'hair:-1', expected a body and its vertices, such as flag:0,31
[64]
$ wisp info --keys clot
! wisp: --keys: got 'clot', expected a block such as surfaces.cloth
[2]

# Files of another kind
$ wisp run ball.yaml --boundary a.obj
! wisp run: --boundary: got 'a.obj', expected a file name that ends in .ply
[64]
$ wisp view square.yaml -o none.png
! wisp view: -o: got 'none.png', expected a file name that ends in .html
[64]
$ wisp render fly.wisp -o a.jpg
! wisp render: -o: got 'a.jpg', expected a file name that ends in .png
[64]
$ wisp gate check suite.yaml --html -
! wisp gate: --html: got '-', expected a file: standard output has the results
[64]
$ wisp gate check -
! wisp gate: suite: got '-', expected a file: other processes read it too
[64]
$ wisp run square.yaml --record -
! wisp run: --record: got '-', expected a file: standard output has the results
[64]

# Options that need or exclude each other
$ wisp bench cloth --long
! wisp bench: --long is an option of the case 'stability' and of suites, which does not run
[64]
$ wisp gate check suite.yaml --patch a
! wisp gate: --patch: expected accept, and a base file below this folder
[64]
$ wisp gate accept /suite.yaml --patch a --reason x
! wisp gate: --patch: expected accept, and a base file below this folder
[64]
$ wisp render square.yaml -o - --frames 0:
! wisp render: -o: got '-', expected a file name for several pictures
[64]
$ wisp bench cloth --report -
! wisp bench: --report and --output both write to '-'
[64]
$ wisp accuracy square.yaml --report - --output -
! wisp accuracy: --report and --output both write to '-'
[64]
$ wisp bench boundary --quick --seconds 0.01 --report a.html --output a.html
! wisp bench: --report and --output both write to 'a.html'
[64]
$ wisp run ghosts.yaml --frames-per-step 4 --every 2 --record ghosts.wisp
! wisp run: --frames-per-step: expected without --every, which leaves steps out
[64]
$ wisp run ghosts.yaml --frames-per-step 4
! wisp run: --frames-per-step: expected together with --record or --track
[64]
$ wisp sweep suite.yaml -o wrong --workers 2
! wisp sweep: --workers: only runs with --exclusive are timed
[64]
$ wisp torture
! wisp torture: expected a scene
[64]
$ wisp tune cloth.yaml
! wisp tune: expected one of --error and --budget
[64]
$ wisp tune cloth.yaml --error 1 --budget 1
! wisp tune: expected one of --error and --budget
[64]
$ wisp render fly.wisp -o a.png --frame 1 --time 2
! wisp render: got several of --frame, --time and --frames, expected one
[64]
$ wisp render fly.wisp -o a.png --frames 0:1 --turntable 3
! wisp render: --turntable: expected one frame, but --frames selects several
[64]
$ wisp render fly.wisp -o a.png --range 0,1
! wisp render: --range: expected together with --colour strain, speed or map
[64]
$ wisp run hair.yaml --track hair:0
! wisp run: --track: expected together with --track-file, or neither of them
[64]
$ wisp run hair.yaml --track-file a.csv
! wisp run: --track: expected together with --track-file, or neither of them
[64]
$ wisp run hair.yaml --record w.wisp --verify w.wisp
! wisp run: --record: got 'w.wisp', which --verify reads; expected another file
[64]

# Files that are not there
$ wisp run absent.yaml
! wisp: absent.yaml: cannot open: No such file or directory
[2]
$ wisp plan absent.yaml
! wisp: absent.yaml: cannot open: No such file or directory
[2]
$ wisp plan absent.yaml --format json
! wisp: absent.yaml: cannot open: No such file or directory
[2]
$ wisp info absent.hair
! wisp: absent.hair: No such file or directory
[2]
$ wisp render absent.wisp -o b.png
! wisp: absent.wisp: No such file or directory
[2]
$ wisp view gone.yaml -o none.html
! wisp: gone.yaml: No such file or directory
[2]
$ wisp tune absent.yaml --error 1
! wisp: absent.yaml: cannot open: No such file or directory
[2]
$ wisp torture none.yaml
! wisp: none.yaml: cannot open: No such file or directory
[2]
$ wisp sweep missing.yaml -o wrong
! wisp: missing.yaml: cannot open: No such file or directory
[2]
$ wisp merge nowhere
! wisp: nowhere: No such file or directory
[2]
$ wisp run .
! wisp: .: got a folder, expected a file
[2]
$ wisp info .
! wisp: .: Is a directory
[2]
$ wisp render . -o b.png
! wisp: .: Is a directory
[2]

# None of them has left a file.
$ ls
