#!/usr/bin/env python3
"""Whether two programs compute the same bits: the state that every run of bench/scenes/runs.txt comes to, side by side.

  hashes.py compare OLD NEW [-j N] [-s SECONDS] [RUN...]

OLD and NEW are programs; runs (default: all) are those of this tree, with one thread. NEW may take SECONDS (default 3) of each; what
it has not ended by then both run again to where it has come, without measures, as their times may be later; those in load steps
whole. A line for each run whose state differs:
steps of both, by how much the greatest of energies differs, as a share of the greatest of them, and the measure that moved the most,
as a share of it. What OLD refuses (a key that it does not know) is listed apart, what NEW refuses or does not finish is a difference.
Exit code 1 when a state differs, 64 bad usage. Bits are those of one machine, compiler and precision: build both alike.
"""
import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from figures import TOP, Wrong, read_runs


class Program:
    def __init__(self, path):
        self.path = os.path.abspath(path)
        if not os.access(self.path, os.X_OK) or os.path.isdir(self.path):
            raise Wrong(f"{path} is not a program")

    def take(self, run, end=None, seconds=None):
        """What the run comes to: its summary, or the words of why there is none. It is asked to stop after `seconds`."""
        keys = [*run.overrides, "output.every=none", *([f"time.end={end!r} s", "measures={}"] if end else [])]
        sets = [word for key in keys for word in ("--set", key)]
        with tempfile.TemporaryDirectory() as folder:
            command = [self.path, "run", f"bench/scenes/{run.scene}.yaml", *sets, "-t", "1", "-q", "-o", folder]
            task = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            try:
                said, _ = task.communicate(timeout=seconds)
            except subprocess.TimeoutExpired:
                task.send_signal(signal.SIGINT)
                said, _ = task.communicate()
            try:
                with open(os.path.join(folder, "summary.json")) as file:
                    return json.load(file)
            except OSError:
                lines = [line for line in said.splitlines() if line.startswith(("bench/scenes/", "brunt:"))]
                return f"exit code {task.returncode}: {lines[-1] if lines else said.strip()}"


def states(old, new, seconds, run):
    """Summaries of both programs at the same end."""
    after, end = new.take(run, seconds=seconds), None
    if isinstance(after, dict) and after["status"] == "stopped":
        end = None if after["effects"].get("equilibrium") else after["time"] or None
        after = new.take(run, end)
    return old.take(run, end), after


def share(a, b, unit):
    return abs(a - b) / unit if unit else float(a != b)


def energy_moved(old, new):
    """Greatest change of an energy, over the greatest energy of the old run."""
    of = [{k: v for k, v in s["energy"].items() if k != "error_relative" and isinstance(v, (int, float))} for s in (old, new)]
    unit = max(map(abs, of[0].values()), default=0)
    return max((share(of[0][k], of[1][k], unit) for k in of[0].keys() & of[1].keys()), default=0)


def measure_moved(old, new):
    """The measure that changed the most, over its old value: how much, and its name; one that only one of the runs has is infinite."""
    of = [{k: m["value"] for k, m in s.get("measures", {}).items()} for s in (old, new)]
    moved = [(0, "")]
    for name in of[0].keys() | of[1].keys():
        a, b = of[0].get(name), of[1].get(name)
        if a != b:
            moved.append((float("inf") if None in (a, b) else share(a, b, abs(a)), name))
    return max(moved)


def tell(name, old, new):
    """The line of a run, and whether its state differs; None of one that OLD cannot run."""
    if isinstance(old, str):
        return f"{name:28} OLD: {old}", None
    if isinstance(new, str):
        return f"{name:28} NEW: {new}", True
    steps = f"{old['steps']} -> {new['steps']}" if old["steps"] != new["steps"] else f"{new['steps']}"
    size, measure = measure_moved(old, new)
    line = f"{name:28} {steps:>18} {energy_moved(old, new):11.1e} {size:11.1e} {measure}"
    if old["status"] != new["status"]:
        line += f"  {old['status']} -> {new['status']}: {new['reason']}"
    return line, old["state_hash"] != new["state_hash"] or old["status"] != new["status"]


def compare(old, new, jobs, seconds, runs):
    with ThreadPoolExecutor(jobs) as pool:
        told = [tell(r.name, *s) for r, s in zip(runs, pool.map(lambda r: states(old, new, seconds, r), runs))]
    moved = [line for line, differs in told if differs]
    refused = [line for line, differs in told if differs is None]
    if moved:
        print(f"{'run':28} {'steps':>18} {'energy':>11} {'measure':>11}")
    print("\n".join(moved + refused + [f"{len(told) - len(moved) - len(refused)} the same, {len(moved)} moved, {len(refused)} not run by OLD"]))
    return 1 if moved else 0


def main():
    parser = argparse.ArgumentParser(prog="hashes.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = lambda message: sys.exit(print(f"hashes.py: {message}", file=sys.stderr) or 64)
    parser.add_argument("command", choices=["compare"])
    parser.add_argument("old", metavar="OLD"), parser.add_argument("new", metavar="NEW")
    parser.add_argument("-j", type=int, default=os.cpu_count(), metavar="N")
    parser.add_argument("-s", type=float, default=3, metavar="SECONDS")
    parser.add_argument("runs", nargs="*", metavar="RUN")
    args = parser.parse_intermixed_args()
    try:
        old, new = Program(args.old), Program(args.new)
        os.chdir(TOP)
        known = read_runs()
        unknown = [name for name in args.runs if name not in known]
        if unknown or args.j < 1 or not args.s > 0:
            parser.error(f"no run {', '.join(unknown)} in bench/scenes/runs.txt" if unknown else "-j wants 1 and more, -s more than 0")
        sys.exit(compare(old, new, args.j, args.s, [known[name] for name in args.runs or known]))
    except Wrong as wrong:
        parser.error(str(wrong))


if __name__ == "__main__":
    main()
