#!/usr/bin/env python3
"""What collisions give back: meshes with `contact.touch` inelastic and elastic, material points with `contact.stop` hard and spring.

usage: collisions.py [PART...]     parts: blocks bars chain times points rest (default: all; from the top of the tree, a quarter of an hour of one core)

Writes a row a run to collisions.csv (parts that are not run keep theirs) and all of them as tables to collisions.md. BRUNT names the program (default
build/brunt), STUDY the other (build/bench/contact_study). blocks: two cubes, a corner and a face (contact_study.c). bars: equal ones, one twice as long, and a rod on a wall
(d'Alembert: all energy and momentum change hands, the force is rho c v A / 2). chain: three and five equal balls that touch as the first is hit; the closed form is
sum of Newton's equations with forces d^(3/2), integrated here. times: what an error of 2 % of the velocity costs of bars and chain. points: a ball on a plane, two disks, two spheres. rest: a stack, 1e5
steps. What it costs is counted in tests/stability/test_cost.c.
"""
import csv, json, math, os, re, subprocess, sys, tempfile

HERE = "bench/studies/collisions"
BRUNT, STUDY = (os.path.abspath(os.environ.get(*name)) for name in (("BRUNT", "build/brunt"), ("STUDY", "build/bench/contact_study")))
TOUCHES, ELEMENTS = ("inelastic", "elastic"), ("tet4", "hex8")
KEPT, SPRINGS = "grid.transfer={apic: 0.9}", "contact={method: augury, friction: %s, stop: spring}"
BARS = """brunt: 1
dimension: 3
time: {end: %g s, cfl: 0.9}
materials: {unit: {model: linear-elastic, density: 1, E: 1, nu: 0}}
bodies:
  a: {method: fem, material: unit, element: %s, size: %g, shape: {box: {min: [-10.01, 0, 0], max: [-0.01, 1, 1]}}, velocity: [1e-3, 0, 0]}
  b: {method: fem, material: unit, element: %s, size: %g, shape: {box: {min: [0, 0, 0], max: [%g, 1, 1]}}}
contact: {method: augury, touch: %s}
output: {every: none, history: 0}
measures:
  kept: {history: energy.mechanical, relative_to: initial}
  most: {history: energy.mechanical, take: max, relative_to: initial}
  left: {history: body.a.velocity_x, relative_to: 1e-3 m/s}
  given: {history: body.b.velocity_x, relative_to: 1e-3 m/s}
  peak: {history: contact.a-b.force_x, take: max, relative_to: 5e-4}
"""
BALL = "  b%d: {method: fem, element: quad4, size: %g mm, material: steel, shape: {intersection: [{disk: {center: [0, %g], radius: 0.05}}, {box: {min: [0, -1], max: [1, 2]}}]}, velocity: [0, %g]}\n"
CHAIN = """brunt: 1
dimension: 2
axisymmetric: true
time: {end: %g s, cfl: 0.9}
materials: {steel: {model: neo-hookean, density: 7800, E: 200 GPa, nu: 0.3}}
bodies:
%scontact: {method: augury, touch: %s}
output: {every: none, history: 10 us}
measures:
  kept: {history: energy.mechanical, relative_to: initial}
%s"""

# A quarter of a stack between planes of symmetry, so that nothing slides off without friction.
BLOCK = "  %s: {method: fem, element: %s, size: 0.25 m, material: soft, shape: {box: {min: [0, %d, 0], max: [%g, %d, %g]}}}\n"
HOLD = "  - {name: %s%s, group: %smin, body: %s, fix: [%s]}\n"
STACK = """brunt: 1
dimension: 3
time: {end: %d s, cfl: 0.9}
materials: {soft: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3, viscosity: {}}}
bodies:
%scontact: {method: augury, friction: %s, touch: %s}
boundaries:
  - {name: ground, group: ymin, body: a, fix: all}
%sloads: {gravity: [0, -10, 0], gravity_ramp: 2 s}
output: {every: none, history: 1 s}
measures:
  force: {history: contact.a-b.force_y, take: mean, from: 200 s, relative_to: 5000 N}
  height: {history: body.c.position_y}
  speed: {history: body.c.velocity_y, take: max_abs, from: 200 s}
  lost: {history: energy.contact, relative_to: 5000 J}
"""


