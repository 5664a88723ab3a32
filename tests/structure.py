#!/usr/bin/env python3
"""Counts how the sources are put together, and checks what must hold.

    python3 tests/structure.py          the figures
    python3 tests/structure.py check    the figures; exit code 1 when one is beyond its limit
    python3 tests/structure.py terms    where the terms of the field are found among the names of files and folders

Arrows against the order: includes of a folder that stands later in ORDER. Circles: files that include each other, by way of
headers. Functions are counted by their lines from the name to the closing brace at the line's start
(or at the end of their one line). Tables are arrays of constants, static or of a whole file, without a number for their
extent: counted by BRUNT_COUNT, a static assert, or the NULL at their end. Lines are repeated where six
or more stand in two places. A line that returns -1 says neither that something failed (BRUNT_FAILED, with a message) nor that
there is none of something (BRUNT_NONE). A function takes the world for one part when it names one member of the
brunt_world that it is given, and hands the world on to no other: the part is what it wants. Not counted are functions whose
type is fixed, found by where they stand: in a table of passes (brunt_pass_row), or declared in a public header.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# A folder sees those before it; folders of one row do not see each other.
ORDER = [
    ["include"], ["base"], ["linear"], ["geometry"], ["materials"], ["grid"], ["mpm", "fem"], ["body"],
    ["contact/surface"], ["contact/distance"], ["contact/constraint"], ["contact"], ["contact/planes"],
    ["contact/search"], ["contact/methods"], ["contact/barrier"],
    ["boundary"], ["account"], ["world"], ["scheme"],
    ["io/file"], ["io/mesh"], ["io/scene"], ["io/output"], ["io/performance"], ["io/run"], ["io/study"], ["app"],
]
RANK = {folder: rank for rank, row in enumerate(ORDER) for folder in row}
LIMITS = {
    "arrows against the order": 0, "circles of files": 0, "unknown folders": 0, "headers that shadow a system's": 0,
    "includes not from the root": 0, "members of the world": 13, "functions that take the world for one part": 0, "functions over 60 lines": 0,
    "functions with over 7 parameters": 0, "lines of the largest file": 599, "files over 600 lines": 0,
    "tables that nothing counts": 0, "pointers to void pointers": 0, "lines that return -1": 0,
    "words not of plain English": 0, "words of before": 0,
    "lines repeated in blocks of six": 0, "terms not found": 0, "suites of label double that go through single precision": 0,
}
# Words that were the project's own for what the field has a term for (CONTRIBUTING.md), as parts of identifiers; and where one
# of them means something else: (paths, identifiers, what it means there).
BEFORE = re.compile(r"(?:^|_)(?:walls?|mirror(?:s|ed)?|sheets?|skins?|book(?:s|ed|ing)?|meetings?|rings?|reach|facing|looker|sight|ragged|"
                    r"scatter|gather|remap|rooms?|loose|slack|drag|actions?|places?)(?:_|$)", re.I)
ELSEWHERE = [
    (r"^io/", r"(\w+_)?walls?(_\w+)?", "time of the wall clock"),
    (r"^(contact|engine)/", r"(\w+_)?gather(_\w+)?|GATHER", "numbers from all over the memory in a row; sums of what followers have"),
    (r"^contact/|^engine/world/surfaces", r"(\w+_)?scatter(_\w+)?", "what contact gives to nodes, not particles to the grid"),
    (r"^(engine|contact)/", r"reach|\w+_(reach|REACH)", "a field of particles: columns of output have its name"),
    (r"^engine/(geometry/fill|world/definition_check|include/brunt/body)", r"(\w+_)?rings(_\w+)?|\w+_RINGS", "particles in rings: a word of scenes"),
    (r"^(engine|io|materials)/", r"actions?|ACTIONS|BRUNT_GROUP_ACTIONS|posix_\w+|\w+_action", "of a group, of failure: keys of scenes; of POSIX"),
    (r"^engine/", r"(\w+_)?drag(_\w+)?", "of damping"),
    (r"^(engine|io|contact)/", r"room", "how much a text or an array takes, of a function's own"),
    (r"", r"(\w+_)?places?(_\w+)?|\w+_PLACES?", "an index in a list; `place` of scenes"),
]
BARE = re.compile(r"\breturn (?:-1;|[^;]*(?:\? -1 : 0;|(?<!\? 1) : -1;))")  # but for what compares: -1 or 1
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


def texts():
    """Sources, tests, scenes and documents; this file names the words it looks for."""
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return [f for f in tracked if re.search(r"\.(c|h|inc|md|py|sh|yaml|txt|cmake)$", f) and f != "tests/structure.py" and (ROOT / f).exists()]


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


def code(path):
    """The text with comments, strings, lines of the preprocessor and uses of macros that make functions (in capitals, at the
    line's start) as blanks: every line and column stays where it is."""
    text = (ROOT / path).read_text()
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, text, flags=re.S)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, text, flags=re.M)
    return re.sub(r"^[A-Z][A-Z0-9_]*\([^;{}()]*\)$", blank, text, flags=re.M)


