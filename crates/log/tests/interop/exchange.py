"""Exchanges logs with Grouser, for interop.rs. Needs rosbags 0.11.9 and mcap-ros2-support 0.6.0.

exchange.py write DIR      writes logs into DIR, and DIR/expected.tsv: what they hold
exchange.py read FILE OUT  reads a log with two readers (one for a bag), and writes OUT: what it holds
exchange.py frames DIR     writes logs with wheels and transforms into DIR, and DIR/poses.tsv: the robot's pose by them

A line of what a log holds: reader or file, topic, time of recording, field, value; numbers with a point as
the bits of a float64.
"""
import dataclasses
import random
import shutil
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

COUNT = 200
START = 1_700_000_000_123_456_789
RULE = "=" * 80 + "\n"
# Everything that a definition can say: nested types, arrays of each kind, defaults, constants, bounds.
PROBE = """# a comment
std_msgs/Header header
uint8 KIND_A=1
bool flag
int8 i8
uint8 u8
int16 i16
uint16 u16
int32 i32
uint32 u32
int64 i64
uint64 u64
float32 f32
float64 f64
string text
float64[3] three
int32[] ticks
uint8[] raw
string[] names
probe_msgs/Part part
probe_msgs/Part[] parts
"""
PART = "float64 value\nstring name\nuint16 small\n"
HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
TIME = "int32 sec\nuint32 nanosec\n"
PROBE_2 = PROBE + RULE + "MSG: probe_msgs/Part\n" + PART + RULE + "MSG: std_msgs/Header\n" + HEADER
PROBE_2 += RULE + "MSG: builtin_interfaces/Time\n" + TIME

dice = random.Random(2012)


def double():
    kind = dice.randrange(8)
    if kind == 0:
        return dice.choice([0.0, -0.0, float("inf"), -float("inf"), 5e-324, 1.7976931348623157e308])
    bits = dice.getrandbits(64)
    value = struct.unpack("<d", struct.pack("<Q", bits))[0]
    return value if value == value else 0.1


def single():
    value = struct.unpack("<f", struct.pack("<I", dice.getrandbits(32)))[0]
    return value if value == value else 0.5


def signed(bits):
    return dice.choice([-(1 << (bits - 1)), (1 << (bits - 1)) - 1, dice.getrandbits(bits) - (1 << (bits - 1))])


def unsigned(bits):
    return dice.choice([0, (1 << bits) - 1, dice.getrandbits(bits)])


def word():
    return dice.choice(["", "left", "räder", "車輪", "a b\tc", "x" * 300])


def part():
    return {"value": double(), "name": word(), "small": unsigned(16)}


def probe(k):
    sec, nanosec = divmod(START + k * 20_000_000, 1_000_000_000)
    return {
        "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": word()},
        "flag": dice.random() < 0.5, "i8": signed(8), "u8": unsigned(8), "i16": signed(16), "u16": unsigned(16),
        "i32": signed(32), "u32": unsigned(32), "i64": signed(64), "u64": unsigned(64), "f32": single(),
        "f64": double(), "text": word(), "three": [double() for _ in range(3)],
        "ticks": [signed(32) for _ in range(dice.randrange(6))],
        "raw": [dice.getrandbits(8) for _ in range(dice.randrange(9))],
        "names": [word() for _ in range(dice.randrange(4))], "part": part(),
        "parts": [part() for _ in range(dice.randrange(3))],
    }


def leaves(value, path=""):
    """Every leaf of a message with its path."""
    if isinstance(value, dict):
        fields = value.items()
    elif dataclasses.is_dataclass(value):
        # Constants stand among the fields there.
        names = [f.name for f in dataclasses.fields(value) if f.name != "__msgtype__" and not f.name.isupper()]
        fields = [(name, getattr(value, name)) for name in names]
    elif hasattr(value, "__slots__") and not isinstance(value, (str, bytes, np.generic, np.ndarray)):
        fields = [(name, getattr(value, name)) for name in value.__slots__]
    elif isinstance(value, (list, tuple, np.ndarray, bytes, bytearray)):
        for place, element in enumerate(value):
            yield from leaves(element, f"{path}[{place}]")
        return
    else:
        yield path, leaf(value)
        return
    for name, element in fields:
        yield from leaves(element, f"{path}.{name}" if path else name)


def leaf(value):
    if isinstance(value, (bool, np.bool_)):
        return f"b{int(value)}"
    if isinstance(value, (int, np.integer)):
        return f"i{int(value)}"
    if isinstance(value, (float, np.floating)):
        return "f" + struct.pack(">d", float(value)).hex()
    return "s" + value.encode().hex()


