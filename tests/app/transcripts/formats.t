# Recordings for other programs, read by strict readers of their formats: every number is that of the .wisp recording of the same run, bit for bit. Hair has numbers that
# need nine digits, and limits of single precision. ./dev readers has the readers of other people.
$ cp "$SOURCE"/tests/app/transcripts/f*.py .; cat >grooms.py <<'END'
> import files
> from formats import *
> from files import wisp_recording, write_hair
> HAIR = [0.1, -0.0, 1e-40, 1 / 3, -123456.789, float.fromhex( "0x1.fffffep-1" ), 1.17549435e-38, 2.5, -7, 999999.9375, 1e6, -1e-10, 121.360634, 122.243706, 100.670395]
> WIDTHS, COLOURS = [1e-3, 8e-4, 1e-4, 1e-3, 5e-4], [0, 0, 0, 1, 0.5, 0.25, 1, 1, 1, 0.002, 0.2, 0, 0, 0, 1]
> write_hair( "odd.hair", [3, 2], HAIR, WIDTHS, colours=COLOURS )
> write_hair( "short.hair", [3, 1, 2], [0.1 * i for i in range( 18 )] )
> def read( path ):
>     bodies, times = wisp_recording.read( path )
>     return { body.name: body for body in bodies }, times
> END
$ python3 grooms.py; cat >all.yaml <<'END'
> wisp: 1
> steps: 4
> strands:
>   - { name: hair-2, file: odd.hair }
> surfaces:
>   - name: cloth
>     generate: { shape: irregular_plane, columns: 5, rows: 4, spacing: 0.05 }
>     transform: { rotate: { axis: [1, 0, 0], degrees: 40 }, translate: [0.3, 1, 0] }
>     pins: [0]
>     velocity: [1, 0, 0]
>     cloth: { warp_compliance: 1e-4 }
>   - { name: drift, generate: { shape: icosphere, level: 1, radius: 0.1 }, transform: { translate: [5, 0, 0] }, velocity: [0, 3, 4], gravity: [0, 0, 0] }
> colliders:
>   - { name: ball, shape: sphere, radius: 0.2 }
>   - { name: mover, shape: sphere, radius: 0.1, keyframes: [ { time: 0, position: [2, 0, 0] }, { time: 0.06, position: [2, 1, 0] } ] }
> END
$ for file in 'a&b.pvd' all.wisp all.pc2 all.obj all.usda all.glb; do wisp run all.yaml --record "$file"; done | grep -c ': 5'
6
$ cat >recording.py <<'END'
> from grooms import *
> BODIES, TIMES = read( "all.wisp" )
> FRAMES, NAMES, STILL = range( 5 ), list( BODIES ), "ball"
> def same( numbers, body, frame ):
>     return bits( numbers ) == BODIES[body].frames[frame].tobytes()
> def lines( offsets, least=2 ):
>     return [list( range( a, b ) ) for a, b in zip( offsets, offsets[1:] ) if b - a >= least]
> def segments( offsets ):
>     return [line[i:i + 2] for line in lines( offsets ) for i in range( len( line ) - 1 )]
> def triangles( numbers ):
>     return [list( numbers[i:i + 3] ) for i in range( 0, len( numbers ), 3 )]
> def near( found, expected, tolerance ):
>     return all( abs( a - b ) <= tolerance for a, b in zip( found, expected, strict=True ) )
> def check_normals( found, body, frame ): # rounded once
>     return all( near( n, expected, 1e-7 ) for n, expected in zip( vectors( found ), normals( BODIES[body].frames[frame], BODIES[body].numbers ), strict=True ) )
> END
$ python3 <<'END'
> from recording import *
> assert NAMES == ["hair-2", "cloth", "drift", "ball", "mover"] and BODIES["hair-2"].numbers == ( 0, 3, 5 ) and all( same( HAIR, "hair-2", f ) for f in FRAMES )
> assert all( abs( time - f / 60 ) < 1e-8 * f + 1e-300 for f, time in enumerate( TIMES ) )
> assert [len( { frame.tobytes() for frame in body.frames } ) for body in BODIES.values()] == [1, 5, 5, 1, 5]
> # every part ends with its checksum, those of frames and of the end from that of the header on
> data = open( "all.wisp", "rb" ).read()
> header, size = struct.unpack_from( "<2Q", data, 16 )
> seed, ends = struct.unpack_from( "<Q", data, header - 8 )[0], [header + size * f for f in range( 6 )] + [len( data )]
> assert data[:header] == files.seal( data[:header - 8] ) and ends[5] + 24 == ends[6] and struct.unpack_from( "<8sQ", data, ends[5] ) == ( b"WISPEND\n", 5 )
> assert all( data[a:b] == files.seal( data[a:b - 8], seed ) for a, b in zip( ends, ends[1:] ) )
> assert all( struct.unpack_from( "<8s2Q", data, ends[f] ) == ( b"WISPFRAM", size, f ) for f in FRAMES )
> END

