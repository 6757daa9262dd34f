# Recordings of a run: formats, frames, values, tracks, verification; boundary points.
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

# Info tells what is in a recording and what is wrong with it: a cut is no error, damage is, and the first ten damaged frames are named. A header is 40 + 16 + 8 + 12 + 8
# bytes here, a frame 40 + 36 + 8.
$ cp "$SOURCE/tests/app/transcripts/files.py" .; python3 <<'END'
> from files import *
> def sail( name, count ):
>     record( name, [[0, 0, 0, 1, 0, 0, 0, 2 + f, -0.5] for f in range( count )], [0, 1, 2], 0.5 )
>     for f in range( 1, count ):
>         change_frame( name, f, lambda frame: frame[:32] + b"\x09" + frame[33:] ) # the hash of the world
> sail( "sail.wisp", 3 )
> data = open( "sail.wisp", "rb" ).read()
> open( "cut.wisp", "wb" ).write( data[:84 + 84 + 30] )
> open( "begun.wisp", "wb" ).write( data[:84] )
> sail( "many.wisp", 14 )
> data = bytearray( open( "many.wisp", "rb" ).read() )
> for f in range( 1, 14 ):
>     data[84 + 84 * f + 50] ^= 4
> open( "many.wisp", "wb" ).write( data )
> END
$ wisp info sail.wisp
sail.wisp: recording of 3 frames
  step                 0.5 s
  time                 0 .. 1 s
  frame                84 bytes
  hash of the world    of 2 frames
  bodies               1
    sheet              1 triangles, 3 vertices, x 0 .. 1, y 0 .. 4, z -0.5 .. 0 m
  no defects
$ wisp info cut.wisp
cut.wisp: recording of 1 frames
...
  wrong: the recording was cut: 30 bytes from byte 168 on are not a whole frame
$ wisp info begun.wisp
begun.wisp: recording of 0 frames
...
  wrong: the recording was not finished: the mark of the end is missing at byte 84
$ wisp info many.wisp | sed -n '3p; /wrong/p' | sed -n '1,2p; 11,12p'; wisp info many.wisp >/dev/null
  time                 0 .. 0 s
  wrong: many.wisp: frame 1 at byte 168 is damaged: its checksum does not match its bytes
  wrong: many.wisp: frame 10 at byte 924 is damaged: its checksum does not match its bytes
  wrong: and 3 more frames
! wisp: many.wisp: frame 1 at byte 168 is damaged: its checksum does not match its bytes
! wisp: many.wisp: frame 1 at byte 168 is damaged: its checksum does not match its bytes
[2]
$ wisp info a.pc2
a.pc2: point cache of 4 frames
  frames               from 0, every 1
  points               800, x ...
  no defects

# A recording has the start and every nth step with the hash of its world; a step is a float of 1/60 s.
$ wisp run hair.yaml --steps 7 --every 3 --record nth.wisp >/dev/null
$ wisp info nth.wisp
...3 frames...
$ python3 <<'END'
> from files import *
> ( hair, ), times = wisp_recording.read( "nth.wisp" )
> assert hair.name == "hair" and hair.is_strands and len( hair.numbers ) == 41 and len( times ) == 3 and all( hashes( "nth.wisp" ) )
> assert all( abs( time - 3 * f / 60 ) < 1e-7 * ( f + 1 ) for f, time in enumerate( times ) )
> END

# Frames between steps pass through the steps, where no world was in between, and ghosts turn no corner there: they are once continuously differentiable, so the
# change of velocity at a step falls with the distance of frames. On straight lines, which the guides move along, it stays. A scene has such frames too, and an
# option has the last word.
$ cat >ghosts.yaml <<'END'
> wisp: 1
> steps: 12
> substeps: 4
> strands:
>   - name: guides
>     generate: { strands: 3, vertices: 8, length: 0.2, seed: 3 }
>     dynamics: {}
>     head: { keyframes: [ { time: 0.08, position: [0.03, 0, 0] }, { time: 0.2, position: [0, 0, 0] } ] }
>   - name: ghosts
>     scatter: { around: guides, count: 4, radius: 0.008 }
>     ghosts: {}
> END
$ sed 's/^wisp: 1/&\nframes_per_step: 4/' ghosts.yaml >written.yaml
$ for n in 1 4 16 32; do wisp run ghosts.yaml --record $n.wisp --frames-per-step $n; done >/dev/null
$ wisp run written.yaml --record written.wisp >/dev/null; wisp run written.yaml --record again.wisp --frames-per-step 1 >/dev/null; cmp 4.wisp written.wisp; cmp 1.wisp again.wisp
$ python3 <<'END'
> from files import *
> runs = {}
> for n in 1, 4, 16, 32:
>     bodies, times = wisp_recording.read( f"{n}.wisp" )
>     assert len( times ) == 12 * n + 1 and all( abs( time - f / ( 60 * n ) ) < 1e-6 for f, time in enumerate( times ) )
>     assert all( ( hash != 0 ) == ( f % n == 0 ) for f, hash in enumerate( hashes( f"{n}.wisp" ) ) )
>     runs[n] = bodies
> for k in 0, 1:
>     assert all( runs[16][k].frames[16 * step] == runs[1][k].frames[step] for step in range( 13 ) )
> def corner( n, k ): # the largest change of velocity from the frame before a step to the frame after it, m per step
>     changes = []
>     for f in range( 2 * n, 12 * n, n ):
>         a, b, c = runs[n][k].frames[f - 1:f + 2]
>         turns = [after + before - 2 * at for before, at, after in zip( a, b, c )]
>         changes += [sum( x * x for x in turns[i:i + 3] ) ** 0.5 for i in range( 0, len( turns ), 3 )]
>     return n * max( changes )
> assert corner( 16, 1 ) > 1e-4 and corner( 32, 1 ) < 0.6 * corner( 16, 1 )
> assert corner( 32, 0 ) > 0.95 * corner( 16, 0 ) and corner( 32, 1 ) < 0.2 * corner( 32, 0 )
> END

