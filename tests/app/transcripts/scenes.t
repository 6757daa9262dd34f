# What scenes build and how it moves, by the points of their recordings; and what only a world can refuse, at the line of its entry.
$ cp "$SOURCE/tests/app/transcripts/files.py" .

# Meshes of colliders look outwards and have their size: an icosphere of level 4 lacks 0.2 % of the volume of its ball, a capsule of 48 segments 0.4 %. They follow their
# keyframes, and stay where the last one has taken them.
$ python3 <<'END'
> from files import *
> from math import pi
> def volume( body ):
>     def of( a, b, c ):
>         return sum( a[i] * ( b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2] ) for i in range( 3 ) ) / 6
>     return sum( of( *[body.frames[0][v] for v in body.numbers[i:i + 3]] ) for i in range( 0, len( body.numbers ), 3 ) )
> bodies, said = run( """colliders:
>   - { name: box, shape: box, half_extent: [1, 2, 3] }
>   - { name: ball, shape: sphere, radius: 0.5 }
>   - { name: pill, shape: capsule, radius: 0.5, half_length: 1 }
>   - { name: dot, shape: capsule, radius: 0.5, half_length: 0 }
>   - { name: wall, shape: plane }
> """ )
> ball = pi / 6
> assert list( bodies ) == ["box", "ball", "pill", "dot"] and [len( body.frames[0] ) for body in bodies.values()][0] == 8
> assert all( abs( volume( body ) / expected - 1 ) < 0.006 for body, expected in zip( bodies.values(), [48, ball, ball + pi / 2, ball] ) )
> bodies, said = run( """dt: 0.1
> steps: 22
> colliders:
>   - { name: a, shape: box, half_extent: [1, 1, 1], position: [1, 0, 0], keyframes: [{ time: 1, position: [3, 0, 0] },
>       { time: 2, position: [3, 0, 0], rotation: { degrees: [0, 180, 0] } }] }
>   - { name: b, shape: box, half_extent: [1, 1, 1], keyframes: [{ time: 0.5, position: [0, 1, 0] }, { time: 1, position: [5, 2, 0], jump: true }] }
> """ )
> a, b = bodies["a"].frames, bodies["b"].frames
> assert all( near( a[f][7], point, 1e-5 ) for f, point in { 0: [2, 1, 1], 5: [3, 1, 1], 20: [2, 1, -1], 22: [2, 1, -1] }.items() )
> assert near( b[9][7], [1, 2, 1], 1e-5 ) and near( b[22][7], [6, 3, 1], 1e-5 )
> END

# Pins are named by number, by place and by box, with the numbers of the file: a repair drops its first vertex, or merges two, which keep both of their numbers. What is
# not pinned falls. An instance has the triangles of its source, here flipped, and pins of its own.
$ printf 'v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 2 4 3\n' >loose.obj; printf 'v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0.001 0 1\nf 1 3 2\nf 4 6 5\n' >split.obj
$ python3 <<'END'
> from files import *
> bodies, said = run( """surfaces:
>   - name: a
>     generate: { shape: plane, columns: 3, rows: 3, spacing: 1 }
>     transform: { translate: [0, 2, 0] }
>     pins: [4, 4]
>     pin_nearest: [[0.9, 2.3, 0.8]]
>     pin_box: [{ min: [-2, 1, -2], max: [-0.5, 3, -0.5] }, { min: [0.5, 1, -2], max: [2, 3, -0.5] }]
>   - { name: loose, file: loose.obj, repair: [unreferenced], pins: [1, 3] }
>   - { name: split, file: split.obj, repair: [weld, flip], weld_distance: 0.01, transform: { scale: 2 }, pins: [3, 5] }
>   - { name: twin, instance_of: split, pins: [1, 2, 4] }
> colliders:
>   - { name: rock, shape: mesh, file: split.obj, double_sided: true, repair: [weld], weld_distance: 0.01, require: [one_component] }
> """ )
> assert [body.still() for body in bodies.values()] == [[0, 2, 4, 8], [0, 2], [1, 2], [1, 2, 3], [0, 1, 2, 3]]
> assert len( bodies["loose"].frames[0] ) == 3 and bodies["split"].frames[0] == bodies["twin"].frames[0] == [( 0, 0, 0 ), ( 2, 0, 0 ), ( 0, 0, 2 ), ( 2, 0, 2 )]
> assert bodies["split"].numbers == bodies["twin"].numbers == ( 0, 1, 2, 1, 3, 2 )
> at = "scene.yaml:3:5: surface 'a': "
> assert refused( "surfaces:\n  - { name: a, file: loose.obj, repair: [unreferenced], pins: [0] }\n" ) == (
>     at + "pins: got vertex 0, which the mesh does not have or which repair removed" )
> assert refused( "surfaces:\n  - { name: a, file: split.obj, repair: [weld], pins: [6] }\n" ) == (
>     at + "pins: got vertex 6, which the mesh does not have or which repair removed" )
> assert refused( "surfaces:\n  - { name: a, file: loose.obj, require: [clean] }\n" ) == at + "loose.obj: unreferenced vertices: 1, the first is vertex 0"
> PLANE = "surfaces:\n  - { name: a, generate: { shape: plane, columns: 3, rows: 3 }, "
> BALL = "surfaces:\n  - { name: a, generate: { shape: icosphere, level: 1 }"
> assert refused( PLANE + "pin_box: { min: [5, 5, 5], max: [6, 6, 6] } }\n" ) == at + "no vertex starts in pin_box 0"
> assert refused( PLANE + "balloon: {} }\n" ) == (
>     at + "balloon: got 8 open edges, the first from vertex 0 to vertex 3, expected a closed mesh; allow_open closes holes" )
> assert refused( BALL + " }\n  - { name: b, instance_of: a, pins: [42] }\n" ) == (
>     "scene.yaml:4:5: surface 'b': pins: got vertex 42, but the mesh has 42 vertices, counted from 0" )
> assert refused( BALL.replace( "1 }", "5 }" ) + ", balloon: { outlet_nearest: [0, 0, 0], outlet_radius: 1 } }\n" ) == (
>     at + "balloon.outlet_radius: got more than 64 vertices within 1 m, which is the limit" )
> assert refused( "surfaces:\n  - { name: a, file: none.obj }\n" ).startswith( at + "none.obj" )
> assert refused( "colliders:\n  - { name: a, shape: mesh, file: none.obj }\n" ).startswith( "scene.yaml:3:5: collider 'a': none.obj" )
> TWICE = " of the group 'a' is also pinned by the surface or by a group before it"
> assert refused( PLANE + "pins: [3], pin_groups: [ { name: a, pins: [4, 3] } ] }\n" ) == at + "vertex 3" + TWICE
> # the number in the file, of a vertex that a repair has moved up
> assert refused( PLANE.replace( "3, rows", "9, rows" ) + "repair: [weld], weld_distance: 0.021, pins: [8], pin_groups: [ { name: a, pins: [8] } ] }\n" ) == at + "vertex 8" + TWICE
> assert refused( PLANE + "pin_groups: [ { name: a, pin_box: { min: [5, 5, 5], max: [6, 6, 6] } } ] }\n" ) == at + "group 'a': no vertex starts in pin_box 0"
> END