def output(words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        sys.exit(" ".join(words) + "\n" + done.stdout + done.stderr)
    return done.stdout


def measured(scene, sets=()):
    """Measures of a scene, a file or its text, and the seconds of its steps: of the clock, or of the processor where other work takes turns."""
    with tempfile.TemporaryDirectory() as folder:
        if "\n" in scene:
            with open(folder + "/scene.yaml", "w") as file:
                file.write(scene)
            scene = folder + "/scene.yaml"
        sets = ["output.every=none", "output.checkpoint=none", *sets]
        output([BRUNT, "run", scene, "-t", "1", "-q", "--fresh", "-o", folder + "/out"] + [w for s in sets for w in ("--set", s)])
        with open(folder + "/out/summary.json") as file:
            summary = json.load(file)
        return {name: m["value"] for name, m in summary["measures"].items() if m["value"] is not None} | {"seconds": min(summary["step_s"], summary["cpu_s"])}


def blocks():
    def row(case, element, *more):
        for touch in TOUCHES:
            line = output([STUDY, case, "element=" + element, "touch=" + touch, *more])
            found = dict(re.findall(r"(E/E0|max|contact|error|pen|dP|dL|wall|status)=([-+.\deE]+)", line))
            if found.pop("status") != "0":
                sys.exit(line)
            yield "blocks", case, element + "".join(" " + m for m in more if not m.startswith("samples")), touch, found

    for element in ELEMENTS:
        for case in ("cubes", "corner", "face"):
            for h in ("1", "0.5", "0.25", "0.125"):
                yield from row(case, element, "h=" + h, "samples=300" if h != "0.125" else "samples=60")
        for more in ("speed=3", "stiff=1000 dt=0.1", "dt=5", "mu=0.1", "mu=0.2", "mu=0.3", "mu=0.4", "h2=0.3", "turn=33 shift=0.31"):
            yield from row("cubes", element, "h=0.5", "samples=300", *more.split())
    for case in ("cubes", "corner"):
        yield from row(case, "hex8", "h=0.25", "hg=0.3")
        yield from row(case, "hex8", "h=0.25", "hg=1")


def bars():
    for length, end in ((10, 45), (20, 65)):
        for element in ELEMENTS:
            for size in (1, 0.5, 0.25):
                for touch in TOUCHES:
                    found = measured(BARS % (end, element, size, element, size, length, touch))
                    yield "bars", f"10 on {length}", f"{element} h={size}", touch, found
    for size in ("0.2", "0.1", "0.05"):
        for touch in TOUCHES:
            found = measured("bench/scenes/rod_on_wall.yaml", [f"bodies.rod.size={size} in", f"contact.touch={touch}"])
            yield "bars", "rod on wall", f"hex8 h={size} in", touch, {"left": found["rebound"] / 5.13588, "peak": found["greatest_force"] / 133104.14, "impulse": found["impulse"] / 13.132058, "contact": found["lost_in_contact"]}
    for size in ("10", "5", "3.5"):
        for touch in TOUCHES:
            found = measured("bench/scenes/sphere_on_plane.yaml", [f"bodies.ball.size={size} mm", f"contact.touch={touch}"])
            yield "bars", "ball on plane", f"hex8 h={size} mm", touch, {"left": found["restitution"], "peak": found["force"] / 31.46}


def hertz(count, step=1e-3):
    """Velocities after a chain of balls that touch is hit with 1."""
    x, v = [0.0] * count, [1.0] + [0.0] * (count - 1)

    def accelerations():
        push = [max(0.0, a - b) ** 1.5 for a, b in zip(x, x[1:])]
        return [a - b for a, b in zip([0.0] + push, push + [0.0])]

    a = accelerations()
    for _ in range(int(12 / step)):
        v = [p + 0.5 * step * q for p, q in zip(v, a)]
        x = [p + step * q for p, q in zip(x, v)]
        a = accelerations()
        v = [p + 0.5 * step * q for p, q in zip(v, a)]
    return v


def balls_in_a_row(count, size, touch):
    balls = "".join(BALL % (k, size, 0.1 * k, 10 if k == 0 else 0) for k in range(count))
    measures = "".join(f"  v{k}: {{history: body.b{k}.velocity_y, relative_to: 10 m/s}}\n" for k in range(count))
    return CHAIN % (1.6e-4 * (count + 0.2), balls, touch, measures)


def chain():
    for count in (3, 5):
        exact = {f"v{k}": v for k, v in enumerate(hertz(count))}
        yield "chain", f"{count} balls", "closed form", "", exact
        for size in (4, 2, 1, 0.5) if count == 3 else (2, 1):
            for touch in TOUCHES:
                yield "chain", f"{count} balls", f"quad4 h={size} mm", touch, measured(balls_in_a_row(count, size, touch))


def times():
    """Error of velocities over the time of the steps, the least of many in turns, as other work on the machine adds to some."""
    def scene(case, element, size, touch):
        return BARS % (45, element, size, element, size, 10, touch) if case == "10 on 10" else balls_in_a_row(3, size, touch)

    exact = hertz(3)
    for case, element, sizes in (("10 on 10", "tet4", (2, 1, 0.5, 0.25)), ("10 on 10", "hex8", (2, 1, 0.5, 0.25)), ("3 balls", "quad4", (4, 2, 1))):
        for size in sizes:
            runs = {touch: [] for touch in TOUCHES}
            for _ in range(30 if case == "10 on 10" else 7):
                for touch in TOUCHES:
                    runs[touch].append(measured(scene(case, element, size, touch)))
            for touch, found in runs.items():
                error = abs(found[0]["given"] - 1) if "given" in found[0] else max(abs(found[0][f"v{k}"] - v) for k, v in enumerate(exact))
                yield "times", case, f"{element} h={size}{' mm' if case == '3 balls' else ''}", touch, {"off": error, "seconds": min(f["seconds"] for f in found)}


def time_to(runs, error=0.02):
    """Seconds that an error takes, by a line through logarithms of the two meshes about it; of (off, seconds), coarsest first. A mesh
    that is better from the start: its seconds, and that it is less. None: no mesh is that good."""
    for k, (off, seconds) in enumerate(runs):
        if off <= error and k == 0:
            return seconds, "<"
        if off <= error:
            before, then = runs[k - 1]
            return then * (seconds / then) ** (math.log(error / before) / math.log(off / before)), ""
    return None


def times_to(groups):
    """Lines of a table: time to 2 % of each case by either touch, and by what factor it falls."""
    runs = {}
    for (case, of, touch), found in groups.items():
        runs.setdefault((case, of.split()[0]), {}).setdefault(touch, []).append((float(found["off"]), float(found["seconds"])))
    yield "| 2 % of | inelastic [s] | elastic [s] | factor |\n| --- | --- | --- | --- |\n"
    for (case, element), by in runs.items():
        (slow, _), (quick, less) = time_to(by["inelastic"]), time_to(by["elastic"])
        yield f"| {case}, {element} | {slow:.3g} | {less}{quick:.3g} | {'>' if less else ''}{slow / quick:.3g} |\n"


def points():
    for name, cell in (("5", 20), ("7", 14.2857), ("10", 10), ("14", 7.14286)):
        for stop in ("hard", "spring"):
            for transfer in ("apic", "{apic: 0.9}"):
                found = measured("bench/scenes/ball_bounces.yaml", [f"grid.cell={cell} mm", f"contact.stop={stop}", f"grid.transfer={transfer}"])
                yield "points", "ball on plane", f"{name} cells, {transfer}", stop, found
    for cfl in (0.1, 0.3, 0.5, 0.7, 0.9):
        found = measured("bench/scenes/ball_bounces.yaml", ["grid.transfer={apic: 0.9}", f"time.cfl={cfl}"])
        yield "points", "ball on plane", f"10 cells, {{apic: 0.9}}, cfl {cfl}", "spring", found
    for cell in (50, 25, 12.5):
        for stop in ("hard", "spring"):
            for transfer in ("apic", "{apic: 0.9}", "{apic: 0.98}"):
                sets = [f"grid.cell={cell} mm", "contact={method: augury, friction: 0, stop: %s}" % stop, f"grid.transfer={transfer}"]
                yield "points", "two disks", f"h={cell} mm, {transfer}", stop, measured("bench/scenes/two_disks.yaml", sets)
    for more in ("0.1", "0.9"):
        found = measured("bench/scenes/two_disks.yaml", ["grid.cell=25 mm", SPRINGS % 0, KEPT, f"time.cfl={more}"])
        yield "points", "two disks", f"h=25 mm, {{apic: 0.9}}, cfl {more}", "spring", found
    nine = [f"bodies.{b}.particles_per_cell=9" for b in ("left", "right")]
    found = measured("bench/scenes/two_disks.yaml", ["grid.cell=25 mm", SPRINGS % 0, "grid.transfer={apic: 0.98}", *nine])
    yield "points", "two disks", "h=25 mm, {apic: 0.98}, 9 a cell", "spring", found
    for cell in (50, 35, 25):
        for stop in ("hard", "spring"):
            sets = [f"grid.cell={cell} mm", "contact={method: augury, friction: 0.3, stop: %s}" % stop, KEPT]
            yield "points", "two spheres", f"h={cell} mm, {{apic: 0.9}}", stop, measured("bench/scenes/two_spheres.yaml", sets)
    for size in (40, 28, 20):
        sets = [f"bodies.{b}={{method: fem, element: hex8, size: {size} mm, material: soft, shape: {{sphere: {{center: [{s}0.3, {s}0.05, 0], radius: 0.2}}}}, velocity: [{v}0.1, 0, 0]}}"
                for b, s, v in (("left", "-", ""), ("right", "", "-"))] + ["contact={method: augury, friction: 0.3}"]
        yield "points", "two spheres", f"meshes, hex8 h={size} mm", "elastic", measured("bench/scenes/two_spheres.yaml", sets)


def rest():
    bodies, ends = (("a", 0, 1, 1), ("b", 1, 2, 0.5), ("c", 2, 3, 0.5)), {"tet4": 250, "hex8": 411}
    hold = "".join(HOLD % (name, axis, axis, name, axis) for name, *_ in bodies for axis in "xz")
    for element in ELEMENTS:
        for mu in ("0", "0.5"):
            for touch in TOUCHES:
                blocks = "".join(BLOCK % (name, element, low, wide, high, wide) for name, low, high, wide in bodies)
                yield "rest", "quarter of a stack", f"{element} mu={mu}", touch, measured(STACK % (ends[element], blocks, mu, touch, hold))
        for touch in TOUCHES:
            line = output([STUDY, "stack", "h=0.333333333333", "element=" + element, "mu=0.5", "touch=" + touch])
            yield "rest", "stack", f"{element} mu=0.5", touch, dict(re.findall(r"(pen|sink2nd|lateral|KE/mgh|N/mg-1)=([-+.\deE]+)", line))


PARTS = {f.__name__: f for f in (blocks, bars, chain, times, points, rest)}
SHOWN = {"blocks": ("E/E0", "max", "contact", "error", "pen", "dP", "dL"), "bars": ("kept", "most", "left", "given", "peak", "impulse"), "chain": ("v0", "v1", "v2", "v3", "v4", "kept"), "times": ("off", "seconds"),
         "points": ("restitution", "force", "energy_kept", "kinetic_kept", "kinetic_left", "friction_work", "lost_in_contact"), "rest": ("force", "height", "speed", "lost", "pen", "sink2nd", "lateral", "KE/mgh", "N/mg-1")}
SAID = {
    "blocks": "Blocks of meshes\n\nE/E0: share of the energy at the end; max: the greatest at any sample; contact: what contact holds or has lost; error: of the ledger; pen: greatest depth of a boundary node [h]; dP, dL: drifts. h=0.5 and no friction unless said. With friction what it does is lost, too.",
    "bars": "Bars, a rod on a wall, a ball on a plane\n\nShares: kept and most of the energy at the start; left, of the striker's velocity (0 of two equal bars and of one on a longer one; rod and ball: what comes back, 1); given (1; 0.5 on twice the length); peak over the closed form's force, impulse likewise.",
    "chain": "Balls in a row\n\nVelocities after the first has hit the others, which touch, with 10 m/s (steel, radius 50 mm); the closed form is that of rigid balls with Hertz's springs.",
    "times": "What 2 % takes\n\noff: speed given on by bars (1), velocities of balls, the worst of them, as shares of the striker's; seconds of the steps, one core of an Intel Xeon (bench/machines), the least of 30 (bars) and 7 (balls) in turns. Below: time to 2 %, by lines through logarithms; <: the coarsest mesh is better.",
    "points": "Material points\n\nrestitution and force [N] of a ball on a plane; energy kept (kinetic and stored), kinetic share, work of friction [J].",
    "rest": "At rest\n\n1e5 steps of three blocks on each other, a quarter between planes of symmetry (without friction whole ones slide off, by either touch): force over the weight, height of the upper one [m], its speed at most [m/s], what contact took; of whole ones depth, sinking and sliding [h], kinetic energy and force.",
}


def write(rows):
    with open(HERE + ".csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["part", "case", "of", "touch or stop", "figure", "value"])
        table.writerows(rows)
    groups = {}
    for part, case, of, kind, figure, value in rows:
        groups.setdefault(part, {}).setdefault((case, of, kind), {})[figure] = value
    with open(HERE + ".md", "w") as file:
        file.write("# What collisions give back\n\nWritten by [collisions.py](collisions.py), which says what is asked; all figures are in [collisions.csv](collisions.csv).\n")
        for part in (p for p in PARTS if p in groups):
            shown = [f for f in SHOWN[part] if any(f in found for found in groups[part].values())]
            file.write("\n## " + SAID[part] + "\n\n| case | of | touch or stop | " + " | ".join(shown) + " |\n|" + " --- |" * (len(shown) + 3) + "\n")
            for (case, of, kind), found in groups[part].items():
                file.write(f"| {case} | {of} | {kind} | " + " | ".join(found.get(f, "") for f in shown) + " |\n")
            if part == "times":
                file.write("\n" + "".join(times_to(groups[part])))


def main(parts):
    if set(parts) - set(PARTS):
        sys.exit(__doc__)
    rows = []
    if os.path.exists(HERE + ".csv"):
        with open(HERE + ".csv") as file:
            rows = list(csv.reader(file))[1:]
    for part in parts or PARTS:
        rows = [row for row in rows if row[0] != part]
        for name, case, of, kind, found in PARTS[part]():
            rows += [[name, case, of, kind, figure, value if isinstance(value, str) else f"{value:.{10 if part == 'rest' else 5}g}"] for figure, value in found.items() if figure in SHOWN[part]]
            print(name, case, of, kind, found, flush=True)
        write(sorted(rows, key=lambda row: list(PARTS).index(row[0])))


if __name__ == "__main__":
    main(sys.argv[1:])
