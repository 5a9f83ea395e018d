"""Operating points from Parquet to Parquet on Spark: with_spark.py SOURCE_FOLDER TARGET_FOLDER.

Without a cluster it runs on Sail, which speaks Spark's protocol and needs no JVM; with one, give its
address to `SparkSession.builder.remote`.
"""

import sys
from pathlib import Path

from points import solve_batch
from pyspark.sql import SparkSession


def solve(batches):  # type: ignore[no-untyped-def]
    return map(solve_batch, batches)


def run(spark: SparkSession, source: Path, target: Path) -> float:
    points = spark.read.parquet(str(source))
    solved = points.mapInArrow(solve, "cell long, pull_n double, status int")
    solved.write.mode("overwrite").parquet(str(target))
    return float(spark.read.parquet(str(target)).selectExpr("sum(pull_n) s").collect()[0]["s"])


if __name__ == "__main__":
    from pysail.spark import SparkConnectServer

    server = SparkConnectServer()
    server.start()
    _, port = server.listening_address
    print(run(SparkSession.builder.remote(f"sc://localhost:{port}").getOrCreate(), Path(sys.argv[1]), Path(sys.argv[2])))
