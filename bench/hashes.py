#!/usr/bin/env python3
"""The state that every run of bench/scenes ends in, as one number each: what a change that must not move a bit is held against.

  hashes.py > FILE        runs all; of those that are long the first tenth of the time
  hashes.py FILE          runs all and tells which differ from the file's; exit code 1 when one does

BRUNT names the program, default build/brunt. Numbers are those of one machine, compiler and precision.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from figures import TOP, brunt, read_runs


def end_of(scene, share):
    text = open(f"bench/scenes/{scene}.yaml").read()
    value, unit = re.search(r"\bend: *([\d.eE+-]+) *([^\s,}#]*)", text).groups()
    return f"time.end={float(value) * share!r} {unit}"


def state_of(run):
    sets = [word for o in run.overrides for word in ("--set", o)]
    if run.label == "long":
        sets += ["--set", end_of(run.scene, 0.1)]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([brunt(), "run", f"bench/scenes/{run.scene}.yaml", *sets, "-t", "1", "-q", "-o", folder], capture_output=True)
        try:
            with open(os.path.join(folder, "summary.json")) as file:
                return json.load(file)["state_hash"]
        except OSError:
            return f"exit code {done.returncode}"


def main():
    os.chdir(TOP)
    runs = list(read_runs().values())
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        now = dict(zip((r.name for r in runs), pool.map(state_of, runs)))
    if not sys.argv[1:]:
        for name, state in now.items():
            print(name, state)
        return
    with open(sys.argv[1]) as file:
        old = dict(line.split(maxsplit=1) for line in file.read().splitlines())
    moved = [name for name in now if now[name] != old.get(name)]
    for name in moved:
        print(f"{name}: {old.get(name)} -> {now[name]}")
    print(f"{len(now) - len(moved)} the same, {len(moved)} moved")
    sys.exit(1 if moved else 0)


if __name__ == "__main__":
    main()
