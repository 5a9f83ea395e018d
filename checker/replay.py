"""Replays one proof of `grouser optimize --certify` with interval arithmetic of its own (check.py reads the logs).
A proof claims that no point of a box has a level below `lower`, and that a point `x` has the level `upper`. Every line is replayed:
the boxes cover the whole box, each leaf's bound follows from its multipliers, and the point has the level. No code is shared with
the program. It relies on IEEE 754 and on elementary functions of Python's math module that are within ULPS units in the last place."""
import fractions, functools, hashlib, json, math, sys
INF, ULPS, point, reduce = math.inf, 4, lambda x: (x, x), functools.reduce
# an interval is (low, high), or None where a function has no value
ALL, ZERO, ONE, TWO = (-INF, INF), point(0.0), point(1.0), point(2.0)
Refused = type("Refused", (Exception,), {"__doc__": "The log does not prove what it claims."})
def need(condition, reason):
    if not condition:
        raise Refused(reason)
down, up = lambda x: math.nextafter(x, -INF), lambda x: math.nextafter(x, INF)
def add(a, b):  # a sum that is exact is not rounded
    low, high = a[0] + b[0], a[1] + b[1]
    low = low if low - a[0] == b[0] and low - b[0] == a[0] else down(low)
    high = high if high - a[1] == b[1] and high - b[1] == a[1] else up(high)
    return (-INF if low != low else low, INF if high != high else high)
neg, sub = lambda a: a and (-a[1], -a[0]), lambda a, b: add(a, neg(b))
def mul(a, b):
    p = [0.0 if x == 0 or y == 0 else x * y for x in a for y in b]
    return ZERO if a == ZERO or b == ZERO else (down(min(p)), up(max(p)))
def div(a, b):
    if b == ZERO or b[0] > 0 or b[1] < 0:
        p = [0.0 if math.isinf(y) else x / (y or 1.0) for x in a for y in b]
        return None if b == ZERO else ZERO if a == ZERO else (down(min(p)), up(max(p)))
    return mul(a, ALL) if b[0] < 0 < b[1] else mul(a, (max(down(1 / b[1]), 0.0), INF) if b[0] == 0 else (-INF, min(up(1 / b[0]), 0.0)))
size, within = lambda a: max(abs(a[0]), abs(a[1])), lambda a, least, most: (max(a[0], least), min(a[1], most))
absolute = lambda a: a if a[0] >= 0 else neg(a) if a[1] <= 0 else (0.0, size(a))
def wide(low, high, least=-INF, most=INF):  # two ends from the library, widened by its error, within the range of the function
    low, high = (x + s * abs(x) * ULPS * sys.float_info.epsilon if math.isfinite(x) else x for x, s in ((low, -1), (high, 1)))
    return (max(down(low), least), min(up(high), most))
def end(f, *x):  # a function that overflows to ∞ instead of raising
    try:
        return f(*x)
    except (OverflowError, ZeroDivisionError):
        return -INF if f is math.sinh and x[0] < 0 else INF
rising = lambda f, a, least=-INF, most=INF, domain=ALL: None if a[1] < domain[0] or a[0] > domain[1] else wide(
    end(f, max(a[0], domain[0])), end(f, min(a[1], domain[1])), least, most)
logarithm = lambda f, a, edge=0.0: None if a[1] <= edge else wide(f(a[0]) if a[0] > edge else -INF, f(a[1]))
root = lambda a: None if a is None or a[1] < 0 else (max(down(math.sqrt(max(a[0], 0.0))), 0.0), up(math.sqrt(a[1])))
def turns(a, shift):  # the whole numbers k with (k + shift/2) π in the interval; many where they cannot be counted
    first, last = (x / math.pi - 0.5 * shift if size(a) < 1e9 else 2 * (x > 0) for x in a)
    return range(2) if size(a) >= 1e9 else range(math.floor(first - 1e-6) + 1, math.floor(last + 1e-6) + 1)
def wave(f, a, shift):  # a wave with maxima at the even and minima at the odd half turns from `shift` quarter turns
    parities = {k % 2 for k in turns(a, shift)}
    low, high = wide(min(map(f, a)), max(map(f, a)), -1.0, 1.0) if len(parities) < 2 else (-1.0, 1.0)
    return (-1.0 if 1 in parities else low, 1.0 if 0 in parities else high)
