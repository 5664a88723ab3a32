#!/usr/bin/env python3
"""Would explicit steps gain by subcycling, and would they keep energy? Writes subcycling.csv, subcycling_gain.csv and subcycling.png.

usage: subcycling.py           (from the top of the tree; BRUNT names the program, default build/brunt; three minutes of one core; needs numpy, gnuplot)
       subcycling.py --plot    draws subcycling.png anew
       subcycling.py --table   prints the tables of subcycling.md from what is stored

Gain: `brunt check --quick` of all of bench/scenes says whose step it is and how long steps would be without that body, or without one element of 100.
Of the passes it names, those of elements and points are shared by number of elements and points; the limiting body's are taken every step, all else, contact too,
every m-th: at most 1 / (s + (1 - s) / m) as fast, s its share (two walks, as "ramp" below takes: 2 s). Passes it does not name count as of the others: it is a bound.

Numerics: bars in one dimension, lumped masses, central differences as engine/scheme/explicit.c has them (kick, contact, drift; velocities in the middle of
steps). The quick body is kicked every h, the slow one every H = m h; contact is u >= -gap / dt, as contact/constraint has it, without what it gives back
unless said. Positions are known at the same time every H. Energy is that which such steps keep: of each body 1/2 v . (M v + dt f) + U, v before
the kick; work of an impulse J is J (v old + v new) / 2, exact where velocities change at kicks alone. How contact is made:
  at once      at common steps, the impulse from velocities after the kick, all of it to the first of the quick body's m substeps
  gap          the same, by an impulse that closes the gap at the end of the common step, from the quick body's answer to an impulse
  spread       a share 1 / m at each substep, so that the gap closes as if its surface's mass were free
  spread gap   the same, from the quick body's answer
  wall         at every substep, the slow surface a wall that keeps its velocity; what it got is given to it at its next kick
  every        at every substep between both masses, the slow surface drifting with what it got; its forces every H alone
  every, back  the same, and what pushes have taken is given back at the first substep that does not push, as contact/constraint/release.c does
  ramp         velocities alike at common steps, the force linear in between (Prakash & Hjelmstad 2004), from the quick body's answer
  ramp, drawn  the same, and what overlaps is drawn apart by a tenth of it a common step
Held (no parting) a common step is a linear map: its spectral radius over a scan of steps says where it grows, all starts at once.
Groups of elements within a bar: "nodes" as Belytschko, Yen & Mullen (1979) and Neal & Belytschko (1989), slow nodes at constant velocity while quick ones
are kicked; "elements", slow elements kick every H with H (impulses); "constant", their force of the last common step kicks every h.
"""
import csv, glob, os, re, subprocess, sys
import numpy as np

HERE, BRUNT = "bench/studies/subcycling", os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
CONTACT = ["at once", "gap", "spread", "spread gap", "wall", "every", "every, back", "ramp", "ramp, drawn"]
CFL = np.linspace(0.2, 0.98, 157)  # of the quick body's, or group's, stable step
HEAD = ["case", "how", "m", "greatest energy / start", "energy at the end / start", "deepest [slow elements]", "impulse off / all", "momentum off / all", "ledger off / exchanged",
        "radius - 1, greatest", "share of steps that grow", "radius - 1 at cfl 0.9"]


def chain(count, mass, stiffness):
    """Masses [count] of the nodes of a free bar of lumped elements, and its stiffness matrix."""
    m, k = np.full(count, float(mass)), np.zeros((count, count))
    for i in range(count - 1):
        k[i:i + 2, i:i + 2] += stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    m[[0, -1]] *= 0.5
    return m, k


def stable(m, k):
    return 2 / np.sqrt(np.max(np.linalg.eigvalsh(k / np.sqrt(np.outer(m, m)))))


