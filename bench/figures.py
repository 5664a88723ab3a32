#!/usr/bin/env python3
"""Runs the scenes, keeps their figures, and writes these into the documents that quote them.

  figures.py list                      the runs of bench/scenes/runs.txt
  figures.py run [-j N] [RUN...]       runs them (default: all) into out/figures/RUN
  figures.py write [RUN...]            what they gave becomes bench/scenes/figures.csv, and this goes into the documents
  figures.py check                     the documents say what figures.csv says, and every scene is run to its end
  figures.py test RUN                  runs one and compares it with figures.csv
  figures.py compare OLD NEW           what moved between two folders of runs, or two files like figures.csv
  figures.py contact [PATTERN]         runs of bench/studies/contact_table.sh give the rows of contact_table.md; times are not compared

BRUNT names the program, default build/brunt. What documents quote stands in bench/figures.txt.
"""
import csv, glob, json, math, os, re, shlex, shutil, subprocess, sys, tempfile
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
RUNS, FIGURES, QUOTES, OUT = "bench/scenes/runs.txt", "bench/scenes/figures.csv", "bench/figures.txt", "out/figures"
TABLE = "bench/studies/contact_table.md"
HEAD = ["run", "figure", "value", "expect", "within"]
ADDRESS = re.compile(r"([a-z]\w*)\.([a-z][\w.@-]*\w)")
NUMBER = r"[+-]?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?"


class Run(NamedTuple):
    name: str
    scene: str
    label: str
    overrides: list
    short: list  # measures that are known to miss what they should be
    scatter: list  # measures that last digits move by as much as they are: asked is what the scene asks
    shares: dict  # of a figure, that it may be off on another machine: of some by name, "": of all others


class Figure(NamedTuple):
    value: float
    expect: float = None
    within: float = 0


class Wrong(Exception):
    pass


# ---------------------------------------------------------------------------------------------------- what there is


def lines_of(path):
    with open(path) as file:
        return [(n, line.rstrip("\n")) for n, line in enumerate(file, 1) if line.strip() and not line.startswith("#")]


def read_runs():
    runs = {}
    for n, line in lines_of(RUNS):
        words = shlex.split(line)
        if len(words) < 3 or words[2] not in ("quick", "long") or words[0] in runs:
            raise Wrong(f"{RUNS}:{n}: RUN SCENE quick|long [short:MEASURE] [scatter:MEASURE] [within:[MEASURE:]SHARE] [KEY=VALUE...] is wanted, every RUN once")
        known = {k: [w[len(k):] for w in words[3:] if w.startswith(k)] for k in ("short:", "scatter:", "within:")}
        rest = [w for w in words[3:] if not w.startswith(tuple(known))]
        shares = {name: float(share) for name, _, share in (w.rpartition(":") for w in ["0.01", *known["within:"]])}
        runs[words[0]] = Run(*words[:3], rest, known["short:"], known["scatter:"], shares)
    return runs


def read_figures(path=FIGURES):
    figures = {}
    if os.path.exists(path):
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                expect = float(row["expect"]) if row["expect"] else None
                figures[row["run"], row["figure"]] = Figure(float(row["value"]), expect, float(row["within"]))
    return figures


def write_figures(figures):
    with open(FIGURES, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEAD)
        for (run, name), f in figures.items():
            writer.writerow([run, name, f"{f.value:.8g}", "" if f.expect is None else f"{f.expect:.8g}", f"{f.within:.2g}"])


def read_quotes():
    """(document, heading, line of bench/figures.txt, phrase) in turn."""
    document, heading, quotes = None, "", []
    for n, line in lines_of(QUOTES):
        if line[0].isspace():
            quotes.append((document, heading, n, line.strip()))
        else:
            document, _, heading = line.strip().partition(" > ")
    return quotes


def quoted():
    """Names of the figures that documents quote, by run."""
    names = {}
    for *_, phrase in read_quotes():
        for place in re.findall(r"{(.*?)}", phrase):
            for run, name in ADDRESS.findall(place):
                names.setdefault(run, {})[name.removesuffix(".off")] = None
    return names


# ---------------------------------------------------------------------------------------------------- runs


def brunt():
    return os.path.abspath(os.environ.get("BRUNT", "build/brunt"))


