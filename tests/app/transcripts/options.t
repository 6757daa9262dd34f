# The command line: options as getopt_long() reads them, help, manual pages and completions, which come from the same tables. "-" as a
# file: standard input where the program reads, standard output where it writes.
$ cat >flag.yaml <<'END'
> wisp: 1
> steps: 3
> surfaces:
>   - name: flag
>     generate: { shape: plane, columns: 5, rows: 5, spacing: 0.1 }
>     pins: [0, 4]
>     cloth: {}
> END
$ cp flag.yaml ./--odd.yaml

# Long options can be abbreviated and joined to their value.
$ for command in "flag.yaml --steps 2" "flag.yaml --steps=2" "--st 2 flag.yaml" "--ste=2 flag.yaml" "-s2 flag.yaml" "-s 2 flag.yaml" "flag.yaml --step 2 --"; do
>     wisp run $command | grep -o '^steps        2 of '
> done
steps        2 of 
steps        2 of 
steps        2 of 
steps        2 of 
steps        2 of 
steps        2 of 
steps        2 of 

# What follows two dashes is no option.
$ wisp run --steps 2 -- --odd.yaml
scene        --odd.yaml
...

# The last of an option that is given twice counts.
$ wisp run flag.yaml --steps 1 --steps 3 --format csv --format text
scene        flag.yaml
steps        3 of ...

# Help is the same in every way that it is asked for.
$ for verb in run render view info plan tune gate accuracy torture help compare bench; do
>     wisp help $verb >help
>     for word in --help -h -? --he; do wisp $verb $word | cmp help -; done
> done
$ wisp help >help; wisp --help | cmp help -
$ wisp --version >version; wisp run -V | cmp version -

# Every option in help is in the manual and in completions: 13 commands, of which each has at least three.
$ wisp completion bash >completion
> for verb in run render view info plan tune bench torture accuracy gate compare help completion; do
>     wisp help --man $verb >manual
>     for name in $( wisp help $verb | sed -nE 's/^  (-., |    )--([a-z-]+).*/\2/p' ); do
>         grep -qF -- "\\fB\\-\\-$( echo $name | sed 's/-/\\-/g' )\\fR" manual || echo "the manual of $verb lacks $name"
>         grep -qF -- "--$name" completion || echo "completions of $verb lack $name"
>         echo $name >>names
>     done
> done; test $( wc -l <names ) -gt 100

# The manual of the program names every command.
$ wisp help --man >manual; grep -c '^.TH wisp 1 ' manual
> wisp help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\).*/\1/p' >names; wc -l <names
> while read name; do grep -qF "\\fBwisp\\-$name\\fR(1)" manual || echo "lacks $name"; done <names
1
16

# A scene comes from standard input, a pipe that cannot be rewound, with files of the current folder.
$ printf '# two triangles\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n' >square.obj
$ printf 'wisp: 1\nsteps: 3\nsurfaces:\n  - name: flag\n    file: square.obj\n    pins: [0]\n    cloth: {}\n' >square.yaml
$ cat square.yaml | wisp run -
scene        standard input
steps        3 of ...
$ cat square.yaml | wisp plan -
... passes in ...
$ cat square.yaml | wisp info -
standard input: scene, ...

# Every kind of file is told by its first bytes.
$ wisp run square.yaml --record flag.wisp --format json --output result.json
$ wisp run square.yaml --record flag.pc2 -o summary.txt
$ for file in square.obj flag.wisp flag.pc2 result.json; do cat $file | wisp info - | head -n 1; done
standard input: open mesh...
standard input: recording of 4 frames...
standard input: point cache...
standard input: results, 1 rows...
$ cat result.json | wisp compare result.json -
...rows: 1; ...

# An error in standard input has its line.
$ printf 'wisp: 1\nstepz: 3\n' | wisp run -
! wisp: standard input:2:1: unknown key 'stepz', did you mean 'steps'?
[2]
$ wisp run - </dev/null
! wisp: standard input: got an empty file...
[2]

# Standard input without an end is refused: the cap of the reader holds, not the room on the disk.
$ wisp run - </dev/zero
! wisp: standard input: expected at most ...
[2]
$ wisp info - </dev/zero
! wisp: standard input: unknown kind of file...
[2]

# A picture, a tuned scene and results go to standard output, and what is told of them to the error stream.
$ wisp render square.obj -o - --size 32x24 2>told | head -c 8 | od -An -c; grep -c '^-: 32 x 24 pixels, ' told
 211   P   N   G  \r  \n 032  \n
1
$ cat square.yaml | wisp tune - --error 1 -o -
wisp: 1
...
! target ...
$ wisp run square.yaml -o - --format json | python3 -m json.tool >json; head -n 1 json
{
