#!/bin/sh
# Compares two binary interfaces that abidw wrote. Within a minor version, which the SONAME names, only additions pass.
#
#     compare_abi.sh RECORDED NOW
set -eu

soname()
{
    sed -n "s/.*soname='\([^']*\)'.*/\1/p" "$1"
}

recorded=$(soname "$1")
now=$(soname "$2")
if [ "$recorded" != "$now" ]; then
    echo "The recorded interface is that of $recorded, and this is $now: ./dev abi accept records it."
    exit 1
fi
if ! abidiff --no-added-syms "$1" "$2"; then
    echo "The binary interface of $recorded has changed as above, so programs that were built before would break. Undo the change,"
    echo "or raise the minor version in meson.build and base.h. Before $recorded is released: ./dev abi accept."
    exit 1
fi
if ! abidiff "$1" "$2"; then
    echo "These additions to $recorded are compatible. ./dev abi accept records them."
fi
