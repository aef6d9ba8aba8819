"""How near the laws of the program's catalogue come to noise-free amplitudes, one harmonic each.

Only oscillators.py uses this, to judge what it drew. With x = Re[A exp(i w t)] and one harmonic, the equation of motion is

    p/A = D(W, |A|) = c1 + c2 (1 - W^2) + i c3 W + (stiffness and loss that the laws add),

linear in the constants and in the strengths of the laws; what enters otherwise (a gap, x_m, an exponent) is scanned. Taken
relative to p/A, the misfit of D is that of A in the standard deviations of the noise: least squares, then Gauss-Newton on
ln A itself. Higher harmonics are left out, so the numbers are good to a per cent or so of the effect, worse for Q below 10.
"""

import bisect
import cmath
import math


def gap_share(c):
    """Stiffness of a stop on both sides over its own, for a gap of c times the amplitude; half of it with a stop on one side."""
    return 0.0 if c >= 1.0 else 2.0 / math.pi * (math.acos(c) - c * math.sqrt(1.0 - c * c))


def joint_table(n, count=160):
    """k'/k_t and k''/k_t of F_s [1 - (1 - x/x_m)^n] under Masing's rule over ln(a/x_m), by quadrature."""
    grid, values = [math.log(1e-3) + math.log(1e5) * i / (count - 1) for i in range(count)], []
    for at in grid:
        a = math.exp(at)

        def backbone(x):
            return (1.0 - max(0.0, 1.0 - x) ** n) / n

        top, steps, stiffness, loss = backbone(a), 200, 0.0, 0.0
        for i in range(steps):  # the way down, x = a cos t; the way up is its mirror image
            t = math.pi * (i + 0.5) / steps
            force = top - 2.0 * backbone(a * (1.0 - math.cos(t)) / 2.0)
            stiffness += 2.0 / steps / a * force * math.cos(t)
            loss -= 2.0 / steps / a * force * math.sin(t)
        values.append(complex(stiffness, loss))
    return grid, values


class Interpolated:
    tables = {}

    def __init__(self, n):
        if n not in self.tables:
            self.tables[n] = joint_table(n)
        self.grid, self.values = self.tables[n]

    def __call__(self, ratio):
        at = min(max(math.log(ratio), self.grid[0]), self.grid[-1] - 1e-9)
        i = bisect.bisect_right(self.grid, at) - 1
        share = (at - self.grid[i]) / (self.grid[i + 1] - self.grid[i])
        return self.values[i] * (1.0 - share) + self.values[i + 1] * share


EXPONENTS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
POWERS = (0.0, 0.5, 1.5, 2.5, 3.0, 4.0)


