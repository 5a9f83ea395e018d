"""The other side of the node's tests: plays messages as a robot's drivers would, and keeps what the node publishes.

Transport: eclipse-zenoh under rmw_zenoh's conventions, or cyclonedds. Messages and type hashes: rosbags. Nothing of it is
the project's own code.

    peer.py OUT ZENOH|DDS DOMAIN COMMAND...    commands of a script on standard input, one line each, see `Script`
"""

import json
import math
import random
import struct
import sys
import threading
import time

from rosbags.typesys import Stores, get_typestore, get_types_from_msg

STORE = get_typestore(Stores.ROS2_JAZZY)
OWN = {
    "grouser_msgs/msg/WheelSlip": "std_msgs/Header header\nstring[] name\nfloat64[] slip\nfloat64[] slip_sigma\nstring[] motion\nstring[] health\n",
    "grouser_msgs/msg/SlipEvent": "std_msgs/Header header\nstring event\nstring wheel\nbool begins\nbuiltin_interfaces/Time since\n",
    "grouser_msgs/msg/WheelTicks": "std_msgs/Header header\nstring[] name\nuint64[] ticks\n",
    "control_msgs/msg/InterfaceValue": "string[] interface_names\nfloat64[] values\n",
    "control_msgs/msg/DynamicJointState": "std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values\n",
}
for name, text in OWN.items():
    STORE.register(get_types_from_msg(text, name))

OUTPUTS = {
    "/grouser/slip": "grouser_msgs/msg/WheelSlip",
    "/grouser/odom": "nav_msgs/msg/Odometry",
    "/grouser/twist": "geometry_msgs/msg/TwistWithCovarianceStamped",
    "/grouser/events": "grouser_msgs/msg/SlipEvent",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/grouser/cmd_vel": "geometry_msgs/msg/Twist",
    "/stamped/cmd_vel": "geometry_msgs/msg/TwistStamped",
}


def type_hash(name):
    return STORE.hash_rihs01(name)


def dds_name(name):
    package, _, short = name.split("/")
    return f"{package}::msg::dds_::{short}_"


class Zenoh:
    """A session of its own for every `open`, as a process has."""

    def __init__(self, domain, endpoint, listens, node="driver"):
        import zenoh

        config = zenoh.Config()
        config.insert_json5("mode", '"peer"')
        config.insert_json5("scouting/multicast/enabled", "false")
        config.insert_json5("listen/endpoints" if listens else "connect/endpoints", json.dumps([endpoint]))
        if not listens:
            config.insert_json5("listen/endpoints", '["tcp/127.0.0.1:0"]')
        self.zenoh, self.domain, self.node = zenoh, domain, node
        self.session = zenoh.open(config)
        self.zid = str(self.session.zid())
        self.entity = 0
        self.kept = []
        self.publishers = {}
        self.declare(f"@ros2_lv/{domain}/{self.zid}/0/0/NN/%/%/{node}")

    def declare(self, token):
        self.kept.append(self.session.liveliness().declare_token(token))

    def token(self, kind, topic, name, hash, qos="::,10:,:,:,,"):
        self.entity += 1
        mangled = topic.replace("/", "%")
        self.declare(f"@ros2_lv/{self.domain}/{self.zid}/0/{self.entity}/{kind}/%/%/{self.node}/{mangled}/{dds_name(name)}/{hash}/{qos}")

    def advertise(self, topic, name, hash=None):
        hash = hash or type_hash(name)
        key = f"{self.domain}/{topic.strip('/')}/{dds_name(name)}/{hash}"
        publisher = self.session.declare_publisher(key, congestion_control=self.zenoh.CongestionControl.BLOCK)
        self.token("MP", topic, name, hash)
        gid = bytes(random.randrange(256) for _ in range(16))
        self.publishers[topic] = [publisher, gid, 0]

    def publish(self, topic, data):
        entry = self.publishers[topic]
        entry[2] += 1
        attachment = struct.pack("<qqB16s", entry[2], time.time_ns(), 16, entry[1])
        entry[0].put(data, attachment=attachment)

    def subscribe(self, topic, name, take, qos="::,10:,:,:,,"):
        key = f"{self.domain}/{topic.strip('/')}/{dds_name(name)}/{type_hash(name)}"
        self.kept.append(self.session.declare_subscriber(key, lambda s: take(topic, bytes(s.payload))))
        self.token("MS", topic, name, type_hash(name), qos)

    def graph(self):
        return [str(reply.ok.key_expr) for reply in self.session.liveliness().get(f"@ros2_lv/{self.domain}/**")]

    def subscribers(self, topic):
        mangled = topic.replace("/", "%")
        return sum("/MS/" in token and f"/{mangled}/" in token for token in self.graph())

    def close(self):
        self.session.close()


