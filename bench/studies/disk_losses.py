#!/usr/bin/env python3
"""Where the energy goes that two disks of material points lose as they collide. Writes disk_losses.csv.

usage: disk_losses.py           (from the top of the tree; BRUNT names the program, default build/brunt; two minutes of one core)

bench/scenes/two_disks.yaml in cells of 50, 25 and 12.5 mm (4, 8, 16 to a radius), contact by augury with springs that give back what they take, unless said:
shares of the energy at the start, by where the ledger has them and when: until the disks have stopped ("in"), until they part ("out"), and after that,
when they only vibrate. Beside it a disk on a rigid plane, which by symmetry is the same collision; disks a tenth as fast; a disk that touches nothing and vibrates
with all of its energy for as long as a collision takes (1.4 s), and squares likewise; and of elements of 6.25 mm, by which nearly nothing is lost, what of their motion no velocities of the
grid's nodes can follow (the rest after a fit by least squares, by mass; the greatest of pictures 0.1 s apart).
"""
import csv, glob, math, os, re, struct, subprocess, sys, tempfile, zlib

HERE = "bench/studies/disk_losses.csv"
BRUNT = os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
PAIR, KEPT = "bench/scenes/two_disks.yaml", "{apic: 0.9}"
SPRINGS = "contact={method: augury, friction: 0, stop: spring}"
SLOW = ["bodies.left.velocity=[0.01, 0.01]", "bodies.right.velocity=[-0.01, -0.01]", "bodies.left.shape.disk.center=[0.356, 0.356]", "bodies.right.shape.disk.center=[0.644, 0.644]"]
ONE = """brunt: 1
dimension: 2
time: {end: %s}
grid: {cell: 50 mm}
materials: {soft: {model: neo-hookean, density: 1000 kg/m^3, E: 1000 Pa, nu: 0.3}}
bodies:
  left: {method: mpm, material: soft, shape: {disk: {center: [0.2, 0.2142], radius: 0.2}}, %s}
%soutput: {every: none}
"""
ON_PLANE = ONE % ("1.9 s", "velocity: [0, -0.141421]", "contact: {stop: spring}\nboundaries: [{name: plane, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}]\n")
FREE = ONE % ("1.4 s", "wave: {velocity: [-0.2, 0], wave_vector: [5, 0], phase: -1}", "")
SQUARE = "shape: {box: {min: [0, 0], max: [0.4, 0.4]}}"
SQUARES = {"free square along the grid": FREE.replace("shape: {disk: {center: [0.2, 0.2142], radius: 0.2}}", SQUARE),
           "free square at 45 degrees": FREE.replace("shape: {disk: {center: [0.2, 0.2142], radius: 0.2}}", SQUARE + ", place: [{rotate: {angle: 45 deg, about: [0.2, 0.2]}}]")}
HEAD = ["case", "cell [mm]", "transfer", "cfl", "kept", "kinetic", "transfers in", "transfers out", "transfers after", "contact", "friction", "viscosity", "balance"]
ELEMENTS = ["%s={method: fem, element: quad4, size: 6.25 mm, material: soft, shape: {disk: {center: [%g, %g], radius: 0.2}}, velocity: [%g, %g]}" % case
            for case in (("bodies.left", 0.2, 0.2, 0.1, 0.1), ("bodies.right", 0.8, 0.8, -0.1, -0.1))]