# Point caches, one a body; a single body has the name as it stands.
$ ls all*.pc2; python3 <<'END'
> from recording import *
> for name in NAMES:
>     assert read_pc2( f"all_{name}.pc2" ) == BODIES[name].frames and [bits( f ) for f in read_pc2( f"all_{name}.pc2" )] == [bits( f ) for f in BODIES[name].frames]
> END
all_ball.pc2
all_cloth.pc2
all_drift.pc2
all_hair-2.pc2
all_mover.pc2

# ParaView: a file a body and frame; a body that stands still has one, without a time, which all frames name. Paths lie beside the list. Colours have the transfer
# function of sRGB: 12.92 c up to 0.0031308, 1.055 c^(1/2.4) - 0.055 above (IEC 61966-2-1).
$ ls 'a&b' | wc -l
21
$ python3 <<'END'
> from recording import *
> assert read_pvd( "a&b.pvd" ) == [( TIMES[f], part, name, f"a&b/{name}_{1 if name == STILL else f + 1:04}.vtp" ) for f in FRAMES for part, name in enumerate( NAMES )]
> for time, part, name, file in read_pvd( "a&b.pvd" ):
>     body, data, f = BODIES[name], Vtp( file ), TIMES.index( time )
>     assert data.time == ( None if name == STILL else time ) and same( data.points, name, f )
>     if body.is_strands:
>         assert data.cells == lines( body.numbers ) and data.roles == { "Scalars": "width" } and set( data.values ) == { "width", "RGB" }
>         assert bits( data.values["width"] ) == bits( WIDTHS )
>         assert list( data.values["RGB"] ) == [0, 0, 0, 255, 188, 137, 255, 255, 255, 7, 124, 0, 0, 0, 255]
>     else:
>         assert data.cells == triangles( body.numbers ) and data.roles == { "Normals": "Normals" } and check_normals( data.values["Normals"], name, f )
> END

# OBJ: frames are numbered from 1, vertices through all bodies; a segment is a line of its own.
$ python3 <<'END'
> from recording import *
> for f in FRAMES:
>     for ( name, points, elements ), body in zip( read_obj( f"all_{f + 1:04}.obj" ), BODIES.values(), strict=True ):
>         assert name == body.name and same( points, name, f )
>         assert elements == ( segments if body.is_strands else triangles )( body.numbers )
> END
$ ls all_*.obj | wc -l
5