sin, cos = lambda x: wave(math.sin, x, 1), lambda x: wave(math.cos, x, 0)
sinh, cosh = lambda x: rising(math.sinh, x), lambda x: rising(math.cosh, absolute(x), least=1.0)
sinc = lambda a: within(div(sin(a), a) or ALL, -0.2173, 1.0) if size(a) > math.pi else wide(  # sin x/x, which falls from 0 to π and beyond
    *(math.sin(x) / x if x > 0 else 1.0 for x in absolute(a)[::-1]), -1.0, 1.0)
def sinc_slopes(a, v):  # -x/3 + x^3/30 - x^5/840 + x^7/45360 - ..., an odd function that falls up to x = 2.08, and its slope
    series = lambda x: mul(point(x), reduce(lambda v, k: add(div(ONE, point(k)), mul(powi(point(x), 2), v)), (-840.0, 30.0, -3.0), (0.0, 2.3e-5)))
    slope = (series(a[1])[0], series(a[0])[1]) if size(a) <= 2 else within(div(sub(cos(a), v), a), -0.4363, 0.4363)
    return slope, within(sub(neg(v), mul(TWO, div(slope, a) or ALL)), -0.334, 0.334)
def powi(a, n):
    if n <= 1:
        return a if n == 1 else div(ONE, powi(a, -n)) if n else ONE
    low, high = (reduce(mul, [point(x)] * n) for x in (absolute(a) if n % 2 == 0 else a))
    return (max(low[0], 0.0) if n % 2 == 0 else low[0], high[1])
def power(a, b):
    if a[0] < 0 and math.floor(b[1]) < b[0] if size(b) < INF else False:  # a negative number has powers at whole exponents alone
        return None if a[1] < 0 else power((0.0, a[1]), b)
    p = [end(math.pow, abs(x), y) if x > 0 or y >= 0 else INF for x in a for y in b]
    return ALL if a[0] < 0 else wide(min(p), max(p), 0.0)
def power_by_exponent(x, y, value):  # x^y ln x; it tends to 0 at x = 0 and is at least -1/(e y)
    whole = mul(value, logarithm(math.log, x) or ALL)
    least = -INF if y[0] <= 0 else down(down(-1 / (2.718281828459045 * y[0])))
    return whole if x[0] > 0 else (least, whole[1] if x[1] > 1 else 0.0) if y[0] > 0 else ALL
crosses = lambda y, x: x[0] <= 0 and y[0] <= 0 <= y[1]  # may the angle jump by a turn?
atan2 = lambda y, x: (-up(math.pi), up(math.pi)) if crosses(y, x) else wide(
    min(p := [math.atan2(a, b) for a in y for b in x]), max(p))
def quotient(a, b, v):
    share, cross = div(ONE, b), neg(powi(b, -2))
    return [share, neg(div(v, b))], [(0, 1, cross), (1, 0, cross), (1, 1, div(mul(TWO, v), powi(b, 2)))]
def power_slopes(a, b, v):
    ln, less = logarithm(math.log, a) or ALL, power(a, sub(b, ONE))
    mixed = mul(less, add(ONE, mul(b, ln)))
    bends = [(0, 0, mul(mul(b, sub(b, ONE)), power(a, sub(b, TWO)))), (0, 1, mixed), (1, 0, mixed), (1, 1, mul(v, powi(ln, 2)))]
    return [mul(b, less), power_by_exponent(a, b, v)], bends
def arc(x, sign):
    slope = div(sign, root(sub(ONE, powi(x, 2))))
    return slope, mul(x, mul(sign, powi(slope, 3)))
def either(first, second):  # the slopes of a choice: certain, or between 0 and 1 with a kink
    known = first or second
    return [(ONE if first else ZERO), (ZERO if first else ONE)] if known else [(0.0, 1.0)] * 2, [] if known else [(0, 0, ALL), (1, 1, ALL)]