class Fit:
    """Fits to complex amplitudes A at (W, p), `series` their numbers; noise relative and in radians (None: no phases)."""

    def __init__(self, points, amplitudes, series, Q, noise, noise_phase):
        self.W = [w for w, _ in points]
        self.D = [p / a for (_, p), a in zip(points, amplitudes)]
        self.a = [abs(a) for a in amplitudes]
        self.top = max(self.a)
        self.series = series
        self.Q, self.noise, self.noise_phase = Q, noise, noise_phase
        self.base = [
            [Q * (1.0 - w * w) for w in self.W], [1.0] * len(self.W), [1j * w for w in self.W],
        ]
        if noise_phase is not None:
            self.base.append([1j * d for d in self.D])  # an offset of the phase
        self.memory = {}

    # -- the laws: each a list of columns for given scanned numbers

    def columns(self, law, *scanned):
        key = (law, *scanned)
        if key not in self.memory:
            self.memory[key] = self.make(law, *scanned)
        return self.memory[key]

    def make(self, law, *scanned):
        W, a, D, top = self.W, self.a, self.D, self.top
        if law == "cubic-stiffness":
            return [[(x / top) ** 2 for x in a]]
        if law == "quintic-stiffness":
            return [[(x / top) ** 4 for x in a]]
        if law == "quadratic-damping":
            return [[1j * w * w * x / top for w, x in zip(W, a)]]
        if law == "power-damping":
            return [[1j * w ** scanned[0] * (x / top) ** (scanned[0] - 1.0) for w, x in zip(W, a)]]
        if law == "structural-damping":
            return [[1j] * len(W)]
        if law == "sensor-delay":
            return [[1j * w * d for w, d in zip(W, D)]]
        if law == "residual-modes":
            return [[d * d for d in D], [d * d / (w * w) for w, d in zip(W, D)]]
        if law == "drift":
            # more than drift: a stiffness, a gain and a damping of its own for each series
            return [[c * (t == s) for t, c in zip(self.series, column)] for s in sorted(set(self.series))[1:] for column in self.base[:3]]
        if law == "clearance":
            return [[gap_share(scanned[0] * top / x) for x in a]]
        if law == "friction-joint":
            table = Interpolated(scanned[0])
            return [[table(x / (scanned[1] * top)) for x in a]]
        raise ValueError(law)

    def scans(self, law):
        if law == "power-damping":
            return [(p,) for p in POWERS]
        if law == "clearance":
            return [(0.02 * 1.23**i,) for i in range(19)]
        if law == "friction-joint":
            return [(n, 0.05 * 1.55**i) for n in EXPONENTS for i in range(13)]
        return [()]

    # -- least squares in real rows

    def rows(self, column):
        """A column of D in noise standard deviations of ln A, real above imaginary parts."""
        ratio = [c / d for c, d in zip(column, self.D)]
        sd = self.noise if self.noise_phase is None else self.noise_phase
        return [complex(r).real / self.noise for r in ratio] + [complex(r).imag / sd for r in ratio]

    @staticmethod
    def without(vector, basis):
        for q in basis:
            share = sum(x * y for x, y in zip(vector, q))
            vector = [x - share * y for x, y in zip(vector, q)]
        return vector

    def extend(self, basis, columns):
        basis = list(basis)
        for column in columns:
            vector = self.rows(column)
            before = math.sqrt(sum(x * x for x in vector))
            vector = self.without(self.without(vector, basis), basis)
            length = math.sqrt(sum(x * x for x in vector))
            if length > 1e-9 * before:
                basis.append([x / length for x in vector])
        return basis

    def left(self, laws):
        """Sum of squares that the linear constants and these (law, scanned) leave, linearised."""
        basis = self.start()
        for law, scanned in laws:
            basis = self.extend(basis, self.columns(law, *scanned))
        rest = self.without(self.target, basis)
        return sum(x * x for x in rest)

    def start(self):
        if not hasattr(self, "first"):
            self.target = self.rows(self.D)
            self.first = self.extend([], self.base)
        return self.first

    def best(self, law, others=()):
        """The scanned numbers of a law that leave least beside others, refined: (sum of squares, scanned)."""
        basis = self.start()
        for other, scanned in others:
            basis = self.extend(basis, self.columns(other, *scanned))
        target = self.without(self.target, basis)

        def cost(scanned):
            extra = self.extend(basis, self.columns(law, *scanned))[len(basis):]
            rest = self.without(target, extra)
            return sum(x * x for x in rest)

        found = min((cost(s), s) for s in self.scans(law))
        if law in ("clearance", "friction-joint"):
            step = 1.25
            while step > 1.02:
                tries = [(*found[1][:-1], found[1][-1] * f) for f in (step, 1.0 / step)]
                again = min((cost(s), s) for s in tries)
                if again[0] < found[0]:
                    found = again
                else:
                    step = math.sqrt(step)
        return found

    def misses(self, laws):
        """(largest, rms) in noise standard deviations of the best fit of ln A, or ln |A| without phases."""
        columns = list(self.base)
        for law, scanned in laws:
            columns += self.columns(law, *scanned)
        columns = [[c / d for c, d in zip(column, self.D)] for column in columns]
        lengths = [math.sqrt(sum(abs(c) ** 2 for c in column)) or 1.0 for column in columns]
        columns = [[c / n for c in column] for column, n in zip(columns, lengths)]
        rows = range(len(self.D))
        phases = self.noise_phase is not None

        def residuals(v):
            model = [sum(x * column[k] for x, column in zip(v, columns)) for k in rows]
            if any(m == 0.0 for m in model):
                return None, None
            logs = [cmath.log(m) for m in model]
            out = [x.real / self.noise for x in logs]
            return model, out + ([x.imag / self.noise_phase for x in logs] if phases else [])

        def normal(model, r, damping):
            slopes = []
            for column in columns:
                s = [c / m for c, m in zip(column, model)]
                slopes.append([x.real / self.noise for x in s] + ([x.imag / self.noise_phase for x in s] if phases else []))
            matrix = [[sum(x * y for x, y in zip(p, q)) for q in slopes] for p in slopes]
            for i in range(len(columns)):
                matrix[i][i] *= 1.0 + damping
                matrix[i][i] += 1e-300
            return [-x for x in solve(matrix, [sum(x * y for x, y in zip(s, r)) for s in slopes])]

        # the start: complex least squares, as if there were phases
        sd = (self.noise, self.noise_phase if phases else self.noise)
        flat = [[complex(c).real / sd[0] for c in column] + [complex(c).imag / sd[1] for c in column] for column in columns]
        target = [1.0 / sd[0]] * len(self.D) + [0.0] * len(self.D)
        matrix = [[sum(x * y for x, y in zip(p, q)) for q in flat] for p in flat]
        for i in range(len(matrix)):
            matrix[i][i] *= 1.0 + 1e-11
        v = solve(matrix, [sum(x * y for x, y in zip(s, target)) for s in flat])
        model, r = residuals(v)
        if r is None:
            return math.inf, math.inf
        damping = 1e-6
        for _ in range(60):
            w = [x + y for x, y in zip(v, normal(model, r, damping))]
            other, s = residuals(w)
            if s is not None and sum(x * x for x in s) < sum(x * x for x in r):
                gained = sum(x * x for x in r) - sum(x * x for x in s)
                v, model, r, damping = w, other, s, damping / 10.0
                if gained < 1e-4 * (1.0 + sum(x * x for x in r)):
                    break
            else:
                damping = max(damping * 30.0, 1e-6)
                if damping > 1e6:
                    break
        return max(abs(x) for x in r), math.sqrt(sum(x * x for x in r) / len(r))


