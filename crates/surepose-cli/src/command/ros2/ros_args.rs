//! Arguments after `--ros-args`, as `ros2 run` and `launch_ros` pass them.

use std::path::PathBuf;

use surepose_config::Config;
use surepose_io::ros_parameters;
use surepose_ros2::Names;

use crate::error::CliError;

/// Flags of rcl without an effect on this node, which logs on standard error only.
const LOG_FLAGS: [&str; 3] = ["rosout-logs", "stdout-logs", "external-lib-logs"];

/// Arguments of ROS.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RosArgs {
    /// Remappings of names, `odom:=/base/odom`.
    pub(super) remappings: Vec<String>,
    /// Namespace, `__ns`; `None` without one.
    pub(super) namespace: Option<String>,
    /// Name of the node, `__node`; `None` without one.
    pub(super) node: Option<String>,
    /// Parameter files, in order.
    parameter_files: Vec<PathBuf>,
    /// Parameters, `law.k_v=2`, in order.
    parameters: Vec<String>,
    /// Whether only warnings are printed.
    pub(super) is_quiet: bool,
}

impl RosArgs {
    /// Parses the arguments between `--ros-args` and `--`.
    ///
    /// # Errors
    /// An unknown or incomplete argument.
    pub(super) fn parse(arguments: &[String]) -> Result<Self, CliError> {
        let mut parsed = Self::default();
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value =
                || rest.next().cloned().ok_or_else(|| usage(format!("--ros-args {argument}: value missing")));
            match argument.as_str() {
                "-r" | "--remap" => parsed.remap(&value()?)?,
                "-p" | "--param" => {
                    let given = value()?;
                    let (name, text) = given.split_once(":=").ok_or_else(|| {
                        usage(format!("--ros-args {argument}: invalid (got '{given}', expected NAME:=VALUE)"))
                    })?;
                    parsed.parameters.push(format!("{}={text}", without_node(name)));
                }
                "--params-file" => parsed.parameter_files.push(value()?.into()),
                "--log-level" => {
                    let given = value()?;
                    let level = given.rsplit(":=").next().unwrap_or_default().to_ascii_lowercase();
                    parsed.is_quiet = match level.as_str() {
                        "debug" | "info" | "unset" => false,
                        "warn" | "warning" | "error" | "fatal" => true,
                        _ => {
                            let what = "expected debug, info, warn, error or fatal";
                            return Err(usage(format!(
                                "--ros-args --log-level: unknown (got '{given}', {what})"
                            )));
                        }
                    };
                }
                "-e" | "--enclave" | "--log-config-file" => drop(value()?),
                flag if is_log_flag(flag) => {}
                "--ros-args" => {}
                unknown => {
                    let expected = "-r, -p, --params-file, --log-level";
                    return Err(usage(format!(
                        "--ros-args: unknown argument (got '{unknown}', expected one of {expected})"
                    )));
                }
            }
        }
        Ok(parsed)
    }

    /// Returns `config` with the parameter files, then the parameters on top. `names` has the names of the node.
    ///
    /// # Errors
    /// An unreadable file, an unknown parameter or an invalid value.
    pub(super) fn over(&self, mut config: Config, names: &Names) -> Result<Config, CliError> {
        let node = format!("{}/{}", names.namespace().trim_end_matches('/'), names.node());
        for file in &self.parameter_files {
            for parameter in ros_parameters::read(file)?.iter().filter(|parameter| parameter.is_of(&node)) {
                let place = format!("{}:{}", file.display(), parameter.line);
                config = set(config, &place, &parameter.name, &parameter.value)?;
            }
        }
        for parameter in &self.parameters {
            let (name, value) = parameter.split_once('=').unwrap_or((parameter, ""));
            config = set(config, "--ros-args -p", name, value)?;
        }
        Ok(config)
    }

    fn remap(&mut self, given: &str) -> Result<(), CliError> {
        let (from, to) = given
            .split_once(":=")
            .ok_or_else(|| usage(format!("--ros-args -r: invalid (got '{given}', expected FROM:=TO)")))?;
        match without_node(from) {
            "__ns" => self.namespace = Some(to.to_owned()),
            "__node" | "__name" => self.node = Some(to.to_owned()),
            from => {
                // A private name `~/pose` is a name of this node.
                let name = from.trim_start_matches("rostopic://").trim_start_matches("rosservice://");
                self.remappings.push(format!("{}:={to}", name.trim_start_matches("~/")));
            }
        }
        Ok(())
    }
}

