#!/bin/bash
# Every public header compiles in every standard of C from 11 to 23 and of C++ from 11 to 23, with every compiler that is there, and
# clang reads them as Microsoft's compiler would.
#
#     test_standards.sh FOLDER-WITH-HEADERS-AS-INSTALLED FOLDER-OF-ENGINE-HEADERS
set -euo pipefail

include=$1
engine=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
strict=(-Wall -Wextra -Wpedantic -Werror -fsyntax-only -I"$include" -I"$include/wisp" -I"$engine")

for header in "$engine"/wisp/*.h "$engine"/wisp/module/*.h "$include"/wisp/*.h; do
    case $header in
        "$engine"/*) echo "#include \"${header#"$engine"/}\"" ;;
        *) echo "#include \"${header#"$include"/}\"" ;;
    esac
done >"$folder/all.c"
[ "$(wc -l <"$folder/all.c")" -gt 25 ] || { echo "FAILED: only $(wc -l <"$folder/all.c") headers in $engine and $include"; exit 1; }
{ cat "$folder/all.c"; echo '#include "wisp/wisp.hpp"'; } >"$folder/all17.cc"
cp "$folder/all.c" "$folder/all.cc"
echo 'int nothing;' | tee -a "$folder/all.c" "$folder/all.cc" >>"$folder/all17.cc"

check()
{
    "$@" || { echo "FAILED: $*"; exit 1; }
}

checked=0
for compiler in gcc clang clang-14; do
    command -v "$compiler" >/dev/null || continue
    for standard in c11 c17 c2x gnu17; do
        check "$compiler" "${strict[@]}" -std=$standard "$folder/all.c"
        checked=$((checked + 1))
    done
done
for compiler in g++ clang++ clang++-14; do
    command -v "$compiler" >/dev/null || continue
    for standard in c++11 c++14 c++17 c++20 c++2b; do
        file="$folder/all.cc"
        case $standard in c++17 | c++20 | c++2b) file="$folder/all17.cc" ;; esac
        check "$compiler" "${strict[@]}" -std=$standard "$file"
        checked=$((checked + 1))
    done
done

# Without the headers of Microsoft's C library: the two functions that inline code calls stand in for <math.h>.
for compiler in clang clang-14; do
    command -v "$compiler" >/dev/null || continue
    mkdir -p "$folder/msvc"
    printf '#define INFINITY __builtin_inff()\nfloat sqrtf( float );\nfloat fabsf( float );\ndouble sqrt( double );\nfloat fmaxf( float, float );\nfloat fminf( float, float );\n' >"$folder/msvc/math.h"
    printf '#include <stddef.h>\nvoid* memcpy( void*, const void*, size_t );\nvoid* memset( void*, int, size_t );\n' >"$folder/msvc/string.h"
    # Hosts include no headers for modules.
    grep -v module/ "$folder/all.c" >"$folder/hosts.c"
    check "$compiler" --target=x86_64-pc-windows-msvc -fms-compatibility -fms-extensions -ffreestanding -std=c17 \
        -isystem "$folder/msvc" "${strict[@]}" "$folder/hosts.c"
    checked=$((checked + 1))
    break
done
command -v gcc >/dev/null || echo "skipped: gcc is not installed, so headers are not compiled by it"
command -v clang clang-14 >/dev/null || echo "skipped: clang is not installed, so headers are not compiled by it"
echo "every public header compiles in $checked combinations of compiler and standard"