class Pair:
    """A quick body right of a slow one; node 0 of it meets the slow one's last node. State: quick x, v, slow x, v, force of "ramp"."""

    def __init__(self, quick, slow, m, h, how, load=0.0):
        (self.ma, self.ka), (self.mb, self.kb) = quick, slow
        self.m, self.h, self.how, self.held = m, h, how, 0.0
        self.load_a, self.load_b = load * self.ma, load * self.mb
        self.answer, self.ramp = {}, np.arange(m) / m
        for key, pulses in (("gap", [1.0] + [0.0] * (m - 1)), ("spread gap", [1.0 / m] * m)):
            x, v = np.zeros(len(self.ma)), np.zeros(len(self.ma))
            for pulse in pulses:
                v = v - h * (self.ka @ x) / self.ma
                v[0] += pulse / self.ma[0]
                x = x + h * v
            self.answer[key] = x[0]
        x, v, _ = self.quick(np.zeros(len(self.ma)), np.zeros(len(self.ma)), lambda i, *_: h * self.ramp[i], 0.0)
        self.answer["ramp"] = self.late(x, v, self.ma, self.ka, 0.0, h)[0] + 0.5 * h / self.ma[0]

    def start(self, va, vb):
        return [np.zeros(len(self.ma)), np.full(len(self.ma), va), np.zeros(len(self.mb)), np.full(len(self.mb), vb), np.zeros(1)]

    @staticmethod
    def late(x, v, m, k, load, dt):
        """Velocities half a step later, at the time of the positions."""
        return v + 0.5 * dt * (load - k @ x) / m

    def energy(self, s):
        (xa, va, xb, vb, _), h = s, self.h
        fa, fb = self.load_a - self.ka @ xa, self.load_b - self.kb @ xb
        of = lambda x, v, m, k, f, load, dt: 0.5 * v @ (m * v + dt * f) + 0.5 * x @ k @ x - load @ x
        return of(xa, va, self.ma, self.ka, fa, self.load_a, h) + of(xb, vb, self.mb, self.kb, fb, self.load_b, self.m * h)

    def quick(self, xa, va, push, weight=1.0):
        """m substeps of the quick body; push(i, x, v, v before the kick) is its impulse. Its last x, v and the work done on it."""
        work = 0.0
        for i in range(self.m):
            old = va[0]
            va = va + self.h * (weight * self.load_a - self.ka @ xa) / self.ma
            J = push(i, xa[0], va[0], old)
            va[0] += J / self.ma[0]
            work += 0.5 * J * (old + va[0])
            xa = xa + self.h * va
        return xa, va, work

    def bound(self, J, hold):
        return J if hold else max(J, 0.0)

    def step(self, s, hold=False):
        """One common step. The new state, the impulse, and the work done by contact on each body (None: not known before the next kick)."""
        xa, va, xb, vb, force = (a.copy() for a in s)
        m, h, H, how = self.m, self.h, self.m * self.h, self.how
        oldb = vb[-1]
        vb = vb + H * (self.load_b - self.kb @ xb) / self.mb
        ma, mb, given = self.ma[0], self.mb[-1], []
        if how in ("wall", "every", "every, back"):
            at = [xb[-1], vb[-1], 0.0, oldb]  # slow surface: place, velocity, work on it, velocity before the kick

            def push(i, x, v, old):
                wall = how == "wall"
                unit = ma if wall else 1 / (1 / ma + 1 / mb)
                u, before = v - at[1], old - at[3]
                J = self.bound((-(x - at[0]) / h - u) * unit, hold)
                if how == "every, back" and not hold:
                    if J > 0:
                        self.held += -0.5 * J * (before + u + J / unit)
                    elif self.held > 0:
                        b = before + u
                        J = 0.5 * unit * (np.sqrt(b * b + 8 * self.held / unit) - b)
                        self.held = 0.0
                if not wall:
                    at[2] -= 0.5 * J * (at[3] + at[1] - J / mb)
                    at[1] -= J / mb
                    at[3] = at[1]
                at[0] += h * at[1]
                given.append(J)
                return J
            xa, va, work = self.quick(xa, va, push)
            if how == "wall":  # given now: the next kick's
                xb = xb + H * vb
                vb[-1] -= sum(given) / mb
                at[2] = None
            else:
                vb[-1] = at[1]
                end = at[0]
                xb[:-1] += H * vb[:-1]
                xb[-1] = end
            return [xa, va, xb, vb, force], sum(given), (work, at[2])
        if how.startswith("ramp"):
            J, now = H * force[0], force[0]
            vb[-1] -= J / mb
            on_b, xb = -0.5 * J * (oldb + vb[-1]), xb + H * vb
            x, v, _ = self.quick(xa, va, lambda i, *_: h * now * (1 - self.ramp[i]))
            apart = self.late(x, v, self.ma, self.ka, self.load_a, h)[0] - self.late(xb, vb, self.mb, self.kb, self.load_b, H)[-1]
            apart += 0.1 * (x[0] - xb[-1]) / H if how == "ramp, drawn" else 0.0
            then = self.bound(-apart / (self.answer["ramp"] + 0.5 * H / mb), hold) if hold or x[0] <= xb[-1] else 0.0
            xa, va, work = self.quick(xa, va, lambda i, *_: h * (now * (1 - self.ramp[i]) + then * self.ramp[i]))
            return [xa, va, xb, vb, np.array([then])], J, (work, on_b)
        if how == "at once":
            first = va[0] + h * (self.load_a - self.ka @ xa)[0] / ma
            J = self.bound((-(xa[0] - xb[-1]) / H - (first - vb[-1])) / (1 / ma + 1 / mb), hold)
        else:
            free = self.quick(xa, va, lambda *_: 0.0)[0][0] - xb[-1] - H * vb[-1]
            answer = self.answer.get(how, H * (m + 1) / (2 * m) / ma) + H / mb
            J = self.bound(-free / answer, hold)
        pulses = [J / m] * m if how.startswith("spread") else [J] + [0.0] * (m - 1)
        xa, va, work = self.quick(xa, va, lambda i, *_: pulses[i])
        vb[-1] -= J / mb
        return [xa, va, xb + H * vb, vb, force], J, (work, -0.5 * J * (oldb + vb[-1]))


