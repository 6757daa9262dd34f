# wisp render draws: pictures are read back, and every invalid argument and file gives one message. On a terminal it shows its progress.
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
$ echo 'a letter' >other.txt; printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >triangle.obj

# An upright sheet of 5 x 5 vertices, 0.4 m wide and wider by a quarter with each of six frames; it flies with 10 m/s, or stays.
$ cp "$SOURCE/tests/app/transcripts/files.py" .; cat >pictures.py <<'END'
> from files import *
> import subprocess
> def wisp( command ):
>     run = subprocess.run( [os.environ["WISP"], *command.split()], capture_output=True, text=True )
>     assert run.returncode == 0 and run.stderr == "", ( command, run )
>     return run.stdout
> def draw( what, name, options="", size=( 64, 48 ) ):
>     said = wisp( f"render {what} -o {name} --size {size[0]}x{size[1]} --samples 1 {options}" )
>     if os.path.exists( name ):
>         p = Picture( name )
>         assert ( p.width, p.height ) == size or "--sheet" in options, ( name, p.width, p.height )
>     return said
> def sheet( frame, shift ):
>     s = 1 + 0.25 * frame
>     return [c for i in range( 25 ) for c in ( s * 0.1 * ( i % 5 - 2 ) + shift * frame, s * 0.1 * ( i // 5 ), 0 )]
> END
$ python3 <<'END'
> from pictures import *
> triangles = [c for j in range( 4 ) for i in range( 4 ) for a in [5 * j + i] for c in ( a, a + 1, a + 5, a + 1, a + 6, a + 5 )]
> for name, shift in ( "fly", 1 ), ( "stay", 0 ):
>     frames = [sheet( f, shift ) for f in range( 6 )]
>     record( name + ".wisp", frames, triangles, 0.1 )
>     with open( name + ".pc2", "wb" ) as file:
>         file.write( struct.pack( "<12s2i2fi", b"POINTCACHE2\0", 1, 25, 0, 1, 6 ) + b"".join( array.array( "f", f ).tobytes() for f in frames ) )
> with open( "sheet.obj", "w" ) as file:
>     file.writelines( "v {} {} {}\n".format( *frames[0][i:i + 3] ) for i in range( 0, 75, 3 ) )
>     file.writelines( "f {} {} {}\n".format( *( c + 1 for c in triangles[i:i + 3] ) ) for i in range( 0, 96, 3 ) )
> END

# Every kind of input becomes a picture of the size that is asked for.
$ sed '$a output:\n  - { strands: hair, file: hair.hair }' hair.yaml >hair_out.yaml; wisp run hair_out.yaml >/dev/null
$ python3 <<'END'
> from pictures import *
> for what in "hair.yaml", "fly.wisp", "fly.pc2 --mesh sheet.obj", "sheet.obj", "hair.hair":
>     said = draw( what, "kind.png", size=( 96, 64 ) )
>     assert len( Picture( "kind.png" ).body() ) > 96 and "kind.png: 96 x 64 pixels" in said
>     os.remove( "kind.png" )
> # the frame nearest to a time: a little before and a little after frame 2 at 0.2 s
> for name, options in ( "frame", "--frame 2" ), ( "before", "--time 0.17" ), ( "after", "--time 0.24" ), ( "last", "" ), ( "five", "--frame 5" ):
>     draw( "fly.wisp", name + ".png", options )
> assert same( "frame.png", "before.png" ) and same( "frame.png", "after.png" ) and same( "last.png", "five.png" )
> assert not same( "last.png", "frame.png" )
> # a recording has neither widths nor colours, which the scene has: only occupied pixels can be equal
> wisp( "run hair.yaml --record drawn.wisp" )
> draw( "drawn.wisp", "recorded.png", "--frames 0:3 --background white" )
> draw( "hair.yaml", "drawn.png", "--frames 0:3 --background white" )
> for i in range( 1, 5 ):
>     assert Picture( f"recorded_000{i}.png" ).body() == Picture( f"drawn_000{i}.png" ).body()
> END

# A recording has neither materials nor planes: both are derived.
$ wisp run cloth.yaml --record cloth.wisp >/dev/null; wisp info cloth.wisp | grep -o '^ *cloth \|^ *ball \|floor' | tr -d ' '
cloth
ball
$ python3 <<'END'
> from pictures import *
> draw( "cloth.yaml", "from_scene.png", size=( 80, 60 ) )
> draw( "cloth.wisp", "from_file.png", "--ground 0", ( 80, 60 ) )
> assert same( "from_scene.png", "from_file.png" )
> for name, options in ( "body", "" ), ( "pace", "--colour speed" ), ( "pull", "--colour strain" ):
>     draw( "cloth.yaml", name + ".png", "--frames 0:6:3 " + options, ( 80, 60 ) )
> assert differing( "body_0003.png", "pace_0003.png" ) and differing( "body_0003.png", "pull_0003.png" ) and differing( "pace_0003.png", "pull_0003.png" )
> END
$ wisp run cloth.yaml --verify cloth.wisp --workers 3
...: 7 frames, every bit equal...

# A ceiling does not hide what is below it. Nor does a small sheet far away make the other one a speck.
$ show() { printf 'wisp: 1\nsteps: 1\nsurfaces:\n  - { name: sheet, generate: { shape: plane, columns: 9, rows: 9 }, cloth: {} }\n%s\n' "$2" >sheets.yaml
>     wisp render sheets.yaml -o sheets$1.png --steps 2 --size 64x48 --samples 1 --from 32,50 --ground none >/dev/null; }
> show 0; show 1 'colliders: [{ name: ceiling, shape: plane, position: [0, 1, 0], rotation: { axis: [1, 0, 0], degrees: 180 } }]'
> show 3 'colliders: [{ name: ball, shape: sphere, radius: 0.12 }]'
> show 2 '  - { name: scrap, generate: { shape: plane, columns: 2, rows: 2 }, transform: { translate: [9, -99, 0] }, cloth: {} }'
$ python3 -c 'from pictures import *
> assert same( "sheets0.png", "sheets1.png" ) and all( len( Picture( f"sheets{i}.png" ).body() ) > 64 * 48 / 8 for i in range( 3 ) )'

# A ball around the sheet is glass, so that the blue of the sheet is seen.
$ python3 -c 'from pictures import *
> blue = [sum( c[2] > c[0] + 25 for row in Picture( f"sheets{i}.png" ).rows for c in row ) for i in ( 0, 3 )]
> assert blue[0] > 64 * 48 / 8 and blue[1] > blue[0] / 2, blue'
$ wisp render sheets.yaml -o longer.png --steps 9 --size 64x48 --samples 1 --from 32,50 --ground none
...frame 9 of sheets.yaml...

# A scene shows the map of a surface: by its values, by the range that is asked for, and as far as single vertices.
$ printf 'wisp: 1\nsurfaces: [{ name: sheet, generate: { shape: plane, columns: 3, rows: 3 }, area_density: { map: weights.txt }, pins: [0, 2], cloth: {} }]\n' >map.yaml
$ sed 's/columns: 3, rows: 3/columns: 6, rows: 6/; s/ pins: .0, 2.,//' map.yaml >spot.yaml
$ python3 <<'END'
> from pictures import *
> def show( name, weights, options, scene="map.yaml" ):
>     open( "weights.txt", "w" ).write( weights )
>     draw( scene, name + ".png", "--frame 0 " + options, ( 80, 60 ) )
> for name, options in ( "plain", "" ), ( "map", "--colour map" ), ( "wide", "--colour map --range 0,30" ):
>     show( name, "1 2 3 1 2 3 1 2 3", options )
> show( "mirrored", "3 2 1 3 2 1 3 2 1", "--colour map" )
> show( "spot", "9" + 35 * " 0.1", "--colour map", "spot.yaml" )
> show( "whole", "9" + 35 * " 0.1", "--colour map --range 0,9", "spot.yaml" )
> assert differing( "plain.png", "map.png" ) and differing( "wide.png", "map.png" ) and differing( "mirrored.png", "map.png" )
> assert same( "spot.png", "whole.png" )
> END

# A sequence is numbered from one; parts of a range of frames may be left out; a sheet has its pictures in columns, with gaps and labels that are narrower
# than a picture, and without frames shows all of a short recording.
$ wisp render fly.wisp -o run.png --size 40x30 --samples 1 --frames 0:4:2
...run_0001.png: the first of 3 pictures of 40 x 30 pixels, frames 0 to 4...
$ for frames in 4: ::3; do wisp render fly.wisp -o part${frames%:*}.png --size 40x30 --samples 1 --frames $frames >/dev/null; done; ls run*.png part*.png
part4_0001.png
part4_0002.png
part:_0001.png
part:_0002.png
run_0001.png
run_0002.png
run_0003.png
$ wisp render fly.wisp -o columns.png --size 60x40 --samples 1 --frames 0:4 --sheet=3; ls columns*.png
...columns.png: 5 pictures of 60 x 40 pixels, frames 0 to 4...
columns.png
$ wisp render fly.wisp -o few.png --size 40x30 --samples 1 --sheet
...6 pictures of 40 x 30 pixels, frames 0 to 5...

# A body that moves is seen by a camera that stands still. One that travels several times its size would be a speck: the camera goes along. The last
# picture is the largest and is filled, the first is 1 / 2.25 as large. A turntable shows other sides and keeps the body in view.
$ python3 <<'END'
> from pictures import *
> sheet = Picture( "columns.png" )
> assert 3 * 60 < sheet.width < 4 * 60 and 2 * 40 < sheet.height < 3 * 40
> def measure( name, number ): # how many pixels are unlike the background, and their middle
>     p = Picture( f"{name}_{number:04}.png" )
>     assert p.is_edge_empty()
>     return len( p.body() ), sum( x for x, y in p.body() ) / len( p.body() )
> draw( "fly.wisp", "still.png", "--frames 0:2 --background white --ground none", ( 160, 90 ) )
> ( first, from_x ), ( last, to_x ) = measure( "still", 1 ), measure( "still", 3 )
> assert first > 50 and last > 50 and to_x > from_x + 60
> draw( "fly.wisp", "along.png", "--frames : --background white --ground none", ( 160, 90 ) )
> for f in range( 1, 7 ):
>     count, middle = measure( "along", f )
>     assert count > 160 * 90 / ( 5 if f == 6 else 40 ) and abs( middle - 79.5 ) < 4
> draw( "sheet.obj", "turn.png", "--turntable 4 --background white --ground none", ( 80, 60 ) )
> assert all( measure( "turn", i )[0] > 10 for i in range( 1, 5 ) ) and not same( "turn_0001.png", "turn_0002.png" )
> assert not os.path.exists( "turn_0005.png" )
> END

# Strain is measured from the first frame, speed between neighbouring frames: dark violet where there is none, yellow at the end of the range. Frame 4 has a
# strain of 1; the sheet flies with 10 m/s and is stretched with at most 2.5 m/s. Below is the legend.
$ python3 <<'END'
> from pictures import *
> def green_over_blue( what, options ):
>     draw( what, "tint.png", options + " --background white --ground none", ( 120, 90 ) )
>     p = Picture( "tint.png" )
>     tints = [p.rows[y][x][1] - p.rows[y][x][2] for x, y in p.body() if y < 45]
>     return sum( tints ) / len( tints )
> assert green_over_blue( "stay.wisp", "--frame 0 --colour strain --range 0,1" ) < -10
> assert green_over_blue( "stay.wisp", "--frame 4 --colour strain --range 0,1" ) > 40
> assert green_over_blue( "fly.wisp", "--frame 2 --color speed --range 10,1000" ) < -10
> assert green_over_blue( "fly.wisp", "--frame 2 --colour speed --range 0,9" ) > 40
> # the user places camera, ground and background
> draw( "sheet.obj", "far.png", "--camera 0,0,15,0,0,0 --background #204060 --ground none", ( 40, 30 ) )
> corner = Picture( "far.png" ).rows[0][0]
> assert corner[2] > corner[1] > corner[0]
> draw( "sheet.obj", "near.png", "--camera 0,0.2,3,0,0.2,0 --fov 20 --background #ffffff,#000000 --ground -1", ( 40, 30 ) )
> assert ( 20, 15 ) in Picture( "near.png" ).body()
> END

# Boundary points are drawn unless nobody asks for them, also those of the start. With the same camera and seed there is no noise. Balls of 0.3 spacings cover
# about a quarter of the ball, which has some 3000 of the pixels. Back from the second frame to the first one: the scene starts again.
$ printf 'wisp: 1\nsteps: 4\nsubsteps: 4\nsurfaces:\n  - name: ball\n    generate: { shape: icosphere, level: 2, radius: 0.2 }\n' >ball.yaml
> printf '    balloon: { gas_ratio: 1.2, buoyancy: false }\n    boundary: { spacing: 0.015 }\n' >>ball.yaml
$ python3 <<'END'
> from pictures import *
> for name, options in { "drawn": "", "normal": "--boundary normal", "none": "--boundary none", "class": "--boundary class", "lines": "--normals",
>                        "bare": "--normals --boundary none", "start": "--frame 0", "empty": "--frame 0 --boundary none" }.items():
>     draw( "ball.yaml", name + ".png", options, ( 120, 90 ) )
> assert same( "drawn.png", "normal.png" ) and differing( "drawn.png", "none.png" ) > 300 and differing( "drawn.png", "class.png" ) > 300
> assert differing( "drawn.png", "lines.png" ) > 30 and differing( "none.png", "bare.png" ) > 30 and differing( "lines.png", "bare.png" ) > 300
> assert differing( "start.png", "empty.png" ) > 100
> draw( "ball.yaml", "film.png", "--frames 0:2", ( 120, 90 ) )
> assert os.path.exists( "film_0003.png" )
> END

# Input that cannot be drawn is refused in one message.
$ while read line; do wisp render $line -o b.png; test $? = 2 || echo "taken: $line"; done <<'END'
> other.txt
> fly.wisp --frame 6
> fly.wisp --frames 0:9
> fly.wisp --frames 7:
> hair.yaml --frame 4
> fly.wisp --time 9
> fly.pc2
> fly.pc2 --mesh absent.obj
> fly.pc2 --mesh triangle.obj
> fly.pc2 --mesh sheet.obj --time 1
> fly.wisp --mesh sheet.obj
> fly.wisp --steps 9
> sheet.obj --colour strain
> hair.yaml --colour strain
> cloth.yaml --colour map
> fly.wisp --colour map
> sheet.obj --colour map
> sheet.obj --camera 0,0,1,0,0,1
> sheet.obj --size 40x30 --samples 1 --camera 0,0,5,0,0,10
> fly.wisp --size 16000x16000 --sheet
> END
! wisp: ...unknown kind of file, expected a scene...
! wisp: ...got frame 6, expected 0 to 5
! wisp: ...got frame 9, expected 0 to 5
! wisp: ...got frame 7...
! wisp: ...got frame 4, expected 0 to 3
! wisp: ...no frame at 9 s...
! wisp: ...--mesh...
! wisp: ...absent.obj...
! wisp: ...got 3 vertices, but fly.pc2 has 25 points
! wisp: ...no times...
! wisp: ...--mesh...
! wisp: ...--steps expects a scene...
! wisp: ...no strain and no speed...
! wisp: ...only surfaces...
! wisp: ...no surface has a map...
! wisp: ...only surfaces of scenes have maps...
! wisp: ...only surfaces of scenes have maps...
! wisp: ...sheet.obj...
! wisp: ...the picture is empty...
! wisp: ...too large for one sheet...
$ test ! -e b.png

# So is output that cannot be written, and tracks of what is not there.
$ mkdir folder.png; while read line; do wisp $line; test $? = 2 || echo "taken: $line"; done <<'END'
> render sheet.obj -o no/such/c.png --size 20x20
> render sheet.obj -o folder.png --size 20x20 --samples 1
> run hair.yaml --record no/such/c.wisp
> run hair.yaml --record c.mpg
> run hair.yaml --track hair:0 --track-file no/such/c.csv
> run hair.yaml --track hiar:0 --track-file c.csv
> run hair.yaml --track hair:800 --track-file c.csv
> END
! wisp: ...no/such/c.png...
! wisp: ...folder.png...
! wisp: ...no/such/c.wisp...
! wisp: ...c.mpg...
! wisp: ...no/such/c.csv...
! wisp: ...did you mean 'hair'?...
! wisp: ...got vertex 800, expected 0 to 799...
$ test ! -e c.csv

# Progress is drawn on a terminal and wiped out again; the first phase always, later ones if a tenth of a second has passed. NO_COLOR takes the colour away
# and leaves the bar, unless it is empty. A dumb terminal and a file see no bar. A picture is not written to a terminal, which may take it for commands.
# Some containers have no terminals.
$ cat >terminal.py <<'END'
> import os, subprocess
> def watch( command, stream="stderr", **variables ):
>     near, far = os.openpty()
>     environment = { name: value for name, value in { **os.environ, **variables }.items() if name != "NO_COLOR" or name in variables }
>     run = subprocess.Popen( [os.environ["WISP"], *command.split()], env=environment, **{ "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, stream: far } )
>     os.close( far )
>     shown = b""
>     try:
>         while part := os.read( near, 65536 ):
>             shown += part
>     except OSError: # the other end is gone
>         pass
>     out, err = run.communicate()
>     return run.returncode, shown.decode() if stream == "stderr" else err.decode()
> try:
>     os.openpty()
> except OSError:
>     raise SystemExit( "skipped" )
> green = "\033[32m"
> status, bar = watch( "run hair.yaml", TERM="xterm" )
> assert status == 0 and green in bar and bar.endswith( "\r" )
> status, bar = watch( "render fly.wisp -o bar.png --size 40x30 --samples 1 --frames 0:2", TERM="xterm" )
> assert status == 0 and " % frames" in bar and bar.endswith( "\r" )
> status, bar = watch( "run hair.yaml", TERM="xterm", NO_COLOR="1" )
> assert status == 0 and "\033" not in bar and "\r[" in bar
> assert green in watch( "run hair.yaml", TERM="xterm", NO_COLOR="" )[1]
> assert watch( "run hair.yaml", TERM="dumb" ) == ( 0, "" )
> for command in "render fly.wisp -o bar.png --size 40x30 --samples 1", "run hair.yaml":
>     run = subprocess.run( [os.environ["WISP"], *command.split()], capture_output=True, text=True, env={ **os.environ, "TERM": "xterm" } )
>     assert run.returncode == 0 and run.stderr == "" and "\033" not in run.stdout
> status, err = watch( "render sheet.obj -o -", "stdout" )
> assert status == 64 and "standard output is a terminal" in err
> END
> python3 terminal.py 2>told; grep -v skipped told >&2
[1]