def report(out, who, topic, time, value):
    for path, text in leaves(value):
        out.write(f"{who}\t{topic}\t{time}\t{path}\t{text}\n")


def build(store, name, fields):
    """A message of rosbags out of plain fields."""
    made = {}
    for field, (kind, details) in store.fielddefs[name][1]:
        made[field] = build_field(store, kind, details, fields.get(field))
    return store.types[name](**made)


def build_field(store, kind, details, value):
    if kind.name == "NAME":
        return build(store, details, value)
    if kind.name == "BASE":
        return value
    inner = details[0]
    if inner[0].name == "NAME":
        return [build(store, inner[1], element) for element in value]
    base = inner[1][0] if isinstance(inner[1], tuple) else inner[1]
    if base == "string":
        return value
    return np.array(value, dtype=base)


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "expected.tsv", "w", encoding="utf-8", newline="\n") as out:
        for packing in ["NONE", "LZ4", "ZSTD"]:
            name = f"support_{packing.lower()}.mcap"
            with open(folder / name, "wb") as file:
                writer = McapWriter(file, chunk_size=4096, compression=CompressionType[packing])
                schema = writer.register_msgdef("probe_msgs/msg/Probe", PROBE_2)
                for k in range(COUNT):
                    value, time = probe(k), START + k * 20_000_000
                    writer.write_message("/probe", schema, value, log_time=time, publish_time=time, sequence=k)
                    report(out, name, "/probe", time, value)
                writer.finish()
        store = get_typestore(Stores.ROS2_HUMBLE)
        store.register(get_types_from_msg(PART, "probe_msgs/msg/Part"))
        store.register(get_types_from_msg(PROBE, "probe_msgs/msg/Probe"))
        kind = "probe_msgs/msg/Probe"
        for mode in ["plain", "zstd"]:
            target = folder / f"rosbags_{mode}"
            writer = Writer2(target, version=9, storage_plugin=StoragePlugin.MCAP)
            if mode == "zstd":
                writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            with writer:
                connection = writer.add_connection("/probe", kind, typestore=store)
                for k in range(COUNT):
                    value, time = probe(k), START + k * 20_000_000
                    writer.write(connection, time, store.serialize_cdr(build(store, kind, value), kind))
                    report(out, f"rosbags_{mode}.mcap", "/probe", time, value)
            made = next(iter(target.glob("*.mcap*")))
            shutil.copy(made, folder / f"rosbags_{mode}.mcap")
        store = get_typestore(Stores.ROS1_NOETIC)
        store.register(get_types_from_msg(PART, kind.replace("Probe", "Part")))
        store.register(get_types_from_msg(PROBE, kind))
        for packing in [None, "BZ2", "LZ4"]:
            name = f"rosbags_{(packing or 'none').lower()}.bag"
            writer = Writer1(folder / name)
            if packing:
                writer.set_compression(Writer1.CompressionFormat[packing])
            with writer:
                connection = writer.add_connection("/probe", kind, typestore=store)
                for k in range(COUNT):
                    value, time = probe(k), START + k * 20_000_000
                    value["header"] = {"seq": k, **value["header"]}
                    writer.write(connection, time, store.serialize_ros1(build(store, kind, value), kind))
                    report(out, name, "/probe", time, value)


def rotation(q):
    """The matrix of a quaternion x, y, z, w."""
    x, y, z, w = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def turned(axis, angle):
    axis = np.array(axis) / np.linalg.norm(axis)
    return [*(np.sin(angle / 2) * axis), np.cos(angle / 2)]


def localised():
    """A map that is corrected each second, an odometry at 50 Hz, and a base that is fixed to it; the poses of the base."""
    messages, poses = [], []
    base = ((-0.3, 0.1, 0.2), turned((1, 2, 9), 0.3))
    messages.append(("/tf_static", 0, "base_footprint", "base_link", base, -500.0))
    for k in range(200):
        time = 0.02 * k
        if k % 50 == 10:
            place = (5 + dice.random(), dice.random() - 7, 0.1 * dice.random())
            at_map = (place, turned((dice.random() - 0.5, dice.random() - 0.5, 4), 6 * dice.random() - 3))
        odom = ((time, 0.3 * time * time, 0.02 * time), turned((0.1, -0.2, 3), 0.7 * time))
        if k >= 10 and k % 5 == 0:
            messages.append(("/tf", k, "map", "odom", at_map, time + 0.5))
        messages.append(("/tf", k, "odom", "base_footprint", odom, time))
        if k % 50 == 10:
            place, turn = np.zeros(3), np.eye(3)
            for translation, quaternion in (at_map, odom, base):
                place = place + turn @ np.array(translation)
                turn = turn @ rotation(quaternion)
            poses.append((k, place[0], place[1], np.arctan2(turn[1, 0], turn[0, 0])))
    return messages, poses


