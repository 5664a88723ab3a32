#!/usr/bin/env python3
"""Counts how the sources are put together, and checks what must hold.

    python3 tests/structure.py          the figures
    python3 tests/structure.py check    the figures; exit code 1 when one is beyond its limit
    python3 tests/structure.py terms    where the terms of the field are found among the names of files and folders

Arrows against the order: includes of a folder that stands later in ORDER. Circles: files that include each other, by way of
headers. Functions are counted by their lines from the name to the closing brace at the line's start.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# A folder sees those before it; folders of one row do not see each other.
ORDER = [
    ["include"], ["base"], ["geometry"], ["materials"], ["grid"], ["mpm", "fem"], ["body"],
    ["contact"], ["contact/surface"], ["contact/distance"], ["contact/constraint"], ["contact/planes"],
    ["contact/search"], ["contact/methods"],
    ["boundary"], ["account"], ["world"], ["scheme"],
    ["io/file"], ["io/mesh"], ["io/scene"], ["io/output"], ["io/performance"], ["io/run"], ["io/study"], ["app"],
]
RANK = {folder: rank for rank, row in enumerate(ORDER) for folder in row}
LIMITS = {"arrows against the order": 0, "circles of files": 0, "unknown folders": 0}
TERMS = {  # of the field: what a file or folder is looked for by
    "hourglass control": "hourglass", "return mapping": "return_mapping|j2|von_mises", "friction cone": "coulomb",
    "stable time step": "stable_step", "checkpoint": "checkpoint", "B-spline weights": "bspline",
    "APIC affine field": "apic|affine", "erosion": "erosion", "programmed burn": "ignition|burn", "GJK": "gjk",
    "broad phase": "broad_phase", "energy ledger": "energy|ledger", "units": "units", "plots": "plot",
    "symmetry plane": "symmetry",
}


def sources():
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return [f for f in tracked if re.match(r"(engine|contact|materials|io)/.*\.(c|h|inc)$", f) and (ROOT / f).exists()]


def below(path):
    """The path from the root that includes are written from."""
    return re.sub(r"^engine/(include/)?", "", path)


def folder(path):
    if path.startswith("engine/include/"):
        return "include"
    name = below(path).rsplit("/", 1)[0]
    while name not in RANK and "/" in name:
        name = name.rsplit("/", 1)[0]
    return name


def includes(path, known):
    text = (ROOT / path).read_text()
    return [known[name] for name in re.findall(r'^ *# *include "([^"]+)"', text, re.M) if name in known]


def circles(graph):
    """Sets of more than one file that reach each other (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(v):
        index[v] = low[v] = len(index)
        stack.append(v)
        for w in graph[v]:
            if w not in index:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in stack:
                low[v] = min(low[v], index[w])
        if low[v] == index[v]:
            part = []
            while not part or part[-1] != v:
                part.append(stack.pop())
            if len(part) > 1 or v in graph[v]:
                found.append(sorted(part))

    for v in graph:
        if v not in index:
            visit(v)
    return found


def functions(path):
    """(name, lines, parameters) of each function that is defined in a file."""
    lines = (ROOT / path).read_text().split("\n")
    for i, line in enumerate(lines):
        if not line.endswith("{") or line.startswith((" ", "#", "}", "/", "typedef", "struct", "enum", "union", "static const struct")):
            if not (line.startswith((" ", "\t")) and line.endswith(") {")):
                continue
        first = i
        while first and (lines[first].startswith((" ", "\t"))):
            first -= 1
        head = " ".join(lines[first : i + 1])
        match = re.match(r"[A-Za-z_][\w\s\*]*?(\w+)\((.*)\) \{$", head)
        if not match or "=" in head or lines[first].startswith(("#", "}")) or match.group(1) in ("for", "if", "while", "switch"):
            continue
        end = i
        while end < len(lines) and not lines[end].startswith("}"):
            end += 1
        depth, count = 0, 0 if match.group(2) in ("", "void") else 1
        for c in match.group(2):
            depth += c in "([" 
            depth -= c in ")]"
            count += c == "," and depth == 0
        yield match.group(1), end - first + 1, count


def world_members():
    for path in sources():
        match = re.search(r"^struct brunt_world \{\n(.*?)^\};", (ROOT / path).read_text(), re.M | re.S)
        if match:
            body = re.sub(r"//.*", "", match.group(1))
            body = re.sub(r"\}|\b(struct|union)\b[^;{]*\{", ";", body)  # what stands within counts as well
            return sum(len(s.split(",")) for s in body.split(";") if s.strip())
    return 0


def figures():
    files = sources()
    known = {below(f): f for f in files}
    graph = {f: includes(f, known) for f in files}
    arrows = [(f, t) for f in files for t in graph[f] if folder(f) in RANK and folder(t) in RANK and folder(f) != folder(t)
              and RANK[folder(t)] >= RANK[folder(f)]]
    unknown = sorted({folder(f) for f in files} - set(RANK))
    loops = circles(graph)
    defined = [(f, *function) for f in files for function in functions(f)]
    long = [d for d in defined if d[2] > 60]
    wide = [d for d in defined if d[3] > 7]
    size = {f: len((ROOT / f).read_text().split("\n")) - 1 for f in files}
    largest = max(size, key=size.get)
    return [
        ("arrows against the order", len(arrows), [f"{a} -> {b}" for a, b in arrows]),
        ("circles of files", len(loops), [" ".join(loop) for loop in loops]),
        ("unknown folders", len(unknown), unknown),
        ("members of the world", world_members(), []),
        ("functions", len(defined), []),
        ("functions over 60 lines", len(long), [f"{f}: {name}, {lines}" for f, name, lines, _ in long]),
        ("functions with over 7 parameters", len(wide), [f"{f}: {name}, {count}" for f, name, _, count in wide]),
        ("lines of the largest file", size[largest], [largest]),
        ("files over 600 lines", sum(s > 600 for s in size.values()), [f"{f}: {s}" for f, s in size.items() if s > 600]),
        ("lines", sum(size.values()), []),
    ]


def terms():
    names = subprocess.run(["git", "ls-files", "engine", "contact", "materials", "io"], cwd=ROOT, capture_output=True, text=True,
                           check=True).stdout.split()
    missing = 0
    for term, pattern in TERMS.items():
        found = [n for n in names if re.search(pattern, n)]
        missing += not found
        print(f"{term}: {' '.join(found[:4]) or 'NOT FOUND'}")
    return missing


def main():
    if sys.argv[1:] == ["terms"]:
        sys.exit(1 if terms() else 0)
    broken = 0
    for name, value, where in figures():
        bad = name in LIMITS and value > LIMITS[name]
        broken += bad
        print(f"{value:7} {name}" + (f" (at most {LIMITS[name]})" if bad else ""))
        if bad or sys.argv[1:] != ["check"]:
            for place in where:
                print(f"          {place}")
    sys.exit(1 if sys.argv[1:] == ["check"] and broken else 0)


if __name__ == "__main__":
    main()
