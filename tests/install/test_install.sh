#!/bin/bash
# Installs into a folder of its own and uses Wisp from there: the examples against the shared and the static library,
# every header by itself, and the programs.
#
#     test_install.sh SOURCE-TREE BUILD-FOLDER COMPILER...
set -euo pipefail

source_tree=$1
build=$2
shift 2
compiler=("$@")
strict=(-std=c17 -Wall -Wextra -Wpedantic -Werror)

# A space in the path, which users may have.
folder=$(mktemp -d "${TMPDIR:-/tmp}/wisp install.XXXXXX")
trap 'rm -rf "$folder"' EXIT

fail()
{
    echo "FAILED: $1"
    exit 1
}

# ---- install ----

root="$folder/root"
env DESTDIR="$root" meson install -C "$build" --no-rebuild --quiet >"$folder/install.log" 2>&1 || {
    cat "$folder/install.log"
    fail "meson install"
}
pc=$(find "$root" -name wisp.pc)
[ -n "$pc" ] || fail "no wisp.pc is installed"
export PKG_CONFIG_PATH="${pc%/*}"
unset PKG_CONFIG_LIBDIR PKG_CONFIG_SYSROOT_DIR
prefix=$(printf '%q' "$root$(sed -n 's/^prefix=//p' "$pc")")

# The output is quoted for a shell, so a shell must read it.
words()
{
    eval "result=($(pkg-config --define-variable=prefix="$prefix" "$@" wisp))"
}
words --cflags
cflags=("${result[@]}")
words --libs
shared=("${result[@]}")
words --static --libs
static=("${result[@]}")
libdir=$(dirname "$(find "$root" -name 'libwisp.so')")

# The archive by its path: -lwisp would link the shared library in the same folder.
for i in "${!static[@]}"; do
    if [ "${static[$i]}" = -lwisp ]; then
        static[i]="$libdir/libwisp.a"
    fi
done

# ---- the installed programs ----

wisp=$(find "$root" -path '*/bin/wisp')
[ -n "$wisp" ] || fail "no program wisp is installed"
"$wisp" plan "$source_tree/data/scenes/flag.yaml" >"$folder/plan.txt" || fail "wisp plan"
"$wisp" bench --list >"$folder/cases.txt" || fail "wisp bench"
[ -s "$folder/cases.txt" ] || fail "wisp bench --list prints nothing"
echo "wisp and wisp bench run"

# ---- manual pages and completions ----