LN10, always = wide(math.log(10.0), math.log(10.0)), lambda *_: True
# name: value; is it defined and continuous over the whole interval?; by the arguments and the value the first and the second
# derivative, of two arguments as a list and as triples with the numbers of the arguments (unbounded where there is none)
TABLE = {
    "neg": (neg, always, lambda x, v: (point(-1.0), ZERO)),
    "abs": (absolute, always, lambda x, v: (ONE, ZERO) if x[0] >= 0 else (point(-1.0), ZERO) if x[1] <= 0 else ((-1.0, 1.0), ALL)),
    "sqrt": (root, lambda x: x[0] >= 0, lambda x, v: (div(ONE, mul(TWO, v)), div(point(-0.25), mul(x, v)))),
    "exp": (lambda x: rising(math.exp, x, 0.0), always, lambda x, v: (v, v)),
    "expm1": (lambda x: rising(math.expm1, x, -1.0), always, lambda x, v: (add(v, ONE), add(v, ONE))),
    "ln": (lambda x: logarithm(math.log, x), lambda x: x[0] > 0, lambda x, v: (div(ONE, x), neg(powi(x, -2)))),
    "ln1p": (lambda x: logarithm(math.log1p, x, -1.0), lambda x: x[0] > -1, lambda x, v: (div(ONE, add(ONE, x)), neg(powi(add(ONE, x), -2)))),
    "log10": (lambda x: (ln := logarithm(math.log, x)) and div(ln, LN10), lambda x: x[0] > 0, lambda x, v: (
        s := div(ONE, mul(x, LN10)), neg(div(s, x)))),
    "sin": (sin, always, lambda x, v: (cos(x), neg(v))),
    "cos": (cos, always, lambda x, v: (neg(sin(x)), neg(v))),
    "tan": (lambda x: ALL if turns(x, 1) else rising(math.tan, x), lambda x: not turns(x, 1), lambda x, v: (
        s := add(ONE, powi(v, 2)), mul(mul(TWO, v), s))),
    "asin": (lambda x: rising(math.asin, x, domain=(-1.0, 1.0)), lambda x: size(x) <= 1, lambda x, v: arc(x, ONE)),
    "acos": (lambda x: rising(lambda y: math.acos(-y), neg(x), 0.0, domain=(-1.0, 1.0)), lambda x: size(x) <= 1, lambda x, v: arc(x, point(-1.0))),
    "atan": (lambda x: rising(math.atan, x), always, lambda x, v: (s := div(ONE, add(ONE, powi(x, 2))), mul(mul(point(-2.0), x), powi(s, 2)))),
    "sinh": (sinh, always, lambda x, v: (cosh(x), v)),
    "cosh": (cosh, always, lambda x, v: (sinh(x), v)),
    "tanh": (lambda x: rising(math.tanh, x, -1.0, 1.0), always, lambda x, v: (s := sub(ONE, powi(v, 2)), mul(mul(point(-2.0), v), s))),
    "sinc": (sinc, always, sinc_slopes),
    "powi": (powi, lambda x, n: n >= 0 or not x[0] <= 0 <= x[1], lambda x, n, v: (
        mul(point(float(n)), powi(x, n - 1)), mul(point(float(n * (n - 1))), powi(x, n - 2)) if n not in (0, 1) else ZERO)),
    "add": (add, always, lambda a, b, v: ([ONE, ONE], [])),
    "sub": (sub, always, lambda a, b, v: ([ONE, point(-1.0)], [])),
    "mul": (mul, always, lambda a, b, v: ([b, a], [(0, 1, ONE), (1, 0, ONE)])),
    "div": (div, lambda a, b: not b[0] <= 0 <= b[1], quotient),
    "pow": (power, lambda a, b: a[0] > 0 or a[0] == 0 < b[0], power_slopes),
    "min": (lambda a, b: (min(a[0], b[0]), min(a[1], b[1])), always, lambda a, b, v: either(a[1] < b[0], b[1] < a[0])),
    "max": (lambda a, b: (max(a[0], b[0]), max(a[1], b[1])), always, lambda a, b, v: either(b[1] < a[0], a[1] < b[0])),
    "atan2": (atan2, lambda a, b: not crosses(a, b), lambda a, b, v: (
        [div(b, add(powi(a, 2), powi(b, 2))), neg(div(a, add(powi(a, 2), powi(b, 2))))], [(0, 0, ALL), (1, 1, ALL)])),
}
TWO_ARGUMENTS = ("add", "sub", "mul", "div", "pow", "min", "max", "atan2")
TABLE |= {name: (value, regular, lambda *x, slopes=slopes: [[part] if k == 0 else [(0, 0, part)] for k, part in enumerate(slopes(*x))])
          for name, (value, regular, slopes) in TABLE.items() if name not in TWO_ARGUMENTS}
operands = lambda op: [] if op[0] in ("const", "var") else op[1:2] if op[0] == "powi" else op[1:]
def needed(ops, node):  # the operations that a row needs, in order
    return sorted(reduce(lambda known, at: known.union(operands(ops[at])) if at in known else known, range(node, -1, -1), {node}))
