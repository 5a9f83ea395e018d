"""Fails unless the package imports within 50 ms of processor time beyond NumPy's own: the best of five."""

import subprocess
import sys

LIMIT_S = 0.05


def seconds(statement: str) -> float:
    code = f"import time; a = time.process_time(); {statement}; print(time.process_time() - a)"
    return float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)


beyond = min(seconds("import numpy; a = time.process_time(); import grouser") for _ in range(5))
print(f"import: {1e3 * beyond:.1f} ms beyond NumPy")
sys.exit(beyond > LIMIT_S)
