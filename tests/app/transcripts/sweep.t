# wisp sweep and wisp merge. What is killed, and parts that were changed, are in test_program_sweep.c.
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