# USD: one sample of each body a frame, at whole time codes, also where the times of frames between steps are rounded; velocities are central differences, one-sided at the ends. A body that stands still has no samples.
$ wisp run all.yaml --frames-per-step 7 --record dense.usda >/dev/null; python3 <<'END'
> from recording import *
> usd, dense = Usda( "all.usda" ), Usda( "dense.usda" )
> assert list( dense.prims["cloth"]["points.timeSamples"] ) == list( range( 29 ) ) and dense.metadata["framesPerSecond"] == 420
> version = usd.metadata.pop( "doc" )
> assert version.startswith( "Wisp " ) and ( usd.type, usd.name, usd.own ) == ( "Xform", "Recording", {} ) and usd.metadata == {
>     "defaultPrim": "Recording", "startTimeCode": 0, "endTimeCode": 4, "framesPerSecond": 60, "timeCodesPerSecond": 60, "metersPerUnit": 1, "upAxis": "Y" }
> assert list( usd.prims ) == [name.replace( "-", "_" ) for name in NAMES]
> for name, body in BODIES.items():
>     prim = usd.prims[name.replace( "-", "_" )]
>     at = lambda key, f: prim[key] if name == STILL else prim[key + ".timeSamples"][f]
>     assert name == STILL or all( list( prim[key] ) == list( FRAMES ) for key in prim if key.endswith( "timeSamples" ) )
>     assert all( same( flat( at( "points", f ) ), name, f ) for f in FRAMES )
>     half = max( WIDTHS ) / 2 if body.is_strands else 0
>     for f in FRAMES:
>         ( a, b ), ( low, high ) = at( "extent", f ), bounds( body.frames[f] )
>         assert bits( a ) == bits( [x - half for x in low] ) and bits( b ) == bits( [x + half for x in high] )
>     if name == STILL:
>         assert not [key for key in prim if "timeSamples" in key or "velocities" in key]
>     for f in FRAMES if name != STILL else []:
>         a, b = max( f - 1, 0 ), min( f + 1, 4 )
>         speeds = [( y - x ) / ( TIMES[b] - TIMES[a] ) for x, y in zip( body.frames[a], body.frames[b] )]
>         assert bits( flat( at( "velocities", f ) ) ) == bits( speeds )
>     colour = prim["primvars:displayColor"]
>     if body.is_strands:
>         assert prim["prim"] == "BasisCurves" and prim["curveVertexCounts"] == [3, 2] and prim["wrap"] == "nonperiodic"
>         assert bits( prim["widths"] ) == bits( WIDTHS ) and bits( flat( colour ) ) == bits( COLOURS )
>         assert prim["widths as"] == prim["primvars:displayColor as"] == "vertex"
>     else:
>         assert prim["prim"] == "Mesh" and prim["doubleSided"] == 1 and prim["subdivisionScheme"] == "none" and len( colour ) == 1
>         assert prim["primvars:displayColor as"] == "constant" and prim["normals as"] == "vertex"
>         assert prim["faceVertexIndices"] == list( body.numbers ) and prim["faceVertexCounts"] == [3] * ( len( body.numbers ) // 3 )
>         assert all( check_normals( flat( at( "normals", f ) ), name, f ) for f in FRAMES )
> END

# glTF: points plus targets are the points of every frame, normals too; one weight after the other is 1 at the times of the frames.
$ python3 <<'END'
> from recording import *
> glb, usd = Glb( "all.glb" ), Usda( "all.usda" )
> assert glb.json["asset"]["version"] == "2.0" and glb.json["scenes"] == [{ "nodes": [0, 1, 2, 3, 4] }] and glb.json["scene"] == 0
> assert [node["name"] for node in glb.json["nodes"]] == NAMES
> for number, ( name, body ) in enumerate( BODIES.items() ):
>     p, corners = glb.body( number ), segments( body.numbers ) if body.is_strands else triangles( body.numbers )
>     assert p["mode"] == ( 1 if body.is_strands else 4 ) and p["indices"] == sum( corners, [] ) and len( p.get( "targets", [] ) ) == ( 0 if name == STILL else 4 )
>     assert set( p["attributes"] ) == { "POSITION", "COLOR_0" if body.is_strands else "NORMAL" } and same( p["attributes"]["POSITION"], name, 0 )
>     assert name == STILL or p["names"] == ["frame_0002", "frame_0003", "frame_0004", "frame_0005"]
>     base, base_normals = p["attributes"]["POSITION"], p["attributes"].get( "NORMAL" )
>     assert body.is_strands or check_normals( base_normals, name, 0 )
>     for f, target in enumerate( p.get( "targets", [] ), 1 ):
>         # the difference is rounded once, by half of an epsilon of itself
>         assert all( abs( a + d - x ) <= 6e-8 * abs( d ) for a, d, x in zip( base, target["POSITION"], body.frames[f], strict=True ) )
>         # three vectors are rounded once each
>         assert body.is_strands or near( [a + d for a, d in zip( base_normals, target["NORMAL"] )], sum( normals( body.frames[f], body.numbers ), [] ), 2.4e-7 )
>     material = glb.json["materials"][p["material"]]
>     colour = [( 1, 1, 1 )] if body.is_strands else usd.prims[name]["primvars:displayColor"]
>     assert material["doubleSided"] and material["pbrMetallicRoughness"]["baseColorFactor"] == [*colour[0], 1]
>     assert not body.is_strands or bits( p["attributes"]["COLOR_0"] ) == bits( COLOURS )
> times, weights = glb.animation()
> assert bits( times ) == bits( TIMES ) and weights == [[float( t == f - 1 ) for t in range( 4 )] for f in FRAMES] and glb.is_filled()
> END

# three.js takes a line with a colon and without an equals sign for a sample, so how a normal is interpolated stands in one line.
$ grep -c '^        normal3f\[\] normals (interpolation = "vertex")$' all.usda
3

# One frame has no animation. glTF demands unit normals also of vertices whose triangles cancel.
$ printf 'v -1 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\nf 1 3 2\n' >both.obj; printf 'wisp: 1\nsurfaces:\n  - { name: m, file: both.obj }\n' >both.yaml
$ sed 's/^steps: 4/steps: 0/' all.yaml >first.yaml; wisp run first.yaml --record one.glb >/dev/null; wisp run both.yaml --record both.glb >/dev/null; python3 <<'END'
> from recording import *
> one = Glb( "one.glb" )
> assert "animations" not in one.json and not any( "targets" in one.body( i ) for i in range( 5 ) ) and one.is_filled()
> assert list( Glb( "both.glb" ).body( 0 )["attributes"]["NORMAL"] ) == [0, 1, 0] * 3
> END

# Values are arrays of points in each frame: strain is the largest |l / l0 - 1| of the edges at a vertex, from the shape of the first frame, and what drifts does so at
# 5 m/s. USD has the same numbers as ParaView.
$ wisp run all.yaml --record with.pvd --record-with strain,speed >/dev/null; wisp run all.yaml --record with.usda --record-with strain,speed >/dev/null; python3 <<'END'
> from recording import *
> usd = Usda( "with.usda" )
> for name, value in [( name, value ) for name in ( "cloth", "drift" ) for value in ( "strain", "speed" )]:
>     prim, data = usd.prims[name], [Vtp( f"with/{name}_{f + 1:04}.vtp" ) for f in FRAMES]
>     assert all( d.roles["Scalars"] == "strain" and bits( d.values[value] ) == bits( prim[f"primvars:{value}.timeSamples"][f] ) for f, d in enumerate( data ) )
>     assert prim[f"primvars:{value} as"] == "vertex" and all( same( d.points, name, f ) for f, d in enumerate( data ) )
>     for f in FRAMES:
>         if value == "strain":
>             rest, now, expected = vectors( BODIES[name].frames[0] ), vectors( BODIES[name].frames[f] ), [0] * BODIES[name].vertices
>             for t in triangles( BODIES[name].numbers ):
>                 for i, j in zip( t, t[1:] + t[:1] ):
>                     strain = abs( math.dist( now[i], now[j] ) / math.dist( rest[i], rest[j] ) - 1 )
>                     expected[i], expected[j] = max( expected[i], strain ), max( expected[j], strain )
>             # positions of about 1 m in single precision, and edges of 3 cm
>             assert near( data[f].values[value], expected, 1e-5 ) and ( name == "drift" or f == 0 or max( expected ) > 1e-4 )
>         elif name == "drift":
>             assert near( data[f].values[value], [5 if f else 0] * BODIES[name].vertices, 1e-5 ) # before the first step nothing has moved
> assert "primvars:strain.timeSamples" not in usd.prims["ball"] and not any( "strain" in key for key in usd.prims["hair_2"] )
> END

# A strand of one vertex is no line, and no curve of USD. Strands without widths have those of hair there.
$ printf 'wisp: 1\nstrands:\n  - { name: s, file: short.hair }\n' >short.yaml; for file in s.wisp s.pvd s.obj s.glb; do wisp run short.yaml --record $file; done >/dev/null
$ python3 <<'END'
> from recording import *
> bodies, times = read( "s.wisp" )
> data, glb, ( ( name, points, elements ), ) = Vtp( "s/s_0002.vtp" ), Glb( "s.glb" ), read_obj( "s_0002.obj" )
> assert bodies["s"].numbers == ( 0, 3, 4, 6 ) and data.cells == [[0, 1, 2], [4, 5]] and data.roles == {} and data.values == {}
> assert elements == [[0, 1], [1, 2], [4, 5]] and glb.body( 0 )["indices"] == [0, 1, 1, 2, 4, 5] and len( data.points ) == 18
> END
$ wisp run short.yaml --record s.usda
! wisp: s.usda: body s: strand 1 has 1 vertices; a curve in a .usda file needs at least 2
[2]
$ sed 's/short.hair/odd.hair/; s/name: s/name: 3s/' short.yaml >digit.yaml; wisp run digit.yaml --steps 1 --record s.usda >/dev/null; grep -c 'def BasisCurves "_3s"' s.usda
1

# Hair that a scene writes has the same numbers in every format: a header of 128 bytes and arrays behind each other, curves with the box of what is drawn, lines of two
# vertices. A strand has at most 65536 vertices in a .hair file, and two at least in USD.
$ cat >outputs.py <<'END'
> import os, subprocess
> from recording import *
> def written( strands, *names ):
>     with open( "outputs.yaml", "w" ) as file:
>         file.write( f"wisp: 1\nstrands:\n  - {{ name: h, {strands} }}\noutput:\n" + "".join( f"  - {{ strands: h, file: {name} }}\n" for name in names ) )
>     return subprocess.run( [os.environ["WISP"], "run", "outputs.yaml"], capture_output=True, text=True ).stderr
> END
$ python3 <<'END'
> from outputs import *
> CLEAR = [0, 0.25, 0.5, 0.75, 1]
> write_hair( "clear.hair", [3, 2], HAIR, WIDTHS, CLEAR, COLOURS )
> assert written( "file: clear.hair", "out.hair", "out.usda", "out.obj" ) == ""
> data = open( "out.hair", "rb" ).read()
> assert struct.unpack_from( "<4s4I", data ) == ( b"HAIR", 2, 5, 31, 2 ) and data[128:132] == struct.pack( "<2H", 2, 1 )
> assert floats( data[132:192] ) == floats( HAIR ) and data[192:] == bits( WIDTHS ) + bits( CLEAR ) + bits( COLOURS )
> [( name, points, lines )] = read_obj( "out.obj" )
> assert points == floats( HAIR ) and lines == segments( ( 0, 3, 5 ) )
> usda = Usda( "out.usda" )
> assert usda.metadata["metersPerUnit"] == 1 and usda.own["type"] == "linear" and usda.own["curveVertexCounts"] == [3, 2] and flat( usda.own["points"] ) == floats( HAIR )
> assert bits( usda.own["widths"] ) == bits( WIDTHS ) and bits( flat( usda.own["primvars:displayColor"] ) ) == bits( COLOURS )
> assert usda.own["primvars:displayOpacity"] == [1 - x for x in CLEAR]
> assert [usda.own[key + " as"] for key in ( "widths", "primvars:displayColor", "primvars:displayOpacity" )] == ["vertex"] * 3
> write_hair( "two.hair", [2], [1, 2, 3, -1, 5, 3], [0.5, 0.25] )
> written( "file: two.hair", "two.usda" )
> two = Usda( "two.usda" ).own
> assert two["extent"] == [( -1.25, 1.75, 2.75 ), ( 1.25, 5.25, 3.25 )] and not any( "display" in key for key in two )
> write_hair( "long.hair", [65536], [0.001 * ( i // 3 ) for i in range( 3 * 65536 )] )
> written( "file: long.hair", "again.hair" )
> assert open( "again.hair", "rb" ).read()[128:] == open( "long.hair", "rb" ).read()[128:]
> assert "long.out.hair: strand 0 has 65537 vertices; a .hair file holds 1 to 65536 a strand" in written( "generate: { strands: 1, vertices: 65537 }", "long.out.hair" )
> assert "s.usda: strand 1 has 1 vertices; a curve in a .usda file needs at least 2" in written( "file: short.hair", "s.usda" )
> END

# Names that USD cannot tell apart are refused.
$ printf 'wisp: 1\nstrands:\n  - { name: a-b, file: odd.hair }\n  - { name: a_b, file: odd.hair }\n' >twice.yaml; wisp run twice.yaml --record twice.usda; ls twice.usda
! wisp: twice.usda: bodies a-b and a_b would both be called a_b in USD
! ls: ...
[2]

# A scene that is far away: USD and glTF tell the origin, other formats have points in the world.
$ sed 's/translate: \[0.3, 1, 0\]/translate: [20000.3, 1, -4096.5]/' all.yaml | grep -v 'hair\|^strands\|drift' >far.yaml
$ for file in far.wisp far.pc2 far.obj far.pvd far.usda far.glb; do wisp run far.yaml --record $file; done >/dev/null
$ python3 <<'END'
> from recording import *
> bodies, times = read( "far.wisp" )
> origin = struct.unpack_from( "<3d", open( "far.wisp", "rb" ).read(), 40 )
> usd, glb, cloth = Usda( "far.usda" ), Glb( "far.glb" ), bodies["cloth"].frames
> assert origin[0] % 8 == 0 and abs( origin[0] - 20000 ) <= 8 and usd.own == { "xformOp:translate": origin, "xformOpOrder": ["xformOp:translate"] }
> assert all( tuple( node["translation"] ) == origin for node in glb.json["nodes"] ) and bits( glb.body( 0 )["attributes"]["POSITION"] ) == bits( cloth[0] )
> placed = [floats( [x + origin[i % 3] for i, x in enumerate( frame )] ) for frame in cloth]
> assert bits( flat( usd.prims["cloth"]["points.timeSamples"][4] ) ) == bits( cloth[4] ) and read_pc2( "far_cloth.pc2" ) == placed
> assert all( Vtp( f"far/cloth_{f + 1:04}.vtp" ).points == read_obj( f"far_{f + 1:04}.obj" )[0][1] == placed[f] for f in FRAMES )
> END

# A mesh that tears has the triangles of its frames. In glTF all frames have those of the last one, and each corner is where it was; in USD a vertex that was split off
# comes from where its corners were in the frame before.
$ cat >tear.yaml <<'END'
> wisp: 1
> steps: 30
> substeps: 8
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: 7, rows: 5, spacing: 0.05 }
>     pins: [0, 6, 28, 34]
>     cloth: {}
>     tearing: { strength: 2, max_new_vertices: 40 }
> END
$ for file in t.wisp t.pvd t.obj t.usda t.glb; do wisp run tear.yaml --record $file; done | grep -c ': 31'
5
$ python3 <<'END'
> from recording import *
> bodies, times = read( "t.wisp" )
> sheet, prim, glb, frames = bodies["sheet"], Usda( "t.usda" ).prims["sheet"], Glb( "t.glb" ), range( 31 )
> torn = [f for f in frames if f and sheet.triangles[f] != sheet.triangles[f - 1]]
> assert torn and "faceVertexIndices" not in prim
> p = glb.body( 0 )
> assert p["indices"] == list( sheet.triangles[30] ) and len( p["targets"] ) == 30
> for f in frames:
>     points, corners, before = vectors( sheet.frames[f] ), sheet.triangles[f], sheet.triangles[f - 1 if f else 0]
>     [( name, obj, elements )] = read_obj( f"t_{f + 1:04}.obj" )
>     assert bits( obj ) == bits( sheet.frames[f] ) and elements == Vtp( f"t/sheet_{f + 1:04}.vtp" ).cells == triangles( corners )
>     assert prim["faceVertexIndices.timeSamples"][f] == list( corners ) and bits( flat( prim["points.timeSamples"][f] ) ) == bits( sheet.frames[f] )
>     # one step earlier, at the corners of now; the first frame looks ahead
>     old, new = ( f - 1, f ) if f else ( 0, 1 )
>     from_points, to_points = vectors( sheet.frames[old] ), vectors( sheet.frames[new] )
>     for now, then in zip( sheet.triangles[new], sheet.triangles[old] ):
>         velocity = [( b - a ) / ( times[new] - times[old] ) for a, b in zip( from_points[then], to_points[now] )]
>         assert near( prim["velocities.timeSamples"][f][now], velocity, 1e-4 ) # nine digits of numbers below 1000
>     base = p["attributes"]["POSITION"]
>     moved = vectors( base if f == 0 else [a + d for a, d in zip( base, p["targets"][f - 1]["POSITION"] )] )
>     assert all( near( moved[last], points[corner], 1e-6 ) for last, corner in zip( sheet.triangles[30], corners ) )
> glb.animation()
> assert glb.is_filled()
> END

# A full disk is a message in every format, and so is a file in the place of the folder of frames.
$ grep -v 'hair\|^strands\|drift\|ball\|mover\|^colliders' all.yaml >one.yaml; python3 <<'END'
> import os, stat, subprocess
> is_there = os.path.exists( "/dev/full" ) and stat.S_ISCHR( os.stat( "/dev/full" ).st_mode )
> for name in ["wisp", "pc2", "pvd", "usda", "glb", "csv", "obj"] if is_there else []:
>     path = "full_0001.obj" if name == "obj" else "full." + name
>     os.symlink( "/dev/full", path )
>     which = ["--track", "cloth:1", "--track-file", path] if name == "csv" else ["--record", "full." + name]
>     run = subprocess.run( [os.environ["WISP"], "run", "one.yaml", "--steps", "200", *which], capture_output=True, text=True )
>     assert run.returncode == 2 and run.stderr.startswith( f"wisp: {path}: cannot write: " ) and run.stderr.count( "\n" ) == 1, ( name, run.stderr )
> assert not [name for name in os.listdir( "." ) if name.startswith( "." )]
> END
$ echo precious >folder; wisp run all.yaml --record folder.pvd
! wisp: folder: cannot make a folder: ...
[2]
$ cat folder; test ! -e folder.pvd
precious