/// Sets one parameter; `use_sim_time` is one of ROS.
fn set(config: Config, place: &str, name: &str, value: &str) -> Result<Config, CliError> {
    match (name, value.trim()) {
        ("use_sim_time", "false" | "False") => Ok(config),
        ("use_sim_time", _) => Err(usage(format!(
            "{place}: use_sim_time: not supported (got {value}); leave it out: the time of the node is that of the stamps of odometry"
        ))),
        // Parameters of the middleware, for every node of a launch file.
        (name, _) if name.starts_with("qos_overrides.") => Ok(config),
        (name, value) => Ok(config.with_option_of(place, &format!("{name}={value}"))?),
    }
}

/// A name without the node before it: `surepose:law.k_v`.
fn without_node(name: &str) -> &str {
    match name.rsplit_once(':') {
        Some((node, name)) if !node.ends_with("rostopic") && !node.ends_with("rosservice") => name,
        _ => name,
    }
}

fn is_log_flag(flag: &str) -> bool {
    let names = ["--enable-", "--disable-"].iter().filter_map(|start| flag.strip_prefix(start));
    names.into_iter().any(|name| LOG_FLAGS.contains(&name))
}

fn usage(what: String) -> CliError {
    let help =
        "write `--ros-args -r odom:=/base/odom -p law.k_v:=2 --params-file robot.yaml -r __ns:=/robot1`"
            .to_owned();
    CliError::Usage { what, help }
}

#[cfg(test)]
mod tests {
    use super::*;
    use surepose::param;

    fn parse(line: &str) -> Result<RosArgs, String> {
        let arguments: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        RosArgs::parse(&arguments).map_err(|error| error.to_string())
    }

    #[test]
    fn arguments_of_launch_files_are_parsed() {
        let line = "-r __node:=parker -r __ns:=/robot1 -r /tf:=tf --remap parker:odom:=/base/odom -p law.k_v:=2.5 \
                    --log-level surepose:=warn --disable-stdout-logs -e /enclave";
        let parsed = parse(line).unwrap();
        assert_eq!((parsed.node.as_deref(), parsed.namespace.as_deref()), (Some("parker"), Some("/robot1")));
        assert_eq!(parsed.remappings, ["/tf:=tf", "odom:=/base/odom"]);
        assert!(parsed.is_quiet);
        let config = parsed.over(Config::default(), &Names::default()).unwrap();
        assert!((config.number(&param::K_V) - 2.5).abs() < 1e-12);
    }

    #[test]
    fn mistakes_are_named() {
        assert!(parse("-r odom").unwrap_err().contains("expected FROM:=TO"));
        assert!(parse("-p").unwrap_err().contains("value missing"));
        assert!(parse("--log-level loud").unwrap_err().contains("got 'loud'"));
        assert!(parse("--nothing").unwrap_err().contains("unknown argument (got '--nothing'"));
        let over = |line: &str| {
            let ended = parse(line).unwrap().over(Config::default(), &Names::default());
            ended.map_err(|error| error.to_string())
        };
        assert!(over("-p use_sim_time:=false").is_ok());
        assert!(over("-p use_sim_time:=true").unwrap_err().contains("not supported"));
        assert!(over("-p law.nothing:=1").unwrap_err().contains("nothing"));
        assert!(over("--params-file no/such.yaml").unwrap_err().contains("no/such.yaml"));
    }
}
