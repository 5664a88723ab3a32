#!/usr/bin/env python3
"""Makes the mistakes of mutations.txt, one at a time in a copy of the sources, and tells which of them the tests notice.

    python3 tests/mutations.py [PART ...]    all of them, or those whose file's path holds one of the parts
    python3 tests/mutations.py check         makes none; tells whether each text is there just once

Each is three lines: the file and the suites that are to notice, the text that is there once, what stands there instead
(with \\n where a line ends).
The last line is "N passed, N failed": noticed and not. A mistake that does not build, or whose text is not there just
once, counts as not noticed. Takes some ten seconds a mistake.
"""
import os
import shutil
import subprocess
import sys

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COPY = os.path.join(SOURCE, "build", "mutations")


def read(path):
    """The mistakes: (file, suites, old, new)."""
    with open(path, encoding="utf-8") as lines:
        text = "\n".join(line for line in lines.read().splitlines() if not line.startswith("#"))
    for block in filter(str.strip, text.split("\n\n")):
        head, old, new = block.strip("\n").split("\n")
        file, suites = head.split(":")
        yield file, suites.split(), old[2:].replace("\\n", "\n"), new[2:].replace("\\n", "\n")


def copy_sources():
    names = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, capture_output=True, text=True).stdout.split("\n")
    for name in filter(None, names):
        target = os.path.join(COPY, name)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if not os.path.exists(target) or not same(os.path.join(SOURCE, name), target):
            shutil.copyfile(os.path.join(SOURCE, name), target)
            shutil.copymode(os.path.join(SOURCE, name), target)


def same(a, b):
    with open(a, "rb") as one, open(b, "rb") as other:
        return one.read() == other.read()


def build(targets):
    done = subprocess.run(["cmake", "--build", "build", "-j", str(os.cpu_count()), "--target", *targets], cwd=COPY,
                          capture_output=True, text=True)
    return done.returncode == 0, done.stdout + done.stderr


def suites_pass(suites):
    # What a mistake makes go on for ever is noticed as well.
    done = subprocess.run(["ctest", "--test-dir", "build", "--stop-on-failure", "--timeout", "600", "-j", str(os.cpu_count()), "-R", "^(%s)$" % "|".join(suites)],
                          cwd=COPY, capture_output=True)
    return done.returncode == 0


def noticed(file, suites, old, new):
    """What became of a mistake, and whether it was noticed."""
    path = os.path.join(COPY, file)
    with open(path, encoding="utf-8") as lines:
        sound = lines.read()
    if sound.count(old) != 1:
        return "its text is there %d times" % sound.count(old), False
    with open(path, "w", encoding="utf-8") as lines:
        lines.write(sound.replace(old, new))
    try:
        built, words = build(suites + ["brunt_program"])
        if not built:
            return "does not build: " + next((w for w in words.split("\n") if "error:" in w), words[-200:]), False
        return ("survived", False) if suites_pass(suites) else ("noticed", True)
    finally:
        with open(path, "w", encoding="utf-8") as lines:
            lines.write(sound)


def misplaced(mistakes):
    """How many texts are not there just once; says which."""
    count = 0
    for file, _, old, _ in mistakes:
        path, times = os.path.join(SOURCE, file), 0
        if os.path.exists(path):
            with open(path, encoding="utf-8") as lines:
                times = lines.read().count(old)
        if times != 1:
            count += 1
            print("%s: %d times: %s" % (file, times, old))
    return count


def main():
    if any(part.startswith("-") for part in sys.argv[1:]):
        sys.exit(__doc__.strip())
    every = list(read(os.path.join(SOURCE, "tests", "mutations.txt")))
    if sys.argv[1:] == ["check"]:
        sys.exit(1 if misplaced(every) else 0)
    mistakes = [m for m in every if not sys.argv[1:] or any(part in m[0] for part in sys.argv[1:])]
    misplaced(mistakes)
    suites = sorted({name for m in mistakes for name in m[1]})
    copy_sources()
    subprocess.run(["cmake", "--preset", "release", "-DBRUNT_BENCH=OFF"], cwd=COPY, check=True, stdout=subprocess.DEVNULL)
    built, words = build(suites + ["brunt_program"])
    if not built or not suites_pass(suites):
        sys.exit("The suites do not pass as they are.\n" + (words if not built else ""))
    count = [0, 0]
    for file, names, old, new in mistakes:
        what, good = noticed(file, names, old, new)
        count[good] += 1
        print("%-9s %s: %r -> %r" % (what, file, old, new), flush=True)
    print("%d passed, %d failed" % (count[1], count[0]))
    sys.exit(count[0] > 0 or count[1] == 0)


if __name__ == "__main__":
    main()