# A random start belongs to its seed. A start has the vertices of a file, as many as the mesh has with or without its repair, and the rest shape stays that of the mesh;
# scale comes after it, about the middle of its bounds. All numbers are sums of powers of two.
$ printf 'v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 2 4 3\nf 6 4 5\n' >rest.obj
> printf 'v 5 5 5\nv 0 0.5 0\nv 0.5 0 0\nv 0 0 0.25\nv 1 2 3\nv 7 7 7\nf 1 2 3\n' >start.obj; sed '1d; /v 7/d' start.obj >short.obj
$ python3 <<'END'
> from files import *
> def random( seed ):
>     return run( f"""surfaces:
>   - name: sheet
>     generate: {{ shape: plane, columns: 3, rows: 5, spacing: 1 }}
>     transform: {{ rotate: {{ degrees: [90, 0, 0] }}, translate: [0, 1, 0] }}
>     start: {{ shape: random, seed: {seed} }}
>     cloth: {{}}
> """ )[0]["sheet"].frames[0]
> assert random( 7 ) == random( 7 ) != random( 8 ) and all( near( p, [0, 1, 0], 2 ) for p in random( 7 ) )
> PLACES = [( 0, 0.5, 0 ), ( 0.5, 0, 0 ), ( 0, 0, 0.25 ), ( 1, 2, 3 )]
> for one, other in ( "start", "short" ), ( "short", "start" ):
>     bodies, said = run( f"""steps: 2
> surfaces:
>   - {{ name: a, file: rest.obj, repair: [weld, unreferenced], start: {{ file: {one}.obj }}, cloth: {{}}, transform: {{ scale: 2, translate: [4, 0, 0] }}, pins: [4] }}
>   - {{ name: b, instance_of: a, start: {{ file: {other}.obj }}, cloth: {{}} }}
>   - {{ name: c, instance_of: a, cloth: {{}} }}
> """ )
>     a, b, c = [bodies[name].frames for name in "abc"]
>     assert a[0] == [( 2 * x + 4, 2 * y, 2 * z ) for x, y, z in PLACES] and b[0] == [( 2 * x, 2 * y, 2 * z ) for x, y, z in PLACES]
>     assert c[0] == [( 0, 0, 0 ), ( 2, 0, 0 ), ( 0, 0, 2 ), ( 2, 0, 2 )] and a[2][3] == ( 6, 4, 6 ) != a[2][2] # the pin holds where the file has it
> scaled = run( "surfaces:\n  - { name: a, file: rest.obj, repair: [weld, unreferenced], start: { file: short.obj, scale: [2, 1, 0] } }\n" )[0]["a"].frames[0]
> assert scaled == [( -0.5, 0.5, 1.5 ), ( 0.5, 0, 1.5 ), ( -0.5, 0, 1.5 ), ( 1.5, 2, 1.5 )] # of x 0 .. 1 and z 0 .. 3
> for keys, message in [
>         ( "file: rest.obj, start: { file: short.obj }", "start.file: short.obj: got 4 vertices, expected 6 as the mesh has" ),
>         ( "file: rest.obj, repair: [weld], start: { file: short.obj }", "start.file: short.obj: got 4 vertices, expected 5 as the mesh has, or 6 as before its repair" ),
>         ( "generate: { shape: plane, columns: 2, rows: 3 }, start: { file: short.obj }", "start.file: short.obj: got 4 vertices, expected 6 as the mesh has" ),
>         ( "file: rest.obj, start: { file: none.obj }", "none.obj: cannot open: No such file or directory" ),
>         ( "file: rest.obj, start: { file: none.txt }", "none.txt: not a mesh, expected a file that ends in .obj, .ply, .glb or .gltf" )]:
>     assert refused( f"surfaces:\n  - {{ name: a, {keys} }}\n" ) == "scene.yaml:3:5: surface 'a': " + message, keys
> END

