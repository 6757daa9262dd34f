# wisp tune: the reported result holds in another run, and the written scene has the configuration.
$ cat >cloth.yaml <<'END'
> # A small cloth.
> wisp: 1
> dt: 0.0166667
> steps: 20
> substeps: 3 # as it was
> surfaces:
>   - name: cloth
>     generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }
>     pins: [0, 8]
>     # soft
>     cloth: { bending: none }
> END

# An error is met, and the scene that is written has the choice.
$ wisp tune cloth.yaml --error 0.02 --workers 1 --output tuned.yaml >told; cat told
target     met: error at most 0.02 m; compared until 0.333 s, the end
chosen ...
...Pareto...
$ sed -nE 's/^.* ms per step, error ([^ ]+) m.*/\1/p' told | head -n 1 | awk '{ print ( $1 <= 0.02 ) }'
1
$ chosen() { grep '^chosen ' told | grep -oE "[ .]$1: [^,]+" | sed 's/.*: //'; }
> written() { grep -oE "\\b$1: [^,} ]+" tuned.yaml | sed 's/.*: //'; }
> for key in substeps iterations coarse_substeps; do test "$( chosen $key )" = "$( written $key )" || echo "$key: $( chosen $key ), $( written $key )"; done
$ cat tuned.yaml
# A small cloth.
wisp: 1
...substeps: ... # as it was
...
    # soft
    cloth: {...
$ wisp run tuned.yaml >/dev/null
