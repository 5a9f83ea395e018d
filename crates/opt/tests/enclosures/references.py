"""Writes references.csv: random expressions at random points, their values to 30 digits (needs mpmath 1.3).

Columns: the expression in postfix notation (x0 x1 x2 are the variables), the point, the value.
"""
import random

import mpmath
from mpmath import mp

mp.dps = 50
random.seed(2012)
ONE = {
    "neg": lambda x: -x, "abs": abs, "sqrt": mpmath.sqrt, "exp": mpmath.exp, "expm1": mpmath.expm1, "ln": mpmath.log,
    "ln1p": lambda x: mpmath.log(1 + x), "log10": mpmath.log10, "sin": mpmath.sin, "cos": mpmath.cos, "tan": mpmath.tan,
    "asin": mpmath.asin, "acos": mpmath.acos, "atan": mpmath.atan, "sinh": mpmath.sinh, "cosh": mpmath.cosh,
    "tanh": mpmath.tanh, "sinc": lambda x: mpmath.sin(x) / x if x else mpmath.mpf(1),
}
TWO = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "pow": mpmath.power, "min": min, "max": max, "atan2": mpmath.atan2,
}


def expression(depth):
    if depth == 0 or random.random() < 0.1:
        return [random.choice(["x0", "x1", "x2"])] if random.random() < 0.8 else [repr(round(random.uniform(-3, 3), 3))]
    kind = random.random()
    if kind < 0.45:
        return expression(depth - 1) + [random.choice(list(ONE))]
    if kind < 0.55:
        return expression(depth - 1) + [f"powi:{random.choice([-2, -1, 2, 3, 4])}"]
    return expression(depth - 1) + expression(depth - 1) + [random.choice(list(TWO))]


def value(tokens, x):
    stack = []
    for token in tokens:
        if token in ONE:
            stack.append(ONE[token](stack.pop()))
        elif token in TWO:
            b, a = stack.pop(), stack.pop()
            if token == "pow" and a <= 0:
                return None
            stack.append(TWO[token](a, b))
        elif token.startswith("powi:"):
            stack.append(stack.pop() ** int(token[5:]))
        else:
            stack.append(x[int(token[1])] if token[0] == "x" else mpmath.mpf(float(token)))
        if not isinstance(stack[-1], mpmath.mpf) or not 1e-60 < abs(stack[-1]) < 1e30:
            return None
    return stack.pop()


rows = []
while len(rows) < 2000:
    tokens, x = expression(5), [random.uniform(-2, 2) for _ in range(3)]
    try:
        result = value(tokens, [mpmath.mpf(v) for v in x])
    except (ZeroDivisionError, ValueError):
        continue
    if result is not None and len(tokens) > 3 and 1e-100 < abs(result) < 1e100:
        rows.append(f"{' '.join(tokens)},{' '.join(map(repr, x))},{mpmath.nstr(result, 30)}")
print("expression,point,value")
print("\n".join(rows))
