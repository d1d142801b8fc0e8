//! Reads the messages of an MCAP recording.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use serde::de::DeserializeOwned;
use surepose::time::Stamp;
use surepose_io::mcap::{McapEnding, McapError, McapReadError, McapRecord, ReadLimits, read_records};
use surepose_io::read_plain;

use crate::convert::stamp_of;
use crate::message::{
    Imu, LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TfMessage, Twist, TwistStamped,
};
use crate::names::Names;

use super::files::files_of;

use super::{BagError, Truncation};

/// Message types that are read.
const ODOMETRY: &str = "nav_msgs/msg/Odometry";
const SCAN: &str = "sensor_msgs/msg/LaserScan";
const IMU: &str = "sensor_msgs/msg/Imu";
const POSE: &str = "geometry_msgs/msg/PoseStamped";
const POSE_WITH_COVARIANCE: &str = "geometry_msgs/msg/PoseWithCovarianceStamped";
const TWIST: &str = "geometry_msgs/msg/Twist";
const TWIST_STAMPED: &str = "geometry_msgs/msg/TwistStamped";
const JOINTS: &str = "tf2_msgs/msg/TFMessage";

/// Topic of static transforms, the same for all robots by convention.
const STATIC: &str = "/tf_static";

/// Message of the recording that the driver uses.
pub(super) enum BagMessage {
    Odometry(Box<Odometry>),
    Scan(LaserScan),
    Imu(Box<Imu>),
    Truth(Box<PoseStamped>),
    StaticTransforms(TfMessage),
    Command(RecordedCommand),
}

/// A velocity command, with the time at which it was recorded.
pub(super) struct RecordedCommand {
    /// Time at which the recorder received it.
    pub(super) received: Stamp,
    /// Its own stamp, if it has one.
    pub(super) stamp: Option<Stamp>,
    pub(super) twist: Twist,
}

/// Role of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Odometry,
    Scan,
    Imu,
    Truth,
    StaticTransforms,
    Command,
}

impl Role {
    /// Name of this role's topic in the node.
    fn name(self) -> &'static str {
        match self {
            Self::Odometry => "odom",
            Self::Scan => "scan",
            Self::Imu => "imu",
            Self::Truth => "truth",
            Self::StaticTransforms => STATIC,
            Self::Command => "cmd_vel",
        }
    }

    /// Message types of this role.
    fn kinds(self) -> &'static [&'static str] {
        match self {
            Self::Odometry => &[ODOMETRY],
            Self::Scan => &[SCAN],
            Self::Imu => &[IMU],
            Self::Truth => &[POSE, POSE_WITH_COVARIANCE, ODOMETRY],
            Self::StaticTransforms => &[JOINTS],
            Self::Command => &[TWIST, TWIST_STAMPED],
        }
    }

    /// Whether the messages of `channel` can have this role.
    fn fits(self, channel: &Channel) -> bool {
        channel.encoding == "cdr" && self.kinds().contains(&channel.kind.as_str())
    }
}

/// Channel of a recording.
#[derive(Clone, Debug)]
struct Channel {
    topic: String,
    kind: String,
    encoding: String,
}

/// Recording with its files.
pub(super) struct Bag {
    parts: Vec<Part>,
    truncations: Vec<Truncation>,
}

/// File of a recording, with the roles of its channels.
struct Part {
    path: PathBuf,
    roles: BTreeMap<u16, (Role, Channel)>,
}

