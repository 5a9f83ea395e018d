//! Robot files out of URDF: wheel poses, radii, widths and masses; rockers, steering, the body's mass.
//!
//! A wheel is a link with a cylinder or a sphere as its collision, on a continuous joint whose axis lies across to
//! within 17°. Origins are composed along all joints, each at 0; fixed links count to what carries them. A joint that
//! turns across the robot and carries wheels becomes a `[[link]]`, with `opposite` where one mimics the other with
//! the factor −1; an upright revolute joint above a wheel is its steering. Heights count from the plane of the lowest
//! wheel, x and y from the root link.
//!
//! Boxes that stand evenly around a wheel's rim, in its link or fixed to it, are its lugs.
//!
//! Where transmissions or `ros2_control` name any of the wheels' joints, the other wheels are free.
//!
//! Source: the URDF specification (wiki.ros.org/urdf/XML).
//!
//! ```
//! let text = r#"<robot name="cart">
//!   <link name="base"><inertial><mass value="4"/></inertial></link>
//!   <link name="left"><collision><origin rpy="1.5707963 0 0"/>
//!     <geometry><cylinder radius="0.1" length="0.05"/></geometry></collision></link>
//!   <joint name="left_wheel_joint" type="continuous"><origin xyz="0 0.2 0.1"/>
//!     <parent link="base"/><child link="left"/><axis xyz="0 1 0"/></joint>
//! </robot>"#;
//! let converted = grouser_files::urdf::robot_file(text)?;
//! assert!(converted.text.contains("name = \"left\""));
//! assert!(converted.text.contains("y_m = 0.2\n") && converted.text.contains("radius_m = 0.1\n"));
//! # Ok::<(), grouser_files::urdf::UrdfError>(())
//! ```

mod error;
mod frame;
mod lugs;
mod mass;
mod parts;
mod text;
mod tree;

pub use error::UrdfError;

/// Greatest size of a URDF, bytes.
pub const SIZE_LIMIT: u64 = 1 << 24;

/// A robot file out of a URDF.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Converted {
    /// The robot's name.
    pub name: String,
    /// Its wheels.
    pub wheels: usize,
    /// The text of the robot file.
    pub text: String,
    /// What was left out, and what is to be added.
    pub notes: Vec<String>,
}

/// The robot file of what a URDF describes.
///
/// # Errors
/// [`UrdfError`] for what is no URDF, for macros that were not expanded, for links that make no tree, and where no
/// joint is a wheel or a wheel's radius is not given.
///
/// ```
/// use grouser_files::urdf;
///
/// let error = urdf::robot_file("<robot name=\"stone\"><link name=\"base\"/></robot>").unwrap_err();
/// assert!(error.to_string().contains("wheel"));
/// ```
pub fn robot_file(urdf: &str) -> Result<Converted, UrdfError> {
    let tree = tree::Tree::parse(urdf)?;
    let parts = parts::Parts::from_tree(&tree)?;
    Ok(Converted {
        text: text::text(&tree, &parts),
        wheels: parts.wheels.len(),
        notes: parts.notes,
        name: tree.name,
    })
}