def parameters(head):
    """(name, count) of a function whose text before its brace this is; None when it is something else."""
    head = re.sub(r"__attribute__\(\(.*?\)\)", " ", head).strip()
    match = re.fullmatch(r"[\w\s*]*?(\w+)\s*\((.*)\)", head, re.S)
    if not match:
        return None
    inner = match.group(2)
    while inner != (flat := re.sub(r"\([^()]*\)|\[[^\[\]]*\]", "", inner)):
        inner = flat
    return match.group(1), 0 if inner.strip() in ("", "void") else inner.count(",") + 1


def functions(path):
    """(name, lines, parameters, head, body) of each function that is defined in a file. The formatter ends each by a brace at the
    line's start."""
    text = code(path)
    start = 0
    for end in re.finditer(r"^(?:\}.*|\w.*\) \{.*\})$", text, re.M):  # the latter: of one line
        close = end.start() if text[end.start()] == "}" else end.end() - 1
        part = text[start:close]
        brace = re.search(r"\{", part[part.rfind(";", 0, part.find("{") + 1) + 1 :])
        first = part.rfind(";", 0, part.find("{") + 1) + 1
        head = part[first : first + brace.start()] if brace else ""
        found = parameters(head)
        if found:
            begin = start + first + len(head) - len(head.lstrip())
            yield found[0], text.count("\n", begin, close) + 1, found[1], head, part[first + brace.start() :]
        start = end.end()


def fixed():
    """Names of functions whose type a table of passes or the public interface gives."""
    names = set()
    for path in sources():
        text = code(path)
        if path.startswith("engine/include/"):
            names.update(re.findall(r"\b(brunt_\w+)\(", text))
        for table in re.finditer(r"^const brunt_pass_row \w+\[\] = \{(.*?)^\};", text, re.M | re.S):
            names.update(re.findall(r"\b[a-z]\w+\b", table.group(1)))
    return names


def one_part(head, body):
    """The one member that a function uses of the world that it takes, and hands on to none; None: it takes none, or wants it whole."""
    world = re.search(r"\bbrunt_world \*(?:const )?(\w+)\s*[,)]", head)
    if not world:
        return None
    uses = re.findall(rf"\b{world.group(1)}\b(?:\s*->\s*(\w+))?", re.sub(rf"\(void\){world.group(1)}\b", "", body))
    return uses[0] if len(set(uses)) == 1 and uses[0] else None


def uncounted(path):
    """Names of the tables of a file whose rows nothing counts: one too few or too many would go unseen."""
    text = re.sub(r"//[^\n]*|\"[^\"\n]*\"", "", (ROOT / path).read_text())
    users = text if not path.endswith(".h") else "".join((ROOT / f).read_text() for f in sources())
    for table in re.finditer(r"^(?:(?:static |extern )?const |[ \t]*static const )[^;{}()]*?[ *](\w+)\[([^\]\n]*)\][^;{}()]*? = \{(.*?)\};", text, re.M | re.S):
        name, extent, rows = table.groups()
        tail = name[name.rfind("_"):]  # macros paste names together
        counted = rf"(?:COUNT\w*\(|sizeof[ (]|_assert\([^;]*\b|LISTED_ROW\([^;]*\b)(?:{name}\b|\w+##{tail}\b)"
        if not extent.isdigit() and not rows.rstrip().endswith("NULL") and not re.search(counted, users):
            yield f"{path}: {name}"


def wordings(path):
    """Words that the house does not use of things, by place."""
    for number, line in enumerate((ROOT / path).read_text(errors="replace").split("\n"), 1):
        for word in re.findall(r"\b[Ww]ho\b|\b(?:is|are|was) gone\b|comes? to light|\b(?:[Nn]obody|[Ss]omeone|[Ss]ooner|bears)\b", line):
            yield f"{path}:{number}: {word}"


def before(path):
    """Identifiers with a word of before, by path: code and macros, without comments, strings and includes."""
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', " ", (ROOT / path).read_text(), flags=re.S)
    meant = [name for where, name, _ in ELSEWHERE if re.search(where, path)]
    for name in sorted({name for name in re.findall(r"[A-Za-z_]\w*", text) if BEFORE.search(name)}):
        if not any(re.fullmatch(other, name) for other in meant):
            yield f"{path}: {name}"


def repeated(files, least=6):
    """Lines that stand in two places, `least` or more one after the other (files, or apart in one), by place. Blank lines,
    includes and lone braces do not count as lines."""
    lines = []
    for path in files:
        for number, line in enumerate((ROOT / path).read_text().split("\n"), 1):
            line = re.sub(r"\s+", " ", line.split("//")[0]).strip()
            if re.search(r"\w", line) and not line.startswith("#include"):
                lines.append((line, path, number))
    windows = {}
    for i in range(len(lines) - least + 1):
        if lines[i][1] == lines[i + least - 1][1]:
            windows.setdefault(tuple(line for line, _, _ in lines[i : i + least]), []).append(i)
    again = sorted({i + k for at in windows.values() if len(at) > 1 for i in at for k in range(least)})
    places = [lines[i] for i in again if i - 1 not in again]
    return len(again), [f"{path}:{number}" for _, path, number in places]


