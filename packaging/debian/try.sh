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
for file in /usr/share/man/man1/wisp-run.1.gz /usr/share/bash-completion/completions/wisp.bash /usr/share/doc/wisp/copyright; do
    [ -e "$file" ] || { echo "$file is not installed"; exit 1; }
done
echo "the program runs: $hash"

python3 - "$scene" "$hash" <<'PYTHON'
import sys, wisp
with wisp.Scene.from_file(sys.argv[1]).create_world() as world:
    world.run(20)
    assert world.hash() == sys.argv[2], (world.hash(), sys.argv[2])
print("Python has the same hash")
PYTHON

cp -r /usr/share/doc/wisp-data/examples .
cc -std=c17 examples/game.c $(pkg-config --cflags --libs wisp) -lm -o shared && ./shared
cc -std=c17 examples/game.c $(pkg-config --static --cflags --libs wisp | sed 's/-lwisp/-l:libwisp.a/') -o static && ./static
if grep -q libwisp <<<"$(ldd static)"; then
    echo "the static host wants libwisp.so"
    exit 1
fi
c++ -std=c++17 examples/game.cpp $(pkg-config --cflags --libs wisp) -o cpp && ./cpp
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.16)
project(host C)
find_package(wisp REQUIRED)
add_executable(host examples/game.c)
target_link_libraries(host wisp::wisp m)
CMAKE
cmake -S . -B cmake >/dev/null && cmake --build cmake >/dev/null && ./cmake/host
echo "hosts build with pkg-config and CMake"
