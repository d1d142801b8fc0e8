//! DDS domain and discovery range from the environment variables of ROS 2.

use std::net::{IpAddr, Ipv4Addr};

use ros2_client::Context;
use rustdds::DomainParticipantBuilder;

/// Highest domain with valid ports.
const HIGHEST_DOMAIN: u16 = 232;

/// DDS domain and discovery range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Network {
    /// `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Whether discovery is limited to this machine: `ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`, or `ROS_LOCALHOST_ONLY=1`.
    pub local: bool,
}

/// Network error.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// Invalid value of a variable or its option.
    #[error("{variable} is '{value}'; {help}")]
    Variable {
        /// Variable.
        variable: &'static str,
        /// Value.
        value: String,
        /// Valid values.
        help: &'static str,
    },
    /// DDS does not start.
    #[error("no DDS participant in domain {domain}: {why}")]
    Participant {
        /// The domain.
        domain: u16,
        /// Error of DDS.
        why: String,
    },
}

impl Network {
    /// Reads the environment through `variable`: `ROS_DOMAIN_ID`, `ROS_AUTOMATIC_DISCOVERY_RANGE` and `ROS_LOCALHOST_ONLY`, which wins if
    /// it is 1, as in ROS.
    ///
    /// # Errors
    /// [`NetworkError::Variable`] for an invalid value.
    pub fn from_env(variable: impl Fn(&str) -> Option<String>) -> Result<Self, NetworkError> {
        let wrong = |variable, value: &str, help| {
            Err(NetworkError::Variable { variable, value: value.escape_debug().to_string(), help })
        };
        let domain = match variable("ROS_DOMAIN_ID").filter(|value| !value.is_empty()) {
            None => 0,
            Some(value) => match value.trim().parse() {
                Ok(domain) if domain <= HIGHEST_DOMAIN => domain,
                _ => return wrong("ROS_DOMAIN_ID", &value, "a domain is a number from 0 to 232"),
            },
        };
        let range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE").unwrap_or_default();
        let local = match range.trim().to_ascii_uppercase().as_str() {
            "" | "SUBNET" | "SYSTEM_DEFAULT" => false,
            "LOCALHOST" => true,
            _ => {
                let help = "use SUBNET or LOCALHOST";
                return wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", &range, help);
            }
        };
        let local = match variable("ROS_LOCALHOST_ONLY").unwrap_or_default().trim() {
            "" | "0" => local,
            "1" => true,
            other => return wrong("ROS_LOCALHOST_ONLY", other, "use 0 or 1"),
        };
        Ok(Self { domain, local })
    }

    /// Creates a participant.
    ///
    /// # Errors
    /// [`NetworkError::Participant`] if DDS does not start.
    pub fn join(self) -> Result<Context, NetworkError> {
        let refused = |why: String| NetworkError::Participant { domain: self.domain, why };
        let mut builder = DomainParticipantBuilder::new(self.domain).same_host_loopback(true);
        if self.local {
            builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let participant = builder.build().map_err(|error| refused(error.to_string()))?;
        Context::from_domain_participant(participant).map_err(|error| refused(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn network(domain: &str, range: &str) -> Result<Network, String> {
        let look_up = |name: &str| match name {
            "ROS_DOMAIN_ID" => Some(domain.to_owned()),
            "ROS_AUTOMATIC_DISCOVERY_RANGE" => Some(range.to_owned()),
            _ => None,
        };
        Network::from_env(look_up).map_err(|error| error.to_string())
    }

    #[test]
    fn the_environment_is_understood_as_ros_does() {
        assert_eq!(Network::from_env(|_| None).unwrap(), Network { domain: 0, local: false });
        assert_eq!(network("42", "LOCALHOST"), Ok(Network { domain: 42, local: true }));
        assert_eq!(network("", "subnet"), Ok(Network { domain: 0, local: false }));
    }

    #[test]
    fn what_it_cannot_mean_is_refused_with_the_value() {
        assert!(network("233", "").unwrap_err().contains("ROS_DOMAIN_ID is '233'"));
        assert!(network("one", "").unwrap_err().contains("0 to 232"));
        assert!(network("0", "OFF").unwrap_err().contains("LOCALHOST"));
        let only = |value: &str| {
            let look_up = |name: &str| (name == "ROS_LOCALHOST_ONLY").then(|| value.to_owned());
            Network::from_env(look_up).map_err(|error| error.to_string())
        };
        assert_eq!(only("1"), Ok(Network { domain: 0, local: true }));
        assert_eq!(only("0"), Ok(Network { domain: 0, local: false }));
        assert!(only("yes").unwrap_err().contains("ROS_LOCALHOST_ONLY is 'yes'"));
    }
}
