# wisp sweep in shares that are stopped and gone on with, and wisp merge, also of parts that were changed.
$ cat >sheet.yaml <<'END'
> wisp: 1
> steps: 2
> surfaces:
>   - name: sheet
>     generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }
>     pins: [0, 2]
>     cloth: { warp_compliance: 1e-3, bending: none }
> END
# 13 x 8 x 3 rows, of which some are run by two shards, and a row of its own.
$ cat >suite.yaml <<'END'
> wisp_suite: 1
> title: sheets
> reference: { file: sheet.yaml, set: { substeps: 40 }, check: { substeps: 20 } }
> scenes:
>   - file: sheet.yaml
>     vary:
>       surfaces[0].damping: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]
>       surfaces[0].area_density: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]
>     along: { substeps: [1, 2, 4] }
>     order: 1
>   - { file: sheet.yaml, name: alone }
> END

# Any number of shards gives the same bytes in every format; some items of several shards are run twice.
$ for count in 1 3 8; do
>     for shard in $( seq $count ); do wisp sweep suite.yaml -o same_$count --shard $shard/$count 2>/dev/null || echo "$shard of $count"; done
>     for format in text markdown csv json; do
>         wisp merge same_$count -f $format -o merged_$count.$format --report merged.html 2>told; cmp merged_1.$format merged_$count.$format
>     done
>     grep -q 'Observed orders' merged.html || echo "no orders of $count"; echo "$count: $( cat told )"
> done
1: 
3: ...
8: ... run by two shards, with the same bits...
$ grep -o '; compared until ' merged_1.text | head -n 1
; compared until 

# Values have the names of `wisp bench`.
$ head -n 1 merged_1.csv | grep -o 'error.RMS_distance_to_the_reference_mm,error.largest_distance_mm'
error.RMS_distance_to_the_reference_mm,error.largest_distance_mm

# Wrong shards are refused.
$ for shard in 0/4 5/4 4 a/4 1/ 1/0 -1/4 1/99999 1/4x; do wisp sweep suite.yaml -o wrong --shard $shard; test $? = 64 || echo "taken: $shard"; done
! wisp sweep: ...got shard 0 of 4...
! wisp sweep: ...got shard 5 of 4...
! wisp sweep: ...expected a share such as 2/8...
! wisp sweep: ...a share such as...
! wisp sweep: ...a share such as...
! wisp sweep: ...got 0 shards...
! wisp sweep: ...got shard -1 of 4...
! wisp sweep: ...1 to 9999...
! wisp sweep: ...a share such as...
$ wisp sweep sheet.yaml -o wrong
! wisp: ...sheet.yaml...
[2]
$ wisp sweep suite.yaml -o missing/folder
! wisp: ...missing/folder...
[2]
$ test ! -e wrong

# Two processes do not write one part.
$ mkdir locked; cat >lock.py <<'END'
> import fcntl, subprocess
> with open( "locked/part-0001-of-0001.jsonl", "a" ) as part:
>     fcntl.flock( part, fcntl.LOCK_EX )
>     subprocess.run( ["sh", "-c", '"$WISP" sweep suite.yaml -o locked; echo $?'] )
> END
> python3 lock.py
2
! wisp: ...another process writes it...
$ wisp sweep suite.yaml -o locked 2>/dev/null

# A suite that changes between shards is refused.
$ wisp sweep suite.yaml -o changed --shard 1/2 2>/dev/null; cp sheet.yaml kept.yaml
> printf 'wisp: 1\nsteps: 3\nsurfaces: [ { name: sheet, generate: { shape: plane, columns: 3, rows: 3 }, cloth: {} } ]\n' >sheet.yaml
> wisp sweep suite.yaml -o changed --shard 1/2
! wisp: changed/part-0001-of-0002.jsonl:1: is of another suite than what is to be run; choose another folder...
[2]
$ wisp sweep suite.yaml -o changed --shard 2/2 2>/dev/null; wisp merge changed
! wisp: changed/part-0002-of-0002.jsonl:1: is of another suite than changed/part-0001-of-0002.jsonl:1...
[2]
$ cp kept.yaml sheet.yaml

