//! What is wrong with a URDF.

use grouser_terra::OutOfRange;

/// What is wrong with a URDF, or why no robot file can be made of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// It is no well-formed XML.
    #[error("{line}:{column}: {message}")]
    Xml {
        /// From 1.
        line: u32,
        /// From 1.
        column: u32,
        /// What the parser says.
        message: String,
    },
    /// Its outermost element is another one.
    #[error("its outermost element is <{found}>, not <robot>")]
    NotARobot {
        /// The element.
        found: String,
    },
    /// It has macros that were not expanded.
    #[error("{line}: {what} is of xacro, which must be expanded first")]
    Xacro {
        /// From 1.
        line: u32,
        /// The element or the value.
        what: String,
    },
    /// A number that is to be filled in from the environment or from arguments.
    #[error("{line}: {attribute} of <{element}> is `{text}`, which was not filled in")]
    Substitution {
        /// From 1.
        line: u32,
        /// The element.
        element: String,
        /// Its attribute.
        attribute: &'static str,
        /// What it says.
        text: String,
    },
    /// Something has no name or lacks an attribute.
    #[error("{line}: <{element}> lacks {what}")]
    Missing {
        /// From 1.
        line: u32,
        /// The element.
        element: String,
        /// What it lacks.
        what: &'static str,
    },
    /// A text that is no number, or not as many of them.
    #[error("{line}: {attribute} of <{element}> is `{text}`, but must be {count} numbers")]
    Number {
        /// From 1.
        line: u32,
        /// The element.
        element: String,
        /// Its attribute.
        attribute: &'static str,
        /// What it says.
        text: String,
        /// How many are needed.
        count: usize,
    },
    /// A number outside its limits.
    #[error("{line}: {range}")]
    OutOfRange {
        /// From 1.
        line: u32,
        /// The attribute and its element, and the limits.
        range: OutOfRange<String>,
    },
    /// Two links or two joints have one name.
    #[error("{line}: there is another {element} \"{name}\"")]
    Twice {
        /// From 1.
        line: u32,
        /// `link` or `joint`.
        element: &'static str,
        /// The name.
        name: String,
    },
    /// A joint names a link that does not exist.
    #[error("joint \"{joint}\" names the link \"{link}\", which does not exist{}", .meant.as_ref().map(|m| format!("; did you mean \"{m}\"?")).unwrap_or_default())]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
        /// The nearest name that exists.
        meant: Option<String>,
    },
    /// Links do not make one tree.
    #[error("its links make no tree: {what}")]
    NoTree {
        /// Why not.
        what: String,
    },
    /// No joint is a wheel.
    #[error("none of its joints is a wheel{}", if .turning.is_empty() { String::new() } else { format!("; without end turn {}", .turning.join(", ")) })]
    NoWheels {
        /// Its continuous joints.
        turning: Vec<String>,
    },
    /// A wheel's shape is a mesh alone, whose radius is not given.
    #[error(
        "link \"{link}\" of the joint \"{joint}\" is a mesh alone, which does not tell a wheel's radius"
    )]
    MeshOnly {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
}

impl UrdfError {
    /// What to do about it, where there is something to say.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Self::Xacro { .. } | Self::NotARobot { .. } => {
                "expand macros with `xacro robot.urdf.xacro > robot.urdf` (`ros2 run xacro xacro …`)"
            }
            Self::Substitution { .. } => {
                "write the number in its place: `$(optenv NAME VALUE)` is the environment variable NAME, or else VALUE; \
                 `$(arg NAME)` is an argument"
            }
            Self::NoWheels { .. } => {
                "a wheel is a link with a <cylinder> or <sphere> as collision, on a continuous joint \
                 whose axis lies across"
            }
            Self::MeshOnly { .. } => {
                "give the link a <collision> with a <cylinder radius length>, its axis along the joint's"
            }
            _ => return None,
        };
        Some(hint.to_owned())
    }
}
