#!/usr/bin/env python3
"""What it costs to add a thing, by adding one: tests/adding/KIND.patch is a whole one of each kind.

    python3 tests/adding.py          the figures, and the lines elsewhere
    python3 tests/adding.py check    the figures; exit code 1 when one is beyond its limit, when a patch does not apply, when
                                     CONTRIBUTING.md says another figure, or when code asks for one of a kind by its name
                                     outside the rows of that kind
    python3 tests/adding.py run      adds all of them to a copy (build/adding), builds that, and runs the scenes beside the patches

Counted are files of its own (at most 1), and lines elsewhere (at most 3), in so many files: added ones, or taken ones
where those are more. Code only: documents, tests, and what chooses the thing in a scene do not count.
"""
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TRIALS = ROOT / "tests" / "adding"
KINDS = ["material", "element", "contact method", "contact method at nodes", "contact method by energy", "boundary", "boundary with a shape", "measure", "body key", "output field",
         "preset", "condition of planes", "pass", "other key of a scene", "key of loads", "stored field"]
# What is known to its rows alone: its list in a header and how code names one, but for what is none and the rows themselves.
ROWS = {
    "contact method": ("engine/include/brunt/definition.h", r"#define BRUNT_CONTACT_METHODS\(X\)", "BRUNT_CONTACT_", ["contact/methods/"]),
    "form of augury": ("engine/include/brunt/definition.h", r"#define BRUNT_AUGURY_FORMS\(X\)", "BRUNT_AUGURY_", ["contact/methods/list.c"]),
    "group action": ("engine/include/brunt/boundary_group.h", r"#define BRUNT_GROUP_ACTIONS\(X\)", "BRUNT_GROUP_",
                     ["engine/boundary/group_actions.c", "io/scene/boundary_group.c"]),
}


def named_outside():
    """(kind, "file:line") of code that names one of a kind outside its rows"""
    for kind, (header, start, prefix, rows) in ROWS.items():
        list_of = re.search(start + r"(.*?)\n(?!    )", (ROOT / header).read_text(), re.S).group(1)
        names = set(re.findall(rf"X\((\w+)[,)]|\b{prefix}(\w+)", list_of))
        name = re.compile(prefix + "(" + "|".join(a or b for a, b in names if a != "NONE") + r")\b")
        for folder in ("contact", "engine", "io", "materials"):
            for path in sorted((ROOT / folder).rglob("*.[ch]")):
                place = str(path.relative_to(ROOT))
                if place == header or place.startswith(tuple(rows)):
                    continue
                for number, line in enumerate(path.read_text().split("\n"), 1):
                    if name.search(line.split("//")[0]):
                        yield kind, f"{place}:{number}"


def patch(kind):
    return TRIALS / (kind.replace(" ", "_") + ".patch")


def count(kind):
    """(names of its own files, {file: lines} elsewhere)"""
    own, elsewhere, name, new, added, taken = [], {}, None, False, 0, 0
    for line in [*patch(kind).read_text().split("\n"), "diff --git a/ b/"]:
        if line.startswith("diff --git "):
            if name and new:
                own.append(name)
            elif name:
                elsewhere[name] = max(added, taken)
            name, new, added, taken = line.split(" b/")[1], False, 0, 0
        elif line.startswith("new file"):
            new = True
        elif re.match(r"[+-](?![+-]{2} )", line):
            added, taken = added + (line[0] == "+"), taken + (line[0] == "-")
    return own, elsewhere


def applies(kind):
    return subprocess.run(["git", "apply", "--check", patch(kind)], cwd=ROOT, capture_output=True).returncode == 0


def run():
    """All of them at once in a copy of what git knows."""
    copy = ROOT / "build" / "adding"
    shutil.rmtree(copy / "source", ignore_errors=True)
    (copy / "source").mkdir(parents=True)
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, names):
        if (ROOT / name).exists():
            (copy / "source" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, copy / "source" / name)
    for kind in KINDS:
        with open(patch(kind), encoding="utf-8") as text:
            subprocess.run(["patch", "-p1", "-s"], cwd=copy / "source", stdin=text, check=True)
    settings = ["-DCMAKE_BUILD_TYPE=Debug", "-DBRUNT_TESTS=OFF", "-DBRUNT_BENCH=OFF", "-DBRUNT_WERROR=ON"]
    subprocess.run(["cmake", "-S", copy / "source", "-B", copy / "build", *settings], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", copy / "build", "-j2"], check=True, stdout=subprocess.DEVNULL)
    for scene in sorted(TRIALS.glob("*.yaml")):
        subprocess.run([copy / "build" / "brunt", "run", scene, "-o", copy / scene.stem], check=True, stdout=subprocess.DEVNULL)
        print(f"{scene.stem}: its measures hold")


def main():
    if sys.argv[1:] == ["run"]:
        return run()
    check, broken = sys.argv[1:] == ["check"], 0
    said = (ROOT / "CONTRIBUTING.md").read_text()
    for kind in KINDS:
        own, elsewhere = count(kind)
        lines = sum(elsewhere.values())
        figure = f"{len(own)} + {lines} in {len(elsewhere)}"
        bad = []
        if len(own) > 1 or lines > 3:
            bad.append("too many")
        if not applies(kind):
            bad.append("its patch does not apply")
        if not re.search(rf"^\| {kind}\b[^|\n]*\| {re.escape(figure)} \|", said, re.M):
            bad.append("CONTRIBUTING.md says another figure")
        broken += bool(bad)
        print(f"{kind}: {figure} files" + "".join(f"; {b}" for b in bad))
        if bad or not check:
            for name in own:
                print(f"    {name}")
            for name, number in elsewhere.items():
                print(f"    {name}: {number}")
    for kind, place in named_outside():
        broken += 1
        print(f"{place}: a {kind} by its name outside its rows")
    sys.exit(1 if check and broken else 0)


if __name__ == "__main__":
    main()