def cases():
    for cell in (50, 25, 12.5):
        for transfer in ("apic", "{apic: 0.5}", KEPT, "{apic: 0.98}", "{flip: 1}"):
            yield "pair", cell, transfer, 0.5, PAIR, [SPRINGS]
        for transfer in (KEPT, "{apic: 0.98}", "{flip: 1}"):
            for cfl in (0.1, 0.3, 0.6) + ((0.9,) if transfer == KEPT else ()) + ((0.03, 0.01) if cell == 50 else ()):
                yield "pair", cell, transfer, cfl, PAIR, [SPRINGS]
        for points in (9, 16, 36):
            for transfer, cfl in ((KEPT, 0.5), ("{apic: 0.98}", 0.5), ("{apic: 0.98}", 0.1)) + ((("{apic: 0.98}", 0.01),) if cell == 50 and points == 9 else ()):
                yield f"pair, {points} points a cell", cell, transfer, cfl, PAIR, [SPRINGS] + [f"bodies.{name}.particles_per_cell={points}" for name in ("left", "right")]
        yield "pair, hard stops", cell, KEPT, 0.5, PAIR, ["contact={method: augury, friction: 0}"]
        yield "pair, at nodes", cell, KEPT, 0.5, PAIR, []
        yield "pair, cubic", cell, KEPT, 0.5, PAIR, [SPRINGS, "grid.kernel=cubic"]
        yield "pair, a tenth as fast", cell, KEPT, 0.5, PAIR, [SPRINGS] + SLOW
        yield "on a plane", cell, KEPT, 0.5, ON_PLANE, []
        for cfl in (0.1, 0.5):
            yield "free, vibrates", cell, KEPT, cfl, FREE, []
            yield "free, vibrates", cell, "{apic: 0.98}", cfl, FREE, []
            for name, scene in SQUARES.items():
                yield name, cell, KEPT, cfl, scene, []


def run(scene, folder, sets):
    subprocess.run([BRUNT, "run", scene, "-t", "1", "-q", "-o", folder, "--fresh", "--set", "output.checkpoint=none"] + [a for s in sets for a in ("--set", s)], check=True, stderr=subprocess.DEVNULL)
    with open(folder + "/history.csv") as file:
        return [{k.split(" [")[0]: float(v or 0) for k, v in row.items()} for row in csv.DictReader(file)]


def ledger(lines):
    start = lines[0]["energy.kinetic"]
    share = {k: [line.get("energy." + k, 0) / start for line in lines] for k in ("kinetic", "internal", "mechanical", "transfer", "contact", "friction", "viscosity", "error")}
    touches = [k for k in lines[0] if re.fullmatch(r"(contact\.left-right\.force|wall\.plane\.force_y)", k)]
    pressed = [i for i, line in enumerate(lines) if any(line[k] != 0 for k in touches)] or [0]
    first, last = pressed[0], min(pressed[-1] + 1, len(lines) - 1)
    stop = min(range(first, last + 1), key=lambda i: share["kinetic"][i])
    taken = [t - (m - k - i) for t, m, k, i in zip(share["transfer"], share["mechanical"], share["kinetic"], share["internal"])]  # velocities and places of one time
    parts = [taken[stop], taken[last] - taken[stop], taken[-1] - taken[last]]
    return [share["mechanical"][-1], share["kinetic"][-1], *parts, share["contact"][-1], share["friction"][-1], share["viscosity"][-1], share["error"][-1]]


def picture(path):
    """Arrays of a .vtu file (appended, raw, zlib), and its time."""
    with open(path, "rb") as file:
        raw = file.read()
    end = raw.index(b"<AppendedData")
    begin, arrays = raw.index(b"_", end) + 1, {}
    for kind, name, offset in re.findall(rb'<DataArray type="(\w+)" Name="(\w+)"[^>]*offset="(\d+)"', raw[:end]):
        at = begin + int(offset)
        count = struct.unpack_from("<Q", raw, at)[0]
        sizes, data = struct.unpack_from(f"<{count}Q", raw, at + 24), b""
        at += 24 + 8 * count
        for size in sizes:
            data, at = data + zlib.decompress(raw[at:at + size]), at + size
        code = {b"Float32": "f", b"Float64": "d", b"Int64": "q", b"UInt8": "B"}[kind]
        arrays[name.decode()] = struct.unpack(f"<{len(data) // struct.calcsize(code)}{code}", data)
    return arrays, float(re.search(rb'TimeValue"[^>]*>([^<]+)<', raw).group(1))