impl Bag {
    /// Opens the recording at `path`, a file or a folder with one recording, with the topics of `names`.
    ///
    /// Except for truth and commands, a topic that is the only one of its type may have any name. Odometry and `required` topics must exist.
    ///
    /// # Errors
    /// [`BagError`] for an unreadable, damaged or ambiguous recording.
    pub(super) fn open(path: &Path, names: &Names, required: &[Role]) -> Result<Self, BagError> {
        let files = files_of(path)?;
        let read = |file: &PathBuf| channels(file).map_err(|problem| in_part(files.len(), file, problem));
        let of_files: Vec<_> = files.iter().map(read).collect::<Result<_, _>>()?;
        let (of_files, endings): (Vec<_>, Vec<_>) = of_files.into_iter().unzip();
        let truncations =
            files.iter().zip(endings).filter_map(|(file, ending)| truncation(file, ending)).collect();
        let channels: Vec<_> = of_files.iter().flat_map(|channels| channels.values().cloned()).collect();
        // A truth of type odometry is not the robot's odometry.
        let truth = topic(&channels, names, Role::Truth, None)?;
        let of = |role: Role| match topic(&channels, names, role, truth.as_deref())? {
            None if role == Role::Odometry || required.contains(&role) => Err(BagError::NoTopic {
                name: role.name().to_owned(),
                kind: role.kinds().join(" or "),
                present: present(&channels),
            }),
            found => Ok(found),
        };
        let topics = [
            (Role::Odometry, of(Role::Odometry)?),
            (Role::Scan, of(Role::Scan)?),
            (Role::Imu, of(Role::Imu)?),
            (Role::Truth, truth),
            (Role::StaticTransforms, Some(STATIC.to_owned())),
            (Role::Command, topic(&channels, names, Role::Command, None)?),
        ];
        let role = |channel: &Channel| {
            let plays = |(role, topic): &&(Role, Option<String>)| {
                topic.as_ref() == Some(&channel.topic) && role.fits(channel)
            };
            topics.iter().find(plays).map(|(role, _)| *role)
        };
        let part = |(path, channels): (PathBuf, BTreeMap<u16, Channel>)| {
            let roles =
                channels.into_iter().filter_map(|(id, channel)| Some((id, (role(&channel)?, channel))));
            Part { path, roles: roles.collect() }
        };
        Ok(Self { parts: files.into_iter().zip(of_files).map(part).collect(), truncations })
    }

    /// Truncated files.
    pub(super) fn truncations(&self) -> &[Truncation] {
        &self.truncations
    }

    /// Whether a replay needs the index: for a truth or static transforms.
    pub(super) fn needs_index(&self) -> bool {
        let mut roles = self.parts.iter().flat_map(|part| part.roles.values());
        roles.any(|(role, _)| matches!(role, Role::Truth | Role::StaticTransforms))
    }

    /// Passes each message of a known role to `consume`, in the order of the files.
    ///
    /// # Errors
    /// [`BagError`] for a damaged recording, or a message that does not match its type.
    pub(super) fn messages(&self, mut consume: impl FnMut(BagMessage)) -> Result<(), BagError> {
        let mut numbers = BTreeMap::<&str, u64>::new();
        self.parts.iter().try_for_each(|part| {
            records(&part.path, |record| {
                let McapRecord::Message { channel_id, log_time, data } = record else { return Ok(()) };
                let Some((role, channel)) = part.roles.get(&channel_id) else { return Ok(()) };
                let number = numbers.entry(&channel.topic).or_default();
                *number += 1;
                let received = Stamp::from_nanoseconds(i64::try_from(log_time).unwrap_or(i64::MAX));
                let said =
                    said(*role, &channel.kind, received, data).map_err(|problem| BagError::Message {
                        number: *number,
                        topic: channel.topic.escape_debug().to_string(),
                        kind: channel.kind.clone(),
                        problem,
                    })?;
                consume(said);
                Ok(())
            })
            .map(|_| ())
            .map_err(|problem| in_part(self.parts.len(), &part.path, problem))
        })
    }
}

/// Adds the file's name to an error if the recording has several `parts`.
fn in_part(parts: usize, path: &Path, problem: BagError) -> BagError {
    if parts == 1 {
        return problem;
    }
    let file = path.file_name().unwrap_or_default().to_string_lossy().escape_debug().to_string();
    BagError::Part { file, problem: Box::new(problem) }
}

/// Decodes a message. The truth may have several types.
fn said(role: Role, kind: &str, received: Stamp, data: &[u8]) -> Result<BagMessage, String> {
    Ok(match role {
        Role::Odometry => BagMessage::Odometry(decoded(data)?),
        Role::Scan => BagMessage::Scan(decoded(data)?),
        Role::Imu => BagMessage::Imu(decoded(data)?),
        Role::StaticTransforms => BagMessage::StaticTransforms(decoded(data)?),
        Role::Command if kind == TWIST => {
            BagMessage::Command(RecordedCommand { received, stamp: None, twist: decoded(data)? })
        }
        Role::Command => {
            let TwistStamped { header, twist } = decoded(data)?;
            BagMessage::Command(RecordedCommand { received, stamp: Some(stamp_of(header.stamp)), twist })
        }
        Role::Truth => BagMessage::Truth(Box::new(match kind {
            ODOMETRY => {
                let told: Odometry = decoded(data)?;
                PoseStamped { header: told.header, pose: told.pose.pose }
            }
            POSE_WITH_COVARIANCE => {
                let told: PoseWithCovarianceStamped = decoded(data)?;
                PoseStamped { header: told.header, pose: told.pose.pose }
            }
            _ => decoded(data)?,
        })),
    })
}