def shadows(files):
    """Headers of ours that another's angle brackets would find: by the path that they are included by, or its last part."""
    return [f for f in files if f.endswith(".h") and (Path("/usr/include") / below(f)).exists()]


def unrooted(files, known):
    """Includes in quotes that are not written from the root of the sources."""
    return [f"{f}: {name}" for f in files for name in re.findall(r'^ *# *include "([^"]+)"', (ROOT / f).read_text(), re.M)
            if name not in known and name not in ("brunt.h",)]


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
    given = fixed()
    narrow = [(f, name, part) for f, name, _, _, head, body in defined if name not in given and (part := one_part(head, body))]
    copies, copied = repeated(files)
    loose = [name for f in files for name in uncounted(f)]
    voids = [f"{f}:{n}" for f in files for n, line in enumerate(code(f).split("\n"), 1) if re.search(r"void\s*\*\s*(?:const\s*)?\*", line)]
    bare = [f"{f}:{n}" for f in files for n, line in enumerate(code(f).split("\n"), 1) if BARE.search(line)]
    words = [place for f in texts() for place in wordings(f)]
    old = [place for f in files for place in before(f)]
    lost = [term for term, found in terms() if not found]
    single = list(in_single())
    return [
        ("arrows against the order", len(arrows), [f"{a} -> {b}" for a, b in arrows]),
        ("circles of files", len(loops), [" ".join(loop) for loop in loops]),
        ("unknown folders", len(unknown), unknown),
        ("headers that shadow a system's", len(shadows(files)), shadows(files)),
        ("includes not from the root", len(unrooted(files, known)), unrooted(files, known)),
        ("members of the world", world_members(), []),
        ("functions", len(defined), []),
        ("functions that take the world for one part", len(narrow), [f"{f}: {name}, {part}" for f, name, part in narrow]),
        ("functions over 60 lines", len(long), [f"{f}: {name}, {lines}" for f, name, lines, *_ in long]),
        ("functions with over 7 parameters", len(wide), [f"{f}: {name}, {count}" for f, name, _, count, *_ in wide]),
        ("lines of the largest file", size[largest], [largest]),
        ("files over 600 lines", sum(s > 600 for s in size.values()), [f"{f}: {s}" for f, s in size.items() if s > 600]),
        ("tables that nothing counts", len(loose), loose),
        ("pointers to void pointers", len(voids), voids),
        ("lines that return -1", len(bare), bare),
        ("words not of plain English", len(words), words),
        ("words of before", len(old), old),
        ("lines repeated in blocks of six", copies, copied),
        ("terms not found", len(lost), lost),
        ("suites of label double that go through single precision", len(single), single),
        ("lines", sum(size.values()), []),
    ]


def in_single():
    """What suites of label double, which are not built in single precision, go through that has numbers of the precision: of the
    headers they include, the sources beside these, and what those include; but for public ones, and those where it is said what
    such a number is."""
    known = [f for f in sources() if "/include/" not in f]
    for suite in sorted((ROOT / "tests").glob("*/test_*.c")):
        if not re.search(r"^// Labels: .*\bdouble\b", suite.read_text(), re.M):
            continue
        seen, ahead = set(), [str(suite.relative_to(ROOT))]
        while ahead:
            f = ahead.pop()
            if f in seen or not (ROOT / f).exists() or f in ("engine/base/real.h", "engine/base/simd.h"):
                continue
            seen.add(f)
            text = code(f)
            if re.search(r"\b(real|lanes(_\w+)?|lane_(int|mask)|BRUNT_(FLOAT|LANES|LANE_BYTES|REAL_NAME))\b", text):
                yield f"{suite.stem}: {f}"
            for name in re.findall(r'#include "(.+?)"', (ROOT / f).read_text()):
                ahead += [k for k in (name, "engine/" + name) if k in known or k.startswith("tests/")]
            ahead += [f[:-1] + "c"] if f.endswith(".h") else []


def terms():
    """(term, names of files and folders where it is found)"""
    names = subprocess.run(["git", "ls-files", "engine", "contact", "materials", "io"], cwd=ROOT, capture_output=True, text=True,
                           check=True).stdout.split()
    return [(term, [n for n in names if re.search(pattern, n)]) for term, pattern in TERMS.items()]


def main():
    if sys.argv[1:] == ["terms"]:
        for term, found in terms():
            print(f"{term}: {' '.join(found[:4]) or 'NOT FOUND'}")
        return 0
    asked = sys.argv[1:] == ["check"]
    broken = 0
    for name, value, where in figures():
        bad = value > LIMITS.get(name, value)
        broken += bad
        lower = value < LIMITS.get(name, value)
        print(f"{value:7} {name}" + (f" (at most {LIMITS[name]})" if bad else f" (lower the limit, {LIMITS[name]})" if lower else ""))
        for place in where if bad or not asked else ():
            print(f"          {place}")
    return 1 if asked and broken else 0


if __name__ == "__main__":
    sys.exit(main())