def take(run, folder):
    """Runs it into the folder; the summary, or None."""
    shutil.rmtree(folder, ignore_errors=True)
    sets = [word for o in run.overrides for word in ("--set", o)]
    command = [brunt(), "run", f"bench/scenes/{run.scene}.yaml", *sets, "-t", "1", "-q", "-o", folder]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    shutil.rmtree(os.path.join(folder, "vtu"), ignore_errors=True)
    if done.returncode:
        print(f"{run.name}: exit code {done.returncode}\n{shlex.join(command)}\n{done.stdout}", file=sys.stderr)
        return None
    return load(folder)


def load(folder):
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)


def at_time(folder, name):
    """COLUMN@SECONDS of the history, linear between its lines."""
    column, time = name.split("@")
    time, before = float(time), None
    with open(os.path.join(folder, "history.csv"), newline="") as file:
        for row in csv.DictReader(file):
            row = {key.split(" [")[0]: text for key, text in row.items()}
            t, value = float(row["time"]), float(row[column])
            if t >= time * (1 - 1e-9):
                return value if before is None else before[1] + (value - before[1]) * (time - before[0]) / (t - before[0])
            before = t, value
    raise Wrong(f"{folder}: the history ends before {time} s")


def figures_of(run, folder, summary, names):
    """All measures that were measured, the steps, and what else is named, as Figures."""
    measures, found = {n: m for n, m in summary["measures"].items() if m["value"] is not None}, {}
    for name in ["steps", *measures, *names]:
        expect = None
        if name in measures:
            value, expect = measures[name]["value"], measures[name]["expect"]
        elif "@" in name:
            value = at_time(folder, name)
        else:
            value = summary
            for key in name.split("."):
                value = value[key]
        share = 0.1 if expect == 0 else run.shares.get(name, run.shares[""])  # what should be nothing is rounding, or an error of second order
        within = float("inf") if name in run.scatter else share * abs(value) + 1e-9 * (expect == 0)
        found[name] = Figure(float(value), expect, within)
    return found


def missed(run, summary):
    return [name for name, m in summary["measures"].items() if m["ok"] is False and name not in run.short]


# ---------------------------------------------------------------------------------------------------- documents


def cubes(form, h, column):
    """A figure of two cubes of elements that meet, by contact_table.md."""
    row = rows_of(TABLE).get(("Two cubes that meet at 22 degrees", form, str(h)))
    if not row:
        raise Wrong(f"no {form}, {h} in {TABLE}")
    return float(row[column])


def fill(place, figures):
    """The text of one place, `EXPRESSION FORMAT`, with RUN.FIGURE for a value and RUN.FIGURE.off for how far it is off."""
    def value(match):
        run, name = match.groups()
        f = figures.get((run, name.removesuffix(".off")))
        if f is None:
            raise Wrong(f"no {run}.{name} in {FIGURES}")
        if name.endswith(".off"):
            return repr((f.value - f.expect) / (abs(f.expect) or 1))
        return repr(f.value)

    expression, form = place.rsplit(" ", 1)
    number = eval(ADDRESS.sub(value, expression), {"__builtins__": {}, "abs": abs, "max": max, "cubes": cubes})
    text = format(round(number) if form.endswith("d") else number, form)
    text = re.sub(r"e([+-])0?(\d)", lambda m: "e" + m[1].replace("+", "") + m[2], text)
    return re.sub(r"^-(0(?:\.0*)?)$", r"\1", text)


def pattern_of(phrase):
    """Matches the phrase with any numbers in its places, any white space between its words, and for `...` any text of a line."""
    literal, blank = {"...": r"[^\n]*?"}, " +" if phrase.startswith("|") else r"\s+"  # rows of tables are lines
    parts = [[literal.get(word, re.escape(word)) for word in re.split(r"\s+", part)] for part in re.split(r"{.*?}", phrase)]
    return re.compile(f"({NUMBER})".join(blank.join(words) for words in parts))


def section_of(text, heading):
    """Begin and end of what stands under a heading; of all without one."""
    found = re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)", text, re.M | re.S) if heading else None
    return found.span(1) if found else (0, 0 if heading else len(text))