def collect(terms):  # the sums of the products by key
    sums = {}
    for key, factor, part in terms:
        sums[key] = add(sums.get(key, ZERO), part if factor == ONE else mul(factor or ALL, part))
    return sums
def forward(ops, order, box):  # over a box: operations' arguments, their values (None: nowhere), and which are defined and continuous
    taken, value, regular = {}, {}, {}
    for at in order:
        (name, *given), x = ops[at], [value[a] for a in operands(ops[at])]
        taken[at], has_value = x + (given[1:] if name == "powi" else []), None not in x
        value[at] = box[given[0]] if name == "var" else point(given[0]) if name == "const" else TABLE[name][0](*taken[at]) if has_value else None
        regular[at] = not x or has_value and TABLE[name][1](*taken[at])
    return taken, value, regular
def passed_on(ops, at, share):  # what a sum, a sign or a multiple passes on of its share; None for others. Exact products are not rounded
    name, *given = ops[at]
    if name == "mul" and [ops[a][0] for a in given].count("const") == 1:
        other, factor = sorted(given, key=lambda a: ops[a][0] == "const")
        (low, high), k = share, ops[factor][1]
        return [(other, point(low * k) if low == high and fractions.Fraction(low) * fractions.Fraction(k) == low * k else mul(share, point(k)))]
    signs = {"add": (share, share), "sub": (share, neg(share)), "neg": (neg(share),)}
    return zip(given, signs[name]) if name in signs else None
def backward(ops, order, seeds, own):  # passes the shares of a weighted sum on to the operands; `own(at, share)` does where none is obvious
    share = dict(seeds)
    for at in reversed(order):
        parts = [] if (mine := share.get(at, ZERO)) == ZERO else passed_on(ops, at, mine)
        for a, part in own(at, mine) if parts is None else parts:
            share[a] = add(share.get(a, ZERO), part)
def total(ops, rows, weights, box, depth):
    """The weighted sum of rows over a box: its value, and to this depth its slopes and curvatures where the mean value theorem applies.
    None also where a row has no value. Sums are taken apart, so that what rows have in common counts once."""
    order = sorted(set().union(*(rows[row][1] for row, _ in weights)))
    taken, value, regular = forward(ops, order, box)
    derivatives = lambda at: TABLE[ops[at][0]][2](*taken[at], value[at]) if taken[at] else ([], [])
    seeds, terms, jumps, slopes, bend, gradient = collect((rows[row][1][-1], ONE, point(w)) for row, w in weights), [ZERO], [], {}, {}, {}
    if any(value[node] is None for node in seeds):
        return None, None, None
    backward(ops, order, seeds, lambda at, share: terms.append(mul(share, value[at])) or [])
    def by_operands(at, share):
        (slopes if ops[at][0] == "var" else {})[ops[at][1]] = share
        jumps.extend([] if regular[at] else [at])
        return [(a, mul(share, f or ALL)) for f, a in zip(derivatives(at)[0] if regular[at] else [], operands(ops[at]))]
    if depth > 0:
        backward(ops, order, seeds, by_operands)
    for at in order if depth > 1 and all(regular.values()) else []:
        inner, (first, second) = operands(ops[at]), derivatives(at)
        gradient[at] = {ops[at][1]: ONE} if ops[at][0] == "var" else collect((d, f, x) for f, a in zip(first, inner) for d, x in gradient[a].items())
        bend[at] = collect([*((de, factor, x) for factor, a in zip(first, inner) for de, x in bend[a].items()),
                            *(((d, e), factor, powi(p, 2) if k == l and d == e else mul(p, q)) for k, l, factor in second
                              for d, p in gradient[inner[k]].items() for e, q in gradient[inner[l]].items())])
    whole = collect((de, w, x) for at, w in seeds.items() for de, x in bend[at].items()) if bend else None
    return reduce(add, terms), slopes if depth > 0 and not jumps else None, whole
def is_curved(bend, half, curvature):  # is `bend` less `curvature` positive definite? Its middle is eliminated, less its spread
    middle = {(d, e): point(0.5 * sum(bend.get((d, e), ZERO))) for d in half for e in half}
    spread = {(d, e): mul(point(size(sub(bend.get((d, e), ZERO), middle[d, e]))), div(half[e], half[d])) for d, e in middle}
    rest = middle | {(d, d): sub(sub(middle[d, d], curvature[d]), collect((0, ONE, spread[d, e]) for e in half)[0]) for d in half}
    for d, e, k in ((d, e, k) for k in half for d in half for e in half if d > k < e):
        rest[d, e] = sub(rest[d, e], mul(div(rest[d, k], rest[k, k]), rest[k, e])) if 0 < rest[k, k][0] else ALL
    return all(0 < rest[d, d][0] <= rest[d, d][1] < INF for d in half)