# Maps of numbers, of colours and of images are refused with their file and line or vertex.
$ printf 'v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n' >plain.obj; printf 'v 0 0 0 2 0 0\nv 1 0 0 1 0 0\nv 0 0 1 -1 0 0\nf 1 3 2\n' >dark.obj; cp "$SOURCE/data/scenes/embroidery.png" map.png
$ python3 <<'END'
> from files import *
> GRID, DENSITY = "generate: { shape: plane, columns: 3, rows: 2 }", "area_density: { map: map.txt }"
> for numbers, mesh, keys, words in [
>         ( b"1 2 3\n4 5\n", GRID, DENSITY, "map.txt: got 5 numbers, but the mesh has 6 vertices" ),
>         ( b"1 2 3\n4 x5 6\n", GRID, DENSITY, "map.txt:2: got 'x5', expected a finite number" ),
>         ( b"1 2 3\n4 5 nan\n", GRID, DENSITY, "map.txt:2: got 'nan'" ),
>         ( b"1 2\n\xff\xd8\xff", GRID, DENSITY, "map.txt:2: got a byte that is no text" ),
>         ( b"1 2 3\n4 -5 6\n", GRID, DENSITY, "map.txt: vertex 4: got -5, expected" ),
>         ( b"", GRID, "area_density: { map: missing.txt }", "missing.txt" ),
>         ( b"", GRID, "area_density: { map: missing.png }", "missing.png: cannot open: No such file" ),
>         ( b"1 1 1 1 1 1", GRID, "cloth: { solver: pbd, warp_compliance: { map: map.txt } }", "map.stretch_compliance: entity" ),
>         ( b"0 0.5 1 1 0.5 0", GRID, "contact: { thickness: { map: map.txt } }", "map.contact_thickness: vertex 0: got the factor 0, expected 0.01 to 1" ),
>         ( b"", GRID, "damping: { map: colours }", "map: the mesh has no colours" ),
>         ( b"", "file: plain.obj", "damping: { map: colours }", "map: the mesh has no colours" ),
>         ( b"", "file: plain.obj", "damping: { map: map.png }", "map.png: the mesh has no coordinates of an image" ),
>         ( b"", "file: dark.obj", "damping: { map: colours, channel: r }", "map: colours: vertex 2: got -1, expected 0 to 1e+09" )]:
>     open( "map.txt", "wb" ).write( numbers )
>     message = refused( f"surfaces:\n  - {{ name: sheet, {mesh}, {keys} }}\n" )
>     assert words in message and message.startswith( "scene.yaml:3:" ), message
> END

