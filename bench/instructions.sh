#!/bin/sh
# Counts the instructions of repeated steps with callgrind, once with every module registered and once with only those
# of the scene, and fails if the two differ. There is a scene for every effect, the same without the effect
# (EFFECT-off, where its module is either registered and not requested, or not registered), and an empty one.
#
#     bench/instructions.sh PROGRAM [SCENE...]     PROGRAM is the built wisp_instructions; it lists its scenes
#
# Only wisp_world_step is counted. The first steps compile the plan and fill buffers, so two runs of different lengths
# are subtracted from each other and what remains are repeated steps. Exit status: 0 equal, 1 different, 2 no count.
set -eu

program=${1:?which program? the built wisp_instructions}
shift
[ $# -gt 0 ] || set -- $("$program" list)
short=3
long=13

command -v valgrind >/dev/null || { echo "instructions.sh: valgrind is not installed" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# valgrind 3.19 stops at AVX-512 code, so kernels for AVX2 are counted.
export WISP_ISA=avx2

# count MODULES SCENE STEPS
count()
{
    file="$folder/$1.$2.$3"
    if ! valgrind --tool=callgrind --toggle-collect=wisp_world_step --callgrind-out-file="$file" \
        "$program" "$1" "$2" "$3" >"$file.out" 2>"$file.err"; then
        tail -n 5 "$file.err" >&2
        return 1
    fi
    sed -n 's/^totals: *//p' "$file"
}

equal=true
for scene in "$@"; do
    counted=
    for modules in every used; do
        first=$(count "$modules" "$scene" "$short") || exit 2
        second=$(count "$modules" "$scene" "$long") || exit 2
        steps=$((second - first))
        if [ "$steps" -le 0 ]; then
            echo "instructions.sh: nothing was counted; is wisp_world_step visible in $program?" >&2
            exit 2
        fi
        echo "$scene scene, $modules: $steps instructions in $((long - short)) steps" \
            "($(cat "$folder/$modules.$scene.$long.out"))"
        if [ -n "$counted" ] && [ "$counted" -ne "$steps" ]; then
            echo "$scene scene: modules that nobody asks for cost $((counted - steps)) instructions in" \
                "$((long - short)) steps" >&2
            equal=false
        fi
        counted=$steps
    done
done
$equal
