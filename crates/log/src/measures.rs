//! What a source of samples measures.

use grouser_files::columns::Meaning;

/// What a source of samples measures: a log, or the chosen topics of a live source.
///
/// ```
/// use grouser_files::columns::{self, Meaning};
/// use grouser_log::{Log, Measures};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let log = Log::find(&[example.join("log.csv")], columns::read(&example.join("columns.toml"))?)?;
/// assert!(Measures::measures(&log, Meaning::YawRate));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Measures {
    /// The wheels, to which the samples' indices refer.
    fn wheels(&self) -> &[String];

    /// Is a quantity of that meaning measured?
    fn measures(&self, meaning: Meaning) -> bool;

    /// Is a quantity of that meaning measured for that wheel?
    fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool;

    /// Is all of it columns of tables, and nothing messages?
    fn is_of_tables(&self) -> bool {
        false
    }

    /// The standard deviation of a place by the reference, m, where the messages state it.
    fn position_sigma(&self) -> Option<f64>;

    /// The position of the sensor of the speed by the log's transforms, forwards and to the left of the robot's origin, m; the
    /// speed is along the robot's axes.
    fn speed_place(&self) -> [f64; 2] {
        [0.0; 2]
    }
}