def frames(folder):
    folder.mkdir(parents=True, exist_ok=True)
    messages, poses = localised()
    kind, joints = "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState"

    def parts(slash, head, parent, child, link, stamp):
        nanoseconds = START + round(stamp * 1e9)
        sec, nanosec = divmod(nanoseconds, 1_000_000_000)
        header = {**head, "stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": slash + parent}
        (x, y, z), q = link
        transform = {"translation": {"x": x, "y": y, "z": z}, "rotation": dict(zip("xyzw", map(float, q)))}
        return {"transforms": [{"header": header, "child_frame_id": slash + child, "transform": transform}]}

    for name, version in [("frames.bag", 1), ("frames.mcap", 2)]:
        first = version == 1
        store = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
        if kind not in store.types:
            store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms\n", kind))
        serialize = store.serialize_ros1 if first else store.serialize_cdr
        target = folder / (name if first else "frames")
        writer = Writer1(target) if first else Writer2(target, version=9, storage_plugin=StoragePlugin.MCAP)
        head, slash = ({"seq": 1}, "/") if first else ({}, "")
        with writer:
            add = {topic: writer.add_connection(topic, kind, typestore=store) for topic in ["/tf_static", "/tf"]}
            wheels = writer.add_connection("/joint_states", joints, typestore=store)
            sec, nanosec = divmod(START, 1_000_000_000)
            state = {"header": {**head, "stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}}
            state |= {"name": ["left", "right"], "position": [], "velocity": [1.0, 1.0], "effort": []}
            writer.write(wheels, START, serialize(build(store, joints, state), joints))
            for topic, k, *rest in messages:
                value = parts(slash, head, *rest)
                writer.write(add[topic], START + k * 20_000_000, serialize(build(store, kind, value), kind))
        if not first:
            shutil.copy(next(iter(target.glob("*.mcap"))), folder / name)
    with open(folder / "poses.tsv", "w", encoding="utf-8", newline="\n") as out:
        for k, x, y, yaw in poses:
            out.write(f"{START + k * 20_000_000}\t{float(x)!r}\t{float(y)!r}\t{float(yaw)!r}\n")


def as_rosbag2(file, folder):
    """A folder as `ros2 bag` makes them, with this MCAP file in it."""
    with open(file, "rb") as opened:
        summary = make_reader(opened).get_summary()
    stats = summary.statistics
    topics = "".join(
        f"""
    - topic_metadata:
        name: {channel.topic}
        type: {summary.schemas[channel.schema_id].name}
        serialization_format: cdr
        offered_qos_profiles: ''
        type_description_hash: ''
      message_count: {stats.channel_message_counts.get(channel.id, 0)}"""
        for channel in summary.channels.values()
    )
    duration = stats.message_end_time - stats.message_start_time
    (folder / "metadata.yaml").write_text(
        f"""rosbag2_bagfile_information:
  version: 8
  storage_identifier: mcap
  relative_file_paths:
    - {file.name}
  duration:
    nanoseconds: {duration}
  starting_time:
    nanoseconds_since_epoch: {stats.message_start_time}
  message_count: {stats.message_count}
  compression_format: ''
  compression_mode: ''
  topics_with_message_count:{topics}
  files:
    - path: {file.name}
      starting_time:
        nanoseconds_since_epoch: {stats.message_start_time}
      duration:
        nanoseconds: {duration}
      message_count: {stats.message_count}
  custom_data: null
  ros_distro: rosbags
""",
        encoding="utf-8",
    )
    shutil.copy(file, folder / file.name)


def read(file, out):
    with open(out, "w", encoding="utf-8", newline="\n") as reported, tempfile.TemporaryDirectory() as made:
        if file.suffix == ".mcap":
            with open(file, "rb") as opened:
                reader = make_reader(opened, validate_crcs=True, decoder_factories=[DecoderFactory()])
                for _, channel, message, value in reader.iter_decoded_messages():
                    report(reported, "mcap-ros2-support", channel.topic, message.log_time, value)
            as_rosbag2(file, Path(made))
            paths = [Path(made)]
        else:
            paths = [file]
        with AnyReader(paths) as reader:
            for connection, time, raw in reader.messages():
                value = reader.deserialize(raw, connection.msgtype)
                report(reported, "rosbags", connection.topic, time, value)


if sys.argv[1] == "write":
    write(Path(sys.argv[2]))
elif sys.argv[1] == "frames":
    frames(Path(sys.argv[2]))
else:
    read(Path(sys.argv[2]), Path(sys.argv[3]))