def radius(step, sizes):
    """Spectral radius of a linear map of a list of arrays."""
    ends, columns = np.cumsum(sizes)[:-1], []
    for i in range(sum(sizes)):
        unit = np.zeros(sum(sizes))
        unit[i] = 1.0
        columns.append(np.concatenate(step(np.split(unit, ends))))
    return np.max(np.abs(np.linalg.eigvals(np.array(columns).T)))


def scan(step_of, h, sizes):
    """Greatest radius - 1 over CFL, share of CFL where it is above 1e-6, that at 0.9. A held contact's map has zero and unit eigenvalues besides."""
    grow = [radius(step_of(c * h), sizes) - 1 for c in CFL]
    return [f"{max(grow):.2g}", f"{np.mean(np.array(grow) > 1e-6):.3f}", f"{grow[int(np.argmin(abs(CFL - 0.9)))]:.2g}"]


def run(pair, s, steps, closed=None, least=0.0):
    """Columns of HEAD from a run; energies less `least`. closed(t): [N s] of the closed form."""
    mass, p0 = (pair.ma, pair.mb), pair.ma @ s[1] + pair.mb @ s[3]
    e0 = now = pair.energy(s)
    most, deepest, off, impulse, booked, exchanged, size = e0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for n in range(steps):
        s, J, (on_a, on_b) = pair.step(s)
        if on_b is None:  # booked where the slow body gets it: with its next kick, from the velocity before
            f = (pair.load_b - pair.kb @ s[2])[-1]
            v = s[3][-1] + J / pair.mb[-1]
            on_b = -0.5 * J * (v + s[3][-1] + pair.m * pair.h * f / pair.mb[-1])
        booked, exchanged, impulse = booked + on_a + on_b, exchanged + 0.5 * (abs(on_a) + abs(on_b)), impulse + J
        now = pair.energy(s)
        most, deepest, size = max(most, now), max(deepest, s[2][-1] - s[0][0]), max(size, abs(impulse))
        if closed:
            off = max(off, abs(impulse - closed((n + 1) * pair.m * pair.h)))
        if not now - least < 1e6 * (e0 - least):
            break
    p = mass[0] @ s[1] + mass[1] @ s[3]
    of_closed = [f"{off / size:.3g}", f"{abs(p - p0) / size:.1g}"] if closed else ["", ""]
    return [f"{(e - least) / (e0 - least):.5g}" for e in (most, now)] + [f"{deepest:.3g}", *of_closed, f"{abs(now - e0 - booked) / max(exchanged, 1e-300):.2g}"]


