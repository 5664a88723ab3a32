#!/usr/bin/env python3
"""What it costs to add a thing: the lines outside its own file that name a sample of its kind.

    python3 tests/adding.py          the figures and the places
    python3 tests/adding.py check    the figures; exit code 1 when one is beyond its limit

Code only: comments, tests and documents do not count. What names a sample as a default, a choice that the physics makes,
or a member of its own file counts as well, so that a figure is an upper bound.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# kind: (what names the sample, its own files, at most so many lines elsewhere)
SAMPLES = {
    "element": (r"\b(BRUNT_TET4|brunt_tet4|tet4)\b", r"engine/fem/elements/tet4\.c", 3),
    "material": (r"drucker[-_]prager", r"materials/drucker_prager\.c", 2),
    # Its word, a row for bodies of points and one for meshes with them, and what the reference says of it.
    "contact method": (r"multi[-_]velocity|MULTI_VELOCITY", r"contact/methods/(grid_velocity|surface_on_grid)", 4),
    # The list, the header of its definition, its member in brunt_boundary; a row for each key of its own besides. It has a file
    # each for its definition, what it does, and the keys that take more than filling a field.
    "boundary": (r"brunt_region|brunt/boundary_region|\bREGION\b|->regions\b|region_count|->where\b|\"region\"",
                 r"boundary_region\.[ch]$|engine/boundary/region\.c", 3),
    # Its word and its row.
    "condition of planes": (r"SYMMETRY|\"symmetry\"", r"^$", 2),
    # A line in the list of kinds, the rows of a measure of one body, and a row for each key of its own.
    "measure": (r"measures\.\*\.extent|OF_BODY\(\"extent|\bEXTENT\b|MEASURE_EXTENT", r"io/output/measure_extent\.c", 3),
    # Its row of a scene, the member that it fills, its row among a body's numbers: what it may be, how a prediction's
    # coarser scene scales it, that implicit steps refuse it.
    "body key": (r"(from|def|body)->mass_scaling|double mass_scaling;|[.*\"]\.mass_scaling", r"engine/fem/", 3),
    # Of elements; the row of material points besides.
    "output field": (r"\"von_mises\"|(derive|element)_von_mises", r"engine/body/mesh_fields\.c", 2),
}


def code(path):
    """The lines of a file without its comments."""
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), (ROOT / path).read_text(), flags=re.S)
    return [re.sub(r"(^|\s)//.*", "", line) for line in text.split("\n")]


def main():
    tracked = subprocess.run(["git", "ls-files", "engine", "contact", "materials", "io"], cwd=ROOT, capture_output=True,
                             text=True, check=True).stdout.split()
    sources = {f: code(f) for f in tracked if re.search(r"\.(c|h|inc)$", f) and (ROOT / f).exists()}
    broken = 0
    for kind, (pattern, own, limit) in SAMPLES.items():
        places = [(f, n, line.strip()) for f, lines in sources.items() if not re.search(own, f)
                  for n, line in enumerate(lines, 1) if re.search(pattern, line)]
        bad = limit is not None and len(places) > limit
        broken += bad
        print(f"{kind}: {len({f for f, _, _ in places})} files, {len(places)} lines" + (f" (at most {limit})" if bad else ""))
        if bad or sys.argv[1:] != ["check"]:
            for f, n, line in places:
                print(f"    {f}:{n}: {line[:100]}")
    sys.exit(1 if sys.argv[1:] == ["check"] and broken else 0)


if __name__ == "__main__":
    main()
