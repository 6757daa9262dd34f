# wisp plan: its forms agree with each other, and each has the syntax of its format. wisp view: the page holds the scene, its files and the
# hashes of a native run. The page itself is tested in a browser by `./dev web test`; here a short one takes its place.
$ cat >hair.yaml <<'END'
> wisp: 1
> steps: 3
> strands:
>   - name: hair
>     generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }
>     frozen_hair:
>       freeze: {}
>       align: { cursor: [0, -0.3, 0] }
>     appearance: {}
>     compute: [points, width]
> END
$ cat >plans.py <<'END'
> import json, subprocess, os, re
> def wisp( command, status=0 ):
>     run = subprocess.run( [os.environ["WISP"], *command.split()], capture_output=True, text=True )
>     assert run.returncode == status and run.stderr == "", ( command, run )
>     return run.stdout
> def unique( pairs ):
>     assert len( dict( pairs ) ) == len( pairs )
>     return dict( pairs )
> def plan( options ):
>     return json.loads( wisp( "plan --format json " + options ), object_pairs_hook=unique )
> def named( array, name ):
>     return next( item for item in array if item["name"] == name )
> def fractions( plan, key ):
>     return [p[key] for p in plan["passes"] if p[key] is not None]
> def graph( options ): # braces and brackets are balanced outside of strings, which end in their line
>     dot = wisp( "plan --format dot " + options )
>     bare = re.sub( r'"([^"\\\n]|\\.)*"', "", dot )
>     for pair in "{}", "[]":
>         depth = 0
>         for c in bare:
>             depth += ( c == pair[0] ) - ( c == pair[1] )
>             assert 0 <= depth and ( pair == "{}" or depth <= 1 )
>         assert depth == 0
>     assert '"' not in bare and dot.startswith( "digraph wisp_plan {" )
>     return dot
> END

# Shares of the JSON form sum to one: a handful of quotients, each rounded once, and their text has all digits. The six passes are command, start,
# freeze, align, vertices in the user's order, width.
$ python3 <<'END'
> from plans import *
> p = plan( "hair.yaml --steps 4" )
> assert p["wisp_plan"] == 2 and p["active"] == 6
> for key in "predicted_fraction", "measured_fraction":
>     assert len( fractions( p, key ) ) == 6 and abs( sum( fractions( p, key ) ) - 1 ) < 1e-12
> assert p["measured"]["steps"] == 4 and p["measured"]["plan_changes"] == 0
> p = plan( "hair.yaml --steps 0" ) # nothing is measured, and all else is told
> assert fractions( p, "measured_fraction" ) == [] and p["measured"] is None
> assert abs( sum( fractions( p, "predicted_fraction" ) ) - 1 ) < 1e-12
> END
$ wisp plan hair.yaml --steps 0 >told; grep 'measured 0' told
[1]
$ cat told
...nothing was measured: --steps 0...

# An active pass has its reasons and its place: 40 strands are 3 groups of 16. A width is a request of the scene, without a reader.
$ python3 <<'END'
> from plans import *
> passes = plan( "hair.yaml" )["passes"]
> freeze, width, clump = ( named( passes, name ) for name in ( "frozen_hair.freeze", "strand_appearance.width", "frozen_hair.clump" ) )
> assert [freeze[key] for key in ( "state", "module", "stage" )] == ["active", "frozen_hair", "shape"]
> assert freeze["place"]["loop"] == "after" and freeze["place"]["items"] == 3 and freeze["place"]["bytes"] > 0
> assert freeze["reasons"][0]["component"] == "strand.position"
> assert width["reasons"][0]["component"] == "point.width" and width["reasons"][0]["reader"] is None
> assert clump["state"] == "missing" and clump["missing"][0] == "frozen_hair.clump" and clump["place"] is None
> END

# Every absent module has its reason in every form; the verbose text names each pass, the short one each active pass in a line of at most 100 letters.
$ python3 <<'END'
> from plans import *
> p = plan( "hair.yaml" )
> short, verbose, dot = wisp( "plan hair.yaml" ), wisp( "plan hair.yaml --verbose" ), graph( "hair.yaml" )
> assert named( p["modules"], "balloon" )["missing"] == "balloon.gas" and named( p["modules"], "frozen_hair" )["present"] is True
> for form in verbose, dot:
>     assert all( m["name"] in form and ( m["present"] or m["because"] in form ) for m in p["modules"] )
> for a_pass in p["passes"]:
>     name, is_active = a_pass["name"], a_pass["state"] == "active"
>     assert f" {name} " in verbose and ( f" {name} " in short ) == is_active
>     # an edge ends in the same words, but never begins a line of its own cluster
>     node = f'"{name}" [label='
>     assert ( "      " + node in dot ) == is_active and ( is_active or node not in dot )
> assert p["hash"] in verbose and "measured on one worker: 10 steps" in verbose
> for words in "requested by the scene\n", "read by frozen_hair.align", "needs component balloon.gas, which no entity has\n":
>     assert words in short
> assert max( map( len, short.splitlines() ) ) <= 100
> for words in '"frozen_hair.freeze" -> "frozen_hair.align"', 'label="after"', 'label="shape"':
>     assert words in dot
> END