def held_step(quick, slow, m, how):
    def make(dt):
        pair = Pair(quick, slow, m, dt, how)
        return lambda s: pair.step(s, hold=True)[0]
    return make


def impact(count, m, how):
    """A bar of `count` quick elements (c = 8) flies into one of 40 (c = 1): masses and edges 1, so that impedances are 8 and 1."""
    quick, slow = chain(count + 1, 1.0, 64.0), chain(41, 1.0, 1.0)
    h, v = 0.9 * stable(*quick), 0.01
    pair = Pair(quick, slow, m, h, how)
    force, ratio, turn = v * 8 / 9, 7 / 9, 2 * count / 8

    def closed(t):
        n = int(t / turn)
        return force * (turn * (1 - ratio**n) / (1 - ratio) + (t - n * turn) * ratio**n)
    sizes = [count + 1] * 2 + [41] * 2 + [1]
    figures = run(pair, pair.start(-v, 0.0), int(60 / (m * h)), closed)
    return figures + scan(held_step(quick, slow, m, how), stable(*quick), sizes)


def water(heavy):
    slow = chain(20, heavy, heavy)
    return slow, (np.array([1.0]), np.array([[4 * 64 / stable(*slow)**2]]))


def membrane(heavy, m, how):
    """A node of a membrane (mass 1, step 1/8 of the water's) carries a column of 20 nodes of water, `heavy` times its mass each, that comes to lie on it by its weight."""
    slow, quick = water(heavy)
    stiff, load, h = quick[1][0, 0], 1e-3, 0.9 * stable(*quick)
    pair = Pair(quick, slow, m, h, how, load)
    all_k = np.zeros((20, 20)) + slow[1]
    all_k[-1, -1] += stiff
    rest = np.linalg.solve(all_k, load * slow[0] + np.array([0.0] * 19 + [load]))
    least = pair.energy([rest[-1:], np.zeros(1), rest, np.zeros(20), []])
    figures = run(pair, pair.start(0.0, 0.0), 20000 // m, None, least)
    return figures + scan(held_step(quick, slow, m, how), stable(*quick), [1, 1, 20, 20, 1])


def graded_step(mass, fine, coarse, quick_node, m, h, how):
    """A common step of one bar: stiffness of quick and of slow elements, and which nodes are quick."""
    whole, slow_node = fine + coarse, ~quick_node

    def step(s):
        x, v = s[0].copy(), s[1].copy()
        held = coarse @ x
        if how == "nodes":
            v[slow_node] -= (m * h * (whole @ x) / mass)[slow_node]
        if how == "elements":
            v -= m * h * held / mass
        for _ in range(m):
            f = whole @ x if how == "nodes" else fine @ x + (held if how == "constant" else 0)
            if how == "nodes":
                v[quick_node] -= (h * f / mass)[quick_node]
            else:
                v -= h * f / mass
            x += h * v
        return [x, v]
    return step


def graded_bar(place, m, how):
    mass, fine, coarse = np.zeros(41), np.zeros((41, 41)), np.zeros((41, 41))
    for e in range(40):
        short = e >= place
        (fine if short else coarse)[e:e + 2, e:e + 2] += (m if short else 1.0) * np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass[e:e + 2] += 0.5 / (m if short else 1.0)
    quick_node = np.arange(41) >= place  # the interface's node is quick
    limit = 1.0 / m  # of a quick element alone
    return mass, fine, coarse, quick_node, limit, lambda dt: graded_step(mass, fine, coarse, quick_node, m, dt, how)


def graded(place, m, how):
    """40 elements, those from `place` on shorter by m: mass and edge 1 / m of the others'. Energy over 1e5 common steps from a velocity of random nodes."""
    mass, fine, coarse, quick_node, limit, make = graded_bar(place, m, how)
    step, v = make(0.9 * limit), np.random.default_rng(1).standard_normal(41)
    v -= (mass @ v) / mass.sum()
    columns = np.array([np.concatenate(step(np.split(row, 2))) for row in np.eye(82)]).T
    s, e0, most, p_most = np.concatenate([np.zeros(41), v]), 0.5 * mass @ v**2, 0.0, 0.0
    for n in range(100000):
        s = columns @ s
        if n % 10 == 0:
            x, w = s[:41], s[41:]
            dt = np.where(quick_node, 0.9 * limit, 0.9 * limit * m) if how == "nodes" else 0.9 * limit
            now = 0.5 * w @ (mass * w - dt * ((fine + coarse) @ x)) + 0.5 * x @ (fine + coarse) @ x if how != "elements" else \
                0.5 * w @ (mass * w - 0.9 * limit * (fine @ x) - 0.9 * limit * m * (coarse @ x)) + 0.5 * x @ (fine + coarse) @ x
            most, p_most = max(most, now), max(p_most, abs(mass @ w))
            if not now < 1e12 * e0:
                break
    return [f"{most / e0:.5g}", f"{now / e0:.5g}", "", "", f"{p_most / (mass @ abs(v)):.1g}", ""] + scan(make, limit, [41, 41])


def faster(times, share, every=0.0, walks=1):
    """Steps `times` as long without what takes `share` of a step: `every` is the share of what is done in all substeps beside it, `walks` how often what is quick is walked."""
    return max([1.0] + [min(m, times) / ((walks * share + every) * m + 1 - share - every) for m in (int(times), int(times) + 1) if m > 1])


def gain():
    for scene in sorted(glob.glob("bench/scenes/*.yaml")):
        text = subprocess.run([BRUNT, "check", scene, "-t", "1", "--quick"], capture_output=True, text=True).stdout
        limit, name = re.search(r"the step is that of body (\w+)(.*)", text), os.path.basename(scene)[:-5]
        if not limit:
            continue  # implicit, or rigid bodies alone
        rows = re.findall(r"^  (\w+) +\S+ +(?:\d+ bodies, )?(\d+) (particles|\w+)", text, re.M)
        count, kind = {n: float(k) for n, k, _ in rows}, {n: k for n, _, k in rows}
        parts = {p: float(c) / 100 for p, c in re.findall(r"(\w+) (\d+) %", re.search(r"^  steps \S+ s \((.*?)\)", text, re.M)[1])}
        body, points = limit[1], kind[limit[1]] == "particles"
        alike = sum(c for n, c in count.items() if (kind[n] == "particles") == points)
        passes = ("sort", "p2g", "grid", "update", "g2p", "ledger", "symmetry", "conditions", "boundaries") if points else ("elements", "kick", "drift")
        share = sum(parts.get(p, 0) for p in passes) * count[body] / alike
        meets = sum(parts.get(p, 0) for p in ("surfaces", "contact"))
        longer = re.search(r"([\d.e+]+) times as long without the body", limit[2])
        inner = re.search(r"([\d.e+]+) times as long without its (?:(\d+) )?shortest", limit[2])
        times, among = float(longer[1]) if longer else 1.0, float(inner[1]) if inner else 1.0
        few = parts.get("elements", 0) * float(inner[2] or 1) / alike if inner else 0.0
        gains = [f"{gain:.2f}" for gain in (faster(times, share), faster(times, share, meets), faster(times, share, walks=2))]
        yield [name, body, kind[body], f"{share:.2f}", f"{meets:.2f}", f"{times:.3g}", *gains, f"{among:.3g}", f"{faster(among, few):.2f}"]


def write(path, head, rows):
    with open(path, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(head)
        for row in rows:
            table.writerow(row)
            print(*row, flush=True)


def numerics():
    for how in CONTACT:
        for m in (1, 2, 4, 8):
            yield ["bar of 16 on bar", how, m] + impact(16, m, how)
            yield ["bar of 2 on bar", how, m] + impact(2, m, how)
            for heavy in (1, 10):
                yield [f"membrane, water {heavy} x", how, m] + membrane(heavy, m, how)
    for how in ("nodes", "elements", "constant"):
        for m in (2, 4):
            for place in (10, 20, 36):
                yield [f"graded bar, quick from {place}", how, m] + graded(place, m, how)


def plot():
    """Spectral radius over the step: a held membrane under water, m 4 and 2, and a graded bar."""
    slow, quick = water(10)
    blocks = [(how, held_step(quick, slow, 4, how), stable(*quick), [1, 1, 20, 20, 1]) for how in ("at once", "spread", "spread gap", "every", "ramp")]
    blocks += [(f"{how}, m {m}", graded_bar(20, m, how)[5], 1.0 / m, [41, 41]) for how in ("nodes", "elements", "constant") for m in (2, 4)]
    data = "".join(f"$b{k} << END\n" + "".join(f"{c} {max(radius(make(c * h), sizes) - 1, 1e-9)}\n" for c in CFL) + "END\n" for k, (_, make, h, sizes) in enumerate(blocks))
    lines = [f"$b{k} with lines lw 2 title '{how}'" for k, (how, *_) in enumerate(blocks)]
    subprocess.run(["gnuplot"], text=True, check=True, input=data + f"""set terminal pngcairo noenhanced size 1300, 520 font 'sans,11'
set output '{HERE}.png'
set colorsequence podo
set multiplot layout 1, 2
set logscale y
set format y '%.0e'
set yrange [1e-7:10]
set xlabel 'substep over the stable step of the quick part'
set ylabel 'growth a common step: spectral radius less 1'
set key bottom left
set title 'membrane held to water 10 times as heavy, 4 substeps'
plot {", ".join(lines[:5])}
set title 'bar, half of its elements shorter by m'
plot {", ".join(lines[5:])}
""")


def read(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def lines(head, rows):
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def tables():
    """Scenes that would gain; of each way and m the worst of all cases."""
    gains, rows = read(HERE + "_gain.csv"), read(HERE + ".csv")
    keys = [k for k in gains[0] if k.startswith("gain")]
    lines(["scene", "limiting body, its share", "steps without it", "gain at most, contact at common steps", "at all substeps", "two walks"],
          [[r["scene"], f"{r['limiting body']}, {r['its share of a step']}", r["steps without it"]] + [r[k] for k in keys[:3]] for r in gains if float(r[keys[0]]) >= 1.1])
    print(f"{len(gains)} explicit scenes; none of them gains more than {max(float(r[keys[3]]) for r in gains)} without 1 % of a body's elements\n")
    for part in (CONTACT, ["nodes", "elements", "constant"]):
        found = []
        for how, m in dict.fromkeys((r["how"], r["m"]) for r in rows if r["how"] in part):
            here = [r for r in rows if (r["how"], r["m"]) == (how, m)]
            worst = [max((float(r[k]) for r in here if r[k]), default=None) for k in (HEAD[3], HEAD[5], HEAD[6], HEAD[7], HEAD[8], HEAD[9], HEAD[10])]
            energy = "grows" if worst[0] > 1e3 else f"{worst[0]:.4f}"
            blank = (1, 2, 4) if energy == "grows" else ()  # nothing that is to be compared
            found.append([how, m, energy] + ["" if w is None or k in blank else f"{w:.1g}" for k, w in enumerate(worst[1:6], 1)] + [f"{worst[6]:.3f}"])
        lines(["how", "m", "energy, greatest", "depth", "impulse off", "momentum off", "ledger off", "growth a step, greatest", "share of steps that grow"], found)


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--plot"], ["--table"]):
        sys.exit(__doc__)
    if sys.argv[1:] == ["--table"]:
        sys.exit(tables())
    if not sys.argv[1:]:
        write(HERE + "_gain.csv", ["scene", "limiting body", "of", "its share of a step", "contact's share", "steps without it", "gain at most, contact at common steps",
                                   "gain at most, contact at all substeps", "gain at most, two walks", "steps without 1 % of its elements", "gain at most without these"], gain())
        write(HERE + ".csv", HEAD, numerics())
    plot()
