#!/bin/bash
# Runs in a clean system in which the packages are installed: what a user would do first.
set -euo pipefail

cd "$(mktemp -d)"
scene=/usr/share/wisp/scenes/flag.yaml
wisp --version
wisp run "$scene" --steps 20 >run.txt
hash=$(awk '$1 == "hash" { print $2 }' run.txt)
[ "${#hash}" -eq 16 ] || { echo "wisp run prints no hash"; exit 1; }
wisp bench --list >cases.txt
[ -s cases.txt ]
man -w wisp wisp-run >/dev/null 2>&1 || [ -e /usr/share/man/man1/wisp-run.1.gz ]
[ -e /usr/share/bash-completion/completions/wisp ]
echo "the program runs: $hash"

python3 - "$scene" "$hash" <<'PYTHON'
import sys, wisp
world = wisp.World(wisp.Scene.read(sys.argv[1]))
world.run(20)
found = format(world.hash(), "016x") if isinstance(world.hash(), int) else str(world.hash())
assert found == sys.argv[2], (found, sys.argv[2])
print("Python has the same hash")
PYTHON

cp -r /usr/share/doc/wisp-data/examples .
cc -std=c17 examples/cloth.c $(pkg-config --cflags --libs wisp) -lm -o shared && ./shared
cc -std=c17 examples/cloth.c $(pkg-config --cflags wisp) -l:libwisp.a $(pkg-config --static --libs-only-l wisp | sed 's/-lwisp//') -fopenmp -lm -o static && ./static
c++ -std=c++17 examples/cloth.cpp $(pkg-config --cflags --libs wisp) -o cpp && ./cpp
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.16)
project(host C)
find_package(wisp REQUIRED)
add_executable(host examples/cloth.c)
target_link_libraries(host wisp::wisp m)
CMAKE
cmake -S . -B cmake >/dev/null && cmake --build cmake >/dev/null && ./cmake/host
echo "hosts build with pkg-config and CMake"
