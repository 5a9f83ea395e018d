"""rosbags on the file of the bench: every message as bytes, and every JointState decoded."""

import statistics
import sys
import time
from importlib.metadata import version
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

ROUNDS = 3
path = Path(sys.argv[1])
size = path.stat().st_size


def median(job):
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        job()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:

    def read():
        return sum(len(data) for _, _, data in reader.messages())

    wheels = [c for c in reader.connections if c.msgtype == "sensor_msgs/msg/JointState"]
    messages = [data for _, _, data in reader.messages(connections=wheels)]

    def decode():
        for data in messages:
            reader.deserialize(data, "sensor_msgs/msg/JointState")

    seconds = median(read)
    each = median(decode) / len(messages)
    print(f"\nPython's rosbags {version('rosbags')} on the same file; medians of {ROUNDS} rounds")
    print(f"{'every message':28} {seconds * 1e3:8.1f} ms {size / seconds / 1e6:7.0f} MB/s")
    print(f"{'a JointState':28} {each * 1e9:8.0f} ns")