def centre(x, slope):  # where the mean value form is best; any point of the box would do
    low, high = slope
    return x[0] if low >= 0 or high == INF else x[1] if high <= 0 or low == -INF else (
        min(x[1], max(x[0], (x[0] * high - x[1] * low) / (high - low))))
def bound(ops, rows, weights, tangent, box):
    """The greatest level that the multipliers prove for the box; infinite where it holds no feasible point."""
    natural, slopes, bend = total(ops, rows, weights, box, 2 if tangent else 1)
    low, forms = natural[0] if natural else INF, [] if slopes is None else [([centre(x, slopes.get(d, ZERO)) for d, x in enumerate(box)], slopes, {})]
    if tangent and bend is not None:
        half = {d: point((b - a) / 2) for d, (a, b) in enumerate(box) if a < b}
        curvature = {d: point(tangent[1] / h[0] ** 2) for d, h in half.items()}
        at = [min(max(p, x[0]), x[1]) for p, x in zip(tangent[0], box, strict=True)]
        steep = total(ops, rows, weights, [*map(point, at)], 1)[1]
        if steep is not None and is_curved(bend, half, curvature):
            forms.append((at, steep, curvature))
    for at, slopes, curvature in forms:
        form = total(ops, rows, weights, [*map(point, at)], 0)[0] or ALL
        for d, step in enumerate(sub(x, point(p)) for x, p in zip(box, at)):
            form = add(form, add(mul(slopes.get(d, ZERO), step), mul(div(curvature.get(d, ZERO), TWO), powi(step, 2))))
        low = max(low, form[0])
    share = collect((0, ONE, point(w)) for row, w in weights if rows[row][0] == "objective").get(0, ZERO)
    return INF if natural is None else (div(point(low), share)[0] if low > -INF else -INF) if share[1] > 0 else INF if low > 0 else -INF
def push(ops, *op):  # the place of an operation, which is listed once
    op = ["powi", op[1], 2] if op[0] == "mul" and op[1] == op[2] else [*op]
    return ops.index(op) if op in ops else ops.append(op) or len(ops) - 1
def fraction(ops, at, one):  # a row as numerator and denominator
    name, *given = ops[at]
    if name not in ("neg", "add", "sub", "mul", "div"):
        return at, one
    times = lambda a, b: b if a == one else a if b == one else push(ops, "mul", a, b)
    (n, d), (m, e) = (fraction(ops, a, one) for a in [*given, given[0]][:2])
    if name in ("mul", "div"):
        return (times(n, m), times(d, e)) if name == "mul" else (times(n, e), times(d, m))
    n, m, d = (n, m, d) if d == e else (times(n, e), times(m, d), times(d, e))
    return push(ops, "neg", n) if name == "neg" else push(ops, name, n, m), d
def cleared(ops, rows, level):  # what rows mean at a level, the last variable: where N/D and -N/D are both rows, N - level |D| <= 0
    ops, done, nodes = [*ops], [], [order[-1] for kind, order in rows if kind == "objective"]
    one, level = push(ops, "const", 1.0), push(ops, "var", level)
    for kind, order in rows:
        node = order[-1]
        paired = any(ops[a] == ["neg", b] for other in nodes for a, b in ((node, other), (other, node)))
        n, d = fraction(ops, node, one) if paired else (node, one)
        limit = push(ops, "mul", level, push(ops, "abs", d))
        done.append(("at_most", needed(ops, push(ops, "sub", n, limit))) if kind == "objective" else (kind, order))
    return ops, done
is_number = lambda x: isinstance(x, (int, float)) and not isinstance(x, bool) and math.isfinite(x)
def check_text(head):  # the problem that the log is bound to, where it has one
    problem = head.get("problem", {"sha256": "", "text": None})
    if problem["text"] is not None:
        need(hashlib.sha256(problem["text"].encode()).hexdigest() == problem["sha256"], "the text of the problem has another hash")
    return problem
