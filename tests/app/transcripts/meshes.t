# The doctors of meshes and of hair: each defect found by `wisp info` with its count and its elements, and each repair of a scene, by the mesh that its recording has.
$ cp "$SOURCE/tests/app/transcripts/files.py" .; cat >meshes.py <<'END'
> from files import *
> TETRAHEDRON = [( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 ), ( 0, 0, 1 )], [( 0, 2, 1 ), ( 0, 1, 3 ), ( 0, 3, 2 ), ( 1, 2, 3 )]
> def write( points, triangles, path="m.obj" ):
>     lines = ["v %.9g %.9g %.9g" % point for point in points] + ["f %d %d %d" % tuple( v + 1 for v in t ) for t in triangles]
>     open( path, "w" ).write( "\n".join( lines ) + "\n" )
> def info( points, triangles ):
>     write( points, triangles )
>     return subprocess.run( [os.environ["WISP"], "info", "m.obj"], capture_output=True, text=True ).stdout
> def scene( keys ):
>     return "surfaces:\n  - { name: m, file: m.obj, %s }\n" % keys
> def repaired( points, triangles, *words, keys="" ):
>     """The points and triangles of the repaired mesh, and what was said about the repair."""
>     write( points, triangles )
>     bodies, said = run( scene( "repair: [%s]%s" % ( ", ".join( words ), keys ) ) )
>     said = [line.split( "'m': " )[1] for line in said.splitlines() if line.startswith( "wisp: warning: scene.yaml:3:5:" )]
>     return bodies["m"].frames[0], list( zip( *[iter( bodies["m"].numbers )] * 3 ) ), said
> def refusal( points, triangles, keys ):
>     write( points, triangles )
>     return refused( scene( keys ) ).removeprefix( "scene.yaml:3:5: surface 'm': " )
> def turned( triangle ):
>     return triangle[0], triangle[2], triangle[1]
> ALL = "degenerates", "duplicates", "winding", "unreferenced"
> END

# A sound mesh is described in few lines, and one that misses a triangle has a loop of three border edges.
$ python3 -c 'from meshes import *; write( *TETRAHEDRON, "four.obj" ); write( TETRAHEDRON[0], TETRAHEDRON[1][:3], "hole.obj" )'; wisp info four.obj; wisp info hole.obj | grep -v bounds
four.obj: closed mesh of triangles
  vertices             4
  triangles            4
  edges                6
  Euler characteristic 2
  bounds               x 0 .. 1, y 0 .. 1, z 0 .. 1 m
  edge length          min 1, mean 1.20711, max 1.41421 m
  area                 2.36603 m^2
  volume               0.166667 m^3
  components           1
  no defects
hole.obj: open mesh of triangles
  vertices             4
  triangles            3
  edges                6
  Euler characteristic 1
  edge length          min 1, mean 1.20711, max 1.41421 m
  area                 1.5 m^2
  components           1
  note: open edges: 3 in 1 loop
    edge of vertices 1 and 2
    edge of vertices 1 and 3
    edge of vertices 2 and 3
  no defects

