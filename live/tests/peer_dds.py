"""The peer's DDS side: cyclonedds, with the types of rosbags as its own."""

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
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

    def nodes(self):
        """Each node as ROS 2's own participants announce it, with the topics whose publishers it names."""
        if self.own is None:
            name = "rmw_dds_common/msg/ParticipantEntitiesInfo"
            policies = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1), Policy.Durability.TransientLocal)
            topic = Topic(self.participant, "ros_discovery_info", self.type_of(name))
            self.own = (
                DataReader(self.participant, topic, policies),
                BuiltinDataReader(self.participant, BuiltinTopicDcpsPublication),
            )
        infos, publications = self.own
        topics = {sample.key.bytes: sample.topic_name for sample in publications.read(N=1000) if sample.topic_name}
        # the end of a writer comes as a sample without content
        infos = [info for info in infos.read(N=100) if isinstance(info, self.type_of("rmw_dds_common/msg/ParticipantEntitiesInfo"))]
        return [
            {
                "namespace": node.node_namespace,
                "name": node.node_name,
                "publishes": sorted(topics.get(bytes(gid.data), "unknown") for gid in node.writer_gid_seq),
                "subscriptions": len(node.reader_gid_seq),
            }
            for info in infos
            for node in info.node_entities_info_seq
        ]

    def close(self):
        self.kept.clear()
        self.publishers.clear()
        self.participant = None
        import gc

        gc.collect()