def read_problem(head):
    need(head["format"] == "grouser-certificate" and head["version"] == 1, "not a proof log of version 1")
    check_text(head)
    lower, upper, ops = (head[key] for key in ("lower", "upper", "ops"))
    sides = [is_number(a) and is_number(b) and a <= b for a, b in zip(lower, upper, strict=True)]
    need(len(sides) == len(head["variables"]) and all(sides), "a side of the box is missing or empty")
    for at, (name, *given) in enumerate(ops):
        whole = all(isinstance(a, int) for a in given[: 2 if name == "powi" else None])
        good = {"const": len(given) == 1 and is_number(given[0]), "var": whole and len(given) == 1 and given[0] in range(len(lower)),
                "powi": whole and len(given) == 2}.get(name, whole and name in TABLE and len(given) == 1 + (name in TWO_ARGUMENTS))
        need(good and all(0 <= a < at for a in operands(ops[at])), f"operation {at} is not understood")
    rows = [(kind, needed(ops, node)) for kind, node, _ in head["rows"] if kind in ("objective", "at_most", "equal")]
    need(len(rows) == len(head["rows"]) and any(kind == "objective" for kind, _ in rows), "a row is not understood")
    return [(float(a), float(b)) for a, b in zip(lower, upper)], ops, rows
def check_point(box, ops, rows, last):  # the point has the level and the violation that are claimed
    need(len(last["x"]) == len(box) and all(is_number(v) and s[0] <= v <= s[1] for v, s in zip(last["x"], box)), "the point is not in the box")
    for kind, order in rows:
        value = forward(ops, order, [*map(point, last["x"])])[1][order[-1]]
        need(value is not None, "a row has no value at the point")
        most, limit = size(value) if kind == "equal" else value[1], last["upper" if kind == "objective" else "violation"]
        need(most <= limit + 1e-12 * (1 + abs(most)), f"the point exceeds what is claimed: {most} > {limit}")
    return True
def check(lines, head):  # replays a log behind its first line; returns what it proves: how it ended, its bounds, its leaves
    box, ops, rows = read_problem(head)
    pending, seen, lowest, leaves, last, without = {0: box}, {0}, INF, 0, None, None
    for entry in map(json.loads, lines):
        if "end" in entry:
            last = entry
            break
        need(entry["box"] in pending, f"box {entry['box']} is not open")
        mine = pending.pop(entry["box"])
        if "divide" in entry:
            d, at = entry["divide"], entry["at"]
            need(d in range(len(box)) and is_number(at) and mine[d][0] < at < mine[d][1], f"box {entry['box']} is not divided inside")
            parts = dict(zip(entry["into"], ((mine[d][0], at), (at, mine[d][1])), strict=True))
            need(len(parts) == 2 and not seen & parts.keys(), f"a part of box {entry['box']} occurs twice")
            seen.update(parts)
            pending.update((number, [*mine[:d], side, *mine[d + 1 :]]) for number, side in parts.items())
            continue
        need(all(row in range(len(rows)) and is_number(w) and (w >= 0 or rows[row][0] == "equal") for row, w in entry["weights"]), "a bad multiplier")
        claimed = {None: INF, "none": -INF}.get(entry["bound"], entry["bound"])
        at, curvature = tangent = entry.get("tangent", ([], 0.0))
        need(all(map(is_number, [*at, curvature])) and curvature <= 0, "a tangent is not allowed")
        without = without or ("cleared" in entry and cleared(ops, rows, len(box)))
        here = (*without, [*mine, point(claimed)]) if "cleared" in entry else (ops, rows, mine)
        proved = bound(*here[:2], entry["weights"], tangent if at else None, here[2])
        need(claimed <= proved, f"box {entry['box']}: {claimed} is claimed, {proved} is proved")
        lowest, leaves = min(lowest, claimed), leaves + 1
    need(last is not None and not pending, f"the log has no end, or {len(pending)} boxes are not covered")
    status, lower, upper = (last[key] for key in ("end", "lower", "upper"))
    # a search that ended early may have no claim but that its boxes hold no feasible point
    need(status != "infeasible" or lowest == INF, "that there are no feasible points is not proved")
    need(lower is None or lower <= lowest, f"the lower bound {lower} is claimed, {lowest} is proved")
    need(upper is None or check_point(box, ops, rows, last), "the point is not checked")
    need(status != "proved" or None not in (lower, upper) and upper - lower <= head["gap"] * (1 + abs(upper)), "the gap is not reached")
    return status, lower, upper, leaves