# A frame of a recording is a start, and a recording moves a body: at half the speed from the third step on, or one pin of cloth.
$ cat >sheet.yaml <<'END'
> wisp: 1
> steps: 4
> surfaces:
>   - { name: sheet, generate: { shape: plane, columns: 5, rows: 4 }, pins: [0, 4], cloth: {} }
> END
$ wisp run sheet.yaml --record sheet.glb >/dev/null; wisp run sheet.yaml --record sheet.wisp >/dev/null; python3 <<'END'
> from files import *
> SHEET = "surfaces:\n  - { name: a, generate: { shape: plane, columns: 5, rows: %d }, "
> points = Body( wisp_recording.read( "sheet.wisp" )[0][0] ).frames
> began = run( SHEET % 4 + "start: { file: 'sheet.glb#@frame_0005' } }\n" )[0]["a"].frames[0]
> assert all( near( p, q, 1e-7 ) for p, q in zip( began, points[4], strict=True ) ) and points[4][10][1] < -0.01 # m, of a sheet 0.08 m wide
> bodies, said = run( """steps: 20
> surfaces:
>   - { name: a, generate: { shape: plane, columns: 5, rows: 4 }, collider: { double_sided: true }, transform: { scale: 2, translate: [1, 0, 0] },
>       animation: { file: 'sheet.glb#sheet', clips: [{ clip: recording, time: 0.05, speed: 0.5 }] } }
>   - { name: b, generate: { shape: plane, columns: 5, rows: 4 }, cloth: {}, pins: [19], animation: { file: sheet.glb, clips: [{ clip: recording }] } }
> colliders:
>   - { name: c, shape: mesh, file: 'sheet.glb#sheet@0.05', double_sided: true, position: [9, 0, 0] }
> """ )
> for f in range( 1, 21 ):
>     at = min( max( ( f - 3 ) / 2, 0 ), 4 )
>     now, part = int( at ), at - int( at )
>     for p, q, found in zip( points[now], points[min( now + 1, 4 )], bodies["a"].frames[f], strict=True ):
>         assert near( found, [2 * ( a + part * ( b - a ) ) + ( k == 0 ) for k, ( a, b ) in enumerate( zip( p, q ) )], 1e-6 )
>     assert near( bodies["b"].frames[f][19], points[min( f, 4 )][19], 1e-6 )
> assert all( near( [x - 9, y, z], p, 1e-6 ) for ( x, y, z ), p in zip( bodies["c"].frames[0], points[3], strict=True ) )
> at = "scene.yaml:3:5: surface 'a': "
> assert refused( SHEET % 4 + "start: { file: 'sheet.glb#@frame_0006' } }\n" ) == (
>     at + "sheet.glb: got 'frame_0006' behind @, expected a time in s or one of the 4 morph targets 'frame_0002' .. 'frame_0005'" )
> assert refused( SHEET % 5 + "animation: { file: sheet.glb, clips: [{ clip: recording }] } }\n" ) == (
>     at + "animation: sheet.glb: got 20 vertices, expected 25 as the mesh has" )
> assert refused( SHEET % 4 + "animation: { file: sheet.glb, clips: [{ clip: recording }, { clip: recording, time: 1 }] } }\n" ) == (
>     at + "animation: got 2 clips, expected one of a mesh with morph targets" )
> END