/// Truncation of a file; `None` if it is complete.
fn truncation(file: &Path, ending: McapEnding) -> Option<Truncation> {
    match ending {
        McapEnding::Complete => None,
        McapEnding::Truncated { offset } => Some(Truncation { file: file.to_owned(), offset }),
    }
}

/// Channels of a file by number, and the ending of the file.
fn channels(path: &Path) -> Result<(BTreeMap<u16, Channel>, McapEnding), BagError> {
    let (mut kinds, mut channels) = (BTreeMap::new(), BTreeMap::new());
    let ending = records(path, |record| {
        match record {
            McapRecord::Schema { id, name } => {
                kinds.insert(id, name.to_owned());
            }
            McapRecord::Channel { id, schema_id, topic, encoding } => {
                let kind = kinds.get(&schema_id).cloned().unwrap_or_default();
                let (topic, encoding) = (topic.to_owned(), encoding.to_owned());
                channels.entry(id).or_insert(Channel { topic, kind, encoding });
            }
            McapRecord::Message { .. } => {}
        }
        Ok(())
    })?;
    Ok((channels, ending))
}

/// Passes the records of a file, including those in chunks, to `on`.
fn records(
    path: &Path,
    on: impl FnMut(McapRecord<'_>) -> Result<(), BagError>,
) -> Result<McapEnding, BagError> {
    let unreadable = |problem| BagError::Unreadable { path: path.to_owned(), problem };
    let file = read_plain(path).map_err(unreadable)?;
    let length = std::fs::metadata(path).map_err(unreadable)?.len();
    read_records(file, ReadLimits::of_file(length), on).map_err(|problem| match problem {
        McapReadError::Io(problem) => unreadable(problem),
        McapReadError::Mcap(McapError::NoMagic) => BagError::NoMcap,
        McapReadError::Mcap(problem) => BagError::Damaged { problem },
        McapReadError::Consumer(problem) => problem,
    })
}

/// Topic of `role`: the one with the node's name, or else the only one of its type that is not `taken`.
///
/// Truth and commands must have the node's name.
fn topic(
    channels: &[Channel],
    names: &Names,
    role: Role,
    taken: Option<&str>,
) -> Result<Option<String>, BagError> {
    let mut candidates: Vec<_> = channels
        .iter()
        .filter(|channel| role.fits(channel) && Some(channel.topic.as_str()) != taken)
        .map(|channel| channel.topic.clone())
        .collect();
    candidates.sort();
    candidates.dedup();
    // `Names` checks its own names.
    let own = role.name();
    let name = names.of(own).map_or_else(|_| own.to_owned(), |name| name.to_string());
    if candidates.contains(&name) {
        return Ok(Some(name));
    }
    if names.is_remapped(own) {
        let kind = role.kinds().join(" or ");
        return Err(BagError::NoTopic { name, kind, present: present(channels) });
    }
    match candidates.as_slice() {
        // Other poses and velocities are not necessarily the truth and the commands of the base.
        _ if matches!(role, Role::Truth | Role::Command) => Ok(None),
        [] => Ok(None),
        [only] => Ok(Some(only.clone())),
        [first, ..] => {
            Err(BagError::Ambiguous { own, candidates: candidates.join(", "), first: first.clone() })
        }
    }
}

/// List of the topics.
fn present(channels: &[Channel]) -> String {
    let described =
        |channel: &Channel| format!("{} ({})", channel.topic.escape_debug(), channel.kind.escape_debug());
    // The files of a recording usually have the same topics.
    let listed = channels.iter().map(described).collect::<BTreeSet<_>>();
    let listed = listed.into_iter().collect::<Vec<_>>().join(", ");
    if listed.is_empty() { "none".to_owned() } else { listed }
}

/// Decodes CDR after its header of 4 bytes, which gives the byte order.
fn decoded<M: DeserializeOwned>(data: &[u8]) -> Result<M, String> {
    let (header, body) = data.split_at_checked(4).ok_or("no CDR header")?;
    let message = match header {
        [0, 0, ..] => from_bytes::<M, BigEndian>(body),
        [0, 1, ..] => from_bytes::<M, LittleEndian>(body),
        _ => return Err(format!("unknown encoding (got {header:02x?}, expected plain CDR)")),
    };
    message.map(|(message, _)| message).map_err(|problem| problem.to_string())
}
