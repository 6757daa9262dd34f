#!/bin/sh
# Counts the instructions of repeated steps with callgrind, once with every module registered and once with only those
# of the scene, and fails if the two differ. There is a scene for every effect, the same without the effect
# (EFFECT-off, where its module is either registered and not requested, or not registered), and an empty one.
#
#     bench/instructions.sh PROGRAM [SCENE...]     PROGRAM is the built wisp_instructions; default: all scenes
#
# Exit status: 0 equal, 1 different, 2 no count.
set -eu

program=${1:?which program? the built wisp_instructions}
shift
command -v valgrind >/dev/null || { echo "instructions.sh: valgrind is not installed" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# valgrind 3.19 stops at AVX-512 code, so kernels for AVX2 are counted. Symbols are bound before the first count. Each count is a file of its own.
export WISP_ISA=avx2 LD_BIND_NOW=1
if ! valgrind --tool=callgrind --toggle-collect=wisp_world_step --zero-before=counted_steps --dump-after=counted_steps \
    --callgrind-out-file="$folder/count" "$program" "$@" >"$folder/scenes" 2>"$folder/errors"; then
    tail -n 5 "$folder/errors" >&2
    exit 2
fi

counts=0
status=0
while read -r scene modules passes; do
    counts=$((counts + 1))
    steps=$(sed -n 's/^totals: *//p' "$folder/count.$counts" 2>/dev/null || true)
    if [ "${steps:-0}" -le 0 ]; then
        echo "instructions.sh: nothing was counted; is counted_steps visible in $program?" >&2
        exit 2
    fi
    echo "$scene scene: $steps instructions in 10 steps ($modules modules, $passes passes)"
    if [ $((counts % 2)) -eq 0 ] && [ "$steps" -ne "$every" ]; then
        echo "$scene scene: modules that nobody asks for cost $((every - steps)) instructions in 10 steps" >&2
        status=1
    fi
    every=$steps
done <"$folder/scenes"
[ "$counts" -gt 0 ] || { echo "instructions.sh: no scene was counted" >&2; exit 2; }
exit $status