# Every frame of a recording is read back by its name and by its time, between frames along straight lines and behind the last one as that is: displacements are rounded, and
# their sum. Vertices that start at one place, as the first two of the sheet do, stay two. Other bodies go by the same weights.
$ python3 <<'END'
> from files import *
> with open( "folded.obj", "w" ) as file:
>     for v in range( 36 ):
>         file.write( "v %g %g %g\n" % ( max( v, 1 ) % 6 * 0.1, max( v, 1 ) // 6 * 0.1, 0.05 * max( v, 1 ) ) )
>     file.write( "f 1 2 3\n" )
> take, said = run( """dt: 0.25
> steps: 6
> substeps: 40
> strands:
>   - { name: hair, generate: { strands: 2, vertices: 3 } }
> surfaces:
>   - { name: sheet, generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }, start: { file: folded.obj }, pins: [0], cloth: {}, damping: 2 }
>   - { name: twin, instance_of: sheet, pins: [5], cloth: {}, velocity: [0, 1, 0], damping: 1 }
> colliders:
>   - { name: ground, shape: box, half_extent: [1, 1, 1], position: [0, -9, 0] }
> """ )
> subprocess.run( [os.environ["WISP"], "run", "scene.yaml", "--record", "take.glb"], check=True, capture_output=True )
> def read( *names ):
>     bodies, said = run( "colliders:\n" + "".join( f"  - {{ name: b{i}, shape: mesh, file: 'take.glb#{name}', double_sided: true }}\n" for i, name in enumerate( names ) ) )
>     return [body.frames[0] for body in bodies.values()]
> def same( found, expected, tolerance=2.5e-7 ):
>     return all( near( p, q, tolerance * ( 1 + max( map( abs, q ) ) ) ) for p, q in zip( found, expected, strict=True ) )
> sheet, twin = take["sheet"].frames, take["twin"].frames
> assert sheet[0][0] == sheet[0][1] != sheet[6][1] and sheet[0] != sheet[1] != sheet[2]
> by_time = read( *[f"sheet@{0.25 * f}" for f in range( 7 )] )
> assert by_time == read( "sheet", *[f"sheet@frame_{f + 1:04}" for f in range( 1, 7 )] ) and all( same( a, b ) for a, b in zip( by_time, sheet, strict=True ) )
> between, late, other, still = read( "sheet@0.8125", "sheet@1e3", "twin@0.5", "ground@1" )
> assert same( between, [[a + ( b - a ) / 4 for a, b in zip( p, q )] for p, q in zip( sheet[3], sheet[4] )] ) and late == by_time[6]
> assert same( other, twin[2] ) and still == take["ground"].frames[0]
> for name, words in [( "sheet@frame_0001", "take.glb: got 'frame_0001' behind @, expected a time in s or one of the 6 morph targets 'frame_0002' .. 'frame_0007'" ),
>                     ( "sheet@-1", "take.glb: got '-1' behind @" ), ( "sheet@", "take.glb: got '' behind @" ), ( "sheet@1e999", "take.glb: got '1e999' behind @" ),
>                     ( "sheet@0." + 64 * "0" + "1", "take.glb: got '0.0000" ), ( "ground@frame_0002", "mesh 'ground' has no morph targets, got 'frame_0002' behind @" ),
>                     ( "skirt@1", "got 0 nodes with the mesh 'skirt'" ), ( "@1", "got 3 nodes with a mesh, expected the name of one behind #" )]:
>     message = refused( f"colliders:\n  - {{ name: a, shape: mesh, file: 'take.glb#{name}' }}\n" )
>     assert words in message, message
> END
$ wisp info take.glb | grep -A3 'mesh sheet'; wisp info take.glb | grep 'target 5\|animation rec'
  mesh sheet of 1 primitive
  morph targets: 6
    target 0, frame_0002, at 0.25 s
    target 1, frame_0003, at 0.5 s
animation recording: 1.5 s, 2 channels
    target 5, frame_0007, at 1.5 s
    target 5, frame_0007, at 1.5 s

# A scene that is far away runs bit for bit as at home: places are multiples of 2 mm at 20 km, and those here of a quarter of a metre. What a scene writes is its last frame.
$ python3 <<'END'
> from files import *
> def stage( x, z ):
>     return f"""steps: 30
> surfaces:
>   - name: cloth
>     generate: {{ shape: plane, columns: 9, rows: 9, spacing: 0.05 }}
>     transform: {{ translate: [{x}, 0.5, {z}] }}
>     pin_nearest: [[{x + 0.25}, 0.5, {z + 0.25}]]
>     pin_keyframes: [{{ time: 0, translate: [0, 0, 0] }}, {{ time: 1, translate: [0, 0.2, 0] }}]
>     cloth: {{}}
>     compute: [points, motion_stats]
> strands:
>   - name: hair
>     generate: {{ strands: 4, vertices: 8, length: 0.2, scalp_radius: 0.1 }}
>     transform: {{ translate: [{x}, 1, {z}] }}
>     dynamics: {{}}
>     head: {{ keyframes: [{{ time: 0, position: [{x}, 1, {z}] }}, {{ time: 1, position: [{x}, 1.5, {z}] }}] }}
>     compute: [points]
> colliders:
>   - {{ name: ground, shape: plane }}
>   - {{ name: ball, shape: sphere, radius: 0.1, position: [{x}, 0.25, {z}],
>       keyframes: [{{ time: 0, position: [{x}, 0.25, {z}] }}, {{ time: 1, position: [{x}, 0.75, {z}] }}] }}
> """
> home = hash_of( stage( 0, 0 ) )
> assert hash_of( stage( 20000, -20000 ) ) == hash_of( stage( -1000, 0 ) ) == home != hash_of( stage( 0, 0 ).replace( "1.5", "1.25" ) )
> assert struct.unpack_from( "<3d", open( "scene.wisp", "rb" ).read(), 40 ) != ( 0, 0, 0 )
> bodies, said = run( "steps: 3\nsurfaces:\n  - { name: cloth, generate: { shape: plane, columns: 3, rows: 3 } }\noutput: [{ surface: cloth, file: out.obj }]\n" )
> rows = [line.split()[1:] for line in open( "out.obj" ) if line.startswith( "v " )]
> assert [tuple( array.array( "f", map( float, row ) ) ) for row in rows] == bodies["cloth"].frames[3] and bodies["cloth"].frames[3][8][1] < 0
> END

# Copies are entries that are written out: they move bit for bit alike, stand in rows, of which each is as long as the root of their number unless the scene says so, and
# have pins and groups of their own.
$ python3 <<'END'
> from files import *
> PLANE, HAIR = "generate: { shape: plane, columns: 5, rows: 5 }, pins: [0, 4], cloth: {}", "generate: { strands: 3, vertices: 5 }, dynamics: {}"
> copied = f"""steps: 5
> surfaces:
>   - {{ name: a, {PLANE}, copies: {{ count: 3, spacing: [0, 0, 3] }} }}
> strands:
>   - {{ name: b, {HAIR}, copies: {{ count: 3, spacing: [2, 0, 0] }} }}
> """
> written = f"""steps: 5
> surfaces:
>   - {{ name: a, {PLANE} }}
>   - {{ name: a-2, {PLANE.split( ', pins' )[0].replace( 'generate: { shape: plane, columns: 5, rows: 5 }', 'instance_of: a' )}, transform: {{ translate: [0, 0, 3] }}, pins: [0, 4], cloth: {{}} }}
>   - {{ name: a-3, {PLANE.split( ', pins' )[0].replace( 'generate: { shape: plane, columns: 5, rows: 5 }', 'instance_of: a' )}, transform: {{ translate: [0, 0, 6] }}, pins: [0, 4], cloth: {{}} }}
> strands:
>   - {{ name: b, {HAIR} }}
>   - {{ name: b-2, {HAIR}, transform: {{ translate: [2, 0, 0] }} }}
>   - {{ name: b-3, {HAIR}, transform: {{ translate: [4, 0, 0] }} }}
> """
> assert hash_of( copied ) == hash_of( written ) != hash_of( written.replace( "[4, 0, 0]", "[1, 0, 0]" ) )
> bodies, said = run( """dt: 0.02
> steps: 10
> strands:
>   - { name: tuft, generate: { strands: 2, vertices: 3 }, copies: { count: 7, spacing: [1, 0, 1] } }
> surfaces:
>   - { name: sheet, generate: { shape: plane, columns: 3, rows: 3, spacing: 1 }, transform: { translate: [1, 2, 3] }, pin_box: { min: [-1, 0, 0], max: [1, 2, 2.5] },
>       pin_nearest: [[2, 2, 4]], copies: { count: 5, columns: 2, spacing: [10, 20, 30] } }
>   - { name: last, generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }, copies: { count: 2, spacing: [2, 0, 0] },
>       pin_groups: [{ name: a, pin_nearest: [[0.2, 0, -0.2]], pin_keyframes: [{ time: 0.2, translate: [0, 0.1, 0] }] }] }
> """ )
> assert list( bodies ) == ["tuft"] + [f"tuft-{i}" for i in range( 2, 8 )] + ["sheet", "last", "sheet-2", "sheet-3", "sheet-4", "sheet-5", "last-2"]
> def moved( a, b ):
>     return [round( q - p, 5 ) for p, q in zip( bodies[a].frames[0][0], bodies[b].frames[0][0] )]
> assert [moved( "tuft", f"tuft-{i}" ) for i in ( 3, 4, 7 )] == [[2, 0, 0], [0, 0, 1], [0, 0, 2]]
> assert [moved( "sheet", f"sheet-{i}" ) for i in ( 2, 3, 4, 5 )] == [[10, 0, 0], [0, 20, 30], [10, 20, 30], [0, 40, 60]]
> assert all( bodies[name].still() == [0, 1, 8] for name in bodies if name.startswith( "sheet" ) )
> assert near( bodies["last"].frames[10][8], [0.2, 0.1, -0.2], 1e-5 ) and near( bodies["last-2"].frames[10][8], [2.2, 0.1, -0.2], 1e-5 )
> def copy_refused( keys, words, more="" ):
>     message = refused( f"surfaces:\n  - {{ name: a, generate: {{ shape: plane }}, {keys} }}\n{more}" )
>     assert words in message, message
> copy_refused( "copies: { count: 2, spacing: [1, 0, 0] }", "the name of the copy 'a-2' is taken by the entry in line 4", "  - { name: a-2, generate: { shape: plane } }\n" )
> copy_refused( "copies: { count: 2 }", "key 'spacing' is missing" )
> copy_refused( "copies: { count: 0, spacing: [1, 0, 0] }", "copies.count: got 0" )
> copy_refused( "copies: { count: 10000, spacing: [1, 0, 0] }", "10001 surfaces", "  - { name: b, generate: { shape: plane } }\n" )
> assert "100000000 vertices" in refused( "surfaces:\n  - { name: a, generate: { shape: plane, columns: 100, rows: 100 }, copies: { count: 10000, spacing: [1, 0, 0] } }\n" )
> assert "20000000000 vertices" in refused( "strands:\n  - { name: a, generate: { strands: 100000, vertices: 20 }, copies: { count: 10000, spacing: [1, 0, 0] } }\n" )
> assert "more than 64 characters" in refused( "surfaces:\n  - { name: " + "a" * 64 + ", generate: { shape: plane }, copies: { count: 2, spacing: [1, 0, 0] } }\n" )
> assert "'copies' is not possible with 'scatter'" in refused( "strands:\n  - { name: a, generate: { strands: 2 }, dynamics: {} }\n"
>     "  - { name: b, scatter: { around: a, count: 2, radius: 0.1 }, copies: { count: 2, spacing: [1, 0, 0] } }\n" )
> END

# Panels close by the speed of their seam; pairs have the numbers of the file, one of which belongs to no triangle.
$ printf 'v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 0 1\nf 1 4 3\n' >tri.obj; python3 <<'END'
> from files import *
> def panels( seam ):
>     return f"""steps: 60
> gravity: [0, 0, 0]
> surfaces:
>   - {{ name: a, generate: {{ shape: plane, columns: 4, rows: 4, spacing: 0.1 }}, cloth: {{}} }}
>   - {{ name: b, instance_of: a, transform: {{ translate: [0.35, 0, 0] }}, cloth: {{}} }}
>   - {{ name: tri, file: tri.obj, repair: [unreferenced] }}
> seams:
>   - {{ name: s, {seam} }}
> """
> a, b, tri = run( panels( "surfaces: [a, b], within: 0.06, closing_speed: 0.2" ) )[0].values()
> assert all( near( a.frames[30][4 * i + 3], b.frames[30][4 * i], 1e-4 ) for i in range( 4 ) )
> a, b, tri = run( panels( "surfaces: [tri, tri], pairs: [[3, 2]]" ) )[0].values()
> assert near( tri.frames[60][2], tri.frames[60][1], 0.3 ) and tri.frames[60][0] == ( 0, 0, 0 ) and a.frames[60] == a.frames[0]
> for seam, words in [( "surfaces: [a, b], within: 0.04", "seam 's': seams: no boundary vertex" ),
>                     ( "surfaces: [a, b], pairs: [[0, 16]]", "seam 's': pairs[0]: got vertex 16 of 'b'" ),
>                     ( "surfaces: [tri, tri], pairs: [[0, 1]]", "seam 's': pairs[0]: got vertex 1 of 'tri'" )]:
>     assert refused( panels( seam ) ).startswith( "scene.yaml:9:5: " + words )
> END

# An instance tears on its own, and its spare vertices are not pinned although they lie where pins are. A map of the strength is a number a vertex of the mesh: only the
# left tears.
$ for i in 1 2 3 4 5 6; do printf '1e-6 1e-6 1e-6 1 1 1\n'; done >strength.txt; python3 <<'END'
> from files import *
> def sheets( a, b ):
>     return run( f"""steps: 20
> gravity: [0, 0, 9.81]
> substeps: 4
> iterations: 4
> surfaces:
>   - name: a
>     generate: {{ shape: plane, columns: 6, rows: 6, spacing: 0.03 }}
>     pins: [0, 1, 2, 3, 4, 5]
>     cloth: {{}}
>     tearing: {{ strength: {a}, max_splits: 7, max_new_vertices: 12 }}
>   - name: b
>     instance_of: a
>     transform: {{ translate: [1, 0, 0] }}
>     pin_box: {{ min: [0, -1, -1], max: [2, 1, 1] }}
>     cloth: {{}}
>     tearing: {{ strength: {b} }}
> """ )[0].values()
> a, b = sheets( 0.01, 1e6 )
> # the instance asks for more spare vertices than its source: a quarter of 36, at least 64
> assert len( a.frames[0] ) == len( b.frames[0] ) == 36 + 64 and a.corners[0] == b.corners[0] == b.corners[20] != a.corners[20] and set( a.corners[0] ) == set( range( 36 ) )
> assert max( a.corners[20] ) >= 36 and set( a.corners[20] ) == set( range( max( a.corners[20] ) + 1 ) ) and b.frames[20][:36] == b.frames[0][:36]
> a, b = sheets( "{ map: strength.txt, to: 1000 }", 1e6 )
> # cells are row by row
> assert max( a.corners[20] ) >= 36 and all( v < 36 for t in range( 50 ) for v in a.corners[20][3 * t:3 * t + 3] if t // 2 % 5 >= 3 )
> END

# Curves are bodies wherever their source stands, and those before the first step are what the engine draws: coordinates are below 0.5 m, and a point is a sum of a dozen
# products.
$ python3 <<'END'
> from files import *
> bodies, said = run( "strands:\n  - { name: drawn, curves: { of: hair, samples: 3 }, compute: [points] }\n  - { name: hair, generate: { strands: 4, vertices: 6 } }\n" )
> assert list( bodies ) == ["drawn", "hair"] and bodies["drawn"].numbers == ( 0, 16, 32, 48, 64 )
> for kind in "bezier", "catmull_rom":
>     a, b = run( f"""strands:
>   - {{ name: hair, generate: {{ shape: curly, strands: 5, vertices: 12 }} }}
>   - {{ name: drawn, curves: {{ of: hair, kind: {kind}, samples: 5 }}, compute: [points] }}
> """ )[0]["drawn"].frames
>     assert all( near( p, q, 4e-7 ) for p, q in zip( a, b, strict=True ) )
> END

# Roots go with their head as a collider of the same keyframes does: their distances to its eight corners stay. Coordinates are below 4 m, where a float is within 2.4e-7,
# and a pose is a few sums of them. On a surface roots stay where they were.
$ python3 <<'END'
> from files import *
> from math import dist
> KEYS = "{ keyframes: [ { time: 0.5, position: [1, 2, 3] }, { time: 1.5, position: [2, 2, 3], rotation: { axis: [0, 0, 1], degrees: 90 } } ] }"
> bodies, said = run( f"""steps: 20
> dt: 0.1
> substeps: 2
> strands:
>   - name: hair
>     generate: {{ strands: 20, vertices: 5, scalp_radius: 0.1 }}
>     transform: {{ translate: [1, 2, 3] }}
>     dynamics: {{}}
>     compute: [points]
>     head: {KEYS}
> colliders:
>   - {{ name: head, shape: box, half_extent: [0.1, 0.1, 0.1], position: [1, 2, 3], {KEYS[2:-2]} }}
> """ )
> hair, head = bodies["hair"].frames, bodies["head"].frames
> def distances( f, s ):
>     return [dist( hair[f][5 * s], corner ) for corner in head[f]]
> assert all( near( distances( f, s ), distances( 0, s ), 3e-6 ) for f in range( 21 ) for s in range( 20 ) )
> x, y, z = hair[0][0]
> assert near( hair[20][0], [2 - ( y - 2 ), 2 + ( x - 1 ), z], 2e-6 )
> hair = run( """steps: 20
> dt: 0.05
> strands:
>   - { name: hair, generate: { dimension: 2, strands: 3, vertices: 4, spacing: 0.01 }, dynamics: {}, on_surface: board, compute: [points] }
> surfaces:
>   - { name: other, generate: { shape: plane, columns: 4, rows: 4, spacing: 0.1 }, pin_box: { min: [-1, -1, -1], max: [1, 1, 1] } }
>   - name: board
>     generate: { shape: plane, columns: 4, rows: 4, spacing: 0.1 }
>     pin_box: { min: [-1, -1, -1], max: [1, 1, 1] }
>     pin_keyframes: [ { time: 0.5, translate: [0.25, 0.5, 0] } ]
> """ )[0]["hair"].frames
> for s in 0, 4, 8: # three barycentric weights, each within half an ulp of a value below 1
>     assert near( hair[20][s], [hair[0][s][0] + 0.25, hair[0][s][1] + 0.5, hair[0][s][2]], 1e-6 )
> END

# Roots of ghosts stand around that of their target, which the head raises by 0.05 m, with and without frozen hair: the mean of a group is its target. Frozen hair changes
# what ghosts look like, by part of the length of a strand, 0.1 m.
$ python3 <<'END'
> from files import *
> from math import dist
> bodies, said = run( """steps: 10
> dt: 0.02
> substeps: 2
> strands:
>   - name: guides
>     generate: { strands: 6, vertices: 8, length: 0.1 }
>     dynamics: {}
>     head: { keyframes: [ { time: 0.1, position: [0, 0.05, 0] } ] }
>     compute: [points]
>   - { name: ghosts, scatter: { around: guides, count: 3, radius: 0.01 }, ghosts: {}, compute: [points] }
>   - { name: frozen, scatter: { around: guides, count: 3, radius: 0.01 }, ghosts: {}, frozen_hair: { freeze: {} }, compute: [points] }
> """ )
> guides, start = bodies["guides"].frames[0], bodies["ghosts"].frames[0]
> for g in range( 18 ):
>     group = [start[8 * h] for h in range( g // 3 * 3, g // 3 * 3 + 3 )]
>     expected = [x + p - sum( q ) / 3 + rise for x, p, q, rise in zip( guides[g // 3 * 8], start[8 * g], zip( *group ), ( 0, 0.05, 0 ) )]
>     assert all( near( bodies[name].frames[10][8 * g], expected, 1e-6 ) for name in ( "ghosts", "frozen" ) ) # sums of coordinates below 0.3 m
> assert 1e-4 < max( map( dist, bodies["ghosts"].frames[10], bodies["frozen"].frames[10] ) ) < 0.1
> GUIDES = "strands:\n  - { name: guides, generate: { strands: 2, vertices: 8 }, dynamics: {} }\n  - { name: ghosts, generate: { strands: 5, vertices: 9 }, "
> assert refused( GUIDES + "ghosts: { targets: guides } }\n" ).startswith( "scene.yaml:4:5: strands 'ghosts': " )
> run( GUIDES + "ghosts: { targets: guides, resample: true }, compute: [points] }\n" )
> assert refused( "strands:\n  - { name: guides, generate: { dimension: 2, strands: 1, vertices: 2 } }\n"
>     "  - { name: more, scatter: { around: guides, count: 2, radius: 0.01 }, dynamics: { vertex_masses: [1e-8, 1e-8] } }\n" ) == (
>     "scene.yaml:4:5: strands 'more': dynamics.vertex_masses: got 2 masses, expected one for each of 4 vertices" )
> END

# Keyframes that jump teleport pins, heads and colliders, and events do so to surfaces. Other motion in a step of 10 ms is below 5 cm. Between two steps a jump waits for
# the next one, and the pins stay until then: they lie 0.4 m apart along x and turn about their middle, at z = -0.2.
$ python3 <<'END'
> from files import *
> bodies, said = run( """steps: 90
> dt: 0.01
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     pins: [0, 8]
>     pin_keyframes: [{ time: 0.3, translate: [3, 0, 0], jump: true }, { time: 0.405, translate: [3, 7, 0], rotate: { axis: [0, 1, 0], degrees: 90 }, jump: true }]
>     cloth: { bending: bend_links }
>     damping: 5
>   - { name: ball, generate: { shape: icosphere, level: 1, radius: 0.1 }, balloon: {}, gravity: [0, 0, 0] }
> strands:
>   - { name: hair, generate: { strands: 3, vertices: 8, length: 0.1 }, dynamics: { damping: 5 }, head: { keyframes: [{ time: 0.3, position: [0, 0, 4], jump: true }] } }
> colliders:
>   - { name: body, shape: sphere, radius: 0.1, position: [0, -2, 0], keyframes: [{ time: 0.3, position: [0, 2, 0], jump: true }, { time: 0.4, position: [1, 2, 0] }] }
> events: [{ step: 30, surface: ball, teleport: [0, 0, 9] }]
> """ )
> for name, way in { "hair": ( 0, 0, 4 ), "cloth": ( 3, 0, 0 ), "ball": ( 0, 0, 9 ), "body": ( 0.1, 4, 0 ) }.items():
>     for p, q in zip( bodies[name].frames[30], bodies[name].frames[31], strict=True ):
>         assert near( q, [x + w for x, w in zip( p, way )], 0.05 ), name
> cloth = bodies["cloth"].frames
> assert near( cloth[41][0], [2.8, 0, -0.2], 1e-5 ) and near( cloth[42][0], [3, 7, 0], 1e-5 ) and near( cloth[90][8], [3, 7, -0.4], 1e-5 )
> END