# Checks and failures are in the status.
$ cat >checks.yaml <<'END'
> wisp_suite: 1
> checks: [finite, { speed: 1e-6 }]
> scenes:
>   - { file: sheet.yaml, name: falls }
>   - { file: sheet.yaml, name: known }
> known: { known: speed }
> END
$ wisp sweep checks.yaml -o checks
! ...2 of 2 items, 1 not as expected...
[1]
$ wisp merge checks
...speed, unexpected...FAILED...
[1]
$ wisp sweep checks.yaml -o checks 2>/dev/null
[1]

# A row of a sweep has the bits and errors that the same row of a benchmark has.
$ printf 'wisp_suite: 1\nreference: { file: sheet.yaml, set: { substeps: 40 }, check: { substeps: 20 } }\nscenes: [ { file: sheet.yaml, along: { substeps: [1, 8] } } ]\n' >few.yaml
$ wisp sweep few.yaml -o few 2>/dev/null; wisp merge few -f csv >merged.csv; wisp bench few.yaml --seconds 0.1 --workers 1 -f csv >measured.csv
$ python3 <<'END'
> import csv
> SAME = ["hash", "error.RMS_distance_to_the_reference_mm", "error.largest_distance_mm", "error.detail", "error.doubt_mm", "error.until_s", "size.vertices"]
> def rows( path ):
>     return [[row[name] for name in SAME] for row in csv.DictReader( open( path ) ) if row["workers"] in "01"]
> assert len( rows( "merged.csv" ) ) == 2 and rows( "merged.csv" ) == rows( "measured.csv" )
> END

