//! Names of message types on the wire.

/// `sensor_msgs::msg::dds_::JointState_` of `sensor_msgs/JointState`.
pub(super) fn dds_type(type_name: &str) -> String {
    let (package, name) = type_name.split_once('/').unwrap_or(("", type_name));
    format!("{package}::msg::dds_::{name}_")
}

/// `sensor_msgs/JointState` of `sensor_msgs::msg::dds_::JointState_`; `None` for services, actions and foreign types.
pub(super) fn ros_type(dds_type: &str) -> Option<String> {
    let (package, name) = dds_type.split_once("::msg::dds_::")?;
    Some(format!("{package}/{}", name.strip_suffix('_')?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_there_and_back() {
        let name = dds_type("sensor_msgs/JointState");
        assert_eq!(name, "sensor_msgs::msg::dds_::JointState_");
        assert_eq!(ros_type(&name).as_deref(), Some("sensor_msgs/JointState"));
        assert_eq!(ros_type("std_srvs::srv::dds_::Empty_Request_"), None);
    }
}
