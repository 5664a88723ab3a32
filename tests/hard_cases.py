#!/usr/bin/env python3
"""The page of hard cases: what is asked, what was measured, whether that holds, and the suite that says so.

    python3 tests/hard_cases.py write FOLDER    writes hard_cases.md from what the suites left in FOLDER
    python3 tests/hard_cases.py check FOLDER    tells whether the page says so: each measure there, with its verdict

Suites leave their measures where the environment's BRUNT_HARD_CASES points to while they run (hard_case.h):

    mkdir -p build/hard_cases && BRUNT_HARD_CASES=$PWD/build/hard_cases ctest --test-dir build
"""
import glob
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
PAGE = os.path.join(HERE, "hard_cases.md")
HEAD = """# Hard cases

What is asked of each case of the catalogue, what was measured, and which suite says so. Made by
`python3 tests/hard_cases.py write FOLDER` (see there) from what the suites measured in double precision; every measure is
asserted by its suite, and that this page tells them right by a test.

%d of %d measures hold, of %d cases.

| | asked | measured | | |
| --- | --- | --- | --- | --- |
"""


def catalogue():
    """By number: what is asked, and the note, if any."""
    cases = {}
    number = None
    with open(os.path.join(HERE, "hard_cases.txt"), encoding="utf-8") as lines:
        for line in map(str.strip, lines):
            if line.startswith("note:"):
                cases[number][1] = line[5:].strip()
            elif line and not line.startswith("#"):
                number, asked = line.split(" ", 1)
                cases[number] = [asked, ""]
    return cases


def measures(folder):
    rows = {}
    for path in sorted(glob.glob(os.path.join(folder, "*.tsv"))):
        with open(path, encoding="utf-8") as lines:
            for line in lines:
                number, suite, what, measured, asked, verdict = line.rstrip("\n").split("\t")
                rows[number, suite, what] = (measured, asked, verdict)
    return rows


def places(number):
    """Suites and scenes with a comment that names the case."""
    found = []
    for pattern, mark in (("tests/*/test_*.c", "//"), ("bench/scenes/*.yaml", "#")):
        for path in sorted(glob.glob(os.path.join(HERE, "..", pattern))):
            with open(path, encoding="utf-8") as lines:
                if re.search(r"^ *%s.*\b%s\b" % (mark, number), lines.read(), re.M):
                    found.append(os.path.splitext(os.path.basename(path))[0])
    return found


def benchmarks():
    lines = ["", "## Benchmarks", "", "| | | where it is tested |", "| --- | --- | --- |"]
    for number, (what, note) in sorted(catalogue().items()):
        if number[0] == "B":
            where = ", ".join(places(number)) or note
            complain([] if where else [number + " stands in no suite and no scene, and has no note"])
            lines.append("| **%s** | %s | %s |" % (number, what, where))
    return "\n".join(lines) + "\n"


def page(rows):
    cases = {number: case for number, case in catalogue().items() if number[0] == "C"}
    complain([("%s is not in the catalogue" % n) for n, _, _ in rows if n not in cases])
    lines = []
    for number, (asked, note) in sorted(cases.items()):
        own = [(key, rows[key]) for key in rows if key[0] == number]
        if not own and not note:
            complain(["%s has neither a measure nor a note" % number])
        if any(row[2] != "holds" for _, row in own) and not note:
            complain(["%s falls short without a note" % number])
        lines.append("| **%s** | %s | %s | | |" % (number, asked, note))
        lines += ["| | %s | %s of %s | %s | %s |" % (what, row[0], row[1], "holds" if row[2] == "holds" else "**falls short**",
                                                   suite) for (_, suite, what), row in own]
    good = sum(row[2] == "holds" for row in rows.values())
    return HEAD % (good, len(rows), len({n for n, _, _ in rows})) + "\n".join(lines) + "\n" + benchmarks()


def told():
    """What the page says: by suite and measure, the verdict."""
    with open(PAGE, encoding="utf-8") as lines:
        text = lines.read()
    return {(m[4], m[1]): m[3].strip("*") for m in re.finditer(r"^\| \| (.*?) \| (.*?) \| (.*?) \| (\w+) \|$", text, re.M)}


def complain(words):
    if words:
        sys.exit("\n".join(words))


def close(row):
    """So near what is asked that another processor's rounding may tell it the other way."""
    return abs(float(row[0]) - float(row[1])) <= 0.1 * float(row[1])


def check(rows):
    page_says = told()
    suites = {suite for _, suite, _ in rows}
    found = {(suite, what): row for (_, suite, what), row in rows.items()}
    complain(["%s, %s: %s of %s, and the page says %s" % (*key, row[0], row[1], page_says.get(key, "nothing"))
              for key, row in found.items() if key not in page_says or page_says[key] != row[2] and not close(row)] +
             ["%s, %s: on the page, and not measured" % key for key in page_says
              if key[0] in suites and key not in found])
    with open(PAGE, encoding="utf-8") as lines:
        complain([] if lines.read().endswith(benchmarks()) else ["the page's benchmarks are not those of the sources"])
    print("hard_cases.md: %d measures as they were found" % len(found))


def main():
    if len(sys.argv) != 3 or sys.argv[1] not in ("write", "check"):
        sys.exit(__doc__)
    rows = measures(sys.argv[2])
    complain([] if rows else ["there is no measure in " + sys.argv[2]])
    if sys.argv[1] == "check":
        check(rows)
    else:
        text = page(rows)  # before the page is opened: what is missing leaves it as it is
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(text)


main()