# A quote in a name does not end a string of the graph.
$ cp hair.yaml 'quo"te.yaml'; python3 -c 'from plans import *
> assert "quo\\\"te.yaml" in graph( "quo\"te.yaml --steps 0" ) and "quo\"te.yaml" in plan( "quo\"te.yaml --steps 0" )["scene"]'

# Scenes of the tree: an empty one; loops of substeps, where what comes round is dashed; what runs together, and links, which do not.
$ python3 <<'END'
> from plans import *
> scenes = os.environ["SOURCE"] + "/data/scenes/"
> empty = plan( scenes + "empty.yaml" )
> assert empty["active"] == 0 and fractions( empty, "measured_fraction" ) == [] and graph( scenes + "empty.yaml" )
> dot = graph( scenes + "hanging_cloth.yaml --steps 1" )
> for loop in "substep", "iteration", "substep end", "after":
>     assert f'label="{loop}"' in dot
> assert "style=dashed, constraint=false" in dot
> chains = scenes + "chain_links.yaml --steps 1"
> passes = plan( chains )["passes"]
> assert named( passes, "strands.stretch" )["place"]["fusion"] == "strands.substeps"
> assert named( passes, "strands.links" )["place"]["fusion"] is None
> assert "strands.stretch          (fused) (in strands.substeps)" in wisp( f"plan {chains} --verbose" )
> assert "fused, in strands.substeps" in graph( chains )
> END

# A page holds the scene and the files that it reads, between the place of its data and the next end of a script.
$ export WISP_DATA=.; mkdir scenes meshes
$ printf '<html><script type="application/json" id="wisp-data">null</script><p>after</p></html>' >viewer.html
$ printf 'v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n' >meshes/square.obj
$ cat >scenes/square.yaml <<'END'
> wisp: 1
> steps: 130
> surfaces:
>   - name: "cloth"  # </script><!--
>     file: ../meshes/square.obj
>     pins: [0]
>     cloth: {}
> END
$ cat >pages.py <<'END'
> from plans import *
> import base64
> def page( command ):
>     os.environ["WISP_DATA"] = "."
>     wisp( command + " -o page.html" )
>     whole = open( "page.html" ).read()
>     data, rest = whole.split( '<script type="application/json" id="wisp-data">', 1 )[1].split( "</script>", 1 )
>     assert rest == "<p>after</p></html>"
>     return json.loads( data, object_pairs_hook=unique )
> END
$ python3 <<'END'
> from pages import *
> data = page( "view scenes/square.yaml --steps 0" )
> assert [data[key] for key in ( "kind", "name", "title" )] == ["scene", "square.yaml", "square"] and len( data["files"] ) == 2
> for name in "square.yaml", "../meshes/square.obj":
>     assert base64.b64decode( data["files"][name], validate=True ) == open( "scenes/" + name, "rb" ).read()
> # hashes are those of wisp run, of 130 steps
> hashes = page( "view scenes/square.yaml" )["hashes"]
> assert hashes["every"] == 60 and len( hashes["values"] ) == 2
> for i in range( 2 ):
>     assert hashes["values"][i] in wisp( f"run scenes/square.yaml --steps {60 * ( i + 1 )}" )
> wisp( "run scenes/square.yaml --steps 3 --record run.wisp" )
> data = page( "view run.wisp" )
> assert data["kind"] == "recording" and base64.b64decode( data["files"]["run.wisp"] ) == open( "run.wisp", "rb" ).read()
> END

# Wrong input is refused and writes nothing.
$ export WISP_DATA=.; echo nothing >wrong.txt; bad=$( printf 'bad\377.yaml' ); echo 'wisp: 1' >"$bad"
> for input in wrong.txt "$( printf '\377.yaml' )" "$bad" 'run.wisp --steps 3'; do set -- $input; wisp view "$@" -o none.html; test $? = 2 || echo "taken: $input"; done
! wisp: wrong.txt: got another kind of file, expected a scene or a recording
! wisp: ...No such file...
! wisp: ...not UTF-8...
! wisp: ...a recording is played, not simulated...
$ export WISP_DATA=.; echo '<html></html>' >viewer.html; wisp view scenes/square.yaml -o none.html --steps 0
! wisp: ...the page has no place for data...
[2]
$ export WISP_DATA=.; rm viewer.html; wisp view scenes/square.yaml -o none.html --steps 0
! wisp: ...'./dev web' builds it...
[2]
$ test ! -e none.html