# Meshes in files: vertices and faces keep the order of the file, polygons are fans around their first corner, and every way to write a corner means the same vertex. PLY passes
# over unknown elements and properties before, between and after known ones, in text and in both byte orders.
$ python3 <<'END'
> from meshes import *
> def read( text, name="m.obj" ):
>     open( name, "wb" ).write( text if isinstance( text, bytes ) else text.encode( "latin-1" ) )
>     body = run( f"surfaces:\n  - {{ name: m, file: {name}, repair: [duplicates] }}\n" )[0]["m"] # so that triangles may repeat others
>     return body.frames[0], list( zip( *[iter( body.numbers )] * 3 ) )
> # the second vertex is unreferenced, the third repeats the first, and faces come between vertices
> assert read( "v 1 2 3\nv 9 9 9\nv 1 2 3\nv 7 7 0\nf 5 1 4\nv 4 5 6\nf 3 4 5\n" ) == ( [( 1, 2, 3 ), ( 9, 9, 9 ), ( 1, 2, 3 ), ( 7, 7, 0 ), ( 4, 5, 6 )], [( 4, 0, 3 ), ( 2, 3, 4 )] )
> assert read( "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 2 3 4 5 1\n" )[1] == [( 1, 2, 3 ), ( 1, 3, 4 ), ( 1, 4, 0 )]
> for face in "1 2 3", "1/1 2/1 3/1", "1//1 2//1 3//1", "1/1/1 2/1/1 3/1/1", "+1 +2 +3", "-3/-1/-1 -2/-1/-1 -1/-1/-1":
>     assert read( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf %s\n" % face )[1] == [( 0, 1, 2 )], face
> assert read( "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf -4 -3 -2\n" )[1] == [( 0, 1, 2 )]
> # behind a position stand a weight, a colour, or both
> assert read( "v 1 2 3 0.5\nv -.125 +.5 2.e1 1 0 0\nv 1e-3 1 1 1 1 1 1\nf 1 2 3\n" )[0] == [( 1, 2, 3 ), ( -0.125, 0.5, 20 ), ( *array.array( "f", [1e-3] ), 1, 1 )]
> assert read( "# free text, 100 % \xc3\xa9\xff\nmtllib none.mtl\no thing\ng a b\ng \n  v 0 0 0 # here\r\n\tv 1 0 0\rv 0 1 0\nvn 1e2147483649 0 0\n"
>     "usemtl red\ns off\nl 1 2\nt x 1/2/3\n\nvertex\nface 1\nf\t1  2 3 #end" ) == ( [( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 )], [( 0, 1, 2 )] )
> # doubles, an unsigned list, a face first
> HEAD = """comment a b c\nobj_info d\nelement strip 2\nproperty list ushort short rows\nelement face 2\nproperty uchar flag\nproperty list uchar uint vertex_indices
> property list int float weights\nelement vertex 4\nproperty char z\nproperty list uchar double extra\nproperty double x\nproperty short y\nelement end 1\nproperty int last\nend_header\n"""
> POINTS = [( 0.5, -2, 1 ), ( 1, 300, -1 ), ( -4, 0, 0 ), ( 8, 1, 127 )]
> ROWS = "2 7 -7\n0\n1 3 0 1 2 0\n\n9 4 3 2 1 0 2 0.5 1e3\n1 0 .5 -2\r\n-1 1 3.5 1 300\n0 0 -4.0 0\n  127 2 1 2 8 1 \n42"
> files = [( "ply\r\nformat ascii 1.0\r\n" + HEAD + ROWS ).encode()]
> for order, mark in ( "little", "<" ), ( "big", ">" ):
>     rows = struct.pack( mark + "H2hH2B3Ii2B4Ii2f", 2, 7, -7, 0, 1, 3, 0, 1, 2, 0, 9, 4, 3, 2, 1, 0, 2, 0.5, 1e3 )
>     rows += b"".join( struct.pack( mark + "bB%dddh" % ( v == 1 ), z, v == 1, *[3.5] * ( v == 1 ), x, y ) for v, ( x, y, z ) in enumerate( POINTS ) ) + struct.pack( mark + "i", 42 )
>     files.append( f"ply\nformat binary_{order}_endian 1.0\n{HEAD}".encode() + rows )
> for file in files:
>     assert read( file, "m.ply" ) == ( POINTS, [( 0, 1, 2 ), ( 3, 2, 1 ), ( 3, 1, 0 )] )
> END

# Colours, texture coordinates and what was missing are described.
$ printf 'v 0 0 0 .25 0 1\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 .5\nvt 2 3\nf 1/1 2/1 3/2\nf 1/2 2/1 4\n' >coloured.obj; wisp info coloured.obj | sed -n '/colours/,/coordinates, which/p'
  colours              red 0.25 .. 1, green 0 .. 1, blue 1 .. 1
  note: vertices without a colour, which are white: 3
  texture coordinates  u 0 .. 2, v 0 .. 3
  note: vertices with several texture coordinates, of which the first are kept: 1
  note: vertices without texture coordinates, which are at (0, 0): 1

# The first scanned mesh is one closed sound shell.
$ wisp info "$SOURCE/data/bunny.obj"
...bunny.obj: closed mesh of triangles
  vertices             1839
  triangles            3674
  edges                5511
  Euler characteristic 2
  bounds               x -4.95848 .. 4.94885, y -0.003149 .. 9.65475, z -3.72983 .. 3.81064 m
  edge length          min 0.179109, mean 0.382707, max 1.01449 m
  area                 218.689 m^2
  volume               194.288 m^3
  components           1
  no defects

# Every defect has its count and its first elements.
$ python3 <<'END'
> from meshes import *
> points, triangles = TETRAHEDRON
> def says( text, *blocks ):
>     assert all( block in text for block in blocks ), text
> # powers of two: the shifted floats are exact
> says( info( [( x + 1048576, y - 2097152, z ) for x, y, z in points], triangles ), "volume               0.166667 m^3\n", "no defects" )
> says( info( points, [triangles[0], turned( triangles[1] ), *triangles[2:]] ), "closed mesh", "wrong: edges along which the winding disagrees: 3\n    edge of vertices 0 and 1\n" )
> inside = info( points, [turned( t ) for t in triangles] )
> says( inside, "  wrong: components turned inside out: 1\n    component 0\n", "volume               -0.166667 m^3\n" )
> assert "the winding" not in inside
> says( info( [( 0, 0, 0 ), ( 0, 1, 0 ), ( 1, 0, 0 ), ( 0, 0, 1 ), ( -1, 0, 0 )], [( 0, 1, 2 ), ( 1, 0, 3 ), ( 0, 1, 4 )] ),
>     "wrong: edges of more than two triangles: 1\n    edge of vertices 0 and 1\n", "open edges: 6 in", "components           1\n" )
> two = [*points, ( 2, 0, 1 ), ( 0, 2, 1 ), ( 0, 0, 3 )], [*triangles, ( 3, 5, 4 ), ( 3, 4, 6 ), ( 3, 6, 5 ), ( 4, 5, 6 )]
> text = info( *two )
> says( text, "vertex 3, fans 2\n", "components           2\n", "volume               1.5 m^3\n" )
> assert "more than two triangles" not in text
> assert refusal( *two, "require: [one_component]" ) == "m.obj: got 2 components, expected one; the second starts with triangle 4"
> assert refusal( *two, "require: [manifold]" ).endswith( ": 1, the first is vertex 3, fans 2" )
> assert refusal( points, triangles[:3], "require: [closed]" ) == "m.obj: open edges: 3, the first is edge of vertices 1 and 2"
> write( *TETRAHEDRON )
> run( scene( "require: [closed, oriented, manifold, clean, one_component]" ) )
> says( info( points, [*triangles, ( 3, 1, 0 ), ( 2, 0, 1 )] ), "wrong: duplicate triangles: 2\n    triangle 4, as triangle 1\n    triangle 5, as triangle 0\n" )
> # vertex 3 is in the middle of 0 and 1, and vertex 6 a little off its line by rounding; a triangle that names a vertex twice belongs to no component
> says( info( [( 0, 0, 0 ), ( 2, 0, 0 ), ( 0, 1, 0 ), ( 1, 0, 0 ), ( 5, 5, 5 ), ( 3, 0.3, 0.9 ), ( 1, 0.1, 0.3 ), ( 7, 0.7, 2.1 )], [( 0, 1, 2 ), ( 0, 3, 1 ), ( 2, 2, 1 ), ( 5, 6, 7 )] ),
>     "wrong: triangles without area: 3\n    triangle 1\n    triangle 2\n    triangle 3\n", "wrong: unreferenced vertices: 1\n    vertex 4\n", "components           2\n" )
> many = info( points + [( 0, 0, 0 )] * 100, triangles )
> says( many, "unreferenced vertices: 100\n    vertex 4\n", "    vertex 11\n    and 92 more\n" )
> huge = info( [tuple( ( 2 * c - 1 ) * 3.4e38 for c in p ) for p in points], triangles )
> assert "without area" not in huge and not re.search( r"\b(inf|nan)\b", huge ) and re.search( r"volume +[1-9]", huge )
> # pairwise comparison of the triangles around one edge would take hours
> fan = [( 0, 0, 0 ), ( 0, 1, 0 )] + [( 1 + t, 0.5, t % 7 ) for t in range( 100000 )], [( 0, 1, t + 2 ) for t in range( 100000 )]
> says( info( *fan ), "edges of more than two triangles: 1\n    edge of vertices 0 and 1\n", "open edges: 200000 in 1 loop\n" )
> assert len( repaired( *fan, *ALL )[0] ) == 100002
> END

# A sound mesh is changed by no repair. Winding is repaired outwards, component by component, whatever was turned; an open mesh keeps that of most of its triangles, also
# where the flood starts with another one. Tents over one triangle share its sides, but none is closed, so each goes on facing the way of its triangles.
$ python3 <<'END'
> from meshes import *
> assert repaired( *TETRAHEDRON, *ALL ) == ( *TETRAHEDRON, [] )
> def made( recipe ):
>     body = run( f"surfaces:\n  - {{ name: m, generate: {{ {recipe} }} }}\n" )[0]["m"]
>     return body.frames[0], list( zip( *[iter( body.numbers )] * 3 ) )
> points, triangles = made( "shape: torus" )
> for is_turned in lambda t: t % 3 != 0, lambda t: t % 5 == 0, lambda t: True:
>     count = sum( map( is_turned, range( len( triangles ) ) ) )
>     assert repaired( points, [turned( corners ) if is_turned( t ) else corners for t, corners in enumerate( triangles )], "winding" ) == (
>         points, triangles, [f"{count} triangles were turned over"] )
> points, triangles = made( "shape: alternating_plane" )
> assert repaired( points, [turned( t ) for t in triangles[:700]] + triangles[700:], "winding" ) == ( points, triangles, ["700 triangles were turned over"] )
> # two tetrahedra on the edge 0-1, the second one reversed
> points = TETRAHEDRON[0] + [( 0, -1, 0 ), ( 0, 0, -1 )]
> second = [( 0, 1, 4 ), ( 0, 5, 1 ), ( 0, 4, 5 ), ( 1, 5, 4 )]
> assert repaired( points, TETRAHEDRON[1] + second, "winding" )[1:] == ( TETRAHEDRON[1] + [turned( t ) for t in second], ["4 triangles were turned over"] )
> tents = [t for top in range( 3, 7 ) for t in ( ( 1, 0, top ), ( 2, 1, top ), ( 0, 2, top ) )]
> assert repaired( [( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 )] + [( 0.3, 0.3, 1 + f ) for f in range( 4 )], tents, "winding" )[1:] == ( tents, [] )
> # the last part of a strip is joined to the first one with reversed winding
> strip = [p for i in range( 5 ) for p in ( ( i, 0, i * i ), ( i, 1, i * i ) )], [
>     t for i in range( 5 ) for a, b in [( 2 * i + 2, 2 * i + 3 ) if i < 4 else ( 1, 0 )] for t in ( ( 2 * i, a, b ), ( 2 * i, b, 2 * i + 1 ) )]
> text = info( *strip )
> assert "the winding disagrees: 1\n    edge of vertices 0 and 1\n" in text and "in 1 loop" in text and "Euler characteristic 0\n" in text
> message = refusal( *strip, "repair: [winding]" )
> assert "one-sided: triangles" in message and "along the edge of vertices" in message
> END

# What is not asked for is not repaired, and what is keeps its order. Vertices 0 and 5 belong to no triangle, triangle 1 repeats the first one, and triangle 3 names a
# vertex twice.
$ python3 <<'END'
> from meshes import *
> points = [( 9, 9, 9 ), *TETRAHEDRON[0], ( 8, 8, 8 )]
> triangles = [( 1, 3, 2 ), ( 2, 3, 1 ), ( 1, 2, 4 ), ( 4, 4, 1 ), ( 1, 4, 3 ), ( 2, 4, 3 )]
> SAID = { "degenerates": "1 triangle without area was removed", "duplicates": "1 duplicate triangle was removed", "winding": "1 triangle was turned over",
>          "unreferenced": "2 unreferenced vertices were removed" }
> for words in ["degenerates"], ["duplicates"], ["unreferenced"], ["duplicates", "winding"], list( ALL ):
>     p, t, said = repaired( points, [t for t in triangles if len( set( t ) ) == 3 or "degenerates" in words], *words ) # a world has none without area
>     assert said == [SAID[word] for word in words], said
>     assert len( t ) == 5 - ( "duplicates" in words ) and len( p ) == ( 4 if "unreferenced" in words else 6 )
> assert ( p, t ) == TETRAHEDRON
> text = info( points, triangles[:5] )
> assert all( block in text for block in ( "open mesh", "  note: open edges: 2 in 1 loop\n    edge of vertices 2 and 4\n", "duplicate triangles: 1\n    triangle 1, as triangle 0\n",
>     "without area: 1\n    triangle 3\n", "unreferenced vertices: 2\n    vertex 0\n    vertex 5\n" ) ) and "no defects" not in text
> faults = TETRAHEDRON[0], [( 0, 0, 1 ), ( 2, 2, 2 )]
> assert refusal( *faults, "repair: [degenerates]" ).endswith( "the repair removes all 2 triangles" ) and "components           0\n" in info( *faults )
> p, t, said = repaired( *TETRAHEDRON, "flip" )
> assert p == TETRAHEDRON[0] and "volume               -0.166667 m^3" in info( p, t ) and said == ["4 triangles were flipped"] and repaired( p, t, "flip" )[1] == TETRAHEDRON[1]
> END

# Welded vertices become the lowest one before them that stays and is near, as a comparison of all pairs finds: from few that are near to crowds, and stretched along an
# axis, so that most cells of the search have neighbours along z. A chain does not drift together; what is as far as the distance is near.
$ python3 <<'END'
> from meshes import *
> import random
> def welded( points, distance ):
>     became = []
>     for v, p in enumerate( points ):
>         became.append( next( ( w for w in range( v ) if became[w] == w and sum( ( a - b ) ** 2 for a, b in zip( points[w], p ) ) <= distance * distance ), v ) )
>     stay = [v for v in range( len( points ) ) if became[v] == v]
>     return stay, [stay.index( w ) for w in became]
> def check( points, triangles, distance ):
>     points = [tuple( array.array( "f", p ) ) for p in points]
>     stay, became = welded( points, array.array( "f", [distance] )[0] )
>     kept = [t for t in ( tuple( became[v] for v in t ) for t in triangles ) if len( set( t ) ) == 3]
>     p, t, said = repaired( points, triangles, "weld", keys=f", weld_distance: {distance}" )
>     count, collapsed = len( points ) - len( stay ), len( triangles ) - len( kept )
>     assert p == [points[v] for v in stay] and t == kept and count > 0
>     assert said[0].startswith( f"{count} vert" ) and ( collapsed == 0 or said[1].startswith( f"{collapsed} triangle" ) ) and len( said ) == 1 + ( collapsed > 0 )
>     return became
> for i, ( distance, stretch ) in enumerate( [( 0.04, 1 ), ( 0.1, 1 ), ( 0.4, 1 ), ( 0.02, 0 ), ( 0.1, 100 )] ):
>     draw = random.Random( i )
>     check( [( stretch * draw.random() - 0.3, draw.random(), draw.random() ) for v in range( 900 )], [( t, t + 1, t + 2 ) for t in range( 898 )], distance )
> assert check( [( 0, 0, 0 ), ( 0.8, 0, 0 ), ( 1.6, 0, 0 ), ( 2.4, 0, 0 ), ( 0, 5, 0 )], [( 0, 2, 4 ), ( 1, 3, 4 ), ( 0, 1, 4 )], 1 ) == [0, 0, 1, 1, 2]
> assert check( [( 0, 0, 0 ), ( 0.5, 0, 0 ), ( 1, 0, 0 ), ( 0, 5, 0 )], [( 0, 2, 3 ), ( 1, 2, 3 )], 0.5 ) == [0, 0, 1, 2]
> # triangles with corners of their own, as a renderer has them, and rounded; the usual distance is a hundred-thousandth of the size
> corners = [v for t in TETRAHEDRON[1] for v in t]
> for noise, is_closed in ( 1e-6, True ), ( 1e-4, False ):
>     split = [( TETRAHEDRON[0][v][0] + noise * ( c % 3 ), *TETRAHEDRON[0][v][1:] ) for c, v in enumerate( corners )], [( c, c + 1, c + 2 ) for c in range( 0, 12, 3 )]
>     text = info( *split )
>     assert "open mesh" in text and ( "  note: vertices that the repair `weld` merges into others: 8\n" in text ) == is_closed
>     if is_closed:
>         p, t, said = repaired( *split, "weld" )
>         assert "closed mesh" in info( p, t ) and said == ["8 vertices were merged into others"]
> # other repairs find the welded mesh: the same triangle twice with corners of its own, one that names a vertex twice from the start, a vertex of none
> p, t, said = repaired( [( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 ), ( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 ), ( 7, 7, 7 ), ( 1, 1, 0 )],
>     [( 0, 1, 2 ), ( 3, 4, 5 ), ( 1, 1, 7 ), ( 1, 7, 2 )], "weld", *ALL )
> assert p == [( 0, 0, 0 ), ( 1, 0, 0 ), ( 0, 1, 0 ), ( 1, 1, 0 )] and t == [( 0, 1, 2 ), ( 1, 3, 2 )] and said == [
>     "3 vertices were merged into others", "1 triangle without area was removed", "1 duplicate triangle was removed", "1 unreferenced vertex was removed"]
> assert refusal( *TETRAHEDRON, "repair: [weld], weld_distance: 10" ).endswith( "the repair removes all 4 triangles" )
> assert "expected at least a billionth of its size" in refusal( [tuple( 1e5 * c for c in p ) for p in TETRAHEDRON[0]], TETRAHEDRON[1], "repair: [weld], weld_distance: 1e-5" )
> largest = 3.40282347e38
> assert "merges into others: 1\n" in info( [( -largest, 0, 0 ), ( largest, 0, 0 ), ( 0, largest, 0 ), ( 0, largest, 0 )], [( 0, 1, 2 ), ( 1, 0, 3 )] )
> END

# Hair has counts, bounds and lengths, and what is wrong with it is named by strand and vertex.
$ python3 -c 'from files import *; write_hair( "head.hair", [3, 2], [0, 0, 0, 0, -1, 0, 0, -2, 0, 3, 0, 0, 3, 0, 4], [0.5, 0.5, 0.5, 0.25, 0.25] )'; wisp info head.hair
head.hair: groom in 3 dimensions
  strands              2
  vertices             5
  vertices a strand    min 2, mean 2.5, max 3
  bounds               x 0 .. 3, y -2 .. 0, z 0 .. 4 m
  length               min 2, mean 3, max 4 m
  thickness            min 0.25, mean 0.4, max 0.5 m
  colour               none
  no defects

# A file that starts with HAIR is hair, whatever it is called. Strands without a list of segments have those of the header, which a list overrules, and what is not there
# is not described. A z of -0 is one of 0: two dimensions.
$ python3 <<'END'
> from files import *
> open( "d.bin", "wb" ).write( struct.pack( "<4s4I108x18f", b"HAIR", 2, 6, 2, 2, *[c for v in range( 6 ) for c in ( v, v + 1, -0.0 )] ) )
> open( "l.bin", "wb" ).write( struct.pack( "<4s4I108x2H9f", b"HAIR", 2, 3, 3, 77, 1, 0, *range( 9 ) ) )
> bodies, said = run( "strands:\n  - { name: d, file: d.bin }\n  - { name: l, file: l.bin }\n" )
> assert bodies["d"].numbers == ( 0, 3, 6 ) and bodies["l"].numbers == ( 0, 2, 3 ) and bodies["l"].frames[0] == [( 0, 1, 2 ), ( 3, 4, 5 ), ( 6, 7, 8 )]
> END
$ wisp info d.bin
d.bin: groom in 2 dimensions
  strands              2
  vertices             6
  vertices a strand    min 3, mean 3, max 3
  bounds               x 0 .. 5, y 1 .. 6, z -0 .. -0 m
  length               min 2.82843, mean 2.82843, max 2.82843 m
  colour               none
  no defects

$ python3 <<'END'
> from files import *
> def says( *blocks, **arrays ):
>     write_hair( "h.hair", **arrays )
>     text = subprocess.run( [os.environ["WISP"], "info", "h.hair"], capture_output=True, text=True ).stdout
>     assert all( block in text for block in blocks ) and ( "no defects" in text ) == ( "wrong" not in text ), text
>     return text
> # a strand without a segment, the root of strand 0 again and a segment of zero length, impossible coordinates
> says( "  wrong: segments of zero length: 1\n    strand 2, from vertex 1\n", "  wrong: strands without a segment: 1\n    strand 1, vertices 1\n",
>     "  wrong: strands that repeat a root: 1\n    strand 2, the root of strand 0\n", "  wrong: vertices beyond 1e+06 m: 1\n    strand 3, vertex 1\n",
>     sizes=[2, 1, 3, 2], points=[1, 0, 0, 1, 1, 0, 5, 0, 0, 1, 0, 0, 2, 2, 0, 2, 2, 0, 7, 0, 0, 0, -2e6, 0] )
> says( "  note: 1 of the segments are below 10 um or a hundredth of their strand's mean, the shortest 1 um (strand 0, vertex 1)\n",
>     sizes=[4, 2], points=[0, 0, 0, 0, -0.01, 0, 0, -0.010001, 0, 0, -0.02, 0, 1, -0.0001, 0, 1, 0, 0] )
> # the first of thirteen does not repeat a root, the others repeat its
> text = says( "segments of zero length: 13\n    strand 0, from vertex 0\n", "    strand 9, from vertex 0\n    and 3 more\n",
>     "repeat a root: 12\n    strand 1, the root of strand 0\n", "    strand 10, the root of strand 0\n    and 2 more\n", sizes=[2] * 13, points=[0.5, 0.25, 0] * 26 )
> assert "strand 10, from vertex" not in text
> says( "  wrong: groom: strand 0, vertex 1: transparency: got 7, expected 0 .. 1\n", sizes=[2], points=[0, 0, 0, 0, -1, 0], transparency=[0, 7] )
> END
