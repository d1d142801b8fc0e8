//! Names of topics, service and action.

use ros2_client::Name;

/// Names in the node and the simulated robot, before remapping.
pub const OWN: [&str; 14] = [
    "odom",
    "scan",
    "imu",
    "goal_pose",
    "initialpose",
    "navigate_to_pose",
    "reinitialize_global_localization",
    "cmd_vel",
    "pose",
    "walls",
    "truth",
    "tf",
    "tf_static",
    "diagnostics",
];

/// Names that are the same for all robots unless remapped: the namespace does not apply.
const GLOBAL: [&str; 3] = ["tf", "tf_static", "diagnostics"];

/// Default name of the node.
const NODE: &str = "surepose";

/// Namespace and remappings of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    node: String,
    namespace: String,
    others: Vec<(String, String)>,
}

/// Invalid name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NameProblem {
    /// The syntax is invalid.
    #[error("'{name}': invalid name: {why}; use letters, digits, _ and /, for example /robot1/odom")]
    Malformed {
        /// As given.
        name: String,
        /// The problem.
        why: String,
    },
    /// The remapping does not consist of two names.
    #[error("'{given}': invalid remapping; write odom:=/base/odom")]
    NotAPair {
        /// As given.
        given: String,
    },
    /// The node does not use the name.
    #[error("'{name}': unknown name (expected one of {})", OWN.join(", "))]
    Unknown {
        /// As given.
        name: String,
    },
}

impl Default for Names {
    fn default() -> Self {
        Self { node: NODE.to_owned(), namespace: "/".to_owned(), others: Vec::new() }
    }
}

impl Names {
    /// Names in `namespace`, of which some become others by remappings such as `odom:=/base/odom`. A leading slash of the name
    /// before `:=` is ignored.
    ///
    /// # Errors
    /// [`NameProblem`] for an invalid or unknown name.
    pub fn new(namespace: &str, remappings: &[String]) -> Result<Self, NameProblem> {
        let namespace = format!("/{}", namespace.trim_matches('/'));
        if namespace != "/" {
            parsed(&namespace)?;
        }
        let mut others = Vec::new();
        for given in remappings {
            let not_a_pair = || NameProblem::NotAPair { given: given.escape_debug().to_string() };
            let (own, other) = given.split_once(":=").ok_or_else(not_a_pair)?;
            let own = own.trim_start_matches('/');
            if !OWN.contains(&own) {
                return Err(NameProblem::Unknown { name: own.escape_debug().to_string() });
            }
            parsed(other)?;
            others.push((own.to_owned(), other.to_owned()));
        }
        Ok(Self { node: NODE.to_owned(), namespace, others })
    }

    /// Changes the name of the node.
    ///
    /// # Errors
    /// [`NameProblem`] for an invalid name.
    pub fn with_node(self, node: &str) -> Result<Self, NameProblem> {
        if node.contains('/') {
            let why = "a node's name has no slash".to_owned();
            return Err(NameProblem::Malformed { name: node.escape_debug().to_string(), why });
        }
        parsed(node)?;
        Ok(Self { node: node.to_owned(), ..self })
    }

    /// Name of the node, without its namespace.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// Namespace with a leading slash.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// Whether `own` is remapped.
    #[cfg(feature = "bag")]
    pub(crate) fn is_remapped(&self, own: &str) -> bool {
        self.others.iter().any(|(from, _)| from == own)
    }

    /// Full name of `own`.
    pub(crate) fn of(&self, own: &str) -> Result<Name, NameProblem> {
        let other = self.others.iter().rev().find(|(from, _)| from == own);
        let name = other.map_or(own, |(_, to)| to);
        if name.starts_with('/') {
            return parsed(name);
        }
        if GLOBAL.contains(&name) && other.is_none() {
            return parsed(&format!("/{name}"));
        }
        parsed(&format!("{}/{name}", self.namespace.trim_end_matches('/')))
    }
}

fn parsed(name: &str) -> Result<Name, NameProblem> {
    let malformed = |why: String| NameProblem::Malformed { name: name.escape_debug().to_string(), why };
    Name::parse(name).map_err(|why| malformed(why.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_others() {
        let names = Names::new("robot1", &["odom:=/base/odom".to_owned()]).unwrap();
        assert_eq!(names.namespace(), "/robot1");
        assert_eq!(names.of("odom").unwrap().to_string(), "/base/odom");
        assert_eq!(names.of("scan").unwrap().to_string(), "/robot1/scan");
        assert_eq!(Names::default().of("scan").unwrap().to_string(), "/scan");
        assert_eq!(names.of("tf").unwrap().to_string(), "/tf");
        let names = Names::new("robot1", &["/tf:=tf".to_owned()]).unwrap();
        assert_eq!(names.of("tf").unwrap().to_string(), "/robot1/tf");
        assert_eq!(names.of("tf_static").unwrap().to_string(), "/tf_static");
        assert_eq!(names.with_node("driver").unwrap().node(), "driver");
    }

    #[test]
    fn what_is_no_name_is_refused_with_a_remedy() {
        let said = |namespace: &str, mapping: &str| {
            Names::new(namespace, &[mapping.to_owned()]).unwrap_err().to_string()
        };
        assert!(said("", "odom").contains("write odom:=/base/odom"));
        assert!(said("", "odo:=x").contains("expected one of odom"));
        assert!(said("", "odom:=a b").contains("'a b': invalid name"));
        assert!(said("1st", "odom:=x").contains("'/1st': invalid name"));
        assert!(Names::default().with_node("a/b").is_err() && Names::default().with_node("").is_err());
    }
}