# A cross build has none.
share=$(dirname "$(find "$root" -path '*/share/wisp' -type d)")
if [ "$(find "$root" -name wisp.1)" ]; then
    for command in $("$wisp" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
        page=$(find "$root" -path "*/man1/wisp-$command.1")
        diff "$page" <("$wisp" help --man "$command") || fail "the manual page of wisp $command is not that of the program"
    done
    diff "$share/bash-completion/completions/wisp.bash" <("$wisp" completion bash) || fail "the completions of bash"
    echo "manual pages and completions are those of the program"
fi
[ -s "$share/doc/wisp/LICENSE" ] || fail "no licence is installed"
[ -s "$share/doc/wisp/examples/game.c" ] || fail "no examples are installed"

# ---- data, wherever the installation is moved to ----

prefix_now=$(dirname "$share") # not that of the build
(
    cd "$folder"
    "$wisp" run "$prefix_now/share/wisp/scenes/flag.yaml" --steps 2 >/dev/null || fail "a scene that is installed does not run"
    "$wisp" gate record "$prefix_now/share/wisp/suites/gate.yaml" --no-instructions -o base.json >/dev/null ||
        fail "a suite that is installed does not find its scenes"
    "$wisp" view "$prefix_now/share/wisp/scenes/flag.yaml" --steps 0 -o page.html >said 2>&1 && [ -s page.html ] ||
        grep -q "share/wisp/viewer.html: the page of .wisp view. is not there" said || fail "wisp view says $(cat said)"
    WISP_DATA=/nowhere "$wisp" view "$prefix_now/share/wisp/scenes/flag.yaml" --steps 0 -o page.html >said 2>&1 &&
        fail "WISP_DATA has no effect"
    grep -q "/nowhere/viewer.html" said || fail "WISP_DATA has no effect: $(cat said)"
)
echo "data of the installation are found"

# ---- every header by itself; cpp/test_standards.sh has all of them as C++ ----

include=$(dirname "$(find "$root" -path '*/wisp/wisp.h')")
headers=0
for header in "$include"/*.h "$include"/module/*.h; do
    name=${header#"$include"/}
    printf '#include <wisp/%s>\nint nothing;\n' "$name" >"$folder/header.c"
    "${compiler[@]}" "${strict[@]}" "${cflags[@]}" -fsyntax-only "$folder/header.c" || fail "wisp/$name as C"
    headers=$((headers + 1))
done
echo "$headers headers compile by themselves"

# ---- programs ----

# run_shared NAME SOURCE : the result is in shared.txt
run_shared()
{
    "${compiler[@]}" "${strict[@]}" "${cflags[@]}" "$2" "${shared[@]}" -o "$folder/$1.shared" ||
        fail "$1 does not build against the shared library"
    LD_LIBRARY_PATH="$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" "$folder/$1.shared" >"$folder/shared.txt" || {
        cat "$folder/shared.txt"
        fail "$1 with the shared library"
    }
}

# build_and_run NAME SOURCE
build_and_run()
{
    run_shared "$@"
    "${compiler[@]}" "${strict[@]}" "${cflags[@]}" "$2" "${static[@]}" -o "$folder/$1.static" ||
        fail "$1 does not build against the static library"
    ldd "$folder/$1.static" | grep -q libwisp && fail "$1.static still wants libwisp.so"
    if [ "$1" = crowd ]; then
        nm "$folder/crowd.static" | grep -E ' wisp_(strands|contact|balloon)_module$' && fail "crowd.static has modules that it does not name"
        text=$(size "$folder/crowd.static" | awk 'NR == 2 { print $1 }')
        echo "crowd, static: $text bytes of code"
        # 2.97 MB by gcc 12 with three sets of kernels; sanitizers add code
        [[ "${compiler[*]}" = *-fsanitize* ]] || [ "$text" -lt 3270000 ] || fail "crowd.static has more code than a host with cloth and collision needs"
    fi
    "$folder/$1.static" >"$folder/static.txt" || {
        cat "$folder/static.txt"
        fail "$1 with the static library"
    }
    # Times differ from run to run, results do not.
    diff <(grep hash "$folder/shared.txt") <(grep hash "$folder/static.txt") ||
        fail "$1 computes something else with the static library"
    echo "$1 builds and runs, shared and static"
}

for example in "$source_tree"/examples/*.c; do
    name=${example##*/}
    [ "$name" = window.c ] && continue # has a test of its own, under a virtual display
    build_and_run "${name%.c}" "$example"
done

# ---- the C of scenes ----

# Each effect alone, effects together, and what is told before steps: pins, bodies and heads that move, and events. The archive is that of the examples.
for scene in scenes/{solids,chain_links,hair_on_balloon,cloth_on_ball,flag,seams,tearing,grippers,head_shake,walking_head,frozen_2d,frozen_and_thawed,pear_jet,needle} \
    suites/scenes/bits/{bodies,crowd,layers,meeting,needles,seams,skins,sleep,walk} $(cd "$source_tree/data" && printf '%s ' suites/scenes/effects/*.yaml); do
    scene=${scene%.yaml}
    "$wisp" info --host "$source_tree/data/$scene.yaml" >"$folder/scene.c" || fail "wisp info --host $scene"
    run_shared "${scene##*/}_scene" "$folder/scene.c"
    diff <(sed -n 's/^hash *//p' "$folder/shared.txt") <("$wisp" run "$source_tree/data/$scene.yaml" 2>/dev/null | sed -n 's/^hash *//p') ||
        fail "the C of $scene has other bits"
    echo "the C of $scene has the bits of the program"
done