def masses(arrays):
    x, of, mass = arrays["Points"], arrays["connectivity"], [0.0] * (len(arrays["Points"]) // 3)
    for k in range(0, len(of), 4):
        corner = [(x[3 * i], x[3 * i + 1]) for i in of[k:k + 4]]
        area = 0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corner, corner[1:] + corner[:1])))
        for i in of[k:k + 4]:
            mass[i] += 1000 * area / 4
    return mass


def splines(u):
    """The first node of a quadratic spline's three, and their weights."""
    base = math.floor(u - 0.5)
    d = u - base
    return base, (0.5 * (1.5 - d) ** 2, 0.75 - (d - 1) ** 2, 0.5 * (d - 0.5) ** 2)


def unseen(arrays, mass, h):
    """[J/m] of the motion of nodes that velocities of a grid's nodes cannot follow: conjugate gradients for the fit."""
    x, v, node, rows, left = arrays["Points"], arrays["velocity"], {}, [], 0.0
    for i in range(len(mass)):
        (at, wide), (up, high) = splines(x[3 * i] / h), splines(x[3 * i + 1] / h)
        rows.append([(node.setdefault((at + a, up + b), len(node)), wide[a] * high[b]) for a in range(3) for b in range(3)])

    def gather(values):
        return [sum(w * values[n] for n, w in row) for row in rows]

    def scatter(values):
        out = [0.0] * len(node)
        for row, m, value in zip(rows, mass, values):
            for n, w in row:
                out[n] += m * w * value
        return out

    lumped = scatter([1.0] * len(mass))
    for axis in range(2):
        given = [v[3 * i + axis] for i in range(len(mass))]
        fit = [a / b for a, b in zip(scatter(given), lumped)]
        rest = scatter([a - b for a, b in zip(given, gather(fit))])
        way = [a / b for a, b in zip(rest, lumped)]
        now = begun = sum(a * b for a, b in zip(rest, way))
        for _ in range(60):
            if now <= 1e-10 * begun or now <= 1e-20:
                break
            turned = scatter(gather(way))
            step = now / sum(a * b for a, b in zip(way, turned))
            fit, rest = [a + step * b for a, b in zip(fit, way)], [a - step * b for a, b in zip(rest, turned)]
            next_ = sum(a * a / b for a, b in zip(rest, lumped))
            way, now = [a / b + next_ / now * c for a, b, c in zip(rest, lumped, way)], next_
        left += sum(0.5 * m * (a - b) ** 2 for m, a, b in zip(mass, given, gather(fit)))
    return left


def of_elements(folder):
    lines = run(PAIR, folder, ["contact={method: augury, friction: 0}", "output.every=100 ms"] + ELEMENTS)
    yield ["elements", 6.25, "", 0.5] + [f"{x:.4f}" for x in ledger(lines)]
    pictures = [picture(path) for path in glob.glob(folder + "/vtu/left_*.vtu")]
    mass = masses(min(pictures, key=lambda p: p[1])[0])
    for cell in (50, 25, 12.5):
        most = max(unseen(arrays, mass, cell * 1e-3) for arrays, time in pictures if time > 1.5)
        yield ["elements, not seen by the grid", cell, "", 0.5, f"{1 - 2 * most / lines[0]['energy.kinetic']:.4f}"] + [""] * (len(HEAD) - 5)


def main(folder):
    for case, cell, transfer, cfl, scene, sets in cases():
        if scene != PAIR:
            with open(folder + "/one.yaml", "w") as file:
                file.write(scene)
        path = PAIR if scene == PAIR else folder + "/one.yaml"
        lines = run(path, folder + "/out", sets + [f"grid.cell={cell} mm", f"grid.transfer={transfer}", f"time.cfl={cfl}", "output.history=0 s", "output.every=none"])
        yield [case, cell, transfer, cfl] + [f"{x:.4f}" for x in ledger(lines)]
    yield from of_elements(folder + "/out")


if __name__ == "__main__":
    if sys.argv[1:]:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder, open(HERE, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(HEAD)
        for row in main(folder):
            table.writerow(row)
            print(*row, flush=True)
