#!/usr/bin/env python3
"""What threads cost on a machine that others use, too: the scenes of the benchmark beside so many busy processes.

  loaded.py [-b BUSY] [-r ROUNDS] [-p PROGRAM] [SCENE...]

Each scene runs to its share of bench/scenes/benchmark.txt, without pictures, with one thread and with the default number, in turn,
ROUNDS times (default 3) while BUSY processes (default 8) do nothing but take time. A line a scene, of medians: wall and processor
seconds of one thread, and of the default as shares of those. The last line has the greatest and the median share of each. Exit code
1 where the two come to other bits, 64 bad usage. Of what others do meanwhile single shares tell little; run it more than once.
"""
import argparse
import json
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from figures import TOP


def scenes():
    with open("bench/scenes/benchmark.txt") as file:
        rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
    return {name: float(share) for name, share in rows}


def read_end(scene):
    """The end time that stands in a scene [s]."""
    with open(f"bench/scenes/{scene}.yaml") as file:
        number, unit = re.search(r"\bend: *([0-9.e+-]+) *([a-z]+)", file.read()).groups()
    return float(number) * {"s": 1, "ms": 1e-3, "us": 1e-6}[unit]


def run(program, scene, end, threads):
    """Wall and processor seconds, and the state's hash."""
    with tempfile.TemporaryDirectory() as folder:
        sets = ["--set", "output.every=none", "--set", "measures={}", "--set", f"time.end={end!r} s"]
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        subprocess.run([program, "run", f"bench/scenes/{scene}.yaml", *sets, *threads, "-q", "-o", folder], check=True)
        wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(os.path.join(folder, "summary.json")) as file:
            state = json.load(file)["state_hash"]
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, state


def compare(program, scene, end, rounds):
    """Medians of one thread, wall and processor, and shares of the default; whether the bits are the same."""
    one, default = [], []
    for _ in range(rounds):
        one.append(run(program, scene, end, ["-t", "1"]))
        default.append(run(program, scene, end, []))
    wall, cpu = (statistics.median(r[k] for r in one) for k in (0, 1))
    shares = [statistics.median(r[k] for r in default) / unit for k, unit in ((0, wall), (1, cpu))]
    return wall, cpu, *shares, len({r[2] for r in one + default}) == 1


def main():
    parser = argparse.ArgumentParser(prog="loaded.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = lambda message: sys.exit(print(f"loaded.py: {message}", file=sys.stderr) or 64)
    parser.add_argument("-b", type=int, default=8, metavar="BUSY"), parser.add_argument("-r", type=int, default=3, metavar="ROUNDS")
    parser.add_argument("-p", default=os.path.join(TOP, "build/brunt"), metavar="PROGRAM")
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    args = parser.parse_intermixed_args()
    program = os.path.abspath(args.p)
    os.chdir(TOP)
    known = scenes()
    unknown = [name for name in args.scenes if name not in known]
    if unknown or args.b < 0 or args.r < 1:
        parser.error(f"no scene {', '.join(unknown)} in benchmark.txt" if unknown else "-b wants 0 and more, -r 1 and more")
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(args.b)]
    try:
        print(f"{'scene':28} {'wall s':>8} {'cpu s':>8} {'wall':>6} {'cpu':>6}")
        rows = []
        for name in args.scenes or known:
            row = compare(program, name, known[name] * read_end(name), args.r)
            rows.append(row)
            print(f"{name:28} {row[0]:8.2f} {row[1]:8.2f} {row[2]:6.2f} {row[3]:6.2f}{'' if row[4] else '  other bits'}", flush=True)
    finally:
        for process in busy:
            process.kill()
    for word, pick in (("greatest", max), ("median", statistics.median)):
        print(f"{word:28} {'':8} {'':8} {pick(r[2] for r in rows):6.2f} {pick(r[3] for r in rows):6.2f}")
    sys.exit(0 if all(r[4] for r in rows) else 1)


if __name__ == "__main__":
    main()