def header(stamp_ns):
    Header, Time = STORE.types["std_msgs/msg/Header"], STORE.types["builtin_interfaces/msg/Time"]
    return Header(Time(stamp_ns // 10**9, stamp_ns % 10**9), "")


def joint_state(stamp_ns, names, angles, rates):
    import numpy as np

    message = STORE.types["sensor_msgs/msg/JointState"](header(stamp_ns), list(names), np.array(angles), np.array(rates), np.zeros(0))
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/JointState"))


def joint_interfaces(stamp_ns, names, angles):
    import numpy as np

    Value = STORE.types["control_msgs/msg/InterfaceValue"]
    values = [Value(["position"], np.array([angle])) for angle in angles]
    message = STORE.types["control_msgs/msg/DynamicJointState"](header(stamp_ns), list(names), values)
    return bytes(STORE.serialize_cdr(message, "control_msgs/msg/DynamicJointState"))


def imu(stamp_ns, rate):
    import numpy as np

    V, Q = STORE.types["geometry_msgs/msg/Vector3"], STORE.types["geometry_msgs/msg/Quaternion"]
    message = STORE.types["sensor_msgs/msg/Imu"](
        header(stamp_ns), Q(0.0, 0.0, 0.0, 1.0), np.full(9, 0.0), V(0.0, 0.0, rate), np.zeros(9), V(0.0, 0.0, 9.81), np.zeros(9)
    )
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/Imu"))


class Drive:
    """A robot whose powered rims run at 0.25 m/s and whose free wheel measures 0.2 m/s: slip 0.2."""

    POWERED = ["front_left", "front_right", "rear_left", "rear_right"]

    def __init__(self, transport, rate_hz=100.0, hash=None, joints=None, rims=0.25, imu=True, interfaces=False):
        self.transport, self.period, self.rims = transport, 1.0 / rate_hz, rims
        self.interfaces = interfaces
        self.joints = joints or self.POWERED + ["fifth"]
        self.has_imu = imu
        self.step = 0
        self.offset_ns = 0
        self.loss = 0.0
        # so many of the next messages are kept, and sent at once
        self.burst = 0
        self.kept = []
        self.running = True
        self.random = random.Random(2012)
        if interfaces:
            transport.advertise("/dynamic_joint_states", "control_msgs/msg/DynamicJointState", hash)
        else:
            transport.advertise("/joint_states", "sensor_msgs/msg/JointState", hash)
        if imu:
            transport.advertise("/imu", "sensor_msgs/msg/Imu")
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        begun = time.monotonic()
        start_ns = time.time_ns()
        while self.running:
            self.step += 1
            at = self.step * self.period
            wait = begun + at - time.monotonic()
            if wait > 0:
                time.sleep(wait)
            stamp = start_ns + int(at * 1e9) + self.offset_ns
            speeds = [self.rims if joint != "fifth" else 0.2 for joint in self.joints]
            # radius 0.1 m; it stands for the first second, and then drives
            angle = max(at - 1.0, 0.0)
            moves = 1.0 if at > 1.0 else 0.0
            angles = [10 * v * angle for v in speeds]
            if self.interfaces:
                self.send("/dynamic_joint_states", joint_interfaces(stamp, self.joints, angles))
            else:
                self.send("/joint_states", joint_state(stamp, self.joints, angles, [10 * v * moves for v in speeds]))
            if self.has_imu:
                self.send("/imu", imu(stamp + 1_000_000, 0.0))

    def send(self, topic, data):
        if self.random.random() < self.loss:
            return
        if self.burst > 0:
            self.burst -= 1
            self.kept.append((topic, data))
            if self.burst > 0:
                return
            for topic, data in self.kept:
                self.transport.publish(topic, data)
            self.kept = []
            return
        self.transport.publish(topic, data)

    def stop(self):
        self.running = False
        self.thread.join()


def twist(speed, yaw_rate, sideways=0.0, stamped=False):
    V = STORE.types["geometry_msgs/msg/Vector3"]
    message = STORE.types["geometry_msgs/msg/Twist"](V(speed, sideways, 0.0), V(0.0, 0.0, yaw_rate))
    name = "geometry_msgs/msg/Twist"
    if stamped:
        name = "geometry_msgs/msg/TwistStamped"
        message = STORE.types[name](header(time.time_ns()), message)
    return bytes(STORE.serialize_cdr(message, name))


class Follower(Drive):
    """A robot whose rims follow the limited commands, and who requests `speed` and `yaw_rate` at 20 Hz.

    Its powered wheels slip by `slip`; `diverging` is the slip of the front left one alone, and a wheel of `stuck` stands.
    Commands that are silent for longer than 0.6 s stop its rims, as a base's own timeout does.
    """

    def __init__(self, script, transport, stamped=False, **options):
        self.speed, self.yaw_rate, self.sideways = 0.0, 0.0, 0.0
        self.slip, self.diverging, self.stuck = 0.1, None, None
        self.requests, self.senses = True, True
        self.stamped, self.script = stamped, script
        self.topic = "/stamped/cmd_vel" if stamped else "/grouser/cmd_vel"
        self.angles = {}
        self.rim = 0.0
        transport.advertise("/cmd_vel", "geometry_msgs/msg/TwistStamped" if stamped else "geometry_msgs/msg/Twist")
        super().__init__(transport, **options)

    def run(self):
        start_ns, begun = time.time_ns(), time.monotonic()
        while self.running:
            self.step += 1
            at = self.step * self.period
            wait = begun + at - time.monotonic()
            if wait > 0:
                time.sleep(wait)
            if self.requests and self.step % 5 == 0:
                self.transport.publish("/cmd_vel", twist(self.speed, self.yaw_rate, self.sideways, self.stamped))
            limited, since = self.script.limited(self.topic)
            self.rim = limited if since < 0.6 else 0.0
            # the first metre is driven by hand: the estimate needs to have seen the wheels turn
            rim = self.by_hand if at < 3.0 else self.rim
            body = rim * (1.0 - self.slip)
            rates = []
            for joint in self.joints:
                speed = body if joint == "fifth" else rim
                if joint == "front_left" and self.diverging is not None:
                    speed = body / (1.0 - self.diverging)
                if joint == self.stuck:
                    speed = 0.0
                self.angles[joint] = self.angles.get(joint, 0.0) + 10 * speed * self.period
                rates.append(10 * speed)
            if self.senses:
                stamp = start_ns + int(at * 1e9)
                angles = [self.angles[joint] for joint in self.joints]
                self.transport.publish("/joint_states", joint_state(stamp, self.joints, angles, rates))
                self.transport.publish("/imu", imu(stamp + 1_000_000, 0.0))

    by_hand = 0.2


class Script:
    """Commands: each is a line of JSON, `[name, arguments...]`; each prints one line of JSON when it is done."""

    def __init__(self, out, kind, domain, endpoint):
        self.kind, self.domain, self.endpoint = kind, domain, endpoint
        self.out = open(out, "w")
        self.lock = threading.Lock()
        self.counts = {}
        self.sessions = {}
        self.drives = {}
        self.last = {}
        self.times = {}

    def take(self, topic, data):
        with self.lock:
            self.counts[topic] = self.counts.get(topic, 0) + 1
            self.last[topic] = data
            self.times[topic] = time.monotonic()
            self.out.write(f"{topic} {time.time_ns()} {data.hex()}\n")

    def open(self, name, domain=None):
        """A session; the first listens, the others connect to it."""
        domain = self.domain if domain is None else domain
        if self.kind == "zenoh":
            self.sessions[name] = Zenoh(domain, self.endpoint, not self.sessions, name)
        else:
            from peer_dds import Dds

            self.sessions[name] = Dds(domain, name, STORE)

    def listen(self, name, *topics):
        for topic in topics or OUTPUTS:
            self.sessions[name].subscribe(topic, OUTPUTS[topic], self.take)

    def transient_local(self, name, topic):
        self.sessions[name].subscribe(topic, OUTPUTS[topic], self.take, ":1:,10:,:,:,,")

    def play(self, name, log, rate):
        """Plays an MCAP file or a bag of ROS 1, `rate` messages a second, once the node has subscribed to its topics."""
        messages = messages_of_bag(log) if log.endswith(".bag") else messages_of_mcap(log)
        session = self.sessions[name]
        topics = {topic: kind for topic, kind, _ in messages}
        for topic, kind in topics.items():
            session.advertise(topic, kind)
        self.wait_for(lambda: all(session.subscribers(topic) for topic in topics), 20)
        time.sleep(0.3)
        begun = time.monotonic()
        for index, (topic, _, data) in enumerate(messages):
            wait = begun + index / rate - time.monotonic()
            if wait > 0:
                time.sleep(wait)
            session.publish(topic, data)
        return len(messages)

    def drive(self, name, **options):
        self.drives[name] = Drive(self.sessions[name], **options)

    def follow(self, name, **options):
        self.drives[name] = Follower(self, self.sessions[name], **options)

    def limited(self, topic):
        """Forward speed of the newest limited command, and the seconds since it came."""
        with self.lock:
            data, at = self.last.get(topic), self.times.get(topic, -1e9)
        if data is None:
            return 0.0, 1e9
        message = STORE.deserialize_cdr(data, OUTPUTS[topic])
        message = getattr(message, "twist", message)
        return message.linear.x, time.monotonic() - at

    def change(self, name, field, value):
        if value == "nan":
            value = math.nan
        setattr(self.drives[name], field, value)

    def stop(self, name):
        self.drives.pop(name).stop()

    def close(self, name):
        if name in self.drives:
            self.stop(name)
        self.sessions.pop(name).close()

    def graph(self, name):
        return self.sessions[name].graph()

    def nodes(self, name):
        return self.sessions[name].nodes()

    def sleep(self, seconds):
        time.sleep(seconds)

    def until(self, topic, count, seconds):
        """Waits for `count` messages of a topic."""
        return self.wait_for(lambda: self.counts.get(topic, 0) >= count, seconds)

    def count(self, topic):
        return self.counts.get(topic, 0)

    def latest(self, topic):
        """The newest message of a topic, decoded by rosbags."""
        with self.lock:
            data = self.last.get(topic)
        return None if data is None else plain(STORE.deserialize_cdr(data, OUTPUTS[topic]))

    def hashes(self, *names):
        return [type_hash(name) for name in names]

    def wait_for(self, condition, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.02)
        return False

    def run(self):
        for line in sys.stdin:
            name, *arguments = json.loads(line)
            options = arguments.pop() if arguments and isinstance(arguments[-1], dict) else {}
            result = getattr(self, name)(*arguments, **options)
            self.out.flush()
            print(json.dumps(result), flush=True)


def messages_of_mcap(log):
    from mcap.reader import make_reader

    with open(log, "rb") as file:
        return [(c.topic, s.name, m.data) for s, c, m in make_reader(file).iter_messages()]


def messages_of_bag(log):
    """Topic, type and CDR of each message of a bag of ROS 1."""
    from rosbags.rosbag1 import Reader

    with Reader(log) as bag:
        return [(c.topic, c.msgtype, bytes(STORE.ros1_to_cdr(raw, c.msgtype))) for c, _, raw in bag.messages()]


def plain(message):
    """A message as numbers, texts, lists and tables; NaN becomes None."""
    if hasattr(message, "__dataclass_fields__"):
        return {name: plain(getattr(message, name)) for name in message.__dataclass_fields__ if not name.startswith("__")}
    if hasattr(message, "tolist"):
        return plain(message.tolist())
    if isinstance(message, (list, tuple)):
        return [plain(part) for part in message]
    if isinstance(message, float) and not math.isfinite(message):
        return None
    return message


if __name__ == "__main__":
    out, kind, domain, endpoint = sys.argv[1:5]
    Script(out, kind, int(domain), endpoint).run()
