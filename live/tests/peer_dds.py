"""The peer's DDS side: cyclonedds, with the types of rosbags as its own."""

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsSubscription
from cyclonedds.core import Listener, Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from rosbags.interfaces import Nodetype

PRIMITIVES = {
    "bool": bool,
    "string": str,
    "byte": types.uint8,
    "char": types.uint8,
    "octet": types.uint8,
    **{name: getattr(types, name) for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")},
}
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(5000), Policy.Durability.Volatile)


class Dds:
    """A participant."""

    def __init__(self, domain, node, store):
        self.participant, self.store, self.classes = DomainParticipant(domain), store, {}
        self.publishers, self.kept = {}, []
        self.own = None
        self.subscriptions = BuiltinDataReader(self.participant, BuiltinTopicDcpsSubscription)
        self.seen = {}

    def type_of(self, name):
        """The class of a ROS type, `sensor_msgs/msg/Imu`."""
        if name not in self.classes:
            fields = {field: self.field(kind) for field, kind in self.store.fielddefs[name][1]}
            package, _, short = name.split("/")
            self.classes[name] = make_idl_struct(short, f"{package}::msg::dds_::{short}_", fields)
        return self.classes[name]

    def field(self, kind):
        node, detail = kind
        if node == Nodetype.BASE:
            return PRIMITIVES[detail[0]]
        if node == Nodetype.NAME:
            return self.type_of(detail)
        element, count = detail
        element = self.field(element)
        return types.array[element, count] if node == Nodetype.ARRAY else types.sequence[element]

    def topic(self, topic, name):
        return Topic(self.participant, "rt/" + topic.strip("/"), self.type_of(name))

    def advertise(self, topic, name, hash=None):
        hash = hash or self.store.hash_rihs01(name)
        qos = Qos(Policy.Userdata(f"typehash={hash};".encode()), base=RELIABLE)
        self.publishers[topic] = (DataWriter(self.participant, self.topic(topic, name), qos), self.type_of(name))

    def publish(self, topic, data):
        writer, kind = self.publishers[topic]
        writer.write(kind.deserialize(data))

    def subscribe(self, topic, name, take, qos=None):
        policies = RELIABLE
        if qos and qos.startswith(":1:"):
            policies = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10), Policy.Durability.TransientLocal)

        kind = self.type_of(name)

        class Take(Listener):
            def on_data_available(self, reader):
                for message in reader.take(N=1000):
                    # the end of a writer comes as a sample without content
                    if isinstance(message, kind):
                        take(topic, message.serialize(use_version_2=False))

        listener = Take()
        self.kept.append((listener, DataReader(self.participant, self.topic(topic, name), policies, listener)))

    def subscribers(self, topic):
        name = "rt/" + topic.strip("/")
        for sample in self.subscriptions.take(N=1000):
            if sample.topic_name:
                self.seen.setdefault(sample.topic_name, 0)
                self.seen[sample.topic_name] += 1
        return self.seen.get(name, 0)

    def graph(self):
        return sorted(self.seen)

    def close(self):
        self.kept.clear()
        self.publishers.clear()
        self.participant = None
        import gc

        gc.collect()
