//! The environment variables of ROS 2.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::transport::Kind;

/// DDS has ports for this many domains.
const MAX_DOMAIN: u32 = 232;

/// What the environment sets.
#[derive(Clone, Debug)]
pub struct Environment {
    /// `ROS_DOMAIN_ID`; 0 by default.
    pub domain: u32,
    /// By `RMW_IMPLEMENTATION`; DDS by default.
    pub transport: Kind,
    /// `ZENOH_SESSION_CONFIG_URI`.
    pub zenoh_config: Option<PathBuf>,
}

impl Environment {
    /// Reads the variables.
    ///
    /// # Errors
    /// [`Error::Environment`] for a domain that is no number up to 232, or another middleware.
    pub fn read() -> Result<Self> {
        Self::from_variables(|name| std::env::var(name).ok().filter(|value| !value.is_empty()))
    }

    fn from_variables(variable: impl Fn(&'static str) -> Option<String>) -> Result<Self> {
        let refused = |name, value: &str, wanted: String| Error::Environment {
            name,
            value: value.to_owned(),
            wanted,
        };
        let domain = match variable("ROS_DOMAIN_ID") {
            None => 0,
            Some(text) => (text.parse().ok())
                .filter(|domain| *domain <= MAX_DOMAIN)
                .ok_or_else(|| {
                    refused(
                        "ROS_DOMAIN_ID",
                        &text,
                        format!("a number from 0 to {MAX_DOMAIN}"),
                    )
                })?,
        };
        let transport = match variable("RMW_IMPLEMENTATION").as_deref() {
            Some("rmw_zenoh_cpp") => Kind::Zenoh,
            None | Some("rmw_fastrtps_cpp" | "rmw_fastrtps_dynamic_cpp" | "rmw_cyclonedds_cpp") => {
                Kind::Dds
            }
            Some(other) => {
                let wanted = "rmw_zenoh_cpp, rmw_cyclonedds_cpp or rmw_fastrtps_cpp";
                return Err(refused("RMW_IMPLEMENTATION", other, wanted.to_owned()));
            }
        };
        Ok(Self {
            domain,
            transport,
            zenoh_config: variable("ZENOH_SESSION_CONFIG_URI").map(PathBuf::from),
        })
    }
}

/// Starts this program again with a variable that only its environment sets; not where the user has set it.
pub(crate) fn restart_with((name, value): (&str, &str)) {
    #[cfg(unix)]
    if std::env::var_os(name).is_none()
        && let Ok(program) = std::env::current_exe()
    {
        use std::os::unix::process::CommandExt as _;
        // where that fails, it goes on without
        let _ = std::process::Command::new(program)
            .args(std::env::args_os().skip(1))
            .env(name, value)
            .exec();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(name: &'static str, value: &'static str) -> Result<Environment> {
        Environment::from_variables(|key| (key == name).then(|| value.to_owned()))
    }

    #[test]
    fn what_is_set_is_used_and_what_is_wrong_is_named() {
        assert_eq!(with("ROS_DOMAIN_ID", "42").unwrap().domain, 42);
        assert_eq!(
            with("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
                .unwrap()
                .transport,
            Kind::Zenoh
        );
        assert_eq!(with("", "").unwrap().transport, Kind::Dds);
        let error = with("ROS_DOMAIN_ID", "233").unwrap_err().to_string();
        assert!(
            error.contains("`ROS_DOMAIN_ID` is `233`, but must be a number from 0 to 232"),
            "{error}"
        );
        assert!(with("RMW_IMPLEMENTATION", "rmw_other").is_err());
    }
}