ALONE = (
    "cubic-stiffness", "quadratic-damping", "friction-joint", "structural-damping", "sensor-delay", "quintic-stiffness",
    "clearance", "power-damping", "residual-modes", "drift",
)
PAIRED = ("cubic-stiffness", "quintic-stiffness", "quadratic-damping", "structural-damping", "residual-modes")


def solve(matrix, right):
    """Gaussian elimination with pivoting; a direction without effect is left at zero."""
    n = len(right)
    rows = [list(matrix[i]) + [right[i]] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda j: abs(rows[j][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        if rows[i][i] == 0.0:
            continue
        for j in range(i + 1, n):
            factor = rows[j][i] / rows[i][i]
            if factor:
                rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i])]
    x = [0.0] * n
    for i in reversed(range(n)):
        if rows[i][i]:
            x[i] = (rows[i][n] - sum(rows[i][j] * x[j] for j in range(i + 1, n))) / rows[i][i]
    return x


def testable(fit, law):
    return fit.noise_phase is not None or law != "sensor-delay"  # which without phases is nothing at all


def alone(fit, laws=ALONE):
    """{law: largest miss} of each law by itself."""
    return {law: fit.misses([(law, fit.best(law)[1])])[0] for law in laws if testable(fit, law)}


def in_pairs(fit, but=(), of=()):
    """[(largest miss, [law, law])] of the pairs that leave least, one of them of PAIRED, the least first; without any of `but`, and
    with one of `of` where there are such."""
    candidates = []
    for i, first in enumerate(PAIRED):
        for second in ALONE:
            if first == second or second in PAIRED[:i] or first in but or second in but or not testable(fit, second):
                continue
            if of and first not in of and second not in of:
                continue
            left, scanned = fit.best(second, [(first, ())])
            candidates.append((left, [(first, ()), (second, scanned)]))
    candidates.sort(key=lambda c: c[0])
    return sorted((fit.misses(laws)[0], [law for law, _ in laws]) for _, laws in candidates[: None if of else 4 if fit.noise_phase else 8])
