#!/usr/bin/env python3
"""compare_abi.sh passes the recorded interface and additions to it, and refuses what breaks programs.

usage: test_compare_abi.py SOURCE_TREE
"""
import gzip
import re
import subprocess
import sys
import tempfile

folder = sys.argv[1] + "/tests/install"
recorded = gzip.open(f"{folder}/abi/libwisp.abi.gz", "rt", encoding="utf-8").read()
failures = 0


def changed(pattern, replacement):
    text, count = re.subn(pattern, replacement, recorded, flags=re.S)
    if count == 0:
        sys.exit(f"the recorded interface has no {pattern}")
    return text


def expect(what, before, after, status, sentence):
    global failures
    with tempfile.TemporaryDirectory() as place:
        for name, text in (("before", before), ("after", after)):
            open(f"{place}/{name}", "w", encoding="utf-8").write(text)
        result = subprocess.run([f"{folder}/compare_abi.sh", f"{place}/before", f"{place}/after"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != status or sentence not in result.stdout:
        failures += 1
        print(f"{what}: got status {result.returncode}, expected {status} and '{sentence}' in:\n{result.stdout}")


smaller = changed(r"\s*<elf-symbol name='wisp_world_hash' [^>]*/>", "")
smaller = re.sub(r"\s*<function-decl name='wisp_world_hash' .*?</function-decl>", "", smaller, count=1, flags=re.S)
expect("no change", recorded, recorded, 0, "")
expect("a new function", smaller, recorded, 0, "These additions")
expect("a function is gone", recorded, smaller, 1, "[D] 'function uint64_t wisp_world_hash(")
expect("a definition grows", recorded, changed(r"(<class-decl name='wisp_world_def' size-in-bits=')(\d+)", r"\g<1>1\2"), 1, "type size changed")
expect("a constant changes", recorded, changed(r"('WISP_IO_ERROR' value=')5'", r"\g<1>7'"), 1, "from value '5' to '7'")
expect("a new minor version", changed(r"(soname='libwisp\.so\.)[0-9.]+'", r"\g<1>0.1'"), recorded, 1, "./dev abi accept records it")
print(f"{6 - failures} passed, {failures} failed")
sys.exit(failures > 0)