def documents(figures, change):
    """Goes through all quotes; what is wrong. With `change` the documents are written."""
    wrong, texts = [], {}
    for document, heading, n, phrase in read_quotes():
        where = f"{QUOTES}:{n}"
        text = texts.get(document) or open(document).read()
        found = list(pattern_of(phrase).finditer(text, *section_of(text, heading)))
        if len(found) != 1:
            wrong.append(f"{where}: {document} has {len(found)} places like '{phrase}', one is wanted")
            continue
        try:
            wanted = [fill(place, figures) for place in re.findall(r"{(.*?)}", phrase)]
        except (Wrong, SyntaxError, ValueError, TypeError) as error:
            wrong.append(f"{where}: {error}")
            continue
        for k in reversed(range(len(wanted))):
            begin, end = found[0].span(k + 1)
            if text[begin:end] != wanted[k]:
                if not change:
                    line = text.count("\n", 0, begin) + 1
                    wrong.append(f"{document}:{line}: {text[begin:end]} where the runs say {wanted[k]} ({where})")
                text = text[:begin] + wanted[k] + text[end:]
        texts[document] = text
    for document, text in texts.items():
        if change and text != open(document).read():
            with open(document, "w") as file:
                file.write(text)
            print(f"{document}: written")
    return wrong


# ---------------------------------------------------------------------------------------------------- commands


def chosen(names):
    runs = read_runs()
    for name in names:
        if name not in runs:
            raise Wrong(f"no run {name} in {RUNS}")
    return [runs[name] for name in names or runs]


def command_list():
    for run in read_runs().values():
        print(f"{run.name:32} {run.label:6} {run.scene:28} {shlex.join(run.overrides)}")


def command_run(*words):
    jobs, names = (int(words[1]), words[2:]) if words[:1] == ("-j",) else (1, words)

    def one(run):
        summary = take(run, os.path.join(OUT, run.name))
        if not summary:
            return False
        short = missed(run, summary)
        print(f"{run.name}: {summary['cpu_s']:.1f} s" + "".join(f", misses {name}" for name in short), flush=True)
        return not short

    with ThreadPoolExecutor(jobs) as pool:
        return not all(list(pool.map(one, chosen(names))))


def command_write(*names):
    runs, figures, asked = chosen(()), read_figures(), quoted()
    new = {}
    for run in runs:
        folder = os.path.join(OUT, run.name)
        if (not names or run.name in names) and os.path.exists(os.path.join(folder, "summary.json")):
            found = figures_of(run, folder, load(folder), asked.get(run.name, {}))
            new.update({(run.name, name): f for name, f in found.items()})
        else:
            new.update({key: f for key, f in figures.items() if key[0] == run.name})
    write_figures(new)
    return say(documents(read_figures(), True))


def command_check():
    runs, figures = read_runs(), read_figures()
    wrong = documents(figures, False)
    for path in sorted(glob.glob("bench/scenes/*.yaml")):
        scene = os.path.basename(path)[:-len(".yaml")]
        if scene not in runs or runs[scene].scene != scene or runs[scene].overrides:
            wrong.append(f"{RUNS}: nothing runs {scene} as it is")
    there = {run for run, _ in figures}
    wrong += [f"{FIGURES}: no figures of {name}" for name in runs if name not in there]
    wrong += [f"{FIGURES}: figures of {name}, which is not in {RUNS}" for name in sorted(there - set(runs))]
    return say(wrong)


def command_test(name):
    run, = chosen([name])
    stored = {figure: f for (owner, figure), f in read_figures().items() if owner == name}
    with tempfile.TemporaryDirectory(prefix="brunt_figures_") as folder:
        summary = take(run, os.path.join(folder, name))
        if not summary:
            return 1
        found = figures_of(run, os.path.join(folder, name), summary, quoted().get(name, {}))
    wrong = [f"{name}: {m} is {found[m].value:.6g} instead of {found[m].expect:.6g}" for m in missed(run, summary)]
    if not stored:
        wrong.append(f"{name}: no figures in {FIGURES}")
    for figure in stored.keys() | found.keys() if stored else ():
        if figure not in found or figure not in stored:
            wrong.append(f"{name}: {figure} is in one of run and {FIGURES} only")
        elif not abs(found[figure].value - stored[figure].value) <= stored[figure].within:
            f = stored[figure]
            wrong.append(f"{name}: {figure} is {found[figure].value:.6g}, in {FIGURES} {f.value:.6g} +- {f.within:.2g}")
    for figure, f in found.items():
        print(f"  {figure:28} {f.value:.6g}" + ("" if f.expect is None else f" of {f.expect:.6g}"))
    if wrong:
        wrong.append(f"If that is meant: sh bench/figures.sh {name}")
    return say(wrong)


