# Results in every format are read back by readers of other people, with the names that are hard for a format, and compared.
$ printf 'wisp: 1\nsteps: 5\nsurfaces:\n  - { name: flag, generate: { shape: plane, columns: 5, rows: 5 }, pins: [0], cloth: {} }\n' >'a, "b|c" [1,2].yaml'
> printf 'wisp_suite: 1\nreference: { set: { substeps: 20 }, check: { substeps: 15 } }\nscenes:\n  - { file: "a, \\"b|c\\" [1,2].yaml", name: flag, set: { substeps: 4 } }\n' >suite.yaml
> cat >results.py <<'END'
> import csv, io, json, os, re, subprocess, sys
> def wisp( *words, status=0 ):
>     done = subprocess.run( [os.environ["WISP"], *words], capture_output=True )
>     assert done.returncode == status, done
>     return ( done.stderr if status else done.stdout ).decode()
> def once( pairs ):
>     assert len( pairs ) == len( dict( pairs ) )
>     return dict( pairs )
> NAME = 'a, "b|c" [1,2].yaml'
> END

# JSON has the keys of its schema, and lists of numbers are a line each. A median is that of the samples. Nothing known is null, and text that is not UTF-8 is said to be so.
$ python3 <<'END'
> from results import *
> text = wisp( "run", NAME, "--workers", "2", "-f", "json" )
> root = json.loads( text, object_pairs_hook=once, parse_constant=lambda word: 1 / 0 )
> [row] = root["rows"]
> assert root["wisp_results"] == 2 and set( root ) == { "wisp_results", "date", "options", "machine", "build", "rows", "notes" }
> assert set( root["machine"] ) == { "cpu", "cores", "memory_bytes", "os", "isa", "cpu_flags" } and set( root["build"] ) == { "version", "commit", "compiler", "flags", "type" }
> assert set( row ) == set( "case variant size workers ms_median ms_p10 ms_p90 fps steps stages error hash samples_ms cpu_fraction".split() )
> samples = row["samples_ms"]
> assert row["case"] == NAME and row["workers"] == 2 and row["steps"] == len( samples ) == 5 and abs( row["ms_median"] - sorted( samples )[2] ) < 1e-6
> assert f'"samples_ms": [{", ".join( "%.9g" % x for x in samples )}],\n' in text and "[1,2]" in text
> assert row["error"] is None and re.fullmatch( "[0-9a-f]{16}", row["hash"] ) and f"hash: {row['hash']}" in root["notes"] and abs( row["fps"] * row["ms_median"] - 1000 ) < 1e-4
> assert row["size"]["vertices"] == 25 and isinstance( row["size"]["vertices"], int ) and all( value >= 0 for value in row["stages"].values() )
> os.rename( NAME, b"\xff\xfe.yaml" )
> assert json.loads( wisp( "run", b"\xff\xfe.yaml", "-f", "json" ) )["rows"][0]["case"] == "(not UTF-8)"
> os.rename( b"\xff\xfe.yaml", NAME )
> END

# CSV has a line a row and the same columns in each, with the numbers of JSON; what a row does not have is empty. A summary goes to a file that `wisp info` takes.
$ python3 <<'END'
> from results import *
> wisp( "bench", "suite.yaml", "--seconds", "0.1", "-f", "json", "-o", "all.json" )
> assert "results, " in wisp( "info", "all.json" )
> rows = json.load( open( "all.json" ) )["rows"]
> text = wisp( "bench", "suite.yaml", "--seconds", "0.1", "-f", "csv" )
> assert text.count( "\r\n" ) == text.count( "\n" ) == 1 + len( rows )
> table = list( csv.DictReader( io.StringIO( text ), strict=True ) )
> def numbers( row ):
>     return { f"{group}.{key}": value for group in ( "size", "stages", "error" ) for key, value in ( row[group] or {} ).items() if key != "against" }
> names = { key for row in rows for key in numbers( row ) }
> assert any( row["error"] for row in rows ) and all( set( line ) == names | set( "case variant workers ms_median ms_p10 ms_p90 fps steps hash error.against".split() ) for line in table )
> for row, line in zip( rows, table, strict=True ):
>     assert [line["case"], line["variant"], line["hash"], line["workers"]] == [row["case"], row["variant"], row["hash"] or "", str( row["workers"] )]
>     found = numbers( row )
>     assert all( ( line[key] != "" ) == ( found.get( key ) is not None ) for key in names )
>     assert all( float( line[key] ) == found[key] for key in found if key.startswith( "error" ) and found[key] is not None )
> line = list( csv.reader( io.StringIO( wisp( "run", NAME, "-f", "csv" ) ), strict=True ) )[1]
> assert line[0] == NAME
> END

