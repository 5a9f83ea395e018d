//! Wheel tests out of a table.

use std::path::Path;

use grouser_terra::{Angle, Kinematics, Slip};

use super::columns::{
    DEVIATIONS, LOAD, PULL, RIM, SIDE, SINKAGE, SLIP, SLIP_ANGLE, TORQUE, TRAVEL, side_force,
};
use super::test::{Support, WheelTest};
use crate::error::{Error, Result};
use crate::table::{Column, Table};

/// Slip and speeds that are both stated agree within this: their rounding, and the noise of a speed.
const SAME_SLIP: f64 = 0.02;

/// The wheel tests of a table.
///
/// Motion: `slip` (in the wheel's plane), or `rim_speed_m_per_s` with `travel_speed_m_per_s` (both also in
/// `mm_per_s`), with `slip_angle_deg` where the wheel drifts. Support: `load_n`; a row without one is taken at
/// its measured sinkage. Readings, any of them, empty where there is none: `drawbar_pull_n`, `side_force_n` (to the
/// left), `torque_nm`, `sinkage_m` or `sinkage_mm`. The names in the files of measured data are read as well
/// ([`columns`](super::columns)); a slip beside speeds must agree with them, in the wheel's plane or along the travel.
///
/// # Errors
/// As [`Table::optional`] and [`Table::refuse_unread`]; [`Error::Law`] for a motion that is none; [`Error::Content`] for a row without load
/// and sinkage.
///
/// ```
/// use grouser_identify::wheel::{Quantity, read_table};
///
/// let tests = read_table("../../examples/bevameter/wheel.csv".as_ref())?;
/// assert!(tests.iter().any(|test| test.read(Quantity::Pull).is_some()));
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn read_table(path: &Path) -> Result<Vec<WheelTest>> {
    let table = Table::read(path)?;
    let read = [
        SLIP, SLIP_ANGLE, RIM, TRAVEL, LOAD, PULL, SIDE, TORQUE, SINKAGE,
    ];
    table.refuse_unread(&[&read[..], &DEVIATIONS].concat())?;
    let given = |column: Column| -> Result<Vec<Option<f64>>> {
        if table.has(column) {
            table.optional(column)
        } else {
            Ok(vec![None; table.len()])
        }
    };
    let by_speeds = table.has(RIM);
    if by_speeds != table.has(TRAVEL) {
        return Err(Error::Content {
            path: path.to_owned(),
            message: "wheel speed and travel speed are read together, but one of them is absent"
                .to_owned(),
        });
    }
    let (rim, travel) = (given(RIM)?, given(TRAVEL)?);
    let slip = if by_speeds || table.has(SLIP) {
        given(SLIP)?
    } else {
        table.optional(SLIP)?
    };
    let angle = given(SLIP_ANGLE)?;
    let (load, pull, side) = (given(LOAD)?, given(PULL)?, side_force(&table)?);
    let (torque, sinkage) = (given(TORQUE)?, given(SINKAGE)?);
    (0..table.len())
        .map(|row| {
            let refuse = |message: &str| Error::Content {
                path: path.to_owned(),
                message: format!("row {}: {message}", row + 1),
            };
            let degrees = angle[row].unwrap_or(0.0);
            let beta = Angle::from_deg(degrees);
            let motion = match (rim[row], travel[row], slip[row]) {
                (Some(rim), Some(travel), _) => {
                    let forward = if degrees.abs() == 90.0 {
                        0.0
                    } else {
                        beta.cos()
                    };
                    Kinematics::from_speeds(travel * forward, travel * beta.sin(), rim)
                }
                (_, _, Some(slip)) if slip.abs() > 1.0 => {
                    return Err(refuse(&format!(
                        "slip is {slip}, but must lie in [-1, 1]: is it in percent?"
                    )));
                }
                (_, _, Some(slip)) => {
                    Slip::new(slip).and_then(|slip| Kinematics::with_slip_angle(slip, beta))
                }
                _ => return Err(refuse("neither slip nor speeds")),
            };
            let kinematics = motion.map_err(|source| Error::Law {
                what: format!("{}: row {}", path.display(), row + 1),
                source,
            })?;
            if let (Some(rim), Some(travel), Some(stated)) = (rim[row], travel[row], slip[row]) {
                let along = Kinematics::from_speeds(travel, 0.0, rim).map(|along| along.slip());
                let differs = |slip: Slip| (slip.value() - stated).abs() > SAME_SLIP;
                if differs(kinematics.slip()) && along.is_ok_and(differs) {
                    return Err(refuse("slip and speeds disagree; leave one of them empty"));
                }
            }
            let support = match (load[row], sinkage[row]) {
                (Some(load), _) => Support::Load(load),
                (None, Some(sinkage)) => Support::Sinkage(sinkage),
                (None, None) => return Err(refuse("neither load nor sinkage")),
            };
            Ok(WheelTest {
                kinematics,
                support,
                pull: pull[row],
                side: side[row],
                torque: torque[row],
                sinkage: load[row].and(sinkage[row]),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<Vec<WheelTest>> {
        let file = std::env::temp_dir().join(format!("grouser-{name}-{}.csv", std::process::id()));
        std::fs::write(&file, text).unwrap();
        let read = read_table(&file);
        std::fs::remove_file(&file).unwrap();
        read
    }

    #[test]
    fn speeds_and_slip_say_the_same() {
        let by_slip = read(
            "slip",
            "slip,slip_angle_deg,load_n,sinkage_mm\n0.25,30,40,12\n",
        )
        .unwrap();
        // in the wheel's plane 0.06 m/s of 0.08 m/s: slip 0.25; along the travel 0.06/cos 30°
        let travel = 60.0 / 30_f64.to_radians().cos();
        let by_speed = read(
            "speed",
            &format!(
                "rim_speed_mm_per_s,travel_speed_mm_per_s,slip_angle_deg,load_n,sinkage_m\n80,{travel},30,40,0.012\n"
            ),
        )
        .unwrap();
        let (a, b) = (&by_slip[0], &by_speed[0]);
        assert!((a.kinematics.slip().value() - b.kinematics.slip().value()).abs() < 1e-14);
        assert!((a.kinematics.q_y() - b.kinematics.q_y()).abs() < 1e-14);
        assert_eq!((a.support, a.sinkage), (Support::Load(40.0), Some(0.012)));
        assert_eq!((a.pull, a.torque), (None, None));
    }

    #[test]
    fn a_row_without_a_load_stands_at_its_sinkage() {
        let tests = read(
            "held",
            "slip,load_n,sinkage_mm,torque_nm\n0.1,,8,0.5\n0.1,30,,0.5\n",
        )
        .unwrap();
        assert_eq!(tests[0].support, Support::Sinkage(0.008));
        assert_eq!(tests[0].sinkage, None);
        assert_eq!(tests[1].support, Support::Load(30.0));
        let neither = read("neither", "slip,load_n,sinkage_mm\n0.1,,\n").unwrap_err();
        assert!(neither.to_string().contains("row 1"), "{neither}");
        let both = |slip: f64| {
            let header = "slip,rim_speed_m_per_s,travel_speed_m_per_s,load_n";
            read("both", &format!("{header}\n{slip},1,0.9,30\n"))
        };
        assert!(both(0.1).is_ok() && both(0.119).is_ok());
        assert!(both(0.121).unwrap_err().to_string().contains("leave one"));
        for unread in [
            "beta_deg",
            "mass_kg",
            "load_kn",
            "rim_speed_m_per_s",
            "Slip_Angle_deg",
        ] {
            let refused = read(unread, &format!("slip,load_n,{unread}\n0.1,30,1\n"));
            let refused = refused.unwrap_err().to_string();
            assert!(
                refused.contains("is a quantity that is not read") || refused.contains("absent"),
                "{refused}"
            );
        }
        let twice = read(
            "twice",
            "slip,load_n,sinkage_m,sinkage_mm\n0.1,30,0.01,20\n",
        );
        assert!(
            twice
                .unwrap_err()
                .to_string()
                .contains("more than one column")
        );
        assert!(read("note", "slip,load_n,note,measured_speed\n0.1,30,x,1\n").is_ok());
        let beyond = read("beyond", "slip,load_n\n1.5,30\n").unwrap_err();
        assert!(beyond.to_string().contains("row 1"), "{beyond}");
    }

    /// A wheel that drifts to its left, as `identify` and as the measured data of `validate` name it.
    #[test]
    fn the_names_of_measured_data_are_read() {
        let own = read(
            "own",
            "slip_angle_deg,rim_speed_mm_per_s,travel_speed_mm_per_s,load_n,drawbar_pull_n,side_force_n,sinkage_mm\n\
             30,20,10,25,-4,-7,11\n",
        );
        let of_bed = read(
            "bed",
            "wheel,slip_angle_deg,slip,rim_speed_mm_s,carriage_speed_mm_s,side_force_n,side_force_sd_n,drag_force_n,\
             drag_force_sd_n,vertical_force_n,vertical_force_sd_n,height_mm,trial\n\
             smooth,30,0.5,20,10,7,0.3,4,0.2,-25,0.1,-11,1\n",
        );
        assert_eq!(own.unwrap(), of_bed.unwrap());
        let measured = read(
            "measured",
            "slip,vertical_load_n,meas_drawbar_pull_n,meas_torque_nm,meas_sinkage_m\n0.1,80,14,3.5,0.005\n",
        );
        let same = read(
            "same",
            "slip,load_n,drawbar_pull_n,torque_nm,sinkage_m\n0.1,80,14,3.5,0.005\n",
        );
        assert_eq!(measured.unwrap(), same.unwrap());
    }
}
