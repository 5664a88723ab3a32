#!/usr/bin/env python3
"""How much forces in a packing of equal disks differ by how their rims are turned: edges, barriers and round rims. Writes rims.csv.

usage: rims.py           (from the top of the tree; BRUNT names the program, default build/brunt; some two minutes of one core)

25 equal disks in a square lattice between smooth planes and plates, as in bench/scenes/packing_square.yaml, pressed by 30 N/m a row in three load steps:
each contact carries 30 N/m, whatever the disks' rims of 32 to 96 edges stand opposite to. Rims are as they are made (a node at each neighbour), all
turned by half an edge (flats at flats), every second one (nodes at flats), or each by an angle of its own, by seeds.
"""
import csv, json, os, random, resource, subprocess, sys, tempfile

HERE = "bench/studies/rims"
BRUNT = os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
SIDE, CELL = 5, 10.03  # disks, mm: 0.03 mm between two of radius 5
CONTACT = {"barrier": "method: barrier, distance: 50 um", "penalty, facets": "method: penalty", "penalty, arcs": "method: penalty, surface: arcs"}
CASES = [(32, "nodes", 0), (32, "flats", 0), (32, "nodes at flats", 0)] + [(n, "drawn", seed) for n in (32, 48, 96) for seed in (1, 2, 3, 4)]
HEAD = ["edges", "turned", "seed", "contact", "mean [N/m]", "spread [%]", "iterations", "seconds"]


def scene(edges, turned, seed, contact, mesh):
    draw, wide = random.Random(seed), SIDE * CELL
    angle = {"nodes": lambda i, j: 0, "flats": lambda i, j: 180 / edges, "nodes at flats": lambda i, j: (i + j) % 2 * 180 / edges, "drawn": lambda i, j: draw.uniform(0, 360)}[turned]
    names = [(f"g{i}{j}", angle(i, j), (j + 0.5) * CELL, (i + 0.5) * CELL) for i in range(SIDE) for j in range(SIDE)]
    plate = f"{{method: fem, element: quad4, size: {0.8 * wide:.9g} mm, material: steel, shape: {{box: {{min: [%s], max: [%s]}}}}}}"
    low, high, far = "0.1 mm", f"{wide + 0.1:.9g} mm", f"{wide:.9g} mm"
    lines = ["brunt: 1", "dimension: 2", "time: {scheme: static, steps: 3}", "newton: {tolerance: 1e-8, iterations: 300}", "materials:",
             "  rubber: {model: linear-elastic, density: 1000 kg/m^3, E: 2.75 MPa, nu: 0.3333333}", "  steel: {model: linear-elastic, density: 1000 kg/m^3, E: 200 MPa, nu: 0.3}", "bodies:"]
    lines += [f"  {g}: {{method: fem, mesh: {mesh}, material: rubber, place: [{{rotate: {{angle: {a:.12g} deg}}}}, {{translate: [{x:.9g} mm, {y:.9g} mm]}}]}}" for g, a, x, y in names]
    lines += ["  top: " + plate % (f"{low}, {far}", f"{high}, {wide + 5:.9g} mm"), "  right: " + plate % (f"{far}, {low}", f"{wide + 5:.9g} mm, {high}"), "boundaries:",
              "  - {plane: {point: [0, 0], normal: [1, 0]}, condition: separate}", "  - {plane: {point: [0, 0], normal: [0, 1]}, condition: separate}",
              f"  - {{body: top, group: ymax, traction: [0, {-30e3 * SIDE / wide:.9g} Pa], table: [[0 s, 0], [1 s, 1]]}}",
              f"  - {{body: right, group: xmax, traction: [{-30e3 * SIDE / wide:.9g} Pa, 0], table: [[0 s, 0], [1 s, 1]]}}",
              "  - {body: top, group: surface, fix: [x]}", "  - {body: right, group: surface, fix: [y]}",
              f"contact: {{{contact}, friction: 0.5, pairs: [{{between: [top, right], method: none}}"
              + "".join(f", {{between: [{g}, {p}], friction: 0}}" for g, *_ in names for p in ("top", "right")) + "]}", "output: {every: none, history: 0 s}"]
    return "\n".join(lines) + "\n"


def run(folder):
    for edges, turned, seed in CASES:
        mesh = f"{folder}/disk_{edges}.msh"
        with open(mesh, "wb") as file:
            subprocess.run([sys.executable, "bench/scenes/disk_mesh.py", "5e-3", str(edges)], stdout=file, check=True)
        for name, contact in CONTACT.items():
            with open(f"{folder}/rims.yaml", "w") as file:
                file.write(scene(edges, turned, seed, contact, mesh))
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run([BRUNT, "run", f"{folder}/rims.yaml", "-t", "1", "-q", "-o", f"{folder}/out", "--fresh"], check=True, stderr=subprocess.DEVNULL)
            seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            with open(f"{folder}/out/summary.json") as file:
                summary = json.load(file)
            links = summary["links"]
            yield [edges, turned, seed, name, f"{links['mean']:.6g}", f"{100 * links['sd'] / links['mean']:.3g}", summary["newton"]["iterations"], f"{seconds:.2f}"]


if sys.argv[1:]:
    sys.exit(__doc__)
rows = []
with tempfile.TemporaryDirectory() as folder:
    for row in run(folder):
        rows.append(row)
        print(*row, sep=", ", flush=True)
with open(f"{HERE}.csv", "w", newline="") as file:
    csv.writer(file, lineterminator="\n").writerows([HEAD] + rows)