# What is killed loses only the item that ran, also if a line was not written whole. What is done stays as it is.
$ cat >kill.py <<'END'
> import os, signal, subprocess, time
> part = "killed/part-0001-of-0001.jsonl"
> def lines():
>     return open( part ).read().count( "\n" ) if os.path.exists( part ) else 0
> sweep = subprocess.Popen( [os.environ["WISP"], "sweep", "suite.yaml", "-o", "killed"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL )
> while lines() < 20 and sweep.poll() is None:
>     time.sleep( 0.001 )
> sweep.kill()
> assert sweep.wait() == -signal.SIGKILL and lines() >= 20
> print( lines() )
> END
$ before=$( python3 kill.py ); echo $before >before; wisp merge killed
! wisp: ...shard 1 of 1 has ... of its 313 items...
[2]
$ before=$( cat before ); printf '{"item":7,"ke' >>killed/part-0001-of-0001.jsonl; wisp sweep suite.yaml -o killed 2>&1 | grep -c "313 of 313 items, $before from before"
> wc -l <killed/part-0001-of-0001.jsonl; wisp merge killed | cmp - merged_1.text
1
313
$ wisp sweep suite.yaml -o killed; wc -l <killed/part-0001-of-0001.jsonl
313
! ...313 from before

# A full disk keeps what fitted, and the same command goes on.
$ ( ulimit -f 20; trap '' XFSZ; wisp sweep suite.yaml -o full )
! ...the same command goes on
! wisp: full/part-0001-of-0001.jsonl: cannot be written: ...
[2]
$ test $( wc -l <full/part-0001-of-0001.jsonl ) -gt 5; wisp merge full
! wisp: ...shard 1 of 1 has ...
[2]
$ wisp sweep suite.yaml -o full 2>/dev/null; wisp merge full | cmp - merged_1.text

# Parts that are not of one sweep are refused.
$ for change in 's/"version":"0/"version":"9/' 's/"sweep":"/&0000000000000000","x":"/' 's/"shards":3/"shards":4/' 's/"reference":/&"x","y":/' 's/"item":/"idem":/' \
>     's/{"item":/&9999/' 's/{/[/'
> do
>     rm -rf bad; cp -r same_3 bad; python3 -c 'import re, sys
> was, new = sys.argv[1].split( "/" )[1:3]
> path = "bad/part-0002-of-0003.jsonl"; text = open( path ).read(); assert was in text
> open( path, "w" ).write( text.replace( was, new.replace( "&", was ), 1 ) )' "$change"; wisp merge bad; test $? = 2 || echo "taken: $change"
> done
! wisp: ...jsonl:1: is of another version of Wisp than ...
! wisp: ...jsonl:1: is of another suite than ...
! wisp: ...jsonl:1: is of another number of shards than ...
! wisp: ...jsonl:1: is of another reference than ...
! wisp: ...jsonl:1: expected a row...
! wisp: ...jsonl:1: expected a row...
! wisp: ...jsonl:1: expected a row...
$ rm -rf bad; cp -r same_3 bad; rm bad/part-0003-of-0003.jsonl; wisp merge bad
! wisp: ...shard 3 of 3 is not there...
[2]
$ rm bad/part-0001-of-0003.jsonl; wisp merge bad
! wisp: ...shard 1 of 3 is not there, and 1 more...
[2]
$ mkdir empty; wisp merge empty
! wisp: ...has no part of a sweep...
[2]

# One file of all lines is as good as a file for each share.
$ mkdir one; cat same_3/*.jsonl >one/all.jsonl; wisp merge one 2>/dev/null | cmp - merged_1.text

# Items that are missing or have two hashes are refused. What was wrong in one of two runs is wrong, and what could not be run in one of them is not.
$ for shard in 1 2; do wisp sweep suite.yaml -o pair --shard $shard/2; done 2>/dev/null; wisp merge pair >/dev/null
! ...run by two shards, with the same bits...
$ cat >pair.py <<'END'
> import json, os, re, shutil, subprocess
> parts = [f"pair/part-000{i}-of-0002.jsonl" for i in ( 1, 2 )]
> first, second = ( open( part ).read().splitlines( True ) for part in parts )
> item = lambda line: json.loads( line ).get( "item" )
> others = { item( line ) for line in second }
> twice = next( i for i, line in enumerate( first ) if item( line ) is not None and item( line ) in others )
> def merge( part, lines ):
>     shutil.rmtree( "bad", ignore_errors=True )
>     shutil.copytree( "pair", "bad" )
>     open( parts[part].replace( "pair/", "bad/" ), "w" ).writelines( lines )
>     return subprocess.run( [os.environ["WISP"], "merge", "bad"], capture_output=True, text=True )
> for gone in twice, 1 if twice == 0 else 0:
>     run = merge( 0, first[:gone] + first[gone + 1:] )
>     assert run.returncode == 2 and "shard 1 of 2 has " in run.stderr
> changed = re.sub( r'"hash":"[0-9a-f]{16}', '"hash":"0123456789abcdef', first[twice] )
> run = merge( 0, first[:twice] + [changed] + first[twice + 1:] )
> assert run.returncode == 2 and f"item {item( changed )} (" in run.stderr and "has other bits than the run by shard 1" in run.stderr
> at = next( i for i, line in enumerate( second ) if item( line ) == item( first[twice] ) )
> run = merge( 1, second[:at] + [second[at].replace( "{", '{"failure":"other bits",', 1 )] + second[at + 1:] )
> assert run.returncode == 1 and "other bits" in run.stdout
> END
> python3 pair.py

# Times come from exclusive runs, and processors are not mixed. What was not timed is run again, once; rows have no times then.
$ printf 'wisp_suite: 1\nscenes: [ { file: sheet.yaml, along: { substeps: [1, 2, 3, 4, 5, 6] } } ]\n' >timed.yaml
$ wisp sweep timed.yaml -o timed 2>/dev/null; wisp merge timed | grep '1 worker'
[1]
$ wisp sweep timed.yaml -o timed --exclusive --workers 2
! ...6 of 6 items
$ wisp sweep timed.yaml -o timed --exclusive --workers 2
! ...6 of 6 items, 6 from before...
$ wisp sweep timed.yaml -o timed --exclusive --workers 3
! wisp: ...jsonl:7: is of another number of workers than...
[2]
$ wisp merge timed -f markdown >told; grep -o 'ms, 1 worker\|ms, 2 workers\|processor' told | sort -u; wisp merge timed -f csv | wc -l
ms, 1 worker
ms, 2 workers
13
$ wisp merge timed -f csv | python3 -c 'import csv, sys
> times = [[float( row[name] ) for name in ( "ms_p10", "ms_median", "ms_p90" )] for row in csv.DictReader( sys.stdin )]
> print( len( times ), all( a <= b <= c for a, b, c in times ), any( a < b < c for a, b, c in times ) )'
12 True True
$ python3 -c 'path = "timed/part-0001-of-0001.jsonl"; text = open( path ).read()
> before, after = text.split( "\"ms\":", 1 )
> open( path, "w" ).write( before + "\"isa\":\"another\",\"ms\":" + after.replace( "\"isa\":", "\"ISA\":", 1 ) )'
$ wisp merge timed
...processor..., another...
$ wisp merge timed -f csv | wc -l
7