def figures_in(place):
    if os.path.isfile(place):
        return read_figures(place)
    figures = {}
    for path in glob.glob(os.path.join(place, "*", "summary.json")):
        folder = os.path.dirname(path)
        run = read_runs().get(os.path.basename(folder), Run("", "", "", [], [], [], 0.01))
        for name, f in figures_of(run, folder, load(folder), {}).items():
            figures[os.path.basename(folder), name] = f
    return figures


def command_compare(old, new):
    old, new = figures_in(old), figures_in(new)
    print("| run | figure | before | after | should be |\n| --- | --- | --- | --- | --- |")
    for key in sorted(old.keys() & new.keys()):
        a, b = old[key], new[key]
        if abs(a.value - b.value) > max(a.within / 10, 1e-4 * abs(a.value)):
            print(f"| {key[0]} | {key[1]} | {a.value:.5g} | {b.value:.5g} | {'' if b.expect is None else f'{b.expect:.5g}'} |")
    for key in sorted(old.keys() ^ new.keys()):
        print(f"{'.'.join(key)}: {'before' if key in old else 'after'} only", file=sys.stderr)


def rows_of(path):
    """Rows of all tables of a document by section and all that is no measured figure: {column: text}."""
    section, columns, rows = "", None, {}
    for line in open(path):
        if line.startswith("## "):
            section, columns = line[3:].strip(), None
        elif line.startswith("| ---"):
            continue
        elif line.startswith("|"):
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if columns is None:
                columns = cells
            else:
                key = tuple(cells[k] for k, c in enumerate(columns[:3]) if c.split()[0].rstrip(",") in ("form", "h", "mu"))
                rows[(section, *key)] = dict(zip(columns, cells + ["failed"] * (len(cells) > len(columns))))
    return rows


def near(a, b):
    """Texts with the same words and nearly the same numbers: to 1 %, or a digit of the last place printed. 1e-6: rounding."""
    numbers = [[float(n.replace(",", "")) for n in re.findall(NUMBER, text)] for text in (a, b)]
    places = max([len(m) for m in re.findall(r"\.(\d+)(?![\de])", a)], default=None)
    digit = 1.5 * 10.0**-places if places is not None and "e" not in a else 1e-6
    return (re.sub(NUMBER, "", a) == re.sub(NUMBER, "", b) and len(numbers[0]) == len(numbers[1]) and
            all(math.isclose(x, y, rel_tol=0.01, abs_tol=digit) for x, y in zip(*numbers)))


def command_contact(pattern=""):
    with tempfile.TemporaryDirectory(prefix="brunt_contact_") as folder:
        made = os.path.join(folder, "table.md")
        study = os.environ.get("CONTACT_STUDY", "build/bench/contact_study")
        if subprocess.run(["sh", "bench/studies/contact_table.sh", "-o", made, "-p", pattern, study]).returncode:
            return 1
        stored, found, wrong = rows_of(TABLE), rows_of(made), []
    for key, row in found.items():
        if key not in stored:
            wrong.append(f"{', '.join(key)}: not in {TABLE}")
            continue
        for column in row:
            if column != "s" and not near(stored[key].get(column, ""), row[column]):
                wrong.append(f"{', '.join(key)}: {column} is {row[column]}, in {TABLE} {stored[key].get(column)}")
    if wrong:
        wrong.append("If that is meant: sh bench/studies/contact_table.sh -f")
    return say(wrong) or not found


def say(wrong):
    for line in wrong:
        print(line, file=sys.stderr)
    return bool(wrong)


def main(words):
    os.chdir(TOP)
    command = globals().get(f"command_{words[0]}") if words else None
    if not command:
        print(__doc__, file=sys.stderr)
        return 64
    try:
        return int(bool(command(*words[1:])))
    except (Wrong, OSError) as error:
        print(f"figures.py: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