# Tracks are the points of the recording: nine digits restore every float.
$ wisp run hair.yaml --record t.wisp --track hair:19,0 --track hair:7 --track-file t.csv
...t.csv: 3 vertices over 4 frames...
$ head -n 1 t.csv
time,hair.19.x,hair.19.y,hair.19.z,hair.0.x...
$ python3 <<'END'
> from files import *
> ( hair, ), times = wisp_recording.read( "t.wisp" )
> rows = [array.array( "f", map( float, line.split( "," ) ) ) for line in open( "t.csv" ).readlines()[1:]]
> assert len( rows ) == 4 and hair.vertices == 800
> for row, points in zip( rows, hair.frames ):
>     assert row[1:] == points[57:60] + points[0:3] + points[21:24]
> END

# A difference of one bit is named by frame, body and vertex.
$ cp proof.wisp off.wisp; python3 <<'END'
> from files import *
> def flip( frame ):
>     frame[40 + 12 * 123 + 4] ^= 1
>     return frame
> change_frame( "off.wisp", 2, flip )
> END
> wisp run hair.yaml --verify off.wisp
! wisp: off.wisp: frame 2 ...hair differs at vertex 123: ...
[2]

# A damaged recording is neither described nor drawn.
$ python3 -c 'data = bytearray( open( "proof.wisp", "rb" ).read() ); data[-200] ^= 1; open( "damaged.wisp", "wb" ).write( data )'
$ wisp info damaged.wisp
...
! wisp: ...frame 3...
[2]
$ wisp render damaged.wisp -o damaged.png
! wisp: ...frame 3...
[2]
$ test ! -e damaged.png

# Files of boundary points hold the vertices, which have no element, and behind them the points with unit normals, those of 480 edges first and then those of 320
# triangles, on which they lie. The middle of a triangle of level 2, 0.18 rad from its corners, lies 1.7 % below them.
$ printf 'wisp: 1\nsteps: 4\nsubsteps: 4\nsurfaces:\n  - name: ball\n    generate: { shape: icosphere, level: 2, radius: 0.2 }\n' >ball.yaml
> printf '    balloon: { gas_ratio: 1.2, buoyancy: false }\n    boundary: { spacing: 0.015 }\n' >>ball.yaml
$ wisp run ball.yaml --boundary layer.ply --record layer.wisp --every 2 >told; grep -o 'boundary points written: .*' told; ls layer*
boundary points written: 2 files, the last is layer_0003.ply...
layer_0002.ply
layer_0003.ply
$ python3 <<'END'
> from files import *
> import re
> header, data = open( "layer_0003.ply", "rb" ).read().split( b"end_header\n", 1 )
> count = int( re.search( rb"element vertex (\d+)", header )[1] )
> assert count == 162 + int( re.search( r"ball: (\d+)", open( "told" ).read() )[1] ) > 2 * 162 and b"element face 320\n" in header
> rows = list( struct.iter_unpack( "<6fi", data[:28 * count] ) )
> norm = lambda v: sum( c * c for c in v ) ** 0.5
> radii = [norm( row[:3] ) for row in rows]
> assert all( 0.97 * min( radii[:162] ) < r <= max( radii[:162] ) for r in radii[162:] )
> assert all( abs( norm( row[3:6] ) - 1 ) < 1e-6 for row in rows ) # roundings of floats
> elements = [row[6] for row in rows]
> assert set( elements[:162] ) == { -1 } and elements[162:] == sorted( elements[162:] ) and 0 <= elements[162] and 480 <= elements[-1] < 800
> assert header.endswith( b"".join( b"property float %s\n" % name for name in b"x y z nx ny nz".split() ) + b"property int element\nelement face 320\n"
>     b"property list uchar int vertex_indices\nelement edge 480\nproperty int vertex1\nproperty int vertex2\n" )
> ball, points = Body( wisp_recording.read( "layer.wisp" )[0][0] ), [row[:3] for row in rows]
> faces, edges = list( struct.iter_unpack( "<B3i", data[28 * count:-8 * 480] ) ), list( struct.iter_unpack( "<2i", data[-8 * 480:] ) )
> assert points[:162] == ball.frames[2] and faces == [( 3, *corners ) for corners in zip( *[iter( ball.numbers )] * 3 )]
> assert { frozenset( edge ) for edge in edges } == { frozenset( ( t[i], t[j] ) ) for t in faces for i, j in ( ( 1, 2 ), ( 2, 3 ), ( 3, 1 ) ) }
> def volume( p, corners ): # of the tetrahedron on a triangle, or the area of the triangle on an edge
>     a, b, *c = [[x - y for x, y in zip( points[v], p )] for v in corners]
>     n = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
>     return norm( n ) if not c else abs( sum( x * y for x, y in zip( n, c[0] ) ) )
> # corners are 0.1 m apart at most, and floats of 0.2 m are rounded by 7e-9 m
> assert all( volume( p, ( edges + [f[1:] for f in faces] )[e] ) < 1e-8 for p, e in zip( points[162:], elements[162:] ) )
> END
$ wisp info layer_0003.ply
...unreferenced vertices...