# Markdown escapes the bar that would end a cell; text has numbers to the right and names to the left, and no colours.
$ wisp run 'a, "b|c" [1,2].yaml' -f markdown | grep '^| scene\|^| pass' 
| scene | a, "b\|c" [1,2].yaml |
| pass | items | ms | % |
$ wisp run 'a, "b|c" [1,2].yaml' -v >told; python3 <<'END'
> lines = open( "told" ).read().split( "\n" )
> at = next( i for i, line in enumerate( lines ) if line.startswith( "part  " ) )
> rows, of, end = lines[at + 3:lines.index( "", at )], lines[at].index( "of" ), lines[at].index( "KiB" ) + 3
> assert "\033" not in "".join( lines ) and len( rows ) > 3 and rows[0][:6] == "world " and rows[0][of:of + 6] == "engine"
> assert all( row[end - 1].isdigit() and row[end] == " " and row[0] != " " and len( row ) == len( rows[0] ) for row in rows )
> END

# What cannot be written is an error in every format that names the file.
$ python3 <<'END'
> from results import *
> for name in "text", "markdown", "csv", "json", "latex":
>     if os.path.exists( "/dev/full" ):
>         assert "/dev/full" in wisp( "run", NAME, "-f", name, "-o", "/dev/full", status=2 ), name
>     assert "no such folder/out.txt" in wisp( "run", NAME, "-f", name, "-o", "no such folder/out.txt", status=2 )
> END

# A file that is no result of ours is refused by what is wrong.
$ python3 <<'END'
> from results import *
> ROW = { "case": "a", "variant": "b", "size": {}, "workers": 1, "ms_median": 1, "ms_p10": None, "ms_p90": None, "fps": None, "steps": 1, "stages": {}, "error": None, "hash": None }
> def of( *rows, **keys ):
>     return json.dumps( { "wisp_results": 1, "machine": {}, "build": {}, "rows": rows, **keys } )
> def info( text, status=2 ):
>     open( "x.json", "w" ).write( text )
>     return wisp( "info", "x.json", status=status )
> for text, named in [( '{"wisp_results":1,', "1:" ), ( of( wisp_results=3 ), "wisp_results" ), ( '{"wisp_results":1,"build":{},"rows":[]}', "machine" ),
>                     ( '{"wisp_results":1,"machine":{},"build":{}}', "rows" ), ( of( 3 ), "rows[0]" ), ( of( {} ), "rows[0].case" ), ( of( { **ROW, "ms_median": "fast" } ), "rows[0].ms_median" ),
>                     ( of( { **ROW, "ms_median": -1 } ), "rows[0].ms_median" ), ( of( ROW, { **ROW, "workers": 1.5 } ), "rows[1].workers" ), ( of( { **ROW, "hash": "xyz" } ), "rows[0].hash" ),
>                     ( of( { **ROW, "samples_ms": [1, -1] } ), "rows[0].samples_ms" ), ( of( ROW )[:-1] + ', "rows": []}', "duplicate" )]:
>     assert named in info( text ), named
> info( of( ROW ), 0 )
> END

# Two files are compared: a time counts if its change is large and certain, on one processor; bits and errors as they stand.
$ python3 <<'END'
> from results import *
> def write( path, factor=1, error=0.01, bits=1, cpu="A" ):
>     samples = [factor * ( 1 + 0.01 * ( i * 7 % 13 ) ) for i in range( 40 )]
>     common = { "case": "flag", "size": { "vertices": 100 }, "workers": 1, "stages": {}, "fps": None }
>     timed = { **common, "variant": "run", "ms_median": sorted( samples )[20], "ms_p10": samples[0], "ms_p90": samples[1], "steps": 40, "samples_ms": samples,
>               "error": { "rms_m": error, "against": "truth" }, "hash": "%016x" % bits }
>     source = { **common, "variant": "source", "ms_median": 5 * factor, "ms_p10": None, "ms_p90": None, "steps": 1, "error": None, "hash": None }
>     json.dump( { "wisp_results": 2, "machine": { "cpu": cpu }, "build": {}, "rows": [timed, source] }, open( path, "w" ) )
> def compare( least=0.25, **keys ):
>     write( "before.json" )
>     write( "after.json", **keys )
>     root = json.loads( wisp( "compare", "before.json", "after.json", "--least", str( least ), "-f", "json" ) )
>     return root["rows"][0]["size"], root["rows"][1]["size"], "\n".join( root["notes"] )
> run, source, notes = compare()
> assert run["is_slower"] == run["is_faster"] == run["bits_differ"] == 0
> assert "rms_m" not in wisp( "compare", "before.json", "after.json" ) # no number differs
> run, source, notes = compare( factor=1.5 )
> assert run["is_slower"] == 1 and run["p"] < 0.01 and source["is_slower"] == 1 # by its median alone
> assert compare( factor=0.5 )[0]["is_faster"] == 1
> run, source, notes = compare( factor=1.1 ) # certain and too small
> assert run["is_slower"] == 0 and run["p"] < 0.01
> assert compare( factor=1.002, least=0.001 )[0]["is_slower"] == 0 # large enough and not certain
> run, source, notes = compare( factor=3, cpu="B" )
> assert run["is_slower"] == 0 and run["ratio"] > 2.9 and "not judged" in notes
> run, source, notes = compare( error=0.0102, bits=2 )
> assert run["bits_differ"] == 1
> assert re.search( r"error\.rms_m .*\+2\.00 %", wisp( "compare", "before.json", "after.json" ) )
> assert "no_such.json" in wisp( "compare", "before.json", "no_such.json", status=2 )
> END
