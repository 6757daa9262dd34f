#!/bin/bash
# What the program writes for bash and for man: bash completes some words, and the manual pages are clean.
#
#     test_completions.sh PROGRAM
set -euo pipefail

wisp=$(realpath "$1")
folder=$(mktemp -d "${TMPDIR:-/tmp}/wisp_completions.XXXXXX")
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail()
{
    echo "FAILED: $1"
    exit 1
}

# ---- bash ----

"$wisp" completion bash >wisp.bash
# shellcheck disable=SC1091 # written a line ago
source ./wisp.bash
mkdir files
touch files/flag.yaml files/flag.wisp files/notes.txt "files/two words.yaml"

# completes EXPECTED WORD... : what the last word, which may be empty, is completed to
completes()
{
    local expected=$1
    shift
    COMP_WORDS=(wisp "$@")
    COMP_CWORD=$#
    COMPREPLY=()
    _wisp
    local IFS=' '
    [ "${COMPREPLY[*]}" = "$expected" ] || fail "bash: 'wisp $*' is completed to '${COMPREPLY[*]}', expected '$expected'"
}

cd files
completes render re
completes "torture" tor
completes "--help --usage --version" -
completes json run --format j
completes json run --format = j
completes "csv" run -f cs
completes "baseline avx2 avx512" run --isa ""
completes "flag.yaml two words.yaml" run ""
completes "flag.wisp" run --verify ""
completes "flag.yaml" run --steps 3 fl
completes "" run --steps ""
completes "--steps" run --st
completes "record" gate r
completes "run render" help r
completes "bash" completion b
completes "strands stability" bench st
completes "--turntable" render flag.wisp --tu
cd ..
echo "bash completes commands, options, words and files"

# ---- manual pages ----

commands=$("$wisp" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
[ "$(wc -w <<<"$commands")" -ge 13 ] || fail "help lists '$commands'"
for command in "" $commands; do
    # shellcheck disable=SC2086 # no word for the program itself
    "$wisp" help --man $command >page.1
    if command -v mandoc >/dev/null; then
        # a date would make every build another one
        said=$(mandoc -T lint -W warning page.1 | grep -v 'missing date' || true)
        [ -z "$said" ] || fail "the page of '$command': $said"
    fi
done
command -v mandoc >/dev/null && echo "mandoc has nothing to say about the manual pages" || echo "skipped: mandoc is not installed, so pages are not checked"
